// Small scenes with media, and what is measured of their images.
#pragma once

#include <functional>

#include "common/geometry/mesh.h"
#include "common/scene/builtin/shapes.h"
#include "common/scene/prepare/prepare_scene.h"
#include "medium/volume_cases.h"
#include "mode_cases.h"
#include "render_serial.h"

namespace pt {

inline Medium make_medium(const Color& extinction, const Color& albedo, PhaseKind phase = {},
                          float parameter = 0) {
  Medium medium;
  medium.extinction = extinction, medium.albedo = albedo;
  medium.phase = phase, medium.phase_parameter = parameter;
  return medium;
}

/// A surface without a BSDF.
inline MaterialDescription make_boundary(std::uint32_t outside, std::uint32_t inside) {
  MaterialDescription boundary;
  boundary.is_boundary = boundary.passes = true;
  boundary.media = {static_cast<std::uint16_t>(outside), static_cast<std::uint16_t>(inside)};
  return boundary;
}

/// The first material of the scene that has the medium inside.
inline std::uint32_t material_around(const SceneData& scene, std::uint32_t medium) {
  const auto found = std::ranges::find_if(scene.materials, [&](const MaterialDescription& m) {
    return m.is_boundary && m.media.inside == medium;
  });
  return static_cast<std::uint32_t>(found - scene.materials.begin());
}

/// How a medium is bounded: by the sphere of radius 1 or the box [-1, 1]^3.
enum class CloudShape { sphere, quads, mesh_box, mesh_ball };

inline const char* name_of(CloudShape shape) {
  constexpr const char* names[] = {"sphere", "quads", "mesh box", "mesh ball"};
  return names[static_cast<int>(shape)];
}

/// The six quads of the box between two corners, whose normals point outward.
inline void add_cuboid(SceneData& scene, const Vec3& low, const Vec3& high,
                       std::uint32_t material) {
  const Vec3 x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
  scene.add_quad(low + z, x, y, material), scene.add_quad(low, y, x, material);
  scene.add_quad(low + x, y, z, material), scene.add_quad(low, z, y, material);
  scene.add_quad(low + y, z, x, material), scene.add_quad(low, x, z, material);
}

/// A floor below, a lamp above and a point light, for what lies within 2 of the origin.
inline void add_floor_and_lights(SceneData& scene) {
  scene.add_quad({-3, -1, 3}, {6, 0, 0}, {0, 0, -6}, scene.add_material(make_diffuse(Color(0.6f))));
  scene.add_quad({-1, 2.5f, -1}, {2, 0, 0}, {0, 0, 2},
                 scene.add_material(make_diffuse(Color(0.0f), {9.0f, 8.0f, 7.0f})));
  DeltaLight point;
  point.position = {2, 2, 2};
  point.intensity = {2.0f, 4.0f, 6.0f};
  scene.delta_lights.push_back(point);
}

/// A ball of 2 * 12 * 24 triangles at most, with normals like a sphere's.
inline Mesh make_ball(std::uint32_t material) {
  Mesh mesh;
  std::vector<ProfilePoint> profile;
  for (int i = 0; i <= 12; ++i) {
    const double angle = pi_double * i / 12;
    const bool is_pole = i == 0 || i == 12;
    profile.push_back({is_pole ? 0.0f : static_cast<float>(std::sin(angle)),
                       static_cast<float>(-std::cos(angle))});
  }
  add_revolution(mesh, Vec3(0.0f), profile, 24);
  for (const Vec3& p : mesh.positions) mesh.normals.push_back(normalize(p));
  mesh.material = material;
  return mesh;
}

inline void add_cloud_shape(SceneData& scene, CloudShape shape, std::uint32_t material) {
  if (shape == CloudShape::sphere) {
    scene.add_sphere(Vec3(0.0f), 1, material);
  } else if (shape == CloudShape::quads) {
    add_cuboid(scene, Vec3(-1.0f), Vec3(1.0f), material);
  } else if (shape == CloudShape::mesh_ball) {
    scene.meshes.push_back(make_ball(material));
  } else {
    Mesh box;
    add_box(box, Affine());
    box.material = material;
    scene.meshes.push_back(box);
  }
}

/// Medium 0 alone under a sky of ones; grids of it may be added afterwards.
inline SceneData cloud_under_sky(const Medium& medium, CloudShape shape) {
  SceneData scene;
  scene.name = "cloud";
  scene.media.push_back(medium);
  add_cloud_shape(scene, shape, scene.add_material(make_boundary(no_medium, 0)));
  scene.sky = {Color(1.0f), Color(1.0f)};
  scene.camera = {{0, 0.3f, 4}, {0, 0, 0}, {0, 1, 0}, 30.0f, 0.0f, 4.0f};
  return scene;
}

/// From far away along -z, so that all rays are nearly parallel and hit the middle.
inline CameraParameters distant_camera() {
  return {{0, 0, 40}, {0, 0, 0}, {0, 1, 0}, 0.05f, 0.0f, 40.0f};
}

inline void darken_sky(SceneData& scene) { scene.sky = {}; }

/// exp(-depth) by channel.
inline glm::dvec3 beer(const Color& extinction, double length) {
  return glm::exp(-glm::dvec3(extinction) * length);
}

/// A directional light.
inline DeltaLight sun_along(const Vec3& direction, const Color& irradiance) {
  DeltaLight sun;
  sun.kind = LightKind::directional;
  sun.direction = normalize(direction);
  sun.intensity = irradiance;
  return sun;
}

/// A sky of ones that is a light: an environment map.
inline void set_environment(SceneData& scene) {
  darken_sky(scene);
  scene.environment.width = 8, scene.environment.height = 4;
  scene.environment.pixels.assign(32, Color(1.0f));
}

inline Image render_medium(SceneData scene, const Settings& settings = {}) {
  const Options options = with(with(Options(), {{"device", "cpu"},
                                                {"mode", "serial"},
                                                {"width", "16"},
                                                {"height", "16"},
                                                {"spp", "16"},
                                                {"max-depth", "5000"}}),
                               settings);
  prepare_scene(scene, options);
  return render(scene, options).image;
}

/// Over the pixels of one channel, each of which is independent.
inline MeanEstimate mean_over_pixels(const Image& image, int channel) {
  MeanEstimate mean;
  for (std::size_t i = static_cast<std::size_t>(channel); i < image.rgb.size(); i += 3) {
    mean.add(double{image.rgb[i]});
  }
  return mean;
}

/// `rounding`: what part of it may be wrong besides the noise, which must be below `noise`.
inline void expect_mean(const Image& image, const glm::dvec3& expected, double noise = 0.008,
                        double rounding = 1e-4) {
  for (int c = 0; c < 3; ++c) {
    const MeanEstimate found = mean_over_pixels(image, c);
    EXPECT_NEAR(found.mean(), expected[c], 5 * found.sigma() + rounding * expected[c] + 1e-7)
        << "channel " << c;
    EXPECT_LE(found.sigma(), noise * expected[c] + 1e-7) << "channel " << c;
  }
}

/// Images of the same without regard to noise, which is independent: pixel by pixel differences of
/// the mean 0.
inline void expect_same_means(const Image& a, const Image& b) {
  ASSERT_EQ(a.rgb.size(), b.rgb.size());
  for (int c = 0; c < 3; ++c) {
    MeanEstimate difference;
    double sum = 0, count = 0;
    for (std::size_t i = static_cast<std::size_t>(c); i < a.rgb.size(); i += 3) {
      difference.add(double{a.rgb[i]} - double{b.rgb[i]});
      sum += double{a.rgb[i]}, ++count;
    }
    EXPECT_NEAR(difference.mean(), 0, 5 * difference.sigma() + 1e-6) << "channel " << c;
    EXPECT_LE(difference.sigma(), 0.02 * sum / count) << "channel " << c;
  }
}

/// The integral of f from a to b by Gauss and Legendre's rule of 5 points in each of 400 parts.
inline double integrate(double a, double b, const std::function<double(double)>& f) {
  constexpr double at[] = {0, 0.5384693101056831, 0.9061798459386640};
  constexpr double weight[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  constexpr int parts = 400;
  const double half = 0.5 * (b - a) / parts;
  double sum = 0;
  for (int i = 0; i < parts; ++i) {
    const double middle = a + (2 * i + 1) * half;
    sum += weight[0] * f(middle);
    for (int k = 1; k < 3; ++k) {
      sum += weight[k] * (f(middle - at[k] * half) + f(middle + at[k] * half));
    }
  }
  return sum * half;
}

}  // namespace pt
