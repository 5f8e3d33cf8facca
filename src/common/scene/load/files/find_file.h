// Files under the names that other files give them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace pt {

/// Called with a line about a name that is not exactly that of the file.
using WarnOfName = std::function<void(const std::string&)>;

/// folder / name where that exists. Else what differs from it in the case of ASCII letters within
/// `name` alone (files made on Windows; the first in alphabetical order), of which `warn` is told;
/// else an empty path.
std::filesystem::path find_file(const std::filesystem::path& folder,
                                const std::filesystem::path& name, const WarnOfName& warn);

}  // namespace pt
