#include "common/scene/load/files/meshes/ply_values.h"

#include <fmt/format.h>

#include <cmath>

#include "common/image/codecs/tone_mapping.h"
#include "common/scene/load/files/meshes/ply_elements.h"
#include "common/scene/load/files/meshes/text_number.h"

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

Color decode_ply_color(const Color& numbers, PlyType type) {
  const auto decode = [&](float x) {
    if (!(x > 0.0f) || !std::isfinite(x)) return 0.0f;
    if (!is_integer(type)) return x;
    const double bits = 8.0 * static_cast<double>(size_bytes(type));
    const bool has_sign = type == PlyType::int8 || type == PlyType::int16 || type == PlyType::int32;
    const double largest = std::exp2(has_sign ? bits - 1.0 : bits) - 1.0;
    return srgb_curve.decode(static_cast<float>(x / largest));
  };
  return {decode(numbers.x), decode(numbers.y), decode(numbers.z)};
}

}  // namespace pt
