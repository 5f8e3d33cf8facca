#include "common/light/sky/sunsky.h"

#include <algorithm>
#include <cmath>

namespace pt {
namespace {

constexpr double turn = 6.283185307179586, quarter_turn = turn / 4;
constexpr double radians = turn / 360;

// The files in data/sunsky say what the numbers are. Radiances are in Mitsuba's units.
constexpr int sun_node_count = 129;
constexpr float sky_shapes[10 * 2 * 6 * 3 * 9] = {
#include <tables/sky_shapes.inc>
};
constexpr float sky_radiances[10 * 2 * 6 * 3] = {
#include <tables/sky_radiances.inc>
};
constexpr float sun_irradiances[10 * sun_node_count * 3] = {
#include <tables/sun_irradiances.inc>
};

/// A curve of Bezier over [0, 1] with six control points, `stride` apart.
double quintic(const float* points, int stride, double x) {
  constexpr double binomial[] = {1, 5, 10, 10, 5, 1};
  double sum = 0;
  for (int i = 0; i < 6; ++i) {
    sum += binomial[i] * std::pow(x, i) * std::pow(1 - x, 5 - i) * double{points[i * stride]};
  }
  return sum;
}

/// Between two turbidities: the lower one's index and how far beyond it.
struct Step {
  int index;
  double rest;
};

Step turbidity_step(double turbidity) {
  const double t = std::clamp(turbidity, 1.0, 10.0) - 1;
  const int index = std::min(static_cast<int>(t), 8);
  return {index, t - index};
}

/// The i-th number of a table by turbidity, albedo, six control points and `size` numbers.
double tabulated(const float* table, int size, int i, double turbidity, double albedo, double x) {
  const Step step = turbidity_step(turbidity);
  const auto at = [&](int t, int a) {
    return quintic(table + ((t * 2 + a) * 6) * size + i, size, x);
  };
  const auto between = [&](int t) { return (1 - albedo) * at(t, 0) + albedo * at(t, 1); };
  return (1 - step.rest) * between(step.index) + step.rest * between(step.index + 1);
}

}  // namespace

SkyModel::SkyModel(double turbidity, const Color& albedo, double elevation) {
  const double x = std::cbrt(std::clamp(elevation / quarter_turn, 0.0, 1.0));
  for (int c = 0; c < 3; ++c) {
    Channel& channel = channels_[static_cast<std::size_t>(c)];
    const double a = std::clamp(double{albedo[c]}, 0.0, 1.0);
    for (int i = 0; i < 9; ++i) {
      channel.shape[static_cast<std::size_t>(i)] =
          tabulated(sky_shapes, 27, 9 * c + i, turbidity, a, x);
    }
    channel.radiance = tabulated(sky_radiances, 3, c, turbidity, a, x);
  }
}

Color SkyModel::radiance(double cos_zenith, double sun_angle) const {
  if (cos_zenith < 0) return Color(0.0f);
  const double cos_sun = std::cos(sun_angle), cos2 = cos_sun * cos_sun;
  Color result;
  for (int c = 0; c < 3; ++c) {
    const auto& [p, radiance] = channels_[static_cast<std::size_t>(c)];
    const double glow = (1 + cos2) / std::pow(1 + p[8] * p[8] - 2 * p[8] * cos_sun, 1.5);
    const double height = 1 + p[0] * std::exp(p[1] / (cos_zenith + 0.01));
    const double around = p[2] + p[3] * std::exp(p[4] * sun_angle) + p[5] * cos2 + p[6] * glow +
                          p[7] * std::sqrt(cos_zenith);
    result[c] = static_cast<float>(std::max(height * around * radiance, 0.0));
  }
  return result;
}

Color sun_irradiance(double turbidity, double elevation) {
  if (elevation < 0) return Color(0.0f);
  const double x = std::cbrt(std::min(elevation / quarter_turn, 1.0)) * (sun_node_count - 1);
  const int node = std::min(static_cast<int>(x), sun_node_count - 2);
  const double t = x - node;
  const Step step = turbidity_step(turbidity);
  Color result;
  for (int c = 0; c < 3; ++c) {
    const auto at = [&](int row, int i) {
      return double{sun_irradiances[(row * sun_node_count + i) * 3 + c]};
    };
    const auto between = [&](int row) { return (1 - t) * at(row, node) + t * at(row, node + 1); };
    const double sum = (1 - step.rest) * between(step.index) + step.rest * between(step.index + 1);
    result[c] = static_cast<float>(std::max(sum, 0.0));
  }
  return result;
}

Vec3 sun_direction(const SunTime& t) {
  // Days since noon of 1 January 2000, universal time; the calendar's by whole-number division.
  const double hours = t.hour - t.timezone + (t.minute + t.second / 60) / 60;
  const int early = (t.month - 14) / 12;  // -1 in January and February
  const int day_number = 1461 * (t.year + 4800 + early) / 4 +
                         367 * (t.month - 2 - 12 * early) / 12 -
                         3 * ((t.year + 4900 + early) / 100) / 4 + t.day - 32075;
  const double days = day_number - 0.5 + hours / 24 - 2451545;
  // The sun on the ecliptic.
  const double anomaly = 6.2400600 + 0.0172019699 * days;
  const double node = 2.1429 - 0.0010394594 * days;
  const double longitude = 4.8950630 + 0.017202791698 * days + 0.03341607 * std::sin(anomaly) +
                           0.00034894 * std::sin(2 * anomaly) - 0.0001134 -
                           0.0000203 * std::sin(node);
  const double obliquity = 0.4090928 - 6.2140e-9 * days + 0.0000396 * std::cos(node);
  // In equatorial, then in horizontal coordinates.
  const double ascension =
      std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude));
  const double declination = std::asin(std::sin(obliquity) * std::sin(longitude));
  const double sidereal = 6.6974243242 + 0.0657098283 * days + hours;
  const double hour_angle = radians * (15 * sidereal + t.longitude) - ascension;
  const double latitude = radians * t.latitude;
  double zenith = std::acos(std::cos(latitude) * std::cos(hour_angle) * std::cos(declination) +
                            std::sin(declination) * std::sin(latitude));
  const double azimuth =
      std::atan2(-std::sin(hour_angle), std::tan(declination) * std::cos(latitude) -
                                            std::sin(latitude) * std::cos(hour_angle));
  zenith += 6371.01 / 149597890 * std::sin(zenith);  // parallax
  return {static_cast<float>(-std::sin(zenith) * std::cos(azimuth)),
          static_cast<float>(-std::sin(zenith) * std::sin(azimuth)),
          static_cast<float>(std::cos(zenith))};
}

}  // namespace pt
