// Light that a shading normal lets through a surface: the shadow ray begins on the other side of it
// than light sampling has assumed, and must end where it would have ended.
#include "render_serial.h"
#include "scene/lamp_rooms.h"
#include "statistics.h"

namespace pt {
namespace {

using Vec3d = glm::dvec3;

const Vec3 tilted = glm::normalize(Vec3(1, 0.3f, 0));
const Vec3 lamp_corner(1.625f, -1.375f, -0.5f), lamp_a(0, 0, 1), lamp_b(0.75f, 0.75f, 0);

/// Lambert's formula at the origin: the sum over the edges.
double lamp_irradiance(const Vec3d& n) {
  const Vec3 corners[4] = {lamp_corner, lamp_corner + lamp_a, lamp_corner + lamp_a + lamp_b,
                           lamp_corner + lamp_b};
  Vec3d sum(0);
  for (int i = 0; i < 4; ++i) {
    const Vec3d v = glm::normalize(Vec3d(corners[i]));
    const Vec3d w = glm::normalize(Vec3d(corners[(i + 1) % 4]));
    sum += std::acos(glm::dot(v, w)) * glm::normalize(glm::cross(v, w));
  }
  return std::abs(0.5 * glm::dot(sum, n));
}

/// A floor's point, seen from above. The lamp lies below the floor, above the horizon of its
/// shading normal, and its plane is slanted: a ray that ends beside the sampled point would cross
/// it.
SceneData floor_above_a_lamp(const RoomPlace& place, float size) {
  SceneData scene;
  scene.name = "floor above a lamp";
  Mesh floor;
  floor.positions = {place.at({-size, 0, -size}), place.at({0, 0, size}),
                     place.at({size, 0, -size})};
  floor.normals = {tilted, tilted, tilted};
  floor.triangles = {{{0, 1, 2}}};
  floor.material = scene.add_material(make_diffuse(Color(0.5f)));
  scene.meshes.push_back(floor);
  const std::uint32_t glow = scene.add_material(make_diffuse(Color(0.0f), Color(4.0f)));
  scene.meshes.push_back(parallelogram(place, lamp_corner, lamp_a, lamp_b, glow));
  scene.camera = {place.at({0.5f, 2, 0.25f}), place.at(Vec3(0.0f)), {0, 0, 1}, 0.001f, 0.0f, 1.0f};
  return scene;
}

// Rays begin off the floor by about 1e-6 of its size and of its distance from the scene's origin:
// up to 1e-3 here, of the lamp's distance of 2.
TEST(ShadingNormal, ShadowRaysThroughTheSurfaceReachTheLamp) {
  const double expected = 4 * 0.5 / pi_double * lamp_irradiance(Vec3d(tilted));
  for (const auto& [far, size] : {std::pair(0.0f, 2.0f), {0.0f, 1024.0f}, {1000.0f, 2.0f}}) {
    SceneData scene = floor_above_a_lamp({far}, size);
    const Options options = image_options(8, 8, 256, 2);
    prepare_scene(scene, options);
    const Image image = render(scene, options).image;
    MeanEstimate mean;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) mean.add(image.rgb[i]);
    EXPECT_NEAR(mean.mean(), expected, 5 * mean.sigma() + 2e-3 * expected)
        << "at " << far << ", size " << size << ", sigma " << mean.sigma();
    EXPECT_LT(mean.sigma(), 5e-3 * expected);
  }
}

}  // namespace
}  // namespace pt
