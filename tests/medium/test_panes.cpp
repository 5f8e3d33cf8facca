// Thin glass through which light sampling sees, as in Mitsuba's integrators for media: what passes
// a pane costs no depth, and shadow rays are dimmed by it. Against formulas and between modes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "cloud_modes.h"
#include "common/transport/first_hit.h"
#include "load/mitsuba_scene.h"

namespace pt {
namespace {

/// The unpolarised light that a thin slab transmits after any number of internal reflections, in
/// double precision.
double slab_transmittance(double cosine, double eta) {
  const double inside = std::sqrt(1 - (1 - cosine * cosine) / (eta * eta));
  const double s = (cosine - eta * inside) / (cosine + eta * inside);
  const double p = (eta * cosine - inside) / (eta * cosine + inside);
  const double once = 0.5 * (s * s + p * p);
  return 1 - 2 * once / (1 + once);
}

MaterialDescription make_pane(const Color& tint, float eta) {
  MaterialDescription pane = make_material<ThinDielectric>(Color(1.0f), tint, eta);
  pane.passes = true;
  return pane;
}

const Color tint(0.9f, 0.6f, 0.3f);
constexpr float eta = 1.5f;

/// A diffuse floor seen from 1 above, lit by a sun of this direction. Panes at the heights `panes`.
SceneData floor_under_panes(const Vec3& sun_direction, const std::vector<float>& panes) {
  SceneData scene;
  scene.name = "panes";
  scene.add_quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, scene.add_material(make_diffuse(Color(0.5f))));
  const std::uint32_t pane = scene.add_material(make_pane(tint, eta));
  for (const float y : panes) scene.add_quad({-50, y, 50}, {100, 0, 0}, {0, 0, -100}, pane);
  scene.delta_lights.push_back(sun_along(sun_direction, Color(3.0f)));
  scene.camera = {{0, 1, 0}, {0, 0, 0}, {0, 0, -1}, 0.05f, 0.0f, 1.0f};
  return scene;
}

TEST(Panes, AttenuateShadowRays) {
  for (const Vec3& direction : {Vec3(0, -1, 0), Vec3(0.6f, -0.8f, 0), Vec3(0, -0.2f, 1)}) {
    const double cosine = -double{normalize(direction).y};
    for (const std::size_t count : {0u, 1u, 2u}) {
      std::vector<float> panes{2.0f, 3.0f};
      panes.resize(count);
      const glm::dvec3 one = slab_transmittance(cosine, double{eta}) * glm::dvec3(tint);
      glm::dvec3 expected(3 * cosine * 0.5 / pi_double);
      for (std::size_t i = 0; i < count; ++i) expected *= one;
      expect_mean(
          render_medium(floor_under_panes(direction, panes), {{"max-depth", "2"}, {"spp", "4"}}),
          expected);
    }
  }
}

// The camera looks through panes: the floor is still the first surface, of two rays.
TEST(Panes, CostNoDepth) {
  const glm::dvec3 one = slab_transmittance(1, double{eta}) * glm::dvec3(tint);
  for (const char* depth : {"2", "3"}) {
    const SceneData scene = floor_under_panes({0, -1, 0}, {0.25f, 0.5f});
    const Image image = render_medium(scene, {{"max-depth", depth}, {"spp", "4000"}});
    // Light that comes back from a pane to the floor is asked for with the fourth ray.
    expect_mean(image, 3 * 0.5 / pi_double * one * one * one * one);
  }
}

// With a depth of 1 a lamp is seen through panes, and not in a pane's mirror; of 2 in both.
TEST(Panes, ReflectAtTheCostOfOneRay) {
  SceneData scene;
  scene.name = "mirror";
  const std::uint32_t pane = scene.add_material(make_pane(tint, eta));
  scene.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, pane);
  const auto lamp = [&](const Color& color) {
    return scene.add_material(make_diffuse(Color(0.0f), color));
  };
  scene.add_quad({-5, -5, -2}, {10, 0, 0}, {0, 10, 0}, lamp({1, 2, 3}));  // behind the glass
  scene.add_quad({-5, 5, 50}, {10, 0, 0}, {0, -10, 0}, lamp({7, 5, 2}));  // behind the camera
  scene.camera = distant_camera();
  const double through = slab_transmittance(1, double{eta});
  const glm::dvec3 seen = through * glm::dvec3(tint) * glm::dvec3(1, 2, 3);
  expect_mean(render_medium(scene, {{"max-depth", "1"}, {"spp", "4000"}}), seen);
  expect_mean(render_medium(scene, {{"max-depth", "2"}, {"spp", "4000"}}),
              seen + (1 - through) * glm::dvec3(7, 5, 2));
}

// In fog, which goes on behind a pane; and a pane that is the fog's own boundary.
TEST(Panes, AmongMediaKeepThemOrChangeThem) {
  const Color extinction(0.3f, 0.6f, 0.9f);
  const glm::dvec3 one = slab_transmittance(1, double{eta}) * glm::dvec3(tint);
  const glm::dvec3 lit = 3 * 0.5 / pi_double * one;
  SceneData scene = floor_under_panes({0, -1, 0}, {1.5f});
  scene.media.push_back(make_medium(extinction, Color(0.0f)));
  add_cuboid(scene, {-2, 1.2f, -2}, {2, 2.2f, 2}, scene.add_material(make_boundary(no_medium, 0)));
  const glm::dvec3 fog = glm::exp(-glm::dvec3(extinction));
  expect_mean(render_medium(scene, {{"max-depth", "2"}, {"spp", "64"}}), lit * fog);
  // The fog lies below the pane, down to the floor.
  scene = floor_under_panes({0, -1, 0}, {});
  scene.media.push_back(make_medium(extinction, Color(0.0f)));
  MaterialDescription pane = make_pane(tint, eta);
  pane.is_boundary = true, pane.media = {no_medium, 0};
  scene.add_quad({-50, 1.5f, 50}, {100, 0, 0}, {0, 0, -100}, scene.add_material(pane));
  scene.camera_medium = 0;
  expect_mean(render_medium(scene, {{"max-depth", "2"}, {"spp", "4000"}}),
              lit * glm::exp(-2.5 * glm::dvec3(extinction)));
}

/// A lamp and an environment over a floor and a ball, between them panes of which one has a picture
/// and one is turned.
SceneData pane_room() {
  SceneData scene = floor_under_panes({0.3f, -0.8f, 0.2f}, {2.0f});
  scene.add_sphere({0.8f, 0.6f, -0.4f}, 0.6f, scene.add_material(make_diffuse({0.8f, 0.4f, 0.3f})));
  scene.add_quad({-0.7f, 3, -0.7f}, {1.4f, 0, 0}, {0, 0, 1.4f},
                 scene.add_material(make_diffuse(Color(0.0f), {5.0f, 6.0f, 7.0f})));
  scene.add_quad({-2, 0.2f, 1}, {4, 0, 0.5f}, {0, 2, -1}, 1);
  scene.sky = {Color(0.1f), {0.3f, 0.4f, 0.6f}};
  scene.camera = {{0.5f, 1.5f, 4}, {0, 0.5f, 0}, {0, 1, 0}, 40.0f, 0.0f, 4.0f};
  return scene;
}

// Light that is asked for and light that is met by chance are one.
TEST(Panes, BothWaysToFindLampsAgree) {
  SceneData scene = pane_room();
  scene.delta_lights.clear();
  const Image by_chance =
      render_medium(scene, {{"max-depth", "4"}, {"nee", "off"}, {"spp", "2048"}});
  expect_same_means(render_medium(scene, {{"max-depth", "4"}, {"spp", "256"}, {"seed", "2"}}),
                    by_chance);
  expect_same_means(
      render_medium(scene, {{"max-depth", "4"}, {"spp", "256"}, {"seed", "3"}, {"mis", "balance"}}),
      by_chance);
}

TEST(Panes, AreTheSameInAllModes) {
  const SceneData scene = pane_room();
  const Rendered serial = render_clouds(scene, cloud_options("serial"));
  for (const Settings& more : {Settings{},
                               {{"pool-size", "50"}},
                               {{"stages", "split"}},
                               {{"wave-collisions", "2"}},
                               {{"accel", "cwbvh"}},
                               {{"sampler", "sobol"}}}) {
    Settings of_serial;
    if (!more.empty() && more[0].first == "sampler") of_serial = more;
    const Rendered expected = render_clouds(scene, cloud_options("serial", of_serial));
    for (const char* mode : {"megakernel", "wavefront"}) {
      const Options options = cloud_options(mode, more);
      if (!has_plan(options, scene)) continue;
      SCOPED_TRACE(command_of(options));
      expect_same(render_clouds(scene, options), expected);
    }
  }
}

// A picture tints as the mean of its texels do, whether light passes by chance or a shadow ray.
TEST(Panes, HavePictures) {
  SceneData scene = floor_under_panes({0, -1, 0}, {2.0f});
  scene.texels = {std::byte{255}, std::byte{0}, std::byte{51}, std::byte{255}};
  Texture texture;
  texture.width = texture.height = 1;
  texture.format = TextureFormat::linear8;
  scene.textures.push_back(texture);
  scene.materials[1][&ThinDielectric::passed] = {Color(0.5f), 0};
  expect_mean(
      render_medium(scene, {{"max-depth", "2"}, {"spp", "4"}}),
      3 * 0.5 / pi_double * slab_transmittance(1, double{eta}) * 0.5 * glm::dvec3(1, 0, 0.2));
}

// The pane is what a camera ray meets first, as ever.
TEST(Panes, AreFirstHits) {
  const Options options = image_options(1, 1, 1);
  SceneData scene = floor_under_panes({0, -1, 0}, {0.25f});
  prepare_scene(scene, options);
  using Kind = Traits<Accel::bvh2, Geometry::mixed, Lighting::full, true, true>;
  const Scene view = host_view(scene, 1, 1);
  const ViewThroughMedia seen = look_through_media<Kind>(view, {{0.01f, 1, 0.02f}, {0, -1, 0}}, 0);
  EXPECT_NEAR(seen.hit.t, 0.75f, 1e-6f);
}

// Markov chains know no shadow rays that go through: glass is a surface like others there.
TEST(Panes, AreOrdinaryGlassInMetropolis) {
  SceneData scene = pane_room(), plain = scene;
  plain.materials[1].passes = false;
  const Options options = cloud_options("serial", {{"integrator", "mlt"}});
  expect_same(render_clouds(scene, options), render_clouds(plain, options));
}

TEST(Panes, AreMadeByMitsubasIntegratorsForMedia) {
  for (const auto& [integrator, passes] :
       {std::pair{"volpath", true}, {"volpathmis", true}, {"prbvolpath", true}, {"path", false}}) {
    const SceneData scene =
        load_xml(fmt::format("<integrator type=\"{}\"/><shape type=\"rectangle\">"
                             "<bsdf type=\"thindielectric\"/></shape><shape type=\"rectangle\">"
                             "<bsdf type=\"dielectric\"/></shape>",
                             integrator))
            .scene;
    EXPECT_EQ(scene.materials[0].passes, passes) << integrator;
    EXPECT_FALSE(scene.materials[1].passes) << integrator;
  }
}

}  // namespace
}  // namespace pt
