#include "common/scene/files/ply_values.h"

#include <fmt/format.h>

#include <cmath>

#include "common/scene/files/text_number.h"

namespace pt {

double PlyTextValues::next(PlyType type) {
  const std::string_view word = next_word(rest_);
  if (word.empty()) throw Error("the file ends here");
  const double value = parse_number(word);
  if (is_integer(type) && value != std::floor(value)) {
    throw Error(fmt::format("expected an integer, found '{}'", word.substr(0, 40)));
  }
  return value;
}

}  // namespace pt
