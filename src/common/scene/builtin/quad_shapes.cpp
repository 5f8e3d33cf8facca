#include "common/scene/builtin/quad_shapes.h"

namespace pt {

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
