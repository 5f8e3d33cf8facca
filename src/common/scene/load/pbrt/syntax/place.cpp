#include "common/scene/load/pbrt/syntax/place.h"

#include <fmt/format.h>

#include "common/error/error.h"

namespace pt::pbrt {

std::string Place::text() const { return fmt::format("{}:{}:{}", *file, line, column); }

void fail(const Place& place, std::string_view message) {
  throw Error(fmt::format("{}: {}", place.text(), message));
}

}  // namespace pt::pbrt
