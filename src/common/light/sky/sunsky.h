// The clear sky and its sun, by the model of Hosek and Wilkie (2012, 'An Analytic Model for Full
// Spectral Sky-Dome Radiance'). Up is +z.
#pragma once

#include <array>

#include "common/math/vec.h"

namespace pt {

/// Radiance of the sky, W / (m^2 sr), for one position of the sun.
class SkyModel {
 public:
  /// `turbidity` from 1 to 10, `albedo` of the ground from 0 to 1, `elevation` of the sun from 0 to
  /// pi / 2.
  SkyModel(double turbidity, const Color& albedo, double elevation);

  /// At an angle to the zenith (below pi / 2; black from there on) and an angle to the sun.
  Color radiance(double cos_zenith, double sun_angle) const;

 private:
  struct Channel {
    std::array<double, 9> shape;
    double radiance;
  };
  std::array<Channel, 3> channels_;
};

/// What the sun gives across its rays; black below the horizon.
Color sun_irradiance(double turbidity, double elevation);

/// Where and when: angles in degrees, the clock in hours ahead of universal time.
struct SunTime {
  double latitude = 35.6894, longitude = 139.6917, timezone = 9;  ///< Tokyo
  int year = 2010, month = 7, day = 10;
  double hour = 15, minute = 0, second = 0;
};

/// The direction to the sun, of unit length: +z up, -x to the north, -y to the east. Within 0.01
/// degrees from 1999 to 2015 (Blanco-Muriel et al. 2001, 'Computing the Solar Vector').
Vec3 sun_direction(const SunTime& time);

}  // namespace pt
