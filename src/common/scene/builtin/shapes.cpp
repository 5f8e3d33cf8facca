#include "common/scene/builtin/shapes.h"

#include "common/math/functions.h"

namespace pt {
namespace {

std::uint32_t vertex_count(const Mesh& mesh) {
  return static_cast<std::uint32_t>(mesh.positions.size());
}

}  // namespace

void add_rectangle(Mesh& mesh, const Vec3& corner, const Vec3& a, const Vec3& b) {
  const std::uint32_t first = vertex_count(mesh);
  for (const Vec3& p : {corner, corner + a, corner + b, corner + a + b})
    mesh.positions.push_back(p);
  mesh.triangles.push_back({{first, first + 1, first + 2}});
  mesh.triangles.push_back({{first + 2, first + 1, first + 3}});
}

void add_box(Mesh& mesh, const Affine& place, bool inward) {
  const std::uint32_t first = vertex_count(mesh);
  for (int i = 0; i < 8; ++i) {  // bit d: which side along axis d
    const auto side = [i](int axis) { return ((i >> axis) & 1) ? 1.0f : -1.0f; };
    mesh.positions.push_back(place.point({side(0), side(1), side(2)}));
  }
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const std::uint32_t a = 1u << ((axis + 1) % 3), b = 1u << ((axis + 2) % 3);
    for (const std::uint32_t side : {0u, 1u}) {
      const std::uint32_t p = first + (side << axis);
      const bool flip = (side == 0) != inward;  // cross(a, b) points along +axis
      const std::uint32_t u = flip ? b : a, v = flip ? a : b;
      mesh.triangles.push_back({{p, p + u, p + u + v}});
      mesh.triangles.push_back({{p, p + u + v, p + v}});
    }
  }
}

void add_revolution(Mesh& mesh, const Vec3& base, std::span<const ProfilePoint> profile,
                    int sides) {
  const std::uint32_t first = vertex_count(mesh), n = static_cast<std::uint32_t>(sides);
  for (const ProfilePoint& point : profile) {
    for (int i = 0; i < sides; ++i) {
      const SinCos turn = sincos_2pi(static_cast<float>(i) / static_cast<float>(sides));
      mesh.positions.push_back(
          base + Vec3(point.radius * turn.sin, point.height, point.radius * turn.cos));
    }
  }
  for (std::uint32_t ring = 0; ring + 1 < profile.size(); ++ring) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t low = first + ring * n, high = low + n, next = (i + 1) % n;
      if (profile[ring].radius > 0) mesh.triangles.push_back({{low + i, low + next, high + next}});
      if (profile[ring + 1].radius > 0)
        mesh.triangles.push_back({{low + i, high + next, high + i}});
    }
  }
}

void add_quad_box(SceneData& scene, const Vec3& center, const Vec3& size, float turn_degrees,
                  std::uint32_t material, bool inward) {
  const float angle = turn_degrees * pi / 180.0f;
  const Vec3 half = 0.5f * size;
  const Vec3 x = half.x * Vec3(std::cos(angle), 0, -std::sin(angle));
  const Vec3 y = half.y * Vec3(0, 1, 0);
  const Vec3 z = half.z * Vec3(std::sin(angle), 0, std::cos(angle));
  const auto face = [&](const Vec3& out, const Vec3& a, const Vec3& b) {  // cross(a, b) along out
    const Vec3 corner = center + out - a - b;
    inward ? scene.add_quad(corner, 2.0f * b, 2.0f * a, material)
           : scene.add_quad(corner, 2.0f * a, 2.0f * b, material);
  };
  face(x, y, z), face(-x, z, y), face(y, z, x), face(-y, x, z), face(z, x, y), face(-z, y, x);
}

}  // namespace pt
