#include "common/scene/load/files/counted_warnings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "common/error/quoted.h"

namespace pt {
namespace {

constexpr std::size_t names_max = 6;  // of a kind, in its message and behind it

}  // namespace

void CountedWarnings::add(std::string_view kind, std::string_view message, std::string_view name) {
  const auto [entry, is_new] = index_of_.try_emplace(std::string(kind), kinds_.size());
  if (is_new) kinds_.push_back({std::string(message), 0, {}});
  Kind& known = kinds_[entry->second];
  if (!is_new) ++known.more;
  if (name.empty() || known.names.size() == names_max) return;
  const std::string shown = in_quotes(name);
  if (std::ranges::find(known.names, shown) == known.names.end()) known.names.push_back(shown);
}

std::vector<std::string> CountedWarnings::lines() const {
  std::vector<std::string> lines;
  for (const Kind& kind : kinds_) {
    std::string line = kind.message;
    if (kind.more > 0) line += fmt::format(" (and {} more", kind.more);
    if (kind.names.size() > 1) {
      line += fmt::format(", also {}", fmt::join(kind.names.begin() + 1, kind.names.end(), ", "));
    }
    lines.push_back(kind.more > 0 ? line + ")" : line);
  }
  return lines;
}

}  // namespace pt
