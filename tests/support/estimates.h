// Pixels with their variances, and how far two images of them are from each other.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <vector>

namespace pt {

/// A mean and the variance of that mean.
struct Estimate {
  double value = 0, variance = 0;
};

/// Estimates of each channel of each pixel.
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

}  // namespace pt
