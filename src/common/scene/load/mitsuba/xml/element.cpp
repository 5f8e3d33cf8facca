#include "common/scene/load/mitsuba/xml/element.h"

#include <fmt/format.h>

#include "common/error/quoted.h"

namespace pt::mitsuba {

const std::string* Element::attribute(std::string_view name) const {
  for (const auto& [key, value] : attributes) {
    if (key == name) return &value;
  }
  return nullptr;
}

const std::string& Element::required(std::string_view name) const {
  if (const std::string* value = attribute(name)) return *value;
  fail(*this, fmt::format("<{}> has no attribute '{}'", tag, name));
}

std::string Element::place() const {
  return line == 0 ? file->string() : fmt::format("{}:{}", file->string(), line);
}

std::string shortened(const std::string& message) {
  constexpr std::size_t head = 150, tail = 150, limit = 320;  // bytes
  if (message.size() <= limit) return clipped(message, limit);
  std::size_t begin = message.size() - tail;
  for (int i = 0; i < 3 && (message[begin] & 0xc0) == 0x80; ++i) ++begin;
  return clipped(message, head) + " " + clipped(message.substr(begin), tail);
}

void fail(const Element& element, const std::string& message) {
  throw Error(element.place() + ": " + shortened(message));
}

}  // namespace pt::mitsuba
