#include "common/scene/load/files/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <limits>

#include "common/error/error.h"

namespace pt {
namespace {

/// A number too large or too small for a double: from_chars does not say which.
double out_of_range(std::string_view word) {
  const bool tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
  return tiny ? 0.0 : std::numeric_limits<double>::infinity();
}

}  // namespace

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_text_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_text_space(text.back())) text.remove_suffix(1);
  return text;
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

std::string_view next_word(std::string_view& text) {
  const auto begin = std::find_if_not(text.begin(), text.end(), is_text_space);
  const auto end = std::find_if(begin, text.end(), is_text_space);
  text = std::string_view(end, text.end());
  return std::string_view(begin, end);
}

double parse_number(std::string_view word) {
  const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
  double value = 0;
  const char* end = digits.data() + digits.size();
  const auto [stop, failure] = std::from_chars(digits.data(), end, value);
  if (failure == std::errc::invalid_argument || stop != end) {
    throw Error(fmt::format("expected a number, found {}", in_quotes(word, 40)));
  }
  return failure == std::errc::result_out_of_range ? out_of_range(digits) : value;
}

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
