#include "common/scene/load/pbrt/syntax/place.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/error/error.h"

namespace pt::pbrt {

std::string Place::text() const { return fmt::format("{}:{}:{}", *file, line, column); }

std::string message_at(const Place& place, std::string_view message) {
  std::string text = fmt::format("{}: {}", place.text(), message);
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  std::ranges::replace_if(text, is_control, ' ');
  return text;
}

void fail(const Place& place, std::string_view message) { throw Error(message_at(place, message)); }

}  // namespace pt::pbrt
