// AOVs (arbitrary output variables): what an EXR holds of a pixel besides its colour. Each is a
// type in one list; its layer, its option and its plane of the film follow from that.
//
// A type has
//   static constexpr const char* name      of the layer and for --aov
//   static constexpr const char* channels  a letter each: the layer's channels are name.X
//   of(x), callable on the device unless x is a PixelStatistics, where x is one of
//     FirstHit -> Vec3, Vec2 or float  the first hit: the film has the mean over all samples,
//     filtered
//                                      as radiance is; 0 where the camera ray misses
//     FirstHit -> std::uint32_t        an index: that of the first sample, since means are useless
//     PixelStatistics -> float         statistics of the pixel's samples
#pragma once

#include <array>
#include <string_view>

#include "common/platform/type_list.h"
#include "common/transport/first_hit.h"

namespace pt {

/// Statistics of a pixel after the render.
struct PixelStatistics {
  double samples = 0;   ///< the finite ones
  double variance = 0;  ///< of the pixel's value, estimated (pixel_statistics.h); luminance
  double bounces = 0;   ///< rays of a sample after the camera ray, shadow rays left out; the mean
  double rays = 0;      ///< of all samples, shadow rays included
};

namespace aov {

struct Albedo {
  static constexpr const char *name = "albedo", *channels = "RGB";
  static PT_HD Vec3 of(const FirstHit& hit) { return hit.albedo; }
};
struct ShadingNormal {
  static constexpr const char *name = "shading_normal", *channels = "XYZ";
  static PT_HD Vec3 of(const FirstHit& hit) { return hit.shading_normal; }
};
struct Normal {
  static constexpr const char *name = "normal", *channels = "XYZ";
  static PT_HD Vec3 of(const FirstHit& hit) { return hit.normal; }
};
struct Depth {
  static constexpr const char *name = "depth", *channels = "Z";
  static PT_HD float of(const FirstHit& hit) { return hit.distance; }
};
struct Collision {
  static constexpr const char *name = "collision", *channels = "Z";
  static PT_HD float of(const FirstHit& hit) { return hit.collision; }
};
struct Transmittance {
  static constexpr const char *name = "transmittance", *channels = "RGB";
  static PT_HD Vec3 of(const FirstHit& hit) { return hit.transmittance; }
};
struct Position {
  static constexpr const char *name = "position", *channels = "XYZ";
  static PT_HD Vec3 of(const FirstHit& hit) { return hit.position; }
};
struct Uv {
  static constexpr const char *name = "uv", *channels = "UV";
  static PT_HD Vec2 of(const FirstHit& hit) { return hit.uv; }
};
struct Primitive {
  static constexpr const char *name = "primitive", *channels = "I";
  static PT_HD std::uint32_t of(const FirstHit& hit) { return hit.primitive; }
};
struct Instance {
  static constexpr const char *name = "instance", *channels = "I";
  static PT_HD std::uint32_t of(const FirstHit& hit) { return hit.instance; }
};
struct MaterialIndex {
  static constexpr const char *name = "material", *channels = "I";
  static PT_HD std::uint32_t of(const FirstHit& hit) { return hit.material; }
};
struct Motion {
  static constexpr const char *name = "motion", *channels = "XY";
  static PT_HD Vec2 of(const FirstHit& hit) { return hit.motion; }
};
struct Variance {
  static constexpr const char *name = "variance", *channels = "Y";
  static float of(const PixelStatistics& s) { return static_cast<float>(s.variance); }
};
struct Samples {
  static constexpr const char *name = "samples", *channels = "N";
  static float of(const PixelStatistics& s) { return static_cast<float>(s.samples); }
};
struct Bounces {
  static constexpr const char *name = "bounces", *channels = "N";
  static float of(const PixelStatistics& s) { return static_cast<float>(s.bounces); }
};
struct Rays {
  static constexpr const char *name = "rays", *channels = "N";
  static float of(const PixelStatistics& s) { return static_cast<float>(s.rays); }
};

}  // namespace aov

/// Every AOV, once. Its index is its bit in ImageSettings::aovs.
using Aovs =
    TypeList<aov::Albedo, aov::ShadingNormal, aov::Normal, aov::Depth, aov::Position, aov::Uv,
             aov::Primitive, aov::Instance, aov::MaterialIndex, aov::Variance, aov::Samples,
             aov::Bounces, aov::Rays, aov::Collision, aov::Transmittance, aov::Motion>;
static_assert(Aovs::size <= 32);

/// The source of an AOV.
enum class AovSource { mean, number, statistics };

struct AovInfo {
  std::string_view name, channels;
  AovSource source;
  std::uint32_t bit;
};

namespace detail {
template <class Aov>
constexpr AovSource source_of() {
  if constexpr (!requires(const FirstHit& hit) { Aov::of(hit); }) {
    return AovSource::statistics;
  } else if constexpr (requires(const FirstHit& hit) {
                         requires std::is_same_v<decltype(Aov::of(hit)), std::uint32_t>;
                       }) {
    return AovSource::number;
  } else {
    return AovSource::mean;
  }
}
template <class... Aov>
constexpr auto make_aov_table(TypeList<Aov...> list) {
  return std::array<AovInfo, sizeof...(Aov)>{AovInfo{Aov::name, Aov::channels, source_of<Aov>(),
                                                     std::uint32_t{1} << index_in<Aov>(list)}...};
}
}  // namespace detail

template <class Aov>
inline constexpr AovSource aov_source = detail::source_of<Aov>();
template <class Aov>
inline constexpr std::uint32_t aov_bit = std::uint32_t{1} << index_in<Aov>(Aovs{});
inline constexpr auto aov_table = detail::make_aov_table(Aovs{});

/// Values that the film has of a first hit: a plane for each channel of these AOVs.
constexpr std::uint32_t feature_plane_count(std::uint32_t aovs) {
  std::uint32_t count = 0;
  for (const AovInfo& info : aov_table) {
    if ((aovs & info.bit) != 0 && info.source != AovSource::statistics) {
      count += static_cast<std::uint32_t>(info.channels.size());
    }
  }
  return count;
}

constexpr bool needs_moments(std::uint32_t aovs) {
  for (const AovInfo& info : aov_table) {
    if ((aovs & info.bit) != 0 && info.source == AovSource::statistics) return true;
  }
  return false;
}

}  // namespace pt
