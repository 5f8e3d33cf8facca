// Lights together: an environment beside lamps of unequal brightness, lamps that are textured,
// stretched or mirrored. One point of a floor is looked at, by light sampling and without, and
// compared with a sum over directions that knows neither.
#include <functional>

#include "common/scene/prepare/prepare_scene.h"
#include "render_serial.h"
#include "scene/direct_light.h"

namespace pt {
namespace {

const Color floor_albedo(0.8f, 0.5f, 0.3f);

/// The floor, seen from nearby in one point, the origin.
SceneData floor_seen_in_a_point() {
  SceneData scene;
  scene.name = "pair";
  Mesh mesh;
  mesh.positions = {{-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}};
  mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  mesh.material = scene.add_material(make_diffuse(floor_albedo));
  scene.meshes.push_back(mesh);
  scene.camera = {{0.3f, 0.1f, -0.2f}, {0, 0, 0}, {0, 1, 0}, 0.002f, 0.0f, 0.4f};
  return scene;
}

/// Directions of a column have one radiance from pole to pole, so that nothing depends on where a
/// map's first and last row lie.
constexpr int columns = 16;
Color column_radiance(int column) {
  return column == 3 ? Color(6, 3, 1.5f) : Color(0.1f, 0.3f, 0.5f) * (1.0f + 0.1f * column);
}

void add_environment(SceneData& scene, LightsAround& lights) {
  scene.environment.width = columns, scene.environment.height = 8;
  for (int i = 0; i < columns * 8; ++i) {
    scene.environment.pixels.push_back(column_radiance(i % columns));
  }
  lights.environment = [](const glm::dvec3& d) {
    const double x = (0.5 + std::atan2(d.x, -d.z) / (2 * pi_double)) * columns - 0.5;
    const int left = static_cast<int>(std::floor(x));
    const double t = x - left;
    const auto at = [](int i) { return glm::dvec3(column_radiance((i + columns) % columns)); };
    return (1 - t) * at(left) + t * at(left + 1);
  };
}

/// A lamp of one triangle.
void add_lamp(SceneData& scene, LightsAround& lights, const Vec3 (&v)[3], const Color& radiance) {
  Mesh mesh;
  mesh.positions = {v[0], v[1], v[2]};
  mesh.triangles = {{{0, 1, 2}}};
  mesh.material = scene.add_material(make_diffuse(Color(0.0f), radiance));
  scene.meshes.push_back(mesh);
  const glm::dvec3 constant(radiance);
  lights.triangles.push_back({{v[0], v[1], v[2]}, [constant](double, double) { return constant; }});
}

void add_sphere_lamp(SceneData& scene, LightsAround& lights, const Vec3& center, float radius,
                     const Color& radiance) {
  scene.add_sphere(center, radius, scene.add_material(make_diffuse(Color(0.0f), radiance)));
  lights.spheres.push_back({center, radius, radiance});
}

/// The mean over all samples and its standard error, by channel.
struct ChannelMeans {
  MeanEstimate of[3];
};

ChannelMeans sampled(const SceneData& scene, bool nee, int size = 96, int depth = 2) {
  Options options = image_options(size, size, 24, depth);
  options.nee = nee;
  const Image image = render(scene, options).image;
  ChannelMeans means;
  for (std::size_t i = 0; i < image.rgb.size(); ++i) means.of[i % 3].add(image.rgb[i]);
  return means;
}

/// With light sampling and without. `precision`: the standard error that the scene must allow.
void expect_irradiance(SceneData scene, const LightsAround& lights, double precision = 6e-3,
                       int depth = 2) {
  prepare_scene(scene);
  const glm::dvec3 expected = glm::dvec3(floor_albedo) / pi_double * floor_irradiance(lights);
  for (const bool nee : {true, false}) {
    const ChannelMeans means = sampled(scene, nee, 96, depth);
    for (int c = 0; c < 3; ++c) {
      SCOPED_TRACE(testing::Message() << "nee " << nee << ", channel " << c);
      const MeanEstimate& mean = means.of[c];
      // 1e-3: the sum over directions, at the lamps' edges.
      EXPECT_NEAR(mean.mean(), expected[c], 5 * mean.sigma() + 1e-3 * expected[c]);
      EXPECT_LT(mean.sigma(), precision * expected[c]) << "too noisy to tell";
    }
  }
}

const Vec3 wide_lamp[3] = {{-1.5f, 1.0f, -0.2f}, {0.1f, 1.4f, -1.2f}, {-0.1f, 1.2f, 0.9f}};
const Vec3 narrow_lamp[3] = {{0.5f, 0.6f, -0.9f}, {1.3f, 0.9f, -0.2f}, {0.6f, 1.2f, -0.5f}};

TEST(LightPairs, TwoUnequalLamps) {
  SceneData scene = floor_seen_in_a_point();
  LightsAround lights;
  add_lamp(scene, lights, wide_lamp, {1, 2, 0.5f});
  add_lamp(scene, lights, narrow_lamp, {9, 1, 4});
  expect_irradiance(scene, lights, 1e-2);
}

TEST(LightPairs, ALampAndASphere) {
  SceneData scene = floor_seen_in_a_point();
  LightsAround lights;
  add_lamp(scene, lights, wide_lamp, {1, 2, 0.5f});
  add_sphere_lamp(scene, lights, {0.9f, 1.1f, 0.5f}, 0.7f, {2, 1, 5});
  expect_irradiance(scene, lights, 1e-2);
}

TEST(LightPairs, AnEnvironmentAlone) {
  SceneData scene = floor_seen_in_a_point();
  LightsAround lights;
  add_environment(scene, lights);
  expect_irradiance(scene, lights);
}

TEST(LightPairs, AnEnvironmentAndALamp) {
  SceneData scene = floor_seen_in_a_point();
  LightsAround lights;
  add_environment(scene, lights);
  add_lamp(scene, lights, wide_lamp, {3, 4, 1});
  expect_irradiance(scene, lights);
}

TEST(LightPairs, AnEnvironmentTwoLampsAndASphere) {
  SceneData scene = floor_seen_in_a_point();
  LightsAround lights;
  add_environment(scene, lights);
  add_lamp(scene, lights, wide_lamp, {1, 2, 0.5f});
  add_lamp(scene, lights, narrow_lamp, {9, 1, 4});
  add_sphere_lamp(scene, lights, {0.9f, 1.1f, 0.5f}, 0.7f, {2, 1, 5});
  expect_irradiance(scene, lights);
}

// The sky is found by chance alone, and adds to the lamps.
TEST(LightPairs, ASkyAndALamp) {
  SceneData scene = floor_seen_in_a_point();
  LightsAround lights;
  scene.sky = {{0.2f, 0.3f, 0.4f}, {0.5f, 1.0f, 2.0f}};
  lights.environment = [](const glm::dvec3& d) {
    const double t = 0.5 * (d.y + 1);
    return (1 - t) * glm::dvec3(0.2, 0.3, 0.4) + t * glm::dvec3(0.5, 1, 2);
  };
  add_lamp(scene, lights, wide_lamp, {3, 4, 1});
  expect_irradiance(scene, lights);
}

/// Dark and bright stripes across a lamp: whether the texture is asked at all, and at which
/// corner, changes what the floor gets.
constexpr double dark = 0.1, bright = 1.0;

void add_stripes(SceneData& scene, std::uint32_t material) {
  Texture stripes;
  stripes.kind = TextureKind::checkerboard;
  stripes.color0 = Color(static_cast<float>(dark)), stripes.color1 = Color(bright);
  stripes.u_row[0] = 1, stripes.u_row[2] = 0;                        // dark for u <= 1/2
  stripes.v_row[0] = 0, stripes.v_row[1] = 0, stripes.v_row[2] = 0;  // v plays no part
  Texture other = stripes;  // of no material: a lamp must not take the first there is
  other.color0 = other.color1 = Color(0.5f);
  scene.textures.push_back(other);
  scene.textures.push_back(stripes);
  scene.materials[material].emission.texture =
      static_cast<std::uint32_t>(scene.textures.size()) - 1;
}

/// The texture's coordinate u at the corners: 0, 1 and 0.
std::function<glm::dvec3(double, double)> striped(const Color& radiance, int bright_corner) {
  return [=](double b1, double b2) {
    const double u = bright_corner == 1 ? b1 : b2;
    return (u > 0.5 ? bright : dark) * glm::dvec3(radiance);
  };
}

/// The wide lamp with stripes, perhaps as an instance that stretches, turns and mirrors.
void add_striped_lamp(SceneData& scene, LightsAround& lights, const Color& radiance,
                      const Affine* to_world) {
  Mesh mesh;
  mesh.positions = {wide_lamp[0], wide_lamp[1], wide_lamp[2]};
  mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
  mesh.triangles = {{{0, 1, 2}}};
  mesh.material = scene.add_material(make_diffuse(Color(0.0f), radiance));
  add_stripes(scene, mesh.material);
  const bool mirrors = to_world != nullptr && to_world->determinant() < 0.0f;
  LampTriangle lamp;
  for (int k = 0; k < 3; ++k) {
    const Vec3& p = wide_lamp[k];
    // Mirroring turns the side that shines away; it shall stay the side it was.
    lamp.v[mirrors && k > 0 ? 3 - k : k] = to_world ? to_world->point(p) : p;
  }
  lamp.radiance = striped(radiance, mirrors ? 2 : 1);
  lights.triangles.push_back(lamp);
  if (to_world) {
    mesh.group = 1;
    scene.instances.push_back({1, *to_world});
  }
  scene.meshes.push_back(mesh);
}

TEST(LightPairs, ATexturedLamp) {
  SceneData scene = floor_seen_in_a_point();
  LightsAround lights;
  add_striped_lamp(scene, lights, {3, 2, 1}, nullptr);
  expect_irradiance(scene, lights, 1e-2);
}

TEST(LightPairs, ATexturedLampBesideAPlainOne) {
  SceneData scene = floor_seen_in_a_point();
  LightsAround lights;
  add_striped_lamp(scene, lights, {6, 4, 2}, nullptr);
  add_lamp(scene, lights, narrow_lamp, {1, 3, 2});
  expect_irradiance(scene, lights, 1e-2);
}

TEST(LightPairs, ATexturedLampInAnInstanceThatStretches) {
  const Affine stretch = translate({0.2f, 0.3f, 0.1f}) * scale({0.6f, 0.8f, 1.7f});
  SceneData scene = floor_seen_in_a_point();
  LightsAround lights;
  add_striped_lamp(scene, lights, {3, 2, 1}, &stretch);
  add_lamp(scene, lights, narrow_lamp, {1, 3, 2});
  expect_irradiance(scene, lights, 1e-2);
}

TEST(LightPairs, ATexturedLampInAnInstanceThatMirrors) {
  const Affine mirror =
      translate({0.1f, 0.2f, -0.1f}) * rotate({0, 1, 0}, 160) * scale({-1.4f, 1, 0.7f});
  SceneData scene = floor_seen_in_a_point();
  LightsAround lights;
  add_striped_lamp(scene, lights, {3, 2, 1}, &mirror);
  add_environment(scene, lights);
  expect_irradiance(scene, lights);
}

// An occluder that hides a lamp, wherever it is between: shadow rays reach from end to end. The
// lamp is a triangle, placed by an instance, or a sphere.
TEST(LightPairs, LampsAreHiddenByWhatLiesBetween) {
  for (const int kind : {0, 1, 2}) {
    for (const double along : {0.02, 0.3, 0.6, 0.9, 0.97}) {
      SceneData scene = floor_seen_in_a_point();
      LightsAround lights;
      if (kind == 2) {
        add_sphere_lamp(scene, lights, {0.2f, 1.9f, -0.1f}, 0.5f, {1, 2, 3});
      } else {
        add_lamp(scene, lights, wide_lamp, {1, 2, 3});
      }
      if (kind == 1) {
        scene.meshes.back().group = 1;
        scene.instances.push_back({1, translate({0, 0.1f, 0})});
      }
      const auto share = static_cast<float>(along);
      Mesh occluder;  // the sphere's lowest point is at 1.4, the triangles' shape is the lamp's
      for (const Vec3& p : wide_lamp) {
        const Vec3 placed = kind == 1 ? p + Vec3(0, 0.1f, 0) : p;
        occluder.positions.push_back(share * placed);
      }
      if (kind == 2) {
        const float y = 1.4f * share, r = 9 * y;
        occluder.positions = {{-r, y, -r}, {3 * r, y, -r}, {-r, y, 3 * r}};
      }
      occluder.triangles = {{{0, 1, 2}}};
      occluder.material = scene.add_material(make_diffuse(Color(0.0f)));
      scene.camera.look_from = 0.01f * scene.camera.look_from;  // below the occluder
      const Vec3 middle =
          (occluder.positions[0] + occluder.positions[1] + occluder.positions[2]) / 3.0f;
      for (Vec3& p : occluder.positions) p = middle + 1.02f * (p - middle);
      scene.meshes.push_back(occluder);
      prepare_scene(scene);
      for (const bool nee : {true, false}) {
        const ChannelMeans means = sampled(scene, nee, 16);
        EXPECT_EQ(means.of[0].mean(), 0) << "kind " << kind << " at " << along << ", nee " << nee;
      }
    }
  }
}

// A sphere in front of a lamp of triangles, in the half of the way that is nearer to the lamp.
TEST(LightPairs, LampsAreHiddenBySpheres) {
  SceneData scene = floor_seen_in_a_point();
  LightsAround lights;
  add_lamp(scene, lights, {{-0.1f, 2, -0.1f}, {0.1f, 2, -0.1f}, {0, 2, 0.1f}}, {1, 2, 3});
  scene.add_sphere({0, 1.5f, 0}, 0.4f, scene.add_material(make_diffuse(Color(0.0f))));
  scene.camera.look_from = 0.01f * scene.camera.look_from;
  prepare_scene(scene);
  for (const bool nee : {true, false}) {
    EXPECT_EQ(sampled(scene, nee, 16).of[1].mean(), 0) << "nee " << nee;
  }
}

// A lamp and its image in a large mirror: no light sampling finds the image, whose light counts in
// full although the bounce before the mirror could be sampled.
TEST(LightPairs, AMirrorShowsALamp) {
  SceneData scene = floor_seen_in_a_point();
  LightsAround lights;
  add_lamp(scene, lights, wide_lamp, {1, 2, 0.5f});
  Mesh mirror;  // the plane x = -2
  mirror.positions = {{-2, -90, -90}, {-2, 90, -90}, {-2, 90, 90}, {-2, -90, 90}};
  mirror.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  mirror.material = scene.add_material(make_metal(Color(1.0f), 0.0f));
  scene.meshes.push_back(mirror);
  LampTriangle image = lights.triangles[0];
  for (glm::dvec3& p : image.v) p.x = -4 - p.x;
  std::swap(image.v[1], image.v[2]);
  lights.triangles.push_back(image);
  expect_irradiance(scene, lights, 2e-2, 3);
}

}  // namespace
}  // namespace pt
