// Tracking: sampling the distance to a collision in a medium, and estimating transmittance.
#pragma once

#include "common/medium/distance_sampling.h"
#include "common/medium/majorant_walk.h"
#include "common/medium/sample_grid.h"
#include "common/sampling/random.h"

namespace pt {

/// The state of a flight along a ray between two collisions. A null collision changes nothing: it
/// comes from the majorant's excess over the density.
struct alignas(8) FreeFlight {
  float t = 0.0f;                ///< distance travelled
  std::uint32_t collisions = 0;  ///< null ones so far

  PT_HD bool has_begun() const { return collisions > 0; }
};

enum class FlightEvent { arrives, collides, collides_with_nothing };

/// The distance to an event of this rate per unit of length; without end for a rate of 0.
/// u uniform in [0, 1).
PT_HD float sample_exponential(float rate, float u) {
  return rate > 0.0f ? divide(-logf(1.0f - u), rate) : HUGE_VALF;
}

/// Advances a flight in a homogeneous medium to its collision, or to `t_max`.
PT_HD FlightEvent fly_homogeneous(const Color& extinction, float t_max, float u_channel,
                                  float u_distance, FreeFlight& flight, ChannelDensities& densities,
                                  Color& beta) {
  const float distance =
      sample_exponential(channel(extinction, densities.choose(u_channel)), u_distance);
  const bool collides = distance < t_max;
  flight.t = fminf(distance, t_max);
  if (!is_grey(extinction)) {  // else the weight is 1
    Color density = transmittance(extinction, flight.t);
    if (collides) density *= extinction;
    beta *= densities.weigh(density, density);
  }
  return collides ? FlightEvent::collides : FlightEvent::arrives;
}

/// The same, but with probability `share` the distance is sampled equiangularly towards a light;
/// `u_technique` makes the choice.
PT_HD FlightEvent fly_homogeneous(const Color& extinction, float t_max, const Equiangular& towards,
                                  float share, float u_technique, float u_channel, float u_distance,
                                  FreeFlight& flight, ChannelDensities& densities, Color& beta) {
  const bool is_equiangular = u_technique < share;
  const float distance =
      is_equiangular
          ? towards.sample(u_distance)
          : sample_exponential(channel(extinction, densities.choose(u_channel)), u_distance);
  const bool collides = is_equiangular || distance < t_max;
  flight.t = fminf(distance, t_max);
  Color value = transmittance(extinction, flight.t);
  Color density = value * Color(1.0f - share);
  if (collides) {
    value *= extinction;
    density = density * extinction + Color(share * towards.pdf(flight.t));
  }
  beta *= densities.weigh(value, density);
  return collides ? FlightEvent::collides : FlightEvent::arrives;
}

/// The random numbers of the next collision, null or real, of the flight with this hash.
struct CollisionDraw {
  std::uint32_t key;
  int channel;  ///< samples the collision

  PT_HD CollisionDraw(std::uint32_t flight_key, const FreeFlight& flight,
                      const ChannelDensities& densities)
      : key(combine_hash(flight_key, flight.collisions)), channel(densities.choose(unit(0))) {}

  PT_HD float unit(std::uint32_t index) const { return to_unit_float(combine_hash(key, index)); }

  /// The integral of the majorants up to the collision.
  PT_HD float depth(const Medium& medium) const {
    return sample_exponential(pt::channel(medium.extinction, channel), unit(1));
  }
};

/// Decides between a real and a null collision at the end of a walk: delta tracking (Woodcock et
/// al. 1965; Miller et al. 2019), with majorants that are constant in cells.
template <bool has_sparse = false>
PT_HD FlightEvent end_walk(const VolumeGrids& grids, const Medium& medium, const Ray& ray,
                           const MajorantWalk& walk, const CollisionDraw& draw, FreeFlight& flight,
                           ChannelDensities& densities, Color& beta) {
  const VolumeGrid& grid = grids.grids[medium.density_grid];
  flight.t = walk.t;
  const bool same_for_all = is_grey(medium.extinction) && grid.channels == 1;  // the weight is 1
  if (walk.arrives) {
    if (!same_for_all) {
      const Color arrived = transmittance(medium.extinction, walk.depth);
      beta *= densities.weigh(arrived, arrived);
    }
    return FlightEvent::arrives;
  }
  const Color density =
      sample_grid<has_sparse>(grids, grid, add_scaled(ray.origin, walk.t, ray.direction));
  const float inverse = divide(1.0f, walk.majorant);
  const Color there(fminf(density.x * inverse, 1.0f), fminf(density.y * inverse, 1.0f),
                    fminf(density.z * inverse, 1.0f));
  const bool collides = draw.unit(2) < channel(there, draw.channel);
  if (!same_for_all) {
    const Color reached = transmittance(medium.extinction, walk.depth) * medium.extinction;
    const Color event = reached * (collides ? there : Color(1.0f) - there);
    beta *= densities.weigh(event, event);
  }
  if (collides) return FlightEvent::collides;
  ++flight.collisions;
  return FlightEvent::collides_with_nothing;
}

/// Advances a flight in a medium with a grid to its next collision, null or real, or to `t_max`.
template <bool has_sparse = false>
PT_HD FlightEvent fly_to_collision(const VolumeGrids& grids, const Medium& medium, const Ray& ray,
                                   float t_max, std::uint32_t key, FreeFlight& flight,
                                   ChannelDensities& densities, Color& beta) {
  const CollisionDraw draw(key, flight, densities);
  const MajorantWalk walk = walk_majorants<has_sparse>(grids, grids.grids[medium.density_grid], ray,
                                                       flight.t, t_max, draw.depth(medium));
  return end_walk<has_sparse>(grids, medium, ray, walk, draw, flight, densities, beta);
}

/// An unbiased estimate of the transmittance of `t_max` of a ray: ratio tracking (Novak et al.
/// 2014, 'Residual ratio tracking for estimating attenuation in participating media') by the
/// channel of the largest extinction, with roulette where little is left.
template <bool has_sparse = false>
PT_HD Color estimate_transmittance(const VolumeGrids& grids, const Medium& medium, const Ray& ray,
                                   float t_max, std::uint32_t key) {
  if (medium.is_homogeneous()) return transmittance(medium.extinction, t_max);
  constexpr float little = 0.125f, survival = 0.5f;
  const VolumeGrid& grid = grids.grids[medium.density_grid];
  const Color& e = medium.extinction;
  const float largest = fmaxf(fmaxf(e.x, e.y), e.z);
  if (!(largest > 0.0f)) return Color(1.0f);
  const Color relative = e * Color(divide(1.0f, largest));
  Color estimate(1.0f);
  float t = 0.0f;
  for (std::uint32_t collisions = 0;; ++collisions) {
    const std::uint32_t event = combine_hash(key, collisions);
    const float depth = sample_exponential(largest, to_unit_float(combine_hash(event, 0)));
    const MajorantWalk walk = walk_majorants<has_sparse>(grids, grid, ray, t, t_max, depth);
    if (walk.arrives) return estimate;
    lanes_of(ray).count(LanePoint::flight);
    t = walk.t;
    const Color density =
        sample_grid<has_sparse>(grids, grid, add_scaled(ray.origin, t, ray.direction));
    const float inverse = divide(1.0f, walk.majorant);
    const auto missed = [&](float of_density, float of_channel) {
      return fmaxf(1.0f - of_density * inverse * of_channel, 0.0f);
    };
    estimate *= Color(missed(density.x, relative.x), missed(density.y, relative.y),
                      missed(density.z, relative.z));
    if (max_abs(estimate) < little) {
      if (!(to_unit_float(combine_hash(event, 1)) < survival)) return Color(0.0f);
      estimate *= Color(1.0f / survival);
    }
  }
}

}  // namespace pt
