// A boundary of a medium in the plane of another surface: a path goes on in the medium that is
// there, whichever of the two a ray meets first. Against formulas, and against the same scene with
// a gap or an overlap that rays can see.
#include <gtest/gtest.h>

#include "medium/medium_scenes.h"

namespace pt {
namespace {

const Settings many_samples{{"spp", "1024"}}, directly{{"spp", "256"}, {"max-depth", "2"}};

Mesh box_mesh(const Vec3& low, const Vec3& high, std::uint32_t material) {
  Mesh mesh;
  add_box(mesh, translate(0.5f * (low + high)) * scale(0.5f * (high - low)));
  mesh.material = material;
  return mesh;
}

/// Everything turned about the origin and enlarged: planes that are not along axes.
void turn(SceneData& scene, const Affine& place) {
  for (Mesh& mesh : scene.meshes) {
    if (mesh.group != 0) continue;
    for (Vec3& p : mesh.positions) p = place.point(p);
  }
  for (Instance& instance : scene.instances) instance.to_world = place * instance.to_world;
  for (DeltaLight& light : scene.delta_lights) {
    light.direction = normalize(place.vector(light.direction));
  }
  CameraParameters& camera = scene.camera;
  camera.look_from = place.point(camera.look_from), camera.look_at = place.point(camera.look_at);
  camera.up = place.vector(camera.up);
}

const Affine unturned, turned = rotate({1, 2, 3}, 40.0f),
                       turned_far = translate({30, -20, 50}) * turned;

/// Absorbs alone; seen along -z under a sky of ones.
struct Absorber {
  Vec3 low, high;
  std::uint32_t outside, inside;
};

const Color red(0.9f, 0.3f, 0.1f), blue(0.2f, 0.5f, 1.1f);

SceneData absorbers(const std::vector<Absorber>& boxes, bool from_behind) {
  SceneData scene;
  scene.name = "absorbers";
  scene.media = {make_medium(red, Color(0.0f)), make_medium(blue, Color(0.0f))};
  for (const Absorber& box : boxes) {
    scene.meshes.push_back(
        box_mesh(box.low, box.high, scene.add_material(make_boundary(box.outside, box.inside))));
  }
  scene.sky = {Color(1.0f), Color(1.0f)};
  scene.camera = distant_camera();
  if (from_behind) scene.camera.look_from.z = -40;
  return scene;
}

void expect_everywhere(const SceneData& scene, const Settings& settings,
                       const glm::dvec3& expected) {
  for (const Affine& place : {unturned, turned, turned_far}) {
    SceneData other = scene;
    turn(other, place);
    SCOPED_TRACE(testing::Message() << "camera at " << other.camera.look_from.x);
    expect_mean(render_medium(other, settings), expected, 0.012, 3e-4);
  }
}

// One behind the other, with a face in common.
TEST(TouchingMedia, SideBySideDimByBoth) {
  for (const bool from_behind : {false, true}) {
    SceneData scene = absorbers(
        {{{-1, -1, -1}, {1, 1, 0.25f}, no_medium, 0}, {{-1, -1, 0.25f}, {1, 1, 1}, no_medium, 1}},
        from_behind);
    expect_everywhere(scene, many_samples, beer(red, 1.25) * beer(blue, 0.75));
    std::swap(scene.meshes[0], scene.meshes[1]);
    expect_everywhere(scene, many_samples, beer(red, 1.25) * beer(blue, 0.75));
  }
}

TEST(TouchingMedia, OfOneMeshDimByBoth) {
  SceneData scene = absorbers({{{-1, -1, -1}, {1, 1, 0.25f}, no_medium, 0}}, false);
  Mesh& mesh = scene.meshes[0];
  add_box(mesh, translate({0, 0, 0.625f}) * scale({1, 1, 0.375f}));
  expect_everywhere(scene, many_samples, beer(red, 2));
}

// A box in a larger one, at its front or its back.
TEST(TouchingMedia, WithinEachOtherAreThoseOfTheirBoundaries) {
  for (const bool from_behind : {false, true}) {
    for (const bool in_front : {false, true}) {
      const float low = in_front ? 0.0f : -1.0f;
      SceneData scene = absorbers({{{-1, -1, -1}, {1, 1, 1}, no_medium, 0},
                                   {{-0.5f, -0.5f, low}, {0.5f, 0.5f, low + 1}, 0, 1}},
                                  from_behind);
      expect_everywhere(scene, many_samples, beer(red, 1) * beer(blue, 1));
      std::swap(scene.meshes[0], scene.meshes[1]);
      expect_everywhere(scene, many_samples, beer(red, 1) * beer(blue, 1));
    }
  }
}

TEST(TouchingMedia, WithPrioritiesTheHigherOneIsThere) {
  SceneData scene = absorbers(
      {{{-1, -1, -1}, {1, 1, 1}, no_medium, 0}, {{-1, -1, -1}, {1, 1, 0}, no_medium, 1}}, false);
  scene.media[0].priority = 1, scene.media[1].priority = 2;
  expect_everywhere(scene, many_samples, beer(red, 1) * beer(blue, 1));
  scene.media[0].priority = 3;
  expect_everywhere(scene, many_samples, beer(red, 2));
}

TEST(TouchingMedia, OfSpheresOfOneSizeDim) {
  SceneData scene = absorbers({}, false);
  scene.add_sphere(Vec3(0.0f), 1, scene.add_material(make_boundary(no_medium, 0)));
  scene.add_sphere(Vec3(0.0f), 1, scene.add_material(make_boundary(0, 1)));
  expect_mean(render_medium(scene, many_samples), beer(blue, 2));
}

/// A sun behind the camera, a diffuse plane behind the fog.
SceneData fog_on(float plane_z, bool is_instance, bool is_boundary = false) {
  SceneData scene = absorbers({{{-1, -1, -1}, {1, 1, 1}, no_medium, 0}}, false);
  darken_sky(scene);
  MaterialDescription ground = make_diffuse(Color(0.7f));
  ground.is_boundary = is_boundary, ground.media = {0, no_medium};
  Mesh plane;
  add_rectangle(plane, {-3, -4, plane_z}, {7, 0, 0}, {0, 8, 0});
  plane.material = scene.add_material(ground);
  scene.meshes.push_back(plane);
  if (is_instance) {  // mirrored
    scene.meshes[0] = box_mesh({-3, 0, 2}, {-1, 4, 3}, scene.meshes[0].material);
    scene.meshes[0].group = 1;
    Affine place;
    place.row[0] = {-1, 0, 0, -2}, place.row[1] = {0, 0.5f, 0, -1}, place.row[2] = {0, 0, 2, -5};
    scene.instances.push_back({1, place});
  }
  scene.delta_lights.push_back(sun_along({0, 0, -1}, Color(2.0f)));
  return scene;
}

// The way to the ground and back: 4.
TEST(TouchingMedia, FogOnTheGroundDimsWhatTheGroundReflects) {
  const glm::dvec3 expected = 2 * 0.7 / pi_double * beer(red, 4);
  for (const bool is_instance : {false, true}) {
    SCOPED_TRACE(is_instance);
    expect_everywhere(fog_on(-1, is_instance), directly, expected);
    expect_everywhere(fog_on(-1.0000002f, is_instance), directly, expected);
  }
  SCOPED_TRACE("a boundary");
  expect_everywhere(fog_on(-1, false, true), directly, expected);
}

/// A box of fog under a sky, and a room without a ceiling or a floor alone.
SceneData fog_in_a_corner(float gap, bool is_room, CloudShape shape) {
  SceneData scene = cloud_under_sky(make_medium(Color(1.0f), {0.9f, 0.7f, 0.5f}), shape);
  scene.sky = {Color(0.4f), {0.5f, 0.7f, 1.0f}};
  const std::uint32_t walls = scene.add_material(make_diffuse({0.6f, 0.5f, 0.4f}));
  const float at = -1 - gap;
  scene.add_quad({-4, at, 4}, {8, 0, 0}, {0, 0, -8}, walls);
  if (is_room) {
    scene.add_quad({at, -4, 4}, {0, 0, -8}, {0, 8, 0}, walls);
    scene.add_quad({-4, -4, at}, {8, 0, 0}, {0, 8, 0}, walls);
  }
  scene.camera = {{1.5f, 1.4f, 4.2f}, {0, 0, 0}, {0, 1, 0}, 40.0f, 0.0f, 4.0f};
  return scene;
}

TEST(TouchingMedia, FogInACornerLooksAsWithAGap) {
  for (const bool is_room : {false, true}) {
    for (const CloudShape shape : {CloudShape::quads, CloudShape::mesh_box}) {
      const Image image = render_medium(fog_in_a_corner(0, is_room, shape), {{"spp", "150"}});
      for (const float gap : {0.001f, -0.001f}) {
        SCOPED_TRACE(gap);
        expect_same_means(
            render_medium(fog_in_a_corner(gap, is_room, shape), {{"spp", "150"}, {"seed", "7"}}),
            image);
      }
    }
  }
}

/// A box of coloured water, whose surface refracts, on a floor under a sun and a sky.
SceneData water_on_a_floor(float gap) {
  SceneData scene = fog_in_a_corner(gap, false, CloudShape::mesh_box);
  MaterialDescription water = make_dielectric(Color(1.0f), 1.33f);
  water.is_boundary = true, water.media = {no_medium, 0};
  scene.media[0] = make_medium({0.2f, 0.6f, 1.0f}, Color(0.0f));
  scene.meshes[0].material = scene.add_material(water);
  return scene;
}

// What touches is wet: as if the water went on in the floor.
TEST(TouchingMedia, WaterWetsItsFloor) {
  const Settings settings{{"spp", "250"}, {"max-depth", "40"}};
  const Image touching = render_medium(water_on_a_floor(0), settings);
  expect_same_means(touching, render_medium(water_on_a_floor(-0.001f),
                                            {{"spp", "250"}, {"max-depth", "40"}, {"seed", "5"}}));
}

// What only comes near keeps its bits, as does what touches in an edge.
TEST(TouchingMedia, OthersStayWhereTheyAre) {
  for (const float gap : {0.001f, -0.001f}) {
    SceneData scene = fog_in_a_corner(gap, true, CloudShape::mesh_box);
    const std::vector<Vec3> before = scene.meshes[0].positions;
    prepare_scene(scene, Options());
    EXPECT_EQ(scene.meshes[0].positions, before);
  }
  SceneData thin = absorbers({{{-1, -1, 0}, {1, 1, 1e-6f}, no_medium, 0}}, false);
  const std::vector<Vec3> before = thin.meshes[0].positions;
  prepare_scene(thin, Options());
  EXPECT_EQ(thin.meshes[0].positions, before) << "the two sides of a thin wall";
}

// By less than a ten-thousandth of the scene, and once: what has been moved touches no longer.
TEST(TouchingMedia, MoveByLittleAndOnce) {
  SceneData scene = fog_in_a_corner(0, true, CloudShape::mesh_box);
  const std::vector<Vec3> before = scene.meshes[0].positions;
  prepare_scene(scene, Options());
  const std::vector<Vec3> moved = scene.meshes[0].positions;
  for (std::size_t i = 0; i < before.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      if (before[i][c] > 0) {
        EXPECT_EQ(moved[i][c], before[i][c]);
      } else {
        EXPECT_LT(moved[i][c], -1.0f - 1e-6f);
        EXPECT_GT(moved[i][c], -1.0f - 8e-4f);
      }
    }
  }
  prepare_scene(scene, Options());
  EXPECT_EQ(scene.meshes[0].positions, moved);
}

/// A plane's part about the axis of the view.
Mesh sheet(float z, bool is_upwards, std::uint32_t material, float left = -1) {
  Mesh mesh;
  if (is_upwards) {
    add_rectangle(mesh, {left, -1, z}, {1 - left, 0, 0}, {0, 2, 0});
  } else {
    add_rectangle(mesh, {left, -1, z}, {0, 2, 0}, {1 - left, 0, 0});
  }
  mesh.material = material;
  return mesh;
}

// Behind the red box a blue one begins with a face that says that red is outside.
TEST(TouchingMedia, AFaceNamesWhatIsBehindIt) {
  for (const bool from_behind : {false, true}) {
    SceneData scene = absorbers({{{-1, -1, -1}, {1, 1, 0.25f}, no_medium, 0}}, from_behind);
    scene.meshes.push_back(sheet(0.25f, false, scene.add_material(make_boundary(0, 1))));
    scene.meshes.push_back(sheet(1, true, scene.add_material(make_boundary(no_medium, 1))));
    expect_everywhere(scene, many_samples, beer(red, 1.25) * beer(blue, 0.75));
    std::swap(scene.meshes[0], scene.meshes[1]);
    expect_everywhere(scene, many_samples, beer(red, 1.25) * beer(blue, 0.75));
  }
}

// Two boxes and, beside the view, a board in the plane of their common face: the boxes decide where
// their faces go, whichever of them is listed first.
TEST(TouchingMedia, BoundariesDecideBeforeOtherSurfaces) {
  for (const bool from_behind : {false, true}) {
    for (const int board : {0, 1, 2}) {
      SCOPED_TRACE(board);
      SceneData scene = absorbers(
          {{{-1, -1, -1}, {1, 1, 0.25f}, no_medium, 0}, {{-1, -1, 0.25f}, {1, 1, 1}, no_medium, 1}},
          from_behind);
      scene.meshes.insert(scene.meshes.begin() + board,
                          sheet(0.25f, true, scene.add_material(make_diffuse(Color(0.5f))), 0.3f));
      expect_everywhere(scene, many_samples, beer(red, 1.25) * beer(blue, 0.75));
    }
  }
}

// Two boundaries of a ball, of which the first one's normals point inwards: medium 0 within the
// second, 1 between the two, nothing outside. The first becomes larger, the second smaller.
TEST(TouchingMedia, BallsPartAsTheirNormalsSay) {
  for (const bool is_turned : {true, false}) {
    for (const bool swapped : {false, true}) {
      SceneData scene;
      scene.media = {make_medium(red, Color(0.0f)), make_medium(blue, Color(0.0f))};
      const std::uint32_t outer =
          scene.add_material(is_turned ? make_boundary(1, no_medium) : make_boundary(no_medium, 1));
      const std::uint32_t inner = scene.add_material(make_boundary(1, 0));
      SphereFrame in, out;
      in.side = -1.0f;
      if (swapped) scene.add_sphere(Vec3(0.0f), 2, inner, out);
      scene.add_sphere(Vec3(0.0f), 2, outer, is_turned ? in : out);
      if (!swapped) scene.add_sphere(Vec3(0.0f), 2, inner, out);
      scene.sky = {Color(1.0f), Color(1.0f)};
      scene.camera = distant_camera();
      prepare_scene(scene, Options());
      float radius[2] = {};
      for (std::size_t i = 0; i < 2; ++i)
        radius[scene.sphere_material[i] == inner] = scene.spheres[i].radius();
      EXPECT_GT(radius[0], radius[1]) << is_turned << swapped;
      for (const float r : radius) EXPECT_NEAR(r, 2, 1e-3f);
    }
  }
}

}  // namespace
}  // namespace pt
