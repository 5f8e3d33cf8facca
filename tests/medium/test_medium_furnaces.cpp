// Where nothing is lost under a sky of ones, or as much shines as is absorbed, everything is one.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "medium/medium_scenes.h"

namespace pt {
namespace {

constexpr CloudShape all_shapes[] = {CloudShape::sphere, CloudShape::quads, CloudShape::mesh_box,
                                     CloudShape::mesh_ball};

/// Without noise: in grey media every path is worth one.
void expect_ones(const SceneData& scene, const Settings& settings = {{"spp", "8"}}) {
  for (const float value : render_medium(scene, settings).rgb) ASSERT_NEAR(value, 1, 1e-4);
}

/// With densities in [0, 4) of the box [-1, 1]^3.
SceneData random_cloud(const Medium& medium, CloudShape shape, std::uint32_t channels,
                       bool interpolates, std::uint64_t seed) {
  TestRandom random(seed);
  SceneData scene = cloud_under_sky(medium, shape);
  const Affine place = scale(Vec3(2.0f)) * translate(Vec3(-0.5f));
  scene.media[0].density_grid =
      add_grid(scene, random_volume(random, {9, 5, 12}, channels, interpolates, place));
  return scene;
}

TEST(MediumFurnace, WhereNothingIsAbsorbedEveryPixelIsOne) {
  for (const CloudShape shape : all_shapes) {
    for (const float density : {0.1f, 1.0f, 8.0f}) {
      for (const auto& [phase, g] : {std::pair{phase_kind_of<Isotropic>, 0.0f},
                                     {phase_kind_of<HenyeyGreenstein>, 0.7f},
                                     {phase_kind_of<HenyeyGreenstein>, -0.5f},
                                     {phase_kind_of<Rayleigh>, 0.0f}}) {
        SCOPED_TRACE(fmt::format("{}, density {}, phase function {}, g {}", name_of(shape), density,
                                 static_cast<int>(phase), g));
        const Medium medium = make_medium(Color(density), Color(1.0f), phase, g);
        expect_ones(cloud_under_sky(medium, shape), {{"spp", "4"}});
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(MediumFurnace, WithGridsToo) {
  for (const CloudShape shape : all_shapes) {
    for (const bool interpolates : {false, true}) {
      SCOPED_TRACE(fmt::format("{}, interpolates {}", name_of(shape), interpolates));
      expect_ones(random_cloud(make_medium(Color(2.0f), Color(1.0f)), shape, 1, interpolates, 81));
      if (HasFatalFailure()) return;
    }
  }
}

// Coloured ones are noisy: a path's weight is one in the mean over its channels.
TEST(MediumFurnace, ColouredOnesToo) {
  const Medium medium = make_medium({0.5f, 2.0f, 4.0f}, Color(1.0f));
  const Settings settings{{"spp", "256"}};
  expect_mean(render_medium(cloud_under_sky(medium, CloudShape::sphere), settings), glm::dvec3(1));
  for (const std::uint32_t channels : {1u, 3u}) {
    const SceneData scene = random_cloud(medium, CloudShape::quads, channels, true, 82);
    expect_mean(render_medium(scene, settings), glm::dvec3(1));
  }
  const Medium clear_red = make_medium({0.0f, 1.0f, 4.0f}, Color(1.0f));
  expect_mean(render_medium(random_cloud(clear_red, CloudShape::sphere, 1, true, 83), settings),
              glm::dvec3(1));
}

// A path's weights of the three channels have the mean one exactly, and with it every pixel.
TEST(MediumFurnace, ColoursOfAPixelHaveTheMeanOne) {
  const Medium medium = make_medium({0.5f, 2.0f, 4.0f}, Color(1.0f));
  const Image image = render_medium(random_cloud(medium, CloudShape::quads, 3, true, 84));
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
    EXPECT_NEAR((image.rgb[i] + image.rgb[i + 1] + image.rgb[i + 2]) / 3, 1, 1e-3);
  }
}

// The sky as a light that is asked for: the two ways to find it add up.
TEST(MediumFurnace, AskingTheSkyCountsNothingTwice) {
  for (const char* nee : {"on", "off"}) {
    for (const float g : {0.0f, 0.8f}) {
      const Medium medium =
          make_medium(Color(1.5f), Color(1.0f), phase_kind_of<HenyeyGreenstein>, g);
      for (SceneData scene : {cloud_under_sky(medium, CloudShape::mesh_ball),
                              random_cloud(medium, CloudShape::quads, 1, true, 85)}) {
        set_environment(scene);
        SCOPED_TRACE(fmt::format("nee {}, g {}", nee, g));
        expect_mean(render_medium(scene, {{"spp", "32"}, {"nee", nee}}), glm::dvec3(1));
      }
    }
  }
}

// What absorbs shines as brightly as the sky: an oven in which all has one temperature.
TEST(MediumFurnace, OfOneTemperatureEveryPixelIsOne) {
  const Medium medium = make_medium(Color(1.5f), {0.1f, 0.6f, 0.95f});
  for (const bool has_grids : {false, true}) {
    for (const CloudShape shape : {CloudShape::sphere, CloudShape::mesh_box}) {
      SceneData scene =
          has_grids ? random_cloud(medium, shape, 1, true, 86) : cloud_under_sky(medium, shape);
      scene.media[0].emission = Color(1.0f);
      if (has_grids) {
        TestRandom random(87);
        const Affine place = scale(Vec3(2.0f)) * translate(Vec3(-0.5f));
        scene.media[0].albedo_grid = add_grid(
            scene, make_volume({4, 3, 2}, 3, true, place, [&](const GridSize&, std::uint32_t) {
              return random.uniform(0, 1);
            }));
        scene.media[0].emission = Color(4.0f);
        scene.media[0].emission_grid =
            add_grid(scene, make_volume({2, 1, 3}, 1, false, place,
                                        [](const GridSize&, std::uint32_t) { return 0.25; }));
      }
      expect_ones(scene);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(MediumFurnace, GlassAroundAMediumIsOne) {
  for (const CloudShape shape : all_shapes) {
    SceneData scene = cloud_under_sky(make_medium(Color(2.0f), Color(1.0f)), shape);
    MaterialDescription& glass = scene.materials[0];
    glass = make_dielectric(Color(1.0f), 1.5f);
    glass.is_boundary = true, glass.media = {no_medium, 0};
    for (Mesh& mesh : scene.meshes) mesh.normals.clear();  // glass of other normals loses light
    SCOPED_TRACE(name_of(shape));
    expect_ones(scene);
    if (HasFatalFailure()) return;
  }
}

TEST(MediumFurnace, AnInstanceOfABoundaryIsOne) {
  for (const float side : {1.0f, -1.0f}) {  // mirrored
    SceneData scene = cloud_under_sky(make_medium(Color(3.0f), Color(1.0f)), CloudShape::mesh_ball);
    scene.meshes[0].group = 1;
    scene.instances.push_back({1, rotate({1, 1, 0}, 30.0f) * scale({side * 0.7f, 1.2f, 1.0f})});
    scene.instances.push_back({1, translate({-0.3f, 1.5f, -2}) * scale(Vec3(0.6f))});
    expect_ones(scene);
    if (HasFatalFailure()) return;
  }
}

TEST(MediumFurnace, WithTheCameraInsideAndMediaWithinMedia) {
  SceneData scene =
      random_cloud(make_medium(Color(1.5f), Color(1.0f)), CloudShape::quads, 1, true, 88);
  scene.camera = {{0.5f, 0.2f, 0.8f}, {0, 0, 0}, {0, 1, 0}, 70.0f, 0.0f, 1.0f};
  scene.camera_medium = 0;
  expect_ones(scene);
  scene.media.push_back(
      make_medium(Color(6.0f), Color(1.0f), phase_kind_of<HenyeyGreenstein>, 0.4f));
  scene.add_sphere(Vec3(0.0f), 0.4f, scene.add_material(make_boundary(0, 1)));
  expect_ones(scene);
  scene.add_sphere(Vec3(0.0f), 0.2f, scene.add_material(make_boundary(1, no_medium)));  // a void
  expect_ones(scene);
}

// A mirror and a wall of albedo one in the medium keep it.
TEST(MediumFurnace, SurfacesInAMediumAreOne) {
  SceneData scene =
      random_cloud(make_medium(Color(1.0f), Color(1.0f)), CloudShape::sphere, 1, true, 89);
  scene.add_quad({-0.5f, -0.3f, 0.4f}, {1, 0, 0}, {0, 0, -0.8f},
                 scene.add_material(make_diffuse(Color(1.0f))));
  scene.add_sphere({0.2f, 0.2f, 0}, 0.3f, scene.add_material(make_metal(Color(1.0f), 0.0f)));
  expect_ones(scene);
}

}  // namespace
}  // namespace pt
