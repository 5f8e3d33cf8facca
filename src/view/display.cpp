// What a display shows of an image: tone curves, and colours for AOVs.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "common/film/aov.h"
#include "common/image/tone_mapping.h"
#include "common/sampling/random.h"
#include "view/change_settings.h"

namespace pt {
namespace {

float largest(const Color& c) { return std::max({c.x, c.y, c.z}); }
float smallest(const Color& c) { return std::min({c.x, c.y, c.z}); }

/// The Khronos PBR Neutral Tone Mapper (Khronos Group, 2024, specification of version 1.0).
Color neutral(Color c) {
  constexpr float start = 0.8f - 0.04f, desaturation = 0.15f, room = 1.0f - start;
  const float x = smallest(c);
  c -= x < 0.08f ? x - 6.25f * x * x : 0.04f;  // what a dielectric's surface of 4 % adds
  const float peak = largest(c);
  if (peak < start) return c;
  const float lowered = 1.0f - room * room / (peak + room - start);
  const float white = 1.0f - 1.0f / (desaturation * (peak - lowered) + 1.0f);
  return glm::mix(c * (lowered / peak), Color(lowered), white);
}

/// AgX (T. Sobotka, 2022) by the fit of its base contrast of sixth degree (B. Wrensch, 'Minimal AgX
/// Implementation', 2023). Its values are those of the display: the sRGB curve encodes them again.
Color agx(const Color& c) {
  constexpr float least_ev = -12.47393f, most_ev = 4.026069f;
  const glm::mat3 inset(0.842479062253094f, 0.0423282422610123f, 0.0423756549057051f,
                        0.0784335999999992f, 0.878468636469772f, 0.0784336f, 0.0792237451477643f,
                        0.0791661274605434f, 0.879142973793104f);
  const glm::mat3 outset(1.19687900512017f, -0.0528968517574562f, -0.0529716355144438f,
                         -0.0980208811401368f, 1.15190312990417f, -0.0980434501171241f,
                         -0.0990297440797205f, -0.0989611768448433f, 1.15107367264116f);
  const Color linear = glm::max(inset * glm::max(c, Color(0.0f)), Color(1e-10f));
  const Color x =
      (glm::clamp(glm::log2(linear), least_ev, most_ev) - least_ev) / (most_ev - least_ev);
  const Color x2 = x * x, x4 = x2 * x2;
  const Color contrast = 15.5f * x4 * x2 - 40.14f * x4 * x + 31.96f * x4 - 6.868f * x2 * x +
                         0.4298f * x2 + 0.1191f * x - 0.00232f;
  const Color shown = glm::clamp(outset * contrast, 0.0f, 1.0f);
  return {srgb_curve.decode(shown.x), srgb_curve.decode(shown.y), srgb_curve.decode(shown.z)};
}

/// ACES by the fit of its RRT and ODT (K. Narkowicz, 'ACES Filmic Tone Mapping Curve', 2016).
Color aces(const Color& c) {
  const Color x = glm::max(c, Color(0.0f));
  return x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f);
}

/// `make(pixel)` is its colour.
template <class Make>
void fill(Image& image, Make&& make) {
  const std::size_t pixels = static_cast<std::size_t>(image.width) * image.height;
  image.rgb.resize(3 * pixels);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pixels, 4096), [&](auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Color color = make(i);
      std::copy_n(&color.x, 3, &image.rgb[3 * i]);
    }
  });
}

Picture picture_of_colors(const Image& image, const Display& display) {
  Picture picture{{image.width, image.height, {}}, display.exposure, {}};
  if (display.curve == ToneCurve::srgb) {
    picture.image.rgb = image.rgb;
    return picture;
  }
  const auto curve = display.curve == ToneCurve::neutral ? neutral
                     : display.curve == ToneCurve::agx   ? +[](Color c) { return agx(c); }
                                                         : +[](Color c) { return aces(c); };
  const float scale = std::exp2(display.exposure);
  fill(picture.image, [&](std::size_t i) {
    const float* const c = &image.rgb[3 * i];
    return curve(scale * Color(c[0], c[1], c[2]));
  });
  picture.exposure = 0;
  return picture;
}

/// Linear, so that the display shows `shown`.
Color decoded(const Color& shown) {
  const Color c = glm::clamp(shown, 0.0f, 1.0f);
  return {srgb_curve.decode(c.x), srgb_curve.decode(c.y), srgb_curve.decode(c.z)};
}

/// Viridis (S. van der Walt and N. Smith, 2015), at equal distances.
Color scale_color(float x) {
  constexpr std::uint32_t viridis[] = {0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c,
                                       0x28ae80, 0x5ec962, 0xaddc30, 0xfde725};
  const auto rgb = [](std::uint32_t c) {
    return Color(float(c >> 16), float(c >> 8 & 255), float(c & 255)) / 255.0f;
  };
  const float at = 8.0f * std::clamp(x, 0.0f, 1.0f);
  const int i = std::min(static_cast<int>(at), 7);
  return decoded(glm::mix(rgb(viridis[i]), rgb(viridis[i + 1]), at - static_cast<float>(i)));
}

/// The least of the finite values and the one that a hundredth exceeds. `counts_zero`: else 0 is no
/// value.
std::array<float, 2> range_of(std::vector<float> values, bool counts_zero) {
  std::erase_if(values, [&](float x) { return !std::isfinite(x) || (!counts_zero && x == 0.0f); });
  if (values.empty()) return {0, 0};
  const float least = *std::ranges::min_element(values);
  const auto high =
      values.begin() + static_cast<std::ptrdiff_t>(values.size() - 1 - values.size() / 100);
  std::ranges::nth_element(values, high);
  return {least, *high};
}

float share_of(float x, const std::array<float, 2>& range) {
  return range[1] > range[0] ? (x - range[0]) / (range[1] - range[0]) : 0.0f;
}

Picture picture_of_numbers(Picture picture, const AovInfo& info, std::vector<float> values,
                           int samples) {
  if (info.name == aov::Variance::name)
    for (float& x : values) x = std::sqrt(std::max(x, 0.0f));
  if (info.name == aov::Rays::name)
    for (float& x : values) x /= static_cast<float>(std::max(samples, 1));
  const bool counts_zero = info.source == AovSource::statistics;  // else nothing was hit there
  const std::array<float, 2> range = range_of(values, counts_zero);
  fill(picture.image, [&](std::size_t i) {
    const bool is_none = !std::isfinite(values[i]) || (!counts_zero && values[i] == 0.0f);
    return is_none ? Color(0.0f) : scale_color(share_of(values[i], range));
  });
  picture.range = range;
  return picture;
}

/// Vectors of any length, each component of which has a range of its own.
bool has_ranges(const AovInfo& info) {
  return info.name == aov::Position::name || info.name == aov::Motion::name;
}

/// Three numbers of a pixel, or two.
Color vector_color(const float* v, const AovInfo& info,
                   const std::array<std::array<float, 2>, 3>& ranges) {
  if (info.channels == "RGB") return {v[0], v[1], v[2]};
  if (info.channels == "UV") return decoded({v[0] - std::floor(v[0]), v[1] - std::floor(v[1]), 0});
  Color color(0.0f);
  for (int c = 0; c < static_cast<int>(info.channels.size()); ++c)
    color[c] = has_ranges(info) ? share_of(v[c], ranges[c]) : 0.5f * v[c] + 0.5f;
  return decoded(color);
}

Picture picture_of_layer(const Image& image, const ImageLayer& layer, const AovInfo& info,
                         int samples) {
  Picture picture{{image.width, image.height, {}}, 0, {}};
  if (!layer.numbers.empty()) {
    fill(picture.image, [&](std::size_t i) {
      const std::uint32_t bits = combine_hash(0, layer.numbers[i]);
      return Color(float(bits & 255), float(bits >> 8 & 255), float(bits >> 16 & 255)) / 255.0f;
    });
    return picture;
  }
  const std::size_t channels = info.channels.size();
  if (channels == 1) return picture_of_numbers(std::move(picture), info, layer.values, samples);
  std::array<std::array<float, 2>, 3> ranges{};
  for (std::size_t c = 0; c < channels && has_ranges(info); ++c) {
    std::vector<float> values;
    for (std::size_t i = c; i < layer.values.size(); i += channels)
      values.push_back(layer.values[i]);
    ranges[c] = range_of(std::move(values), true);
  }
  fill(picture.image,
       [&](std::size_t i) { return vector_color(&layer.values[channels * i], info, ranges); });
  return picture;
}

}  // namespace

std::vector<std::string> layer_names() {
  std::vector<std::string> names{color_layer};
  for (const AovInfo& info : aov_table) names.emplace_back(info.name);
  return names;
}

std::optional<std::uint32_t> layer_bit(std::string_view name) {
  if (name == color_layer) return 0;
  const auto info = std::ranges::find(aov_table, name, &AovInfo::name);
  return info == aov_table.end() ? std::nullopt : std::optional(info->bit);
}

std::optional<Picture> make_picture(const Image& image, const Display& display, int samples) {
  const auto info = std::ranges::find(aov_table, std::string_view(display.layer), &AovInfo::name);
  if (info == aov_table.end()) return picture_of_colors(image, display);
  const auto layer = std::ranges::find(image.layers, display.layer, &ImageLayer::name);
  if (layer == image.layers.end()) return std::nullopt;
  return picture_of_layer(image, *layer, *info, samples);
}

}  // namespace pt
