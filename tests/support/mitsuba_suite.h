// Pixels with their variances, of ours and of Mitsuba's, and how far they are from each other.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "app/make_renderer.h"
#include "common/film/pixel_statistics.h"
#include "common/image/image_io.h"
#include "common/render/batches.h"
#include "serial/serial.h"

namespace pt {

/// A mean and the variance of that mean.
struct Estimate {
  double value = 0, variance = 0;
};

/// Of each channel of each pixel.
struct Estimates {
  int width = 0, height = 0;
  std::vector<std::array<Estimate, 3>> pixels;

  /// The means of squares of `side` x `side` pixels, row by row; what is left at the border is part
  /// of smaller ones. Pixels are taken as independent.
  std::vector<Estimate> tiles(int side, std::size_t channel) const {
    std::vector<Estimate> all;
    for (int y0 = 0; y0 < height; y0 += side) {
      for (int x0 = 0; x0 < width; x0 += side) {
        all.push_back(
            mean_of(x0, y0, std::min(x0 + side, width), std::min(y0 + side, height), channel));
      }
    }
    return all;
  }
  /// The pixels. The variance is that of the pixel itself or the mean of it and its neighbours,
  /// whichever is larger: where something is rare (the corner of a pixel in which a lamp begins),
  /// samples that have missed it say that there is no noise.
  std::vector<Estimate> single(std::size_t channel) const {
    std::vector<Estimate> all;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const int x0 = std::max(x - 1, 0), y0 = std::max(y - 1, 0);
        const int x1 = std::min(x + 2, width), y1 = std::min(y + 2, height);
        const Estimate around = mean_of(x0, y0, x1, y1, channel);
        Estimate& e = all.emplace_back(pixels[static_cast<std::size_t>(y * width + x)][channel]);
        e.variance = std::max(e.variance, around.variance * (x1 - x0) * (y1 - y0));
      }
    }
    return all;
  }
  Estimate mean(std::size_t channel) const { return mean_of(0, 0, width, height, channel); }

 private:
  Estimate mean_of(int x0, int y0, int x1, int y1, std::size_t channel) const {
    Estimate sum;
    const double count = (x1 - x0) * (y1 - y0);
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        const Estimate& e = pixels[static_cast<std::size_t>(y * width + x)][channel];
        sum.value += e.value / count, sum.variance += e.variance / (count * count);
      }
    }
    return sum;
  }
};

/// Two values that ought to be equal, and how many standard deviations they are apart.
struct Difference {
  double z = 0, ours = 0, theirs = 0;
  std::size_t place = 0;

  void take(const Difference& other) {
    if (other.z > z) *this = other;
  }
  friend std::ostream& operator<<(std::ostream& out, const Difference& d) {
    return out << d.z << " sigmas at " << d.place << " (" << d.ours << ", Mitsuba " << d.theirs
               << ")";
  }
};

/// `rounding`: the part of a value that counts as another standard deviation.
inline std::vector<Difference> differences(const std::vector<Estimate>& ours,
                                           const std::vector<Estimate>& theirs, double rounding) {
  std::vector<Difference> all;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const Estimate &a = ours[i], &b = theirs[i];
    const double exact = rounding * b.value;
    const double error = std::sqrt(a.variance + b.variance + exact * exact);
    const double apart = std::abs(a.value - b.value);
    all.push_back({error > 0 ? apart / error : apart > 0 ? 1e9 : 0, a.value, b.value, i});
  }
  return all;
}

inline Difference worst_of(const std::vector<Difference>& all) {
  Difference worst;
  for (const Difference& d : all) worst.take(d);
  return worst;
}

/// The sum of their squares as a normal number (Wilson and Hilferty 1931). Finds what is a little
/// wrong everywhere.
inline double chi_square_sigmas(const std::vector<Difference>& all) {
  double sum = 0;
  for (const Difference& d : all) sum += d.z * d.z;
  const auto n = static_cast<double>(all.size());
  const double spread = 2 / (9 * n);
  return (std::cbrt(sum / n) - (1 - spread)) / std::sqrt(spread);
}

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
  /// Of `weight` times the mean.
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
        if (warning.find("triangles are used") == std::string::npos) warnings.push_back(warning);
      });
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  const SceneDefaults& defaults = scene.defaults;
  options.width = *defaults.width, options.height = *defaults.height, options.spp = *defaults.spp;
  options.max_depth = *defaults.max_depth, options.crop = defaults.crop, options.rr_depth = 0;
  options.filter = defaults.filter;
  const auto renderer = make_serial_renderer(options, scene);

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
