// The lines of MTL files that name pictures.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "common/scene/load/obj/mtl_file.h"

namespace pt::obj {

/// Called with a kind of warning and its message.
using WarnOfKind = std::function<void(const std::string& kind, const std::string& message)>;

/// Reads what follows a statement such as map_Kd: options, the picture's name, which may be in
/// quotes and have spaces, and options again, as some exporters write them. The name ends before
/// the first word that is an option. `warn` is told of options that have no counterpart or that
/// are malformed; these change nothing.
MtlMap parse_mtl_map(std::string_view text, const WarnOfKind& warn);

}  // namespace pt::obj
