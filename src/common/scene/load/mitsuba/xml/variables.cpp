#include "common/scene/load/mitsuba/xml/variables.h"

#include <fmt/format.h>

#include <cctype>

#include "common/error/error.h"

namespace pt::mitsuba {
namespace {

bool is_name_character(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

}  // namespace

std::string Variables::substitute(const std::string& text) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] != '$') {
      result += text[at++];
      continue;
    }
    std::size_t end = at + 1;
    while (end < text.size() && is_name_character(text[end])) ++end;
    const std::string name = text.substr(at + 1, end - at - 1);
    std::size_t length = name.size();
    while (length > 0 && !values_.count(name.substr(0, length))) --length;
    if (length == 0) {
      throw Error(fmt::format("${} is not defined; expected a <default> before it or -D {}=VALUE",
                              name, name));
    }
    const auto value = values_.find(name.substr(0, length));
    used_.insert(value->first);
    result += value->second;
    at += 1 + length;
  }
  return result;
}

void Variables::check_used(const std::string& file) const {
  std::string names;
  for (const auto& [name, value] : definitions_) {
    if (!used_.count(name)) names += (names.empty() ? "" : ", ") + name;
  }
  if (!names.empty()) {
    throw Error(fmt::format("-D {}: {} has no such variable", names, file));
  }
}

}  // namespace pt::mitsuba
