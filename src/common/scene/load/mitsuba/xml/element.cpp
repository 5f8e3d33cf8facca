#include "common/scene/load/mitsuba/xml/element.h"

#include <fmt/format.h>

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

void fail(const Element& element, const std::string& message) {
  throw Error(element.place() + ": " + message);
}

}  // namespace pt::mitsuba
