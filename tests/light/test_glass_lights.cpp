// Radiance inside of glass is eta^2 times that outside: lamps, cameras and skies on either side.
#include "common/scene/prepare/prepare_scene.h"
#include "common/transport/path.h"
#include "render_serial.h"
#include "statistics.h"

namespace pt {
namespace {

constexpr float eta = 1.5f, eta2 = eta * eta;
/// Transmittance of a surface of this glass at normal incidence.
constexpr double passes = 1 - 0.2 * 0.2;

/// A unit ball of glass around the origin and a camera of a narrow view towards it.
SceneData glass_ball(const Vec3& camera) {
  SceneData scene;
  scene.name = "glass ball";
  scene.add_sphere({0, 0, 0}, 1, scene.add_material(make_dielectric(Color(1.0f), eta)));
  scene.camera = {camera, camera + Vec3(0, 0, -1), {0, 1, 0}, 0.5f, 0.0f, 1.0f};
  return scene;
}

Options one_pixel(int spp, int rr_depth = 0) {
  Options options = image_options(1, 1, spp, 200);
  options.rr_depth = rr_depth;
  return options;
}

MeanEstimate pixel(SceneData scene, const Options& options) {
  MeanEstimate mean;
  prepare_scene(scene, options);
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Options seeded = options;
    seeded.seed = seed;
    mean.add(render(scene, seeded).image.rgb[0]);
  }
  return mean;
}

// Head-on, light of a black lamp leaves by 1 - R and is spread over an angle that is eta^2 larger.
TEST(GlassLights, ALampInAGlassBallIsDimmerOutsideByEtaSquared) {
  SceneData scene = glass_ball({0, 0, 4});
  scene.add_sphere({0, 0, 0}, 0.5f, scene.add_material(make_diffuse(Color(0.0f), Color(3.0f))));
  const MeanEstimate mean = pixel(scene, one_pixel(400));
  EXPECT_NEAR(mean.mean(), 3 * passes / double{eta2}, 5 * mean.sigma() + 1e-4);
}

// A sky of radiance 1 fills the ball with radiance eta^2, from its middle in all directions.
TEST(GlassLights, WithinAFurnaceOfGlassRadianceIsEtaSquared) {
  SceneData scene = glass_ball({0, 0, 0});
  scene.sky = {Color(1.0f), Color(1.0f)};
  const MeanEstimate mean = pixel(scene, one_pixel(400));
  EXPECT_NEAR(mean.mean(), double{eta2}, 5 * mean.sigma() + 1e-4);
}

// A diffuse surface in the ball sees radiance eta^2 and sends its share out again: a furnace stays
// one, whatever is inside.
TEST(GlassLights, AFurnaceLooksTheSameThroughGlass) {
  SceneData scene = glass_ball({0, 0, 4});
  scene.add_sphere({0.3f, 0, 0}, 0.5f, scene.add_material(make_diffuse(Color(1.0f))));
  scene.sky = {Color(1.0f), Color(1.0f)};
  for (const int rr_depth : {0, 2}) {
    const MeanEstimate mean = pixel(scene, one_pixel(2000, rr_depth));
    EXPECT_NEAR(mean.mean(), 1, 5 * mean.sigma() + 1e-4) << "roulette from " << rr_depth;
  }
}

TEST(GlassLights, RouletteTakesNoPathForDimBecauseItIsInGlass) {
  Color beta(1 / eta2);
  play_roulette(beta, 0.94f, eta2);
  EXPECT_NEAR(beta.x, 1 / double{eta2} / 0.95, 1e-6) << "survives as a path of throughput 1 does";
  // A ball before a black sky: what leaves it has been through both of its surfaces at least.
  SceneData scene = glass_ball({0, 0, 4});
  const Options with = one_pixel(4000, 1), without = one_pixel(4000);
  prepare_scene(scene, with);
  const auto rays = [&](const Options& options) {
    return static_cast<double>(render(scene, options).counts.rays) / 4000;
  };
  // 3.08 rays without roulette; twice 0.95 with it, but 0.42 inside if beta were all it sees.
  EXPECT_GT(rays(with), 0.93 * rays(without));
}

}  // namespace
}  // namespace pt
