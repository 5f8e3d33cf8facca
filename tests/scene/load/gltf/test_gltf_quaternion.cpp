// The glTF loader: rotations of nodes.
#include <cmath>

#include "load/gltf_files.h"

namespace pt {
namespace {

// Rodrigues' formula in double precision.
TEST(GltfQuaternion, TurnsAboutAnyAxis) {
  for (const glm::dvec3& a : {glm::dvec3(0, 0, 1), {0.36, 0.48, 0.8}, {-0.6, 0.64, 0.48}}) {
    const double angle = 1.1, c = std::cos(angle), s = std::sin(angle), h = std::sin(angle / 2);
    GltfMaker maker = triangle_file();
    maker.root["nodes"] = {
        {{"mesh", 0}, {"rotation", {h * a.x, h * a.y, h * a.z, std::cos(angle / 2)}}}};
    maker.root["scenes"] = {{{"nodes", {0}}}};
    const Loaded loaded(maker);
    const glm::dvec3 points[] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec3& p = points[i];
      const glm::dvec3 turned = c * p + s * glm::cross(a, p) + (1 - c) * glm::dot(a, p) * a;
      const Vec3& found = loaded.scene.meshes.at(0).positions.at(i);
      EXPECT_LT(glm::length(glm::dvec3(found) - turned), 1e-6) << a.x << " " << i;
    }
  }
}

}  // namespace
}  // namespace pt
