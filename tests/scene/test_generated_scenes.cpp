// Generated scenes: their names, their sizes, that their surfaces are closed, and that they are the
// same every time.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cstring>
#include <limits>
#include <map>

#include "common/geometry/triangle.h"
#include "common/scene/builtin/builtin_scenes.h"
#include "common/scene/builtin/generated_scenes.h"
#include "common/scene/builtin/noise.h"
#include "common/scene/builtin/shapes.h"
#include "scene/small_scenes.h"
#include "statistics.h"
#include "temp_folder.h"

namespace pt {
namespace {

using Vec3d = glm::dvec3;

std::array<Vec3d, 3> corners(const Mesh& mesh, const TriangleIndices& t) {
  return {Vec3d(mesh.positions[t.v[0]]), Vec3d(mesh.positions[t.v[1]]),
          Vec3d(mesh.positions[t.v[2]])};
}

Vec3d normal(const Mesh& mesh, const TriangleIndices& t) {
  const auto [a, b, c] = corners(mesh, t);
  return glm::cross(b - a, c - a);
}

/// Positive where the triangles of a closed mesh point outward.
double volume(const Mesh& mesh) {
  double sum = 0;
  for (const TriangleIndices& t : mesh.triangles)
    sum += glm::dot(corners(mesh, t)[0], normal(mesh, t));
  return sum / 6;
}

/// Edges that lack their opposite; none may occur twice.
std::size_t open_edges(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const TriangleIndices& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) ++edges[{t.v[i], t.v[(i + 1) % 3]}];
  }
  std::size_t open = 0;
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1) << "edge " << edge.first << " " << edge.second;
    open += !edges.contains({edge.second, edge.first});
  }
  return open;
}

/// Distance to the nearest triangle of the world's meshes in this direction; infinite: none.
float trace(const SceneData& scene, const Vec3& origin, const Vec3& direction) {
  const TriangleRay ray = make_triangle_ray(origin, direction);
  float nearest = HUGE_VALF;
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.group != 0) continue;
    for (const TriangleIndices& t : mesh.triangles) {
      const TriangleHit hit = intersect_triangle(ray, mesh.positions[t.v[0]],
                                                 mesh.positions[t.v[1]], mesh.positions[t.v[2]]);
      if (hit.t > 0 && hit.t < nearest) nearest = hit.t;
    }
  }
  return nearest;
}

std::vector<float> view_distances(const SceneData& scene, int width, int height) {
  const Camera camera = make_camera(scene.camera, width, height);
  std::vector<float> distances;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Ray ray = camera_ray(camera, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f,
                                 0.5f, 0.5f);
      distances.push_back(trace(scene, ray.origin, ray.direction));
    }
  }
  return distances;
}

std::uint64_t count_of(const std::string& text, std::uint64_t least = 0) {
  return parse_count(parse_scene_name(text), 77, least, 1'000'000'000'000);
}

TEST(SceneName, Counts) {
  EXPECT_EQ(count_of("terrain"), 77u);
  EXPECT_EQ(count_of("terrain:12"), 12u);
  EXPECT_EQ(count_of("terrain:10M"), 10'000'000u);
  EXPECT_EQ(count_of("terrain:2k"), 2'000u);
  EXPECT_EQ(count_of("terrain:2.5M"), 2'500'000u);
  EXPECT_EQ(count_of("terrain:2.3M"), 2'300'000u);
  EXPECT_EQ(count_of("terrain:.5K"), 500u);
  EXPECT_EQ(count_of("terrain:100G"), 100'000'000'000u);
  EXPECT_EQ(count_of("terrain:1e6"), 1'000'000u);
  EXPECT_EQ(count_of("terrain:123456789"), 123'456'789u);
  for (const char* bad : {"x:M", "x:1.5", "x:-3", "x:+3", "x:10MM", "x:10 M", "x:inf", "x:nan",
                          "x:0x10", "x:1e99", "x:10T", "x:3:4", "x:1.0005K"}) {
    expect_error([&] { count_of(bad); }, std::string("--scene ") + bad);
    expect_error([&] { count_of(bad); }, "expected x:N");
  }
  expect_error([] { count_of("terrain:"); }, "--scene terrain:: expected a parameter");
  expect_error([] { count_of("terrain:1", 2); }, "from 2 to");
}

TEST(SceneName, Scales) {
  const auto scale_of = [](const std::string& text) { return parse_scale(parse_scene_name(text)); };
  EXPECT_EQ(scale_of("boxes"), 1.0);
  EXPECT_EQ(scale_of("boxes:1e-3"), 1e-3);
  EXPECT_EQ(scale_of("boxes:1e5"), 1e5);
  EXPECT_EQ(scale_of("boxes:2.5"), 2.5);
  for (const char* bad : {"boxes:0", "boxes:-1", "boxes:1e7", "boxes:1e-7", "boxes:inf", "boxes:x"})
    expect_error([&] { scale_of(bad); }, "expected boxes:SCALE");
}

TEST(GeneratedScenes, ErrorsOfNames) {
  expect_error([] { build_scene("cornell:3"); },
               "--scene cornell:3: scene 'cornell' takes no parameter");
  expect_error([] { build_scene("mountain:3"); }, "--scene mountain:3: no such scene");
  expect_error([] { build_scene("terrain:1"); }, "--scene terrain:1: expected terrain:N");
  expect_error([] { build_scene("terrain:3G"); }, "from 2 to 2147483647");
  expect_error([] { build_scene("statue:99"); }, "from 100 to");
  expect_error([] { build_scene("instances:0"); }, "from 1 to 100000000");
  expect_error([] { generate_terrain(1); }, "terrain of 1 triangles");
  expect_error([] { generate_terrain(std::uint64_t{1} << 31); }, "terrain of 2147483648");
  expect_error([] { generate_knot(99); }, "statue of 99 triangles");
  expect_error([] { make_forest_scene(0); }, "forest of 0 instances");
}

TEST(GeneratedScenes, HaveWhatTheirDataRefersTo) {
  for (const SceneInfo& info : scene_list()) {
    if (info.parameter.empty()) continue;
    SCOPED_TRACE(info.name);
    const SceneData scene = build_scene(small_scene(info));
    EXPECT_EQ(scene.name, small_scene(info));
    EXPECT_FALSE(scene.meshes.empty() && scene.grids.empty());
    std::uint32_t groups = 0;
    for (const Mesh& mesh : scene.meshes) {
      EXPECT_LT(mesh.material, scene.materials.size());
      EXPECT_TRUE(mesh.normals.empty() && mesh.uvs.empty());
      EXPECT_FALSE(mesh.triangles.empty());
      groups = std::max(groups, mesh.group);
      for (const Vec3& p : mesh.positions)
        ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
      for (const TriangleIndices& t : mesh.triangles) {
        for (const std::uint32_t v : t.v) ASSERT_LT(v, mesh.positions.size());
        ASSERT_GT(glm::length(normal(mesh, t)), 0.0) << "a triangle without area";
      }
    }
    for (const Instance& instance : scene.instances) {
      ASSERT_TRUE(instance.group >= 1 && instance.group <= groups);
      ASSERT_GT(instance.to_world.determinant(), 0.0f);
    }
    for (const MaterialDescription& m : scene.materials) {
      for (int c = 0; c < 3; ++c) EXPECT_TRUE(m.color(0)[c] >= 0 && m.color(0)[c] < 1);
    }
  }
}

TEST(GeneratedScenes, AreTheSameForAnyNumberOfThreads) {
  const auto same = [](const auto& a, const auto& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
  };
  for (const SceneInfo& info : scene_list()) {
    if (info.parameter.empty()) continue;
    SCOPED_TRACE(info.name);
    const auto with_threads = [&](int threads) {
      return tbb::task_arena(threads).execute([&] { return build_scene(small_scene(info)); });
    };
    const SceneData one = with_threads(1), many = with_threads(2);
    ASSERT_EQ(one.meshes.size(), many.meshes.size());
    for (std::size_t i = 0; i < one.meshes.size(); ++i) {
      EXPECT_TRUE(same(one.meshes[i].positions, many.meshes[i].positions));
      EXPECT_TRUE(same(one.meshes[i].triangles, many.meshes[i].triangles));
    }
    ASSERT_EQ(one.instances.size(), many.instances.size());
    for (std::size_t i = 0; i < one.instances.size(); ++i) {
      ASSERT_EQ(one.instances[i].group, many.instances[i].group);
      ASSERT_EQ(
          0, std::memcmp(&one.instances[i].to_world, &many.instances[i].to_world, sizeof(Affine)));
    }
  }
}

TEST(Noise, IsSmoothZeroOnItsLatticeAndBounded) {
  TestRandom random;
  MeanEstimate mean;
  for (int i = 0; i < 100'000; ++i) {
    const Vec3d p{random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-50, 50)};
    const double value = gradient_noise<3>(p, 1);
    ASSERT_LE(std::abs(value), 1.5);
    mean.add(value);
    const Vec3d near = p + 1e-6 * random.direction();
    ASSERT_NEAR(gradient_noise<3>(near, 1), value, 1e-5);
    ASSERT_EQ(gradient_noise<3>(glm::floor(p), 1), 0.0);
    ASSERT_LE(std::abs(gradient_noise<2>({p.x, p.y}, 1)), 1.0);
    const double ridges = ridged_multifractal<3>(p, 8, 1);
    ASSERT_TRUE(ridges >= 0 && ridges < 2);
  }
  EXPECT_NEAR(mean.mean(), 0, 5 * mean.sigma());
}

TEST(Noise, OctavesAreThoseThatAGridCanShow) {
  EXPECT_EQ(resolved_octaves(10), 1);
  EXPECT_EQ(resolved_octaves(0.25), 1);  // the second octave's lattice has edges of 0.49
  EXPECT_EQ(resolved_octaves(0.24), 2);
  EXPECT_EQ(resolved_octaves(1e-12), 16);
}

TEST(Terrain, IsTheLargestSquareGridThatFits) {
  for (std::uint64_t count = 2; count < 2000; ++count) {
    const std::uint64_t triangles = generate_terrain(count).triangles.size();
    std::uint64_t n = 1;
    while (2 * (n + 1) * (n + 1) <= count) ++n;
    ASSERT_EQ(triangles, 2 * n * n) << count;
  }
  EXPECT_EQ(generate_terrain(1'000'000).triangles.size(), 999'698u);
}

TEST(Terrain, IsOneSurfaceThatFacesUp) {
  const Mesh mesh = generate_terrain(20'000);
  EXPECT_EQ(mesh.triangles.size(), 20'000u);
  EXPECT_EQ(open_edges(mesh), 400u) << "its border and nothing else";
  double area = 0, least = 1e9, most = -1e9;
  for (const TriangleIndices& t : mesh.triangles) {
    ASSERT_GT(normal(mesh, t).y, 0);
    area += normal(mesh, t).y / 2;
  }
  for (const Vec3& p : mesh.positions) {
    least = std::min(least, double{p.y}), most = std::max(most, double{p.y});
    ASSERT_LE(std::max(std::abs(p.x), std::abs(p.z)), 500.0f);
  }
  EXPECT_NEAR(area, terrain_extent * terrain_extent, 1) << "seen from above";
  EXPECT_GE(least, 0);
  EXPECT_LE(most, terrain_height);
  EXPECT_GE(most - least, 0.6 * terrain_height) << "mountains";
}

TEST(Terrain, KeepsItsShapeAtAnySize) {
  const Mesh coarse = generate_terrain(2 * 64 * 64), fine = generate_terrain(2 * 256 * 256);
  MeanEstimate difference;
  for (std::size_t row = 0; row <= 64; ++row) {
    for (std::size_t i = 0; i <= 64; ++i) {
      const Vec3 a = coarse.positions[row * 65 + i], b = fine.positions[4 * row * 257 + 4 * i];
      ASSERT_EQ(a.x, b.x);
      ASSERT_EQ(a.z, b.z);
      difference.add(std::abs(a.y - b.y));
    }
  }
  EXPECT_LE(difference.mean(), 0.05 * terrain_height);
}

TEST(Terrain, FillsTheView) {
  const SceneData scene = make_terrain_scene(20'000);
  std::size_t hits = 0;
  const std::vector<float> distances = view_distances(scene, 24, 16);
  for (const float d : distances) {
    hits += d < HUGE_VALF;
    EXPECT_GT(d, 20.0f) << "the camera is too close to the ground";
  }
  EXPECT_GE(static_cast<double>(hits), 0.6 * static_cast<double>(distances.size()));
  EXPECT_LT(hits, distances.size()) << "and some sky";
}

TEST(Statue, IsAClosedTubeOfTheRightSize) {
  for (const std::uint64_t count : {100u, 2'000u, 30'000u}) {
    SCOPED_TRACE(count);
    const Mesh mesh = generate_knot(count);
    EXPECT_LE(mesh.triangles.size(), count);
    const auto around = std::max(3.0, std::floor(std::sqrt(static_cast<double>(count) / 24)));
    EXPECT_GT(static_cast<double>(mesh.triangles.size()), static_cast<double>(count) - 2 * around);
    EXPECT_EQ(open_edges(mesh), 0u);
    // Euler's characteristic of a torus; each of the 3 F / 2 edges is shared by two triangles.
    EXPECT_EQ(2 * mesh.positions.size(), mesh.triangles.size());
    for (const Vec3& p : mesh.positions) ASSERT_LE(glm::length(p), 1.0f);
    EXPECT_GT(volume(mesh), 0);
  }
  EXPECT_GE(generate_knot(1'000'000).triangles.size(), 999'000u);
}

TEST(Statue, HasTheVolumeOfItsTubeLessTheCarving) {
  double length = 0;  // of the knot's axis, (0.56 + 0.24 cos 3t) e(2t) + 0.24 sin 3t
  const auto axis = [](double t) {
    const double w = 0.56 + 0.24 * std::cos(3 * t);
    return Vec3d(w * std::cos(2 * t), 0.24 * std::sin(3 * t), w * std::sin(2 * t));
  };
  for (int i = 0; i < 10'000; ++i)
    length += glm::length(axis(2 * pi_double * (i + 1) / 1e4) - axis(2 * pi_double * i / 1e4));
  const auto tube = [&](double radius) { return pi_double * radius * radius * length; };
  const double v = volume(generate_knot(100'000));
  EXPECT_LT(v, tube(0.19));
  EXPECT_GT(v, tube(0.19 - 0.05));
}

TEST(Statue, IsLitByALampThatFacesItAndSeenByTheCamera) {
  const SceneData scene = make_statue_scene(2'000);
  const Mesh& lamp = scene.meshes.back();
  ASSERT_EQ(lamp.triangles.size(), 2u);
  EXPECT_FALSE(is_black(scene.materials[lamp.material].emission.radiance));
  for (const TriangleIndices& t : lamp.triangles) {
    const Vec3d to_knot = glm::normalize(-corners(lamp, t)[0]);
    EXPECT_GT(glm::dot(glm::normalize(normal(lamp, t)), to_knot), 0.7);
  }
  const Mesh& floor = scene.meshes[1];
  for (const TriangleIndices& t : floor.triangles) EXPECT_GT(normal(floor, t).y, 0);
  for (const Vec3& p : scene.meshes[0].positions) EXPECT_GT(p.y, floor.positions[0].y);
  EXPECT_LT(trace(scene, scene.camera.look_from,
                  glm::normalize(Vec3(0.7f, 0, 0) - scene.camera.look_from)),
            4.0f);
}

TEST(Shapes, ABoxIsClosedAndFacesOutOrIn) {
  const Affine place = translate({3, 2, 1}) * rotate({1, 2, 3}, 50) * scale({1, 2, 3});
  for (const bool inward : {false, true}) {
    Mesh mesh;
    add_box(mesh, place, inward);
    EXPECT_EQ(mesh.triangles.size(), 12u);
    EXPECT_EQ(open_edges(mesh), 0u);
    EXPECT_NEAR(volume(mesh), inward ? -48 : 48, 1e-4);
  }
}

TEST(Shapes, ACornetFacesOutward) {
  const ProfilePoint profile[] = {{0, -1}, {2, 0}, {1, 3}, {0, 4}};
  Mesh mesh;
  add_revolution(mesh, {5, 6, 7}, profile, 200);
  EXPECT_EQ(mesh.triangles.size(), 4u * 200u);
  for (Vec3& p : mesh.positions) p -= Vec3(5, 6, 7);
  // Cones of height 1, a frustum of height 3.
  EXPECT_NEAR(volume(mesh), pi_double * (4.0 / 3 + 3 * (4 + 2 + 1) / 3.0 + 1.0 / 3), 0.02);
}

TEST(Boxes, AreInARoomWithoutGapsAtAnyScale) {
  const SceneData unit = make_boxes_scene(1);
  std::size_t triangles = 0;
  for (const Mesh& mesh : unit.meshes) triangles += mesh.triangles.size();
  EXPECT_EQ(triangles, 6158u);
  for (std::size_t i = 0; i + 1 < unit.meshes.size(); ++i)
    EXPECT_EQ(open_edges(unit.meshes[i]), 0u);
  for (const double factor : {1e-3, 1.0, 1e5}) {
    SCOPED_TRACE(factor);
    const SceneData scene = make_boxes_scene(factor);
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
      for (std::size_t v = 0; v < scene.meshes[i].positions.size(); ++v) {
        const Vec3d p = factor * Vec3d(unit.meshes[i].positions[v]);
        ASSERT_EQ(scene.meshes[i].positions[v], Vec3(p));
        ASSERT_LE(std::max(std::abs(p.x), std::abs(p.z)), 10.0 * factor);
        ASSERT_TRUE(p.y >= -1e-6 * factor && p.y <= 10.0 * factor);
      }
    }
    TestRandom random(6);
    for (int i = 0; i < 1000; ++i) {
      const float d = trace(scene, scene.camera.look_from, Vec3(random.direction()));
      ASSERT_LT(d, 30 * factor) << "a leak";
      ASSERT_GT(d, 0.1 * factor) << "the camera is in a wall";
    }
  }
}

TEST(Boxes, TheLampShinesDown) {
  const SceneData scene = make_boxes_scene(1);
  const Mesh& lamp = scene.meshes.back();
  EXPECT_FALSE(is_black(scene.materials[lamp.material].emission.radiance));
  for (const TriangleIndices& t : lamp.triangles) EXPECT_LT(normal(lamp, t).y, 0);
}

TEST(Forest, TreesAreOfASensibleSize) {
  std::map<std::uint32_t, std::size_t> triangles;
  for (const Mesh& mesh : generate_trees()) {
    triangles[mesh.group] += mesh.triangles.size();
    for (const Vec3& p : mesh.positions) {
      EXPECT_TRUE(p.y > -0.06f && p.y < 1.2f);
      EXPECT_LT(std::max(std::abs(p.x), std::abs(p.z)), 0.6f);
    }
  }
  ASSERT_EQ(triangles.size(), 4u);
  for (const auto& [group, count] : triangles) EXPECT_TRUE(count >= 2'000 && count <= 20'000);
}

TEST(Forest, EveryTreeStandsOnTheGround) {
  for (const std::uint64_t count : {1u, 50u, 3'000u}) {
    SCOPED_TRACE(count);
    const SceneData scene = make_forest_scene(count);
    ASSERT_EQ(scene.instances.size(), count);
    const std::size_t step = 1 + count / 200;
    std::vector<bool> seen(5);
    for (std::size_t i = 0; i < count; ++i) {
      seen[scene.instances[i].group] = true;
      if (i % step != 0) continue;
      const Vec3 root = scene.instances[i].to_world.translation();
      const float above = trace(scene, root + Vec3(0, 5, 0), {0, -1, 0}) - 5;
      EXPECT_TRUE(above < 0.05f && above > -0.15f) << "tree " << i << " " << above;
    }
    if (count >= 50) {
      EXPECT_EQ(seen, std::vector<bool>({false, true, true, true, true}));
    }
  }
}

TEST(Forest, SomeTreesSwayAboutTheirFeet) {
  EXPECT_FALSE(make_forest_scene(50, 0.0f).moves());
  EXPECT_EQ(make_forest_scene(50, 100.0f).motion.instances.size(), 50u);
  const SceneData scene = make_forest_scene(2'000, 25.0f);
  EXPECT_NEAR(static_cast<double>(scene.motion.instances.size()), 500.0, 5.0);
  float least = 90.0f, most = 0.0f;
  for (const auto& [instance, keys] : scene.motion.instances) {
    ASSERT_EQ(keys.size(), 2u);
    EXPECT_EQ(keys[0].time, scene.motion.shutter.open);
    EXPECT_EQ(keys[1].time, scene.motion.shutter.close);
    EXPECT_TRUE(keys[0].to_world == scene.instances[instance].to_world);
    const Affine &from = keys[0].to_world, &to = keys[1].to_world;
    EXPECT_NEAR(glm::length(to.translation() - from.translation()), 0.0f, 1e-3f);
    const Vec3 up(from.vector({0, 1, 0})), tilted(to.vector({0, 1, 0}));
    EXPECT_NEAR(glm::length(tilted), glm::length(up), 1e-4f);
    EXPECT_GT(tilted.x, up.x);
    const float turn = std::atan2(tilted.x, tilted.y) - std::atan2(up.x, up.y);
    least = std::min(least, glm::degrees(turn)), most = std::max(most, glm::degrees(turn));
  }
  EXPECT_TRUE(least > 1.99f && least < 2.5f) << least;
  EXPECT_TRUE(most > 11.5f && most < 12.01f) << most;
}

TEST(Forest, IsReadFromItsName) {
  const auto parse = [](const char* text) { return parse_forest(parse_scene_name(text)); };
  EXPECT_EQ(parse("instances").trees, 10'000u);
  EXPECT_EQ(parse("instances:2K").trees, 2'000u);
  EXPECT_EQ(parse("instances:2K").percent, 0.0f);
  EXPECT_EQ(parse("instances:50:12.5").trees, 50u);
  EXPECT_EQ(parse("instances:50:12.5").percent, 12.5f);
  for (const char* text :
       {"instances:50:101", "instances:50:-1", "instances:50:", "instances:50:1:2"})
    expect_error([&] { parse(text); }, "expected 0 to 100 percent of the trees in instances:N:P");
  expect_error([&] { parse("instances:0:5"); }, "a whole number N from 1 to 100000000");
}

TEST(Forest, TransformsAreOfEveryKind) {
  const SceneData scene = make_forest_scene(200);
  MeanEstimate shear, stretch;
  for (const Instance& instance : scene.instances) {
    const Vec3d x(instance.to_world.vector({1, 0, 0})), y(instance.to_world.vector({0, 1, 0}));
    const Vec3d z(instance.to_world.vector({0, 0, 1}));
    shear.add(std::abs(glm::dot(glm::normalize(x), glm::normalize(y))));
    stretch.add(std::abs(std::log(glm::length(x) / glm::length(z))));
    EXPECT_TRUE(y.y >= 3 && y.y <= 5);
  }
  EXPECT_GT(shear.mean(), 0.02);
  EXPECT_GT(stretch.mean(), 0.05);
}

TEST(Forest, IsInView) {
  for (const std::uint64_t count : {1u, 100u, 10'000u}) {
    SCOPED_TRACE(count);
    const SceneData scene = make_forest_scene(count);
    const Camera camera = make_camera(scene.camera, 200, 100);
    const Vec3d forward = glm::normalize(Vec3d(scene.camera.look_at - scene.camera.look_from));
    int visible = 0;
    for (const Instance& instance : scene.instances) {
      const Vec3d to_tree =
          Vec3d(instance.to_world.point({0, 0.5f, 0})) - Vec3d(scene.camera.look_from);
      const Vec3d on_plane =
          to_tree * (double{scene.camera.focus_distance} / glm::dot(to_tree, forward)) -
          Vec3d(camera.corner);
      const double px = glm::dot(on_plane, Vec3d(camera.step_x)) /
                        glm::dot(Vec3d(camera.step_x), Vec3d(camera.step_x));
      const double py = glm::dot(on_plane, Vec3d(camera.step_y)) /
                        glm::dot(Vec3d(camera.step_y), Vec3d(camera.step_y));
      visible += glm::dot(to_tree, forward) > 0 && px > 0 && px < 200 && py > 0 && py < 100;
    }
    EXPECT_GE(visible, 0.5 * static_cast<double>(count));
    const float y = trace(scene, scene.camera.look_from, {0, -1, 0});
    EXPECT_TRUE(y == HUGE_VALF || y > 2) << "the camera is above the ground";
  }
}

}  // namespace
}  // namespace pt
