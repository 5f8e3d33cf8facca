// Media: named ones to ours, which lie on the sides of a shape, and what their kinds share.
#pragma once

#include <vector>

#include "common/math/vec.h"
#include "common/scene/data/volume_data.h"
#include "common/scene/load/pbrt/surfaces/colors.h"
#include "common/scene/load/pbrt/syntax/context.h"
#include "common/scene/load/pbrt/syntax/description.h"
#include "common/scene/load/pbrt/syntax/parameters.h"

namespace pt::pbrt {

/// The scene's number of the medium of this name, which is made once; no_medium for an empty name
/// and for a medium that is not supported, which is reported. Throws Error, with `place`, for a
/// name that no MakeNamedMedium defines. Adding a kind is adding a line to the table in media.cpp.
std::uint16_t medium_named(Context& context, const std::string& name, const Place& place);

/// What a shape has on its sides. Where both are the same, it keeps the medium of its surroundings.
MediumBoundary media_of(Context& context, const ShapeEntity& shape);

// The kinds of media: each reads one, and adds the grids that it needs to the scene.

Medium read_homogeneous(Context& context, const Entity& entity);
Medium read_uniform_grid(Context& context, const Entity& entity);
Medium read_rgb_grid(Context& context, const Entity& entity);
Medium read_cloud(Context& context, const Entity& entity);
Medium read_nanovdb_grids(Context& context, const Entity& entity);

/// Extinction and albedo by sigma_a and sigma_s (both 1 unless they are given) times `scale`, and
/// the phase function by g.
Medium read_coefficients(Context& context, const Parameters& parameters, float scale);

/// By g, of which 0 is isotropic.
void read_phase(const Parameters& parameters, Medium& medium);

/// A factor, which must be finite and not negative.
float read_factor(const Parameters& parameters, std::string_view name, float fallback);

/// sigma_s of what has these coefficients, over their sum; 0 where there is nothing.
Color albedo_of(const Color& absorption, const Color& scattering);

// A box of regular samples, as pbrt's grids have them.

/// p0 to p1 in the space of a medium, filled with voxels; a sample lies in the middle of each.
struct SampleBox {
  std::uint32_t size[3] = {1, 1, 1};
  Vec3 low, high;   ///< in the medium's space
  Affine to_world;  ///< of the medium's space

  std::size_t voxels() const { return std::size_t{size[0]} * size[1] * size[2]; }

  /// Of the middle of a voxel, in the medium's space.
  Vec3 center(std::uint32_t i, std::uint32_t j, std::uint32_t k) const;
};

/// The place of the medium's samples, of which there is one. Throws Error for a box without volume.
SampleBox read_box(const Entity& entity);

/// The same with nx * ny * nz samples.
SampleBox read_sample_box(const Entity& entity);

/// The values of colours side by side, or with one channel their reds.
std::vector<float> channels_of(const std::vector<Color>& colors, std::uint32_t channels);

/// For all channels of a voxel, x fastest: how pbrt looks samples up. Beyond the outermost of them
/// they fade to zero, which a layer of zeros around the box says.
VolumeData faded_volume(const SampleBox& box, std::uint32_t channels,
                        const std::vector<float>& values);

/// The same, but the outermost samples go on beyond the box.
VolumeData plain_volume(const SampleBox& box, std::uint32_t channels, std::vector<float> values);

// The density of a cloud, as that of pbrt.

/// Gradient noise with cells of size 1: Perlin 2002, 'Improving Noise', with the directions in
/// which pbrt's slopes go. Zero at integers.
float perlin_noise(const Vec3& p);

struct CloudShape {
  float density = 1.0f, wispiness = 1.0f, frequency = 5.0f;
};

/// In [0, 1]: more the lower, and nothing but noise above y = 1/2.
float cloud_density(const CloudShape& shape, const Vec3& p);

}  // namespace pt::pbrt
