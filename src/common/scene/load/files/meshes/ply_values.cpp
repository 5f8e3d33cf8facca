#include "common/scene/load/files/meshes/ply_values.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
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

namespace {

/// What stands for 1 among integers of which `most` is the largest.
float white_of(PlyType type, float most) {
  const int bits = 8 * static_cast<int>(size_bytes(type));
  const bool has_sign = type == PlyType::int8 || type == PlyType::int16 || type == PlyType::int32;
  const float largest = std::exp2(static_cast<float>(has_sign ? bits - 1 : bits)) - 1.0f;
  for (const float white : {255.0f, 65535.0f}) {
    if (most <= std::min(white, largest)) return std::min(white, largest);
    if (most <= white) return white;  // a text may exceed its type
  }
  return largest;
}

}  // namespace

void decode_ply_colors(std::vector<Color>& colors, PlyType type) {
  float most = 0.0f;
  for (const Color& c : colors) {
    for (int i = 0; i < 3; ++i) most = std::max(most, std::isfinite(c[i]) ? c[i] : 0.0f);
  }
  const float white = white_of(type, most);
  const auto decode = [&](float x) {
    if (!(x > 0.0f) || !std::isfinite(x)) return 0.0f;
    return is_integer(type) ? srgb_curve.decode(std::min(x / white, 1.0f)) : x;
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, colors.size(), 2048),
                    [&](const tbb::blocked_range<std::size_t>& block) {
                      for (std::size_t i = block.begin(); i < block.end(); ++i) {
                        Color& c = colors[i];
                        c = {decode(c.x), decode(c.y), decode(c.z)};
                      }
                    });
}

}  // namespace pt
