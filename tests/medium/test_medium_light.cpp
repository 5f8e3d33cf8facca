// Light through media and from them, against formulas and quadrature in double precision.
#include <gtest/gtest.h>

#include "medium/medium_scenes.h"

namespace pt {
namespace {

const Settings long_render{{"spp", "1024"}}, once{{"spp", "512"}, {"max-depth", "2"}};

/// Seen along -z through the middle of its box.
SceneData slab_of(const Medium& medium, CloudShape shape = CloudShape::quads) {
  SceneData scene = cloud_under_sky(medium, shape);
  scene.camera = distant_camera();
  return scene;
}

/// The density is linear: a at z = -1, b at z = 1.
void set_linear_density(SceneData& scene, double a, double b, std::uint32_t voxels = 24) {
  VolumeData volume =
      slab_volume(voxels, 2, 1, [&](double z, std::uint32_t) { return a + (b - a) * 0.5 * z; });
  volume.to_world = translate({0, 0, -1}) * volume.to_world;
  scene.media[0].density_grid = add_grid(scene, volume);
}

/// The same as a function of z, and its integral from there to the near side.
struct LinearDensity {
  double a, b;
  double at(double z) const { return a + (b - a) * 0.5 * (z + 1); }
  double to_front(double z) const { return 0.5 * (at(z) + b) * (1 - z); }
};

TEST(MediumTransmittance, IsBeersLaw) {
  const Color extinction(0.2f, 0.7f, 1.6f);
  for (const CloudShape shape : {CloudShape::quads, CloudShape::mesh_box, CloudShape::sphere}) {
    const SceneData scene = slab_of(make_medium(extinction, Color(0.0f)), shape);
    expect_mean(render_medium(scene, long_render), beer(extinction, 2));
  }
}

TEST(MediumTransmittance, BeginsWhereTheCameraIs) {
  const Color extinction(0.2f, 0.7f, 1.6f);
  SceneData scene = slab_of(make_medium(extinction, Color(0.0f)));
  scene.camera.look_from = {0, 0, 0.5f};
  scene.camera_medium = 0;
  expect_mean(render_medium(scene, long_render), beer(extinction, 1.5));
}

TEST(MediumTransmittance, OfALinearDensityIsThatOfItsIntegral) {
  const Color extinction(0.2f, 0.7f, 1.6f);
  SceneData scene = slab_of(make_medium(extinction, Color(0.0f)));
  set_linear_density(scene, 0.2, 1.4);
  expect_mean(render_medium(scene, long_render), beer(extinction, 1.6));
}

TEST(MediumTransmittance, OfAnInstanceHasItsSize) {
  const Color extinction(0.2f, 0.7f, 1.1f);
  SceneData scene = slab_of(make_medium(extinction, Color(0.0f)), CloudShape::mesh_box);
  scene.meshes[0].group = 1;
  scene.instances.push_back({1, rotate({0, 1, 0}, 90.0f) * scale({1.25f, 1, 3})});
  expect_mean(render_medium(scene, long_render), beer(extinction, 2.5));
}

// L = Le (1 - T).
TEST(MediumEmission, IsThatOfASlab) {
  Medium medium = make_medium({0.4f, 0.8f, 1.3f}, Color(0.0f));
  medium.emission = {0.3f, 0.6f, 1.2f};
  SceneData scene = slab_of(medium);
  darken_sky(scene);
  expect_mean(render_medium(scene, long_render),
              glm::dvec3(medium.emission) * (1.0 - beer(medium.extinction, 2)));
  // What scatters does not shine; after one ray nothing else adds to it.
  scene.media[0].albedo = {0.3f, 0.0f, 0.8f};
  expect_mean(
      render_medium(scene, {{"spp", "1024"}, {"max-depth", "1"}}),
      glm::dvec3(0.7, 1, 0.2) * glm::dvec3(medium.emission) * (1.0 - beer(medium.extinction, 2)));
}

// The integral of T sigma_a Le, with an emission and an albedo that vary.
TEST(MediumEmission, OfGridsIsTheIntegral) {
  const float extinction = 1.3f;
  Medium medium = make_medium(Color(extinction), {0.2f, 0.5f, 1.0f});
  medium.emission = {2.0f, 1.0f, 0.5f};
  SceneData scene = slab_of(medium);
  darken_sky(scene);
  set_linear_density(scene, 1.5, 0.3);
  VolumeData linear = slab_volume(2, 2, 1, [](double z, std::uint32_t) { return 0.1 + 0.4 * z; });
  linear.to_world = translate({0, 0, -1}) * linear.to_world;
  scene.media[0].emission_grid = add_grid(scene, linear);
  linear.values = {0.9f, 0.2f};
  scene.media[0].albedo_grid = add_grid(scene, linear);
  const LinearDensity density{1.5, 0.3};
  glm::dvec3 expected;
  for (int c = 0; c < 3; ++c) {
    expected[c] = integrate(-1, 1, [&](double z) {
      const double albedo = double{medium.albedo[c]} * (0.9 - 0.35 * (z + 1));
      const double emission = double{medium.emission[c]} * (0.1 + 0.4 * (z + 1));
      return std::exp(-double{extinction} * density.to_front(z)) * double{extinction} *
             density.at(z) * (1 - albedo) * emission;
    });
  }
  expect_mean(render_medium(scene, {{"spp", "1024"}, {"max-depth", "1"}}), expected);
}

double henyey_greenstein(double g, double cosine) {
  return (1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5) / (4 * pi_double);
}

// From the side: to each point of the ray light comes through as much of the box.
TEST(MediumScattering, OnceIsQuadrature) {
  const Color extinction(0.6f, 1.5f, 0.2f), albedo(0.4f, 0.9f, 1.0f), irradiance(3.0f, 1.0f, 2.0f);
  for (const CloudShape shape : {CloudShape::quads, CloudShape::mesh_box}) {
    SceneData scene = slab_of(make_medium(extinction, albedo), shape);
    darken_sky(scene);
    scene.delta_lights.push_back(sun_along({0, -1, 0}, irradiance));
    const glm::dvec3 expected = glm::dvec3(irradiance) * beer(extinction, 1) * glm::dvec3(albedo) *
                                (1.0 - beer(extinction, 2)) / (4 * pi_double);
    expect_mean(render_medium(scene, once), expected);
  }
}

// From the front and above: the light is thrown back, whose cosine is -0.6.
TEST(MediumScattering, KnowsForwardsFromBackwards) {
  const double extinction = 0.75;
  for (const float g : {0.6f, -0.6f}) {
    SceneData scene = slab_of(make_medium(Color(static_cast<float>(extinction)), Color(1.0f),
                                          phase_kind_of<HenyeyGreenstein>, g));
    darken_sky(scene);
    scene.delta_lights.push_back(sun_along({0, -0.8f, -0.6f}, Color(1.0f)));
    const double expected = integrate(-1, 1, [&](double z) {
      const double to_light = std::min(1 / 0.8, (1 - z) / 0.6);
      return extinction * std::exp(-extinction * (1 - z + to_light)) *
             henyey_greenstein(double{g}, -0.6);
    });
    expect_mean(render_medium(scene, once), glm::dvec3(expected));
  }
}

// The same with a density that grows towards the camera.
TEST(MediumScattering, OfALinearDensityIsQuadrature) {
  const Color extinction(0.75f, 0.25f, 1.5f);
  const LinearDensity density{0.2, 1.4};
  SceneData scene = slab_of(make_medium(extinction, Color(0.9f)));
  set_linear_density(scene, density.a, density.b);
  darken_sky(scene);
  scene.delta_lights.push_back(sun_along({0, -0.8f, -0.6f}, Color(2.0f)));
  glm::dvec3 expected;
  for (int c = 0; c < 3; ++c) {
    const double e = double{extinction[c]};
    expected[c] = integrate(-1, 1, [&](double z) {
      // To the light z grows by 0.6 for each unit of length.
      const double length = std::min(1 / 0.8, (1 - z) / 0.6);
      const double to_light = 0.5 * (density.at(z) + density.at(z + 0.6 * length)) * length;
      return 2 * 0.9 * e * density.at(z) * std::exp(-e * (density.to_front(z) + to_light)) /
             (4 * pi_double);
    });
  }
  expect_mean(render_medium(scene, once), expected);
}

TEST(MediumScattering, OfALightWithinIsQuadrature) {
  const double extinction = 0.8;
  SceneData scene = slab_of(make_medium(Color(static_cast<float>(extinction)), Color(0.5f)));
  darken_sky(scene);
  DeltaLight point;
  point.position = {0, 0.5f, 0.25f};
  point.intensity = Color(2.0f);
  scene.delta_lights.push_back(point);
  const double expected = integrate(-1, 1, [&](double z) {
    const double distance2 = 0.25 + (z - 0.25) * (z - 0.25);
    return extinction * 0.5 * std::exp(-extinction * (1 - z + std::sqrt(distance2))) * 2 /
           distance2 / (4 * pi_double);
  });
  expect_mean(render_medium(scene, once), glm::dvec3(expected));
}

// Between a medium and its sun lie another medium, of which a shadow ray sees one part, and glass
// that lets no shadow ray through.
TEST(MediumScattering, ShadowRaysKnowWhatTheyCross) {
  const Color veil(0.9f, 0.3f, 0.1f);
  SceneData scene = slab_of(make_medium(Color(0.6f), Color(1.0f)));
  darken_sky(scene);
  scene.delta_lights.push_back(sun_along({0, -1, 0}, Color(1.0f)));
  scene.media.push_back(make_medium(veil, Color(0.5f)));
  add_cuboid(scene, {-3, 1.5f, -3}, {3, 2.25f, 3}, scene.add_material(make_boundary(no_medium, 1)));
  const glm::dvec3 expected =
      std::exp(-0.6) * -std::expm1(-1.2) / (4 * pi_double) * beer(veil, 0.75);
  expect_mean(render_medium(scene, once), expected);
  // The same as a grid of the same density within a brighter one: null collisions.
  SceneData of_grid = scene;
  of_grid.media[1].density_grid = add_grid(
      of_grid, make_volume({3, 1, 1}, 1, false, translate({-9, -9, -9}) * scale(Vec3(18.0f)),
                           [](const GridSize& v, std::uint32_t) { return v[0] == 1 ? 1 : 5; }));
  expect_mean(render_medium(of_grid, once), expected);
  scene.add_quad({-3, 3, 3}, {6, 0, 0}, {0, 0, -6},
                 scene.add_material(make_dielectric(Color(1.0f), 1.5f)));
  expect_mean(render_medium(scene, once), glm::dvec3(0));
}

/// A lamp outside a cloud and one inside.
SceneData cloud_with_lamps(PhaseKind phase, float g) {
  SceneData scene =
      cloud_under_sky(make_medium({1.2f, 0.8f, 2.0f}, Color(0.8f), phase, g), CloudShape::mesh_box);
  darken_sky(scene);
  const std::uint32_t lamp = scene.add_material(make_diffuse(Color(0.3f), {6.0f, 8.0f, 4.0f}));
  scene.add_quad({-0.8f, 1.6f, -0.8f}, {1.6f, 0, 0}, {0, 0, 1.6f}, lamp);
  scene.add_sphere({0.3f, -0.4f, -0.2f}, 0.25f, lamp);
  return scene;
}

/// Light that is asked for and light that is met by chance are one.
void expect_both_ways_agree(const SceneData& scene, const std::string& spp) {
  const auto with_settings = [&](const Settings& more) {
    Settings settings{{"max-depth", "4"}};
    settings.insert(settings.end(), more.begin(), more.end());
    return render_medium(scene, settings);
  };
  const Image by_chance = with_settings({{"nee", "off"}, {"spp", "1024"}});
  expect_same_means(with_settings({{"spp", spp}, {"seed", "2"}}), by_chance);
  expect_same_means(with_settings({{"spp", spp}, {"seed", "3"}, {"mis", "balance"}}), by_chance);
}

// Through a boundary the density of asking is as seen from where the path was scattered.
TEST(MediumLamps, BothWaysToFindThemAgree) {
  for (const auto& [phase, g] :
       {std::pair{phase_kind_of<Isotropic>, 0.0f}, {phase_kind_of<HenyeyGreenstein>, 0.85f}}) {
    expect_both_ways_agree(cloud_with_lamps(phase, g), "192");
  }
}

// A small one behind a cloud that scatters forwards, where both ways are as good: it is sampled by
// its area, whose density depends on the distance.
TEST(MediumLamps, BothWaysToFindSmallOnesAgree) {
  SceneData scene =
      cloud_under_sky(make_medium(Color(1.2f), Color(0.9f), phase_kind_of<HenyeyGreenstein>, 0.9f),
                      CloudShape::mesh_box);
  darken_sky(scene);
  scene.camera = {{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 6.0f, 0.0f, 4.0f};
  scene.add_quad({-0.25f, -0.25f, -3}, {0.5f, 0, 0}, {0, 0.5f, 0},
                 scene.add_material(make_diffuse(Color(0.0f), Color(5.0f))));
  expect_both_ways_agree(scene, "256");
}

// A grid of one density is the homogeneous medium. Outside of the ball it is denser, so that most
// collisions are with nothing.
TEST(MediumGrids, OfConstantDensityAreHomogeneous) {
  for (const Color& extinction : {Color(1.5f), Color(0.4f, 1.5f, 3.0f)}) {
    const SceneData plain = cloud_under_sky(
        make_medium(extinction, {0.9f, 0.7f, 0.3f}, phase_kind_of<HenyeyGreenstein>, 0.3f),
        CloudShape::sphere);
    for (const std::uint32_t channels : {1u, 3u}) {
      SceneData grid = plain;
      grid.media[0].density_grid = add_grid(
          grid, make_volume({8, 8, 8}, channels, true, scale(Vec3(6.0f)) * translate(Vec3(-0.5f)),
                            [](const GridSize& v, std::uint32_t) {
                              return v[0] + v[1] + v[2] == 0 ? 4 : 1;
                            }));
      grid.sky.zenith = {2.0f, 1.0f, 0.5f};
      SceneData other = plain;
      other.sky = grid.sky;
      expect_same_means(render_medium(grid, {{"spp", "128"}}),
                        render_medium(other, {{"spp", "128"}, {"seed", "9"}}));
    }
  }
}

// Where the medium's box is an instance, the image is that of the box itself.
TEST(MediumGrids, InInstancesAreWhereTheWorldHasThem) {
  TestRandom random(91);
  SceneData plain =
      cloud_under_sky(make_medium({1.0f, 2.0f, 4.0f}, Color(0.8f)), CloudShape::mesh_box);
  plain.media[0].density_grid = add_grid(
      plain, random_volume(random, {4, 5, 3}, 1, true, scale(Vec3(2.0f)) * translate(Vec3(-0.5f))));
  SceneData instance = plain;
  const Affine place = translate({0.2f, 0.1f, 0}) * scale({0.5f, 0.8f, 0.6f});
  for (Vec3& p : plain.meshes[0].positions) p = place.point(p);
  instance.meshes[0].group = 1;
  instance.instances.push_back({1, place});
  expect_same_means(render_medium(plain, {{"spp", "64"}}),
                    render_medium(instance, {{"spp", "64"}, {"seed", "9"}}));
}

std::vector<double> layer_means(const Image& image, const std::string& name) {
  for (const ImageLayer& layer : image.layers) {
    if (layer.name != name) continue;
    std::vector<double> means(layer.channels.size());
    const double pixels = static_cast<double>(layer.values.size() / means.size());
    for (std::size_t i = 0; i < layer.values.size(); ++i) {
      means[i % means.size()] += double{layer.values[i]} / pixels;
    }
    return means;
  }
  throw std::runtime_error("no layer " + name);
}

// To a wall behind two media that do not touch: along the whole ray, not from the last boundary.
TEST(MediumLayers, ReachThroughAllBoundaries) {
  const Color near(0.4f, 0.1f, 0.7f), far(0.2f, 0.9f, 0.3f);
  for (const CloudShape shape : {CloudShape::quads, CloudShape::mesh_box}) {
    SceneData scene = slab_of(make_medium(near, Color(0.0f)), shape);
    scene.media.push_back(make_medium(far, Color(0.0f)));
    add_cuboid(scene, {-2, -2, -5}, {2, 2, -3.5f}, scene.add_material(make_boundary(no_medium, 1)));
    scene.add_quad({-3, -3, -6}, {6, 0, 0}, {0, 6, 0},
                   scene.add_material(make_diffuse({0.2f, 0.3f, 0.4f})));
    const Settings settings{{"spp", "64"},
                            {"max-depth", "1"},
                            {"output", "a.exr"},
                            {"aov", "depth,position,collision,transmittance"}};
    const Image image = render_medium(scene, settings);
    EXPECT_NEAR(layer_means(image, "depth")[0], 46, 1e-3);
    EXPECT_NEAR(layer_means(image, "position")[2], -6, 1e-4);
    const glm::dvec3 expected = beer(near, 2) * beer(far, 1.5);
    const std::vector<double> found = layer_means(image, "transmittance");
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(found[static_cast<std::size_t>(c)], expected[c], 1e-4);
    }
    // All paths collide: a hundredth behind the near side of the second medium.
    scene.media[0].extinction = Color(0.0f), scene.media[1].extinction = Color(100.0f);
    const Image thick = render_medium(scene, settings);
    EXPECT_NEAR(layer_means(thick, "collision")[0], 43.51, 1e-3);
    EXPECT_NEAR(layer_means(thick, "depth")[0], 46, 1e-3);
  }
}

}  // namespace
}  // namespace pt
