#include "common/files/ply_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace pt {
namespace {

bool is_space(char c) { return c == ' ' || ('\t' <= c && c <= '\r'); }

/// A number too large or too small for a double: from_chars does not say which.
double out_of_range(std::string_view word) {
  const bool tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
  return tiny ? 0.0 : std::numeric_limits<double>::infinity();
}

}  // namespace

double PlyTextValues::next(PlyType type) {
  const auto begin = std::find_if_not(rest_.begin(), rest_.end(), is_space);
  const auto end = std::find_if(begin, rest_.end(), is_space);
  std::string_view word(begin, end);
  rest_ = std::string_view(end, rest_.end());
  if (word.empty()) throw Error("the file ends here");
  if (word.starts_with('+')) word.remove_prefix(1);

  double value = 0;
  const auto [stop, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (failure == std::errc::result_out_of_range) value = out_of_range(word);
  if (failure == std::errc::invalid_argument || stop != word.data() + word.size() ||
      (is_integer(type) && value != std::floor(value))) {
    throw Error(fmt::format("expected {}, found '{}'", is_integer(type) ? "an integer" : "a number",
                            word.substr(0, 40)));
  }
  return value;
}

}  // namespace pt
