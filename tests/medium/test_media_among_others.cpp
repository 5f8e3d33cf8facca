// Errors that all modes would share, so that comparing modes does not show them: media among
// lights, grids, priorities and surfaces that hide from the camera.
#include <gtest/gtest.h>

#include "medium/filled_glasses.h"

namespace pt {
namespace {

/// In fog, a plate close to the camera. Of the point lights around it strong ones lie below its
/// horizon and shine on the fog above it, weak ones above. Points, which no direction finds: what
/// the tree leaves out is lost.
SceneData plate_and_lamps() {
  SceneData scene;
  scene.name = "plate";
  scene.media.push_back(make_medium(Color(0.25f), Color(0.9f)));
  scene.camera_medium = 0;
  scene.add_quad({-0.5f, 0, 0.5f}, {1, 0, 0}, {0, 0, -1},
                 scene.add_material(make_diffuse(Color(0.8f))));
  for (int i = 0; i < 48; ++i) {
    const float angle = 0.1308997f * static_cast<float>(i);
    const bool is_weak = i % 2 == 1;
    DeltaLight lamp;
    lamp.position = {2 * std::cos(angle), is_weak ? 0.5f : -0.5f, 2 * std::sin(angle)};
    lamp.intensity = (is_weak ? 0.01f : 1.0f) * Color(3.0f, 4.0f, 2.0f);
    scene.delta_lights.push_back(lamp);
  }
  scene.camera = {{0, 0.1f, 0}, {0, 0, 0}, {0, 0, -1}, 60.0f, 0.0f, 0.1f};
  return scene;
}

// A collision receives light from all sides, also after a surface that did not. (Of lamps with
// extent MIS would find in other directions what the tree left out.)
TEST(MediaAmongLights, ATreeFindsThemFromCollisions) {
  const SceneData scene = plate_and_lamps();
  const auto with_selection = [&](const char* selection, const char* depth, const char* seed) {
    return render_medium(
        scene,
        {{"light-selection", selection}, {"max-depth", depth}, {"spp", "512"}, {"seed", seed}});
  };
  const auto mean = [](const Image& image) {
    double sum = 0;
    for (const float x : image.rgb) sum += x;
    return sum / static_cast<double>(image.rgb.size());
  };
  const Image by_power = with_selection("power", "3", "1");
  EXPECT_GT(mean(by_power), 1.02 * mean(with_selection("power", "2", "1")))
      << "light that the plate sends into the fog";
  expect_same_means(with_selection("tree", "3", "2"), by_power);
}

// Each part of a shadow ray has numbers of its own: what gets through two veils of the same grid is
// the product of what gets through each.
TEST(MediaAmongGrids, ShadowRaysEstimateEachByItself) {
  const Color veil(0.9f, 0.3f, 0.1f);
  SceneData scene = cloud_under_sky(make_medium(Color(0.6f), Color(1.0f)), CloudShape::quads);
  scene.camera = distant_camera();
  darken_sky(scene);
  scene.delta_lights.push_back(sun_along({0, -1, 0}, Color(1.0f)));
  scene.media.push_back(make_medium(veil, Color(0.5f)));
  scene.media[1].density_grid = add_grid(
      scene, make_volume({3, 1, 1}, 1, false, translate({-9, -9, -9}) * scale(Vec3(18.0f)),
                         [](const GridSize& v, std::uint32_t) { return v[0] == 1 ? 1 : 5; }));
  const std::uint32_t boundary = scene.add_material(make_boundary(no_medium, 1));
  double length = 0;
  for (const float y : {1.5f, 3.0f, 4.5f, 6.0f}) {
    add_cuboid(scene, {-3, y, -3}, {3, y + 1, 3}, boundary);
    length += 1;
    expect_mean(render_medium(scene, {{"spp", "1024"}, {"max-depth", "2"}}),
                std::exp(-0.6) * -std::expm1(-1.2) / (4 * pi_double) * beer(veil, length), 0.03);
  }
}

/// A lamp whose shape has a medium of its own, in a box of one of a higher priority.
SceneData lamp_in_dye(bool is_ball) {
  SceneData scene;
  scene.name = "lamp in dye";
  scene.media = {make_medium({0.2f, 0.5f, 0.9f}, Color(0.0f)),
                 make_medium(Color(3.0f), Color(0.0f))};
  scene.media[0].priority = 2, scene.media[1].priority = 1;
  add_cuboid(scene, Vec3(-1.0f), Vec3(1.0f), scene.add_material(make_boundary(no_medium, 0)));
  MaterialDescription lamp = make_diffuse(Color(0.0f), {2.0f, 3.0f, 4.0f});
  lamp.is_boundary = true, lamp.media = {no_medium, 1};
  const std::uint32_t material = scene.add_material(lamp);
  if (is_ball) {
    scene.add_sphere({0, 0, 0}, 0.5f, material);
  } else {
    add_cuboid(scene, Vec3(-0.5f), Vec3(0.5f), material);
  }
  return scene;
}

// The surface of a shape within a higher priority is nothing, but what shines shines.
TEST(MediaOfHigherPriority, DoNotHideLamps) {
  for (const bool is_ball : {false, true}) {
    SceneData scene = lamp_in_dye(is_ball);
    scene.camera = distant_camera();
    expect_mean(render_medium(scene, {{"spp", "1024"}}),
                glm::dvec3(2, 3, 4) * beer(scene.media[0].extinction, 0.5));
    // And it casts shadows: light from behind it does not reach a floor in front.
    scene.add_quad({-9, -9, 3}, {18, 0, 0}, {0, 18, 0},
                   scene.add_material(make_diffuse(Color(0.5f))));
    scene.materials[1].emission.radiance = Color(0.0f, 0.0f, 1e-20f);
    scene.delta_lights.push_back(sun_along({0, 0, 1}, Color(1.0f)));
    scene.camera = {{0, 0, 1.5f}, {0, 0, 3}, {0, 1, 0}, 4.0f, 0.0f, 1.0f};
    expect_mean(render_medium(scene, {{"spp", "64"}, {"max-depth", "2"}}), glm::dvec3(0.0));
  }
}

// They light a floor as light that is met by chance says.
TEST(MediaOfHigherPriority, LampsWithinLightWhatIsOutside) {
  SceneData scene = lamp_in_dye(false);
  scene.add_quad({-3, -1.5f, 3}, {6, 0, 0}, {0, 0, -6},
                 scene.add_material(make_diffuse(Color(0.7f))));
  scene.camera = {{0, 2, 4}, {0, -0.5f, 0}, {0, 1, 0}, 50.0f, 0.0f, 4.0f};
  expect_same_means(
      render_medium(scene, {{"max-depth", "3"}, {"spp", "256"}}),
      render_medium(scene, {{"max-depth", "3"}, {"nee", "off"}, {"spp", "2048"}, {"seed", "5"}}));
}

/// A lamp between a floor and its sun, which the camera does not see; it shines upwards.
SceneData hidden_lamp(CloudShape shape, bool has_fog) {
  SceneData scene;
  scene.name = "hidden lamp";
  scene.camera.hides_emitters = true;
  scene.add_quad({-9, 0, 9}, {18, 0, 0}, {0, 0, -18},
                 scene.add_material(make_diffuse(Color(0.5f))));
  const std::uint32_t lamp = scene.add_material(make_diffuse(Color(0.0f), Color(1e-6f)));
  if (shape == CloudShape::sphere) {
    scene.add_sphere({0, 1.5f, 0}, 0.5f, lamp);
  } else {
    scene.add_quad({-0.5f, 1, 0.5f}, {1, 0, 0}, {0, 0, -1}, lamp);
  }
  if (has_fog) {
    scene.media.push_back(make_medium(Color(0.5f), Color(0.0f)));
    add_cuboid(scene, {-1, 0.2f, -1}, {1, 0.7f, 1},
               scene.add_material(make_boundary(no_medium, 0)));
  }
  scene.delta_lights.push_back(sun_along({0, -1, 0}, Color(1.0f)));
  CameraParameters& camera = scene.camera;
  camera.look_from = {0, 4, 0}, camera.look_at = {0, 0, 0}, camera.up = {0, 0, -1};
  camera.fov_degrees = 4.0f;
  return scene;
}

// Shadow rays and later rays meet it; camera rays alone do not.
TEST(HiddenLamps, CastShadows) {
  for (const bool has_fog : {false, true}) {
    for (const CloudShape shape : {CloudShape::quads, CloudShape::sphere}) {
      SceneData scene = hidden_lamp(shape, has_fog);
      const Image shaded = render_medium(scene, {{"spp", "64"}, {"max-depth", "2"}});
      for (const float value : shaded.rgb) EXPECT_LT(value, 1e-5f);
      scene.camera.look_from.x = scene.camera.look_at.x = 3;
      const glm::dvec3 lit(0.5 / pi_double);
      expect_mean(render_medium(scene, {{"spp", "64"}, {"max-depth", "2"}}), lit);
    }
  }
}

// The floor of a fog whose material says what is on its two sides: shadow rays begin in the fog,
// and so do paths.
TEST(MediaBehindSurfaces, ShadowRaysBeginWhereTheyGo) {
  const Color extinction(0.2f, 0.5f, 0.9f);
  SceneData scene;
  scene.name = "closed by a floor";
  scene.media = {make_medium(extinction, Color(0.0f)), make_medium(Color(9.0f), Color(0.0f))};
  MaterialDescription floor = make_diffuse(Color(0.6f));
  floor.is_boundary = true, floor.media = {0, 1};
  scene.add_quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, scene.add_material(floor));
  scene.add_quad({-2, -2, 1.5f}, {4, 0, 0}, {0, 4, 0},
                 scene.add_material(make_boundary(no_medium, 0)));
  scene.camera = distant_camera();
  scene.delta_lights.push_back(sun_along({0, 0, -1}, Color(1.0f)));
  expect_mean(render_medium(scene, {{"spp", "1024"}, {"max-depth", "2"}}),
              0.6 / pi_double * beer(extinction, 3));
  // A camera that is not said to be in the fog: the floor's own media count all the same.
  scene.camera.look_from = {0, 0, 1}, scene.camera.fov_degrees = 1.0f;
  expect_mean(render_medium(scene, {{"spp", "64"}, {"max-depth", "2"}}),
              0.6 / pi_double * beer(extinction, 1.5), 0.008, 1e-3);
}

/// A lamp in a ball of rough glass that is full of dye, and a floor.
SceneData lamp_in_rough_glass(float inside) {
  SceneData scene;
  scene.name = "lamp in glass";
  scene.media = {make_medium({0.3f, 1.0f, 2.0f}, Color(0.0f)),
                 make_medium(Color(0.1f), Color(0.0f))};
  MaterialDescription glass = make_material<RoughDielectric>(Color(1.0f), Color(1.0f), 1.2f);
  glass[&RoughDielectric::alpha_x].value = Color(0.6f);
  glass[&RoughDielectric::alpha_y].value = Color(0.6f);
  glass.is_boundary = true, glass.media = {1, 0};
  Mesh ball = make_ball(scene.add_material(glass));
  ball.normals.clear();
  scene.meshes.push_back(ball);
  scene.add_sphere({0, 0, 0}, inside,
                   scene.add_material(make_diffuse(Color(0.0f), {5.0f, 6.0f, 7.0f})));
  scene.camera_medium = 1;
  scene.camera = {{0, 0.5f, 4}, {0, 0, 0}, {0, 1, 0}, 25.0f, 0.0f, 4.0f};
  return scene;
}

// A shadow ray that begins on glass goes through what is on the side to which it goes.
TEST(MediaBehindSurfaces, LampsInRoughGlassShineThroughWhatIsInside) {
  for (const float radius : {0.7f, 0.3f}) {
    const SceneData scene = lamp_in_rough_glass(radius);
    expect_same_means(
        render_medium(scene, {{"max-depth", "2"}, {"spp", "256"}}),
        render_medium(scene, {{"max-depth", "2"}, {"nee", "off"}, {"spp", "2048"}, {"seed", "5"}}));
  }
}

// The camera sees a mirror through the lamp, and in the mirror the lamp's bright side.
TEST(HiddenLamps, AreSeenInMirrors) {
  for (const CloudShape shape : {CloudShape::quads, CloudShape::sphere}) {
    for (const bool has_fog : {false, true}) {
      SceneData scene = hidden_lamp(shape, has_fog);
      scene.delta_lights.clear();
      scene.materials[0] = make_metal(Color(1.0f), 0.0f);
      scene.materials[1].emission.radiance = {2.0f, 3.0f, 4.0f};
      if (shape == CloudShape::quads) {  // downwards
        scene.quads[1] = make_quad({-0.5f, 1, -0.5f}, {1, 0, 0}, {0, 0, 1});
      }
      const double length = has_fog ? 1 : 0;  // there and back
      const glm::dvec3 expected = glm::dvec3(2, 3, 4) * std::exp(-0.5 * length);
      expect_mean(render_medium(scene, {{"spp", "1024"}, {"max-depth", "2"}}), expected, 0.008,
                  3e-4);
      for (const float value : render_medium(scene, {{"spp", "16"}, {"max-depth", "1"}}).rgb) {
        EXPECT_EQ(value, 0.0f);
      }
    }
  }
}

// Camera rays alone do not see the sky: it lights a floor, and its picture in a mirror is there.
TEST(HiddenLamps, SkiesLightWhatIsSeen) {
  for (const bool is_map : {false, true}) {
    SceneData scene;
    scene.name = "floor under a hidden sky";
    scene.sky = {Color(1.0f), Color(1.0f)};
    if (is_map) set_environment(scene);
    scene.camera = {{0, 1, 0}, {0, 0, 0}, {0, 0, -1}, 40.0f, 0.0f, 1.0f};
    scene.camera.hides_emitters = true;
    scene.add_quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6},
                   scene.add_material(make_diffuse(Color(0.5f))));
    expect_mean(render_medium(scene, {{"spp", "256"}}), glm::dvec3(0.5));
    scene.materials[0] = make_metal(Color(0.9f), 0.0f);
    expect_mean(render_medium(scene), glm::dvec3(0.9));
    scene.camera.look_at.y = 2;
    for (const float value : render_medium(scene).rgb) EXPECT_EQ(value, 0.0f);
  }
}

/// A glossy plate that mirrors a small lamp at a distance of 1.13. A box of nothing, whose
/// boundaries rays cross, is in front of the camera or of the lamp.
SceneData glossy_plate(bool is_before_camera) {
  SceneData scene;
  scene.name = "glossy plate";
  scene.media.push_back(make_medium(Color(0.0f), Color(0.0f)));
  scene.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2},
                 scene.add_material(make_material<Conductor>(1, 0, 1, 0.08f, 0.08f, 0)));
  const float s = 0.15f * std::sqrt(0.5f);
  scene.add_quad({-0.15f, 0.8f - s, -0.8f - s}, {0.3f, 0, 0}, {0, 2 * s, 2 * s},
                 scene.add_material(make_diffuse(Color(0.0f), {5.0f, 6.0f, 7.0f})));
  const std::uint32_t boundary = scene.add_material(make_boundary(no_medium, 0));
  const float z = is_before_camera ? 0.5f : -0.5f;
  add_cuboid(scene, {-0.9f, 0.1f, z - 0.2f}, {0.9f, 1.9f, z + 0.2f}, boundary);
  scene.camera = {{0, 1.5f, 1.5f}, {0, 0, 0}, {0, 1, 0}, 6.0f, 0.0f, 2.0f};
  return scene;
}

// The density of asking is as seen from the last scattering: what a path travelled before a surface
// does not count, and all of what it travelled since does, however many boundaries it crossed.
TEST(MediaBehindSurfaces, DensitiesAreAsSeenFromTheSurface) {
  for (const bool is_before_camera : {false, true}) {
    SCOPED_TRACE(is_before_camera);
    const SceneData scene = glossy_plate(is_before_camera);
    const Image by_chance =
        render_medium(scene, {{"max-depth", "2"}, {"nee", "off"}, {"spp", "1024"}});
    expect_same_means(render_medium(scene, {{"max-depth", "2"}, {"spp", "512"}, {"seed", "5"}}),
                      by_chance);
  }
}

}  // namespace
}  // namespace pt
