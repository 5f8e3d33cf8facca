#include "common/scene/load/mitsuba/xml/variables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>

#include "common/error/error.h"

namespace pt::mitsuba {
namespace {

constexpr std::size_t max_expanded = std::size_t{64} << 20;

bool is_name_character(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

}  // namespace

// Of all names up to `name` in alphabetical order, what begins with a prefix of `name` comes after
// that prefix: the last of them either is the longest one or shares with `name` all that the
// longest one has.
Variables::Values::const_iterator Variables::longest_prefix_of(std::string_view name) const {
  while (!name.empty()) {
    const auto after = values_.upper_bound(name);
    if (after == values_.begin()) break;
    const auto candidate = std::prev(after);
    const std::string_view found = candidate->first;
    const auto [end, ignored] = std::mismatch(name.begin(), name.end(), found.begin(), found.end());
    const auto common = static_cast<std::size_t>(end - name.begin());
    if (common == found.size() && common > 0) return candidate;
    name = name.substr(0, common);
  }
  return values_.end();
}

std::string Variables::substitute(const std::string& text) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    if (text.compare(at, 2, "\\$") == 0) {
      result += '$';
      at += 2;
      continue;
    }
    if (text[at] != '$') {
      result += text[at++];
      continue;
    }
    std::size_t end = at + 1;
    while (end < text.size() && is_name_character(text[end])) ++end;
    const auto name = std::string_view(text).substr(at + 1, end - at - 1);
    const auto value = longest_prefix_of(name);
    if (value == values_.end()) {
      throw Error(fmt::format("${} is not defined; expected a <default> before it or -D {}=VALUE",
                              name, name));
    }
    used_.insert(value->first);
    expanded_ += value->second.size();
    if (expanded_ > max_expanded) {
      throw Error(fmt::format("variables expand to more than {} bytes", max_expanded));
    }
    result += value->second;
    at += 1 + value->first.size();
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
