// Images with their variances: Mitsuba's from a file, ours rendered.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "common/film/pixel_statistics.h"
#include "common/image/codecs/image_io.h"
#include "common/render/batches.h"
#include "estimates.h"
#include "make_render.h"
#include "serial/serial.h"

namespace pt {

/// The upper half of the file has means, the lower one their standard errors.
inline Estimates read_reference(const std::string& path) {
  const Image image = read_image(path);
  Estimates result{image.width, image.height / 2, {}};
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      std::array<Estimate, 3>& pixel = result.pixels.emplace_back();
      const float *mean = image.pixel(x, y), *error = image.pixel(x, y + result.height);
      for (std::size_t c = 0; c < 3; ++c) pixel[c] = {mean[c], double{error[c]} * error[c]};
    }
  }
  return result;
}

/// Sums of a pixel's samples of one sign (PixelFilter), taken one by one.
class SampleSums {
 public:
  /// The film's sum after one more sample.
  void advance(const FilmPixel& now) {
    if (now.samples != last_.samples) {
      for (std::size_t c = 0; c < 3; ++c) {
        const double sample = now.sum[c] - last_.sum[c];
        squares_[c] += sample * sample;
      }
    }
    last_ = now;
  }
  std::uint64_t count() const { return last_.samples; }
  /// Estimates `weight` times the mean.
  Estimate estimate(std::size_t channel, double weight) const {
    const auto n = static_cast<double>(last_.samples);
    if (n < 2) return {};
    const double mean = last_.sum[channel] / n;
    const double variance = std::max(0.0, squares_[channel] / n - mean * mean) / (n - 1);
    return {weight * mean, weight * weight * variance};
  }

 private:
  FilmPixel last_;
  double squares_[3] = {};
};

/// What the renderer makes of a scene file, with the image size, samples and so on that it asks
/// for. Nothing of it may be unsupported.
inline Estimates render_estimates(const std::string& path,
                                  const std::map<std::string, std::string>& definitions) {
  Options options;
  options.scene = path, options.definitions = definitions, options.mode = Mode::serial;
  options.device.kind = DeviceChoice::Kind::cpu;
  std::vector<std::string> warnings;
  const SceneData scene =
      make_scene_for(options, choose_device(options.device), [&](const std::string& warning) {
        const bool is_fine = warning.find("triangles are used") != std::string::npos ||
                             warning.find("linear sRGB is used") != std::string::npos;
        if (!is_fine) warnings.push_back(warning);
      });
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  const SceneDefaults& defaults = scene.defaults;
  options.width = *defaults.width, options.height = *defaults.height, options.spp = *defaults.spp;
  options.max_depth = *defaults.max_depth, options.crop = defaults.crop, options.rr_depth = 0;
  options.filter = defaults.filter;
  options.mode = Mode::serial;
  const auto renderer = make_renderer(options, scene, choose_device(options.device));

  Film film;
  film.window = window_of(options);
  const std::size_t pixels = film.window.pixel_count();
  std::vector<std::array<SampleSums, 2>> sums(pixels);
  for (int i = 0; i < options.spp; ++i) {
    renderer->render(film, 1, {});
    for (std::size_t k = 0; k < film.pixels.size(); ++k) {
      sums[k % pixels][k / pixels].advance(film.pixels[k]);
    }
  }
  Estimates result{static_cast<int>(film.window.width), static_cast<int>(film.window.height), {}};
  for (const auto& [positive, negative] : sums) {
    const auto weights = sign_weights(scene.filter, positive.count(), negative.count());
    std::array<Estimate, 3>& pixel = result.pixels.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      const Estimate a = positive.estimate(c, weights[0]), b = negative.estimate(c, weights[1]);
      pixel[c] = {a.value + b.value, a.variance + b.variance};
    }
  }
  return result;
}

}  // namespace pt
