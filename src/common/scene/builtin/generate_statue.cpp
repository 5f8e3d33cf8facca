#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "common/error/error.h"
#include "common/scene/builtin/generated_scenes.h"
#include "common/scene/builtin/noise.h"
#include "common/scene/builtin/shapes.h"

namespace pt {
namespace {

using Vec3d = glm::dvec3;
constexpr double tau = 6.283185307179586;
constexpr double tube_radius = 0.19;
constexpr double carving_size = 0.16;   ///< of the first octave's lattice
constexpr double carving_depth = 0.05;  ///< of the deepest valley
constexpr std::uint32_t statue_seed = 2;

/// The axis of the (2, 3) torus knot and its first two derivatives by t, for t in [0, 2 pi).
struct AxisPoint {
  Vec3d p, d1, d2;
};

AxisPoint knot_axis(double t) {
  // (R + r cos 3t) (cos 2t, 0, sin 2t) + (0, r sin 3t, 0), and the product rule.
  constexpr double R = 0.56, r = 0.24;
  const Vec3d e{std::cos(2 * t), 0, std::sin(2 * t)}, f{-e.z, 0, e.x};  // e' = 2 f, f' = -2 e
  const double s = std::sin(3 * t), c = std::cos(3 * t);
  const double w = R + r * c, w1 = -3 * r * s, w2 = -9 * r * c;
  return {w * e + Vec3d(0, r * s, 0), w1 * e + 2 * w * f + Vec3d(0, 3 * r * c, 0),
          w2 * e + 4 * w1 * f - 4 * w * e + Vec3d(0, -9 * r * s, 0)};
}

/// Vertices on a circle around the tube, and circles along the knot.
struct TubeGrid {
  std::uint64_t around, along;
};

TubeGrid tube_grid(std::uint64_t triangle_count) {
  const auto around =
      static_cast<std::uint64_t>(std::sqrt(static_cast<double>(triangle_count) / 24));
  const std::uint64_t least = 3;
  return {std::max(least, around), triangle_count / (2 * std::max(least, around))};
}

void place_vertices(const TubeGrid& grid, std::uint64_t ring, int octaves, Vec3* vertices) {
  const AxisPoint axis =
      knot_axis(tau * static_cast<double>(ring) / static_cast<double>(grid.along));
  const Vec3d tangent = glm::normalize(axis.d1);  // Frenet's frame: the knot has no straight part
  const Vec3d normal = glm::normalize(axis.d2 - glm::dot(axis.d2, tangent) * tangent);
  const Vec3d binormal = glm::cross(tangent, normal);
  for (std::uint64_t i = 0; i < grid.around; ++i) {
    const double angle = tau * static_cast<double>(i) / static_cast<double>(grid.around);
    const Vec3d out = std::cos(angle) * normal + std::sin(angle) * binormal;
    const Vec3d smooth = axis.p + tube_radius * out;
    const double ridges = 0.5 * ridged_multifractal<3>(smooth / carving_size, octaves, statue_seed);
    vertices[i] = Vec3(smooth - carving_depth * (1 - ridges) * out);
  }
}

/// The triangles from a ring to the next.
void join_rings(const TubeGrid& grid, std::uint64_t ring, TriangleIndices* triangles) {
  const std::uint64_t next = (ring + 1) % grid.along;
  const auto vertex = [&](std::uint64_t r, std::uint64_t i) {
    return static_cast<std::uint32_t>(r * grid.around + i % grid.around);
  };
  for (std::uint64_t i = 0; i < grid.around; ++i) {
    const std::uint32_t a = vertex(ring, i), b = vertex(ring, i + 1);
    const std::uint32_t c = vertex(next, i), d = vertex(next, i + 1);
    triangles[2 * i] = {{a, b, d}};
    triangles[2 * i + 1] = {{a, d, c}};
  }
}

}  // namespace

Mesh generate_knot(std::uint64_t triangle_count) {
  if (triangle_count < statue_least || triangle_count > statue_most) {
    throw Error(fmt::format("statue of {} triangles: expected from {} to {}", triangle_count,
                            statue_least, statue_most));
  }
  const TubeGrid grid = tube_grid(triangle_count);
  const double spacing = tau * tube_radius / static_cast<double>(grid.around);
  const int octaves = resolved_octaves(spacing / carving_size);
  Mesh mesh;
  mesh.positions.resize(grid.along * grid.around);
  mesh.triangles.resize(2 * grid.along * grid.around);
  tbb::parallel_for(std::uint64_t{0}, grid.along, [&](std::uint64_t ring) {
    place_vertices(grid, ring, octaves, &mesh.positions[ring * grid.around]);
    join_rings(grid, ring, &mesh.triangles[2 * ring * grid.around]);
  });
  return mesh;
}

SceneData make_statue_scene(std::uint64_t triangle_count) {
  SceneData scene;
  scene.meshes.push_back(generate_knot(triangle_count));
  scene.meshes.back().material = scene.add_material(make_diffuse(Color(0.78f, 0.76f, 0.72f)));
  Mesh floor, lamp;
  add_rectangle(floor, {-6, -0.55f, -6}, {0, 0, 12}, {12, 0, 0});
  floor.material = scene.add_material(make_diffuse(Color(0.4f)));
  // One unit wide, above and left of the camera, turned to the knot.
  add_rectangle(lamp, {-2.5f, 2.2f, 1.0f}, {0.42f, 0.7f, -0.56f}, {0.8f, 0, 0.6f});
  lamp.material = scene.add_material(make_diffuse(Color(0.0f), Color(14.0f, 13.0f, 11.0f)));
  scene.meshes.push_back(std::move(floor));
  scene.meshes.push_back(std::move(lamp));
  scene.sky = {{0.35f, 0.4f, 0.5f}, {0.35f, 0.4f, 0.5f}};
  scene.camera = {{0, 1.5f, 3.2f}, {0, -0.08f, 0}, {0, 1, 0}, 36.0f, 0.0f, 3.2f};
  return scene;
}

}  // namespace pt
