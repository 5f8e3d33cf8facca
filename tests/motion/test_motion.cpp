// Motion blur: times of paths, interpolated poses, boxes of motions, and what is refused.
#include <gtest/gtest.h>

#include <functional>
#include <numeric>

#include "accel/tree_kinds.h"
#include "app/render/make_renderer.h"
#include "common/error/error.h"
#include "common/scene/prepare/prepare_steps.h"
#include "common/transport/shutter_time.h"
#include "scene/deforming_triangles.h"
#include "statistics.h"
#include "temp_folder.h"

namespace pt {
namespace {

using DVec3 = glm::dvec3;
using DMat3 = glm::dmat3;

// Times.

TEST(ShutterTime, HasAStratumForEachSampleOfAPixel) {
  for (const std::uint32_t samples : {1u, 7u, 16u}) {
    for (std::uint32_t pixel = 0; pixel < 50; ++pixel) {
      for (std::uint32_t round = 0; round < 3; ++round) {
        std::vector<int> strata(samples);
        for (std::uint32_t i = 0; i < samples; ++i) {
          const float t =
              shutter_time({SamplerKind::stratified, samples}, 5, {pixel, round * samples + i, 0});
          ASSERT_TRUE(t >= 0.0f && t < 1.0f);
          ++strata[cell_of(double{t}, static_cast<int>(samples))];
        }
        EXPECT_EQ(strata, std::vector<int>(samples, 1));
      }
    }
  }
}

TEST(ShutterTime, OfSobolSamplesIsANet) {
  for (std::uint32_t pixel = 0; pixel < 50; ++pixel) {
    for (std::uint32_t first = 0; first < 64; first += 16) {
      std::vector<int> strata(16);
      for (std::uint32_t i = 0; i < 16; ++i)
        ++strata[cell_of(double{shutter_time({SamplerKind::sobol, 64}, 9, {pixel, first + i, 0})},
                         16)];
      EXPECT_EQ(strata, std::vector<int>(16, 1));
    }
  }
}

TEST(ShutterTime, IsUniformAndIndependentOfPixelAndSample) {
  for (const SamplerKind sampler :
       {SamplerKind::independent, SamplerKind::stratified, SamplerKind::sobol}) {
    // The first sample of each pixel beside that of its neighbour.
    std::vector<double> pairs(64), seeds(16);
    for (std::uint32_t pixel = 0; pixel < 20000; ++pixel) {
      const auto cell = [&](std::uint32_t p, std::uint32_t seed, int cells) {
        return cell_of(double{shutter_time({sampler, 4}, seed, {p, 0, 0})}, cells);
      };
      ++pairs[8 * cell(2 * pixel, 1, 8) + cell(2 * pixel + 1, 1, 8)];
      ++seeds[cell(77, pixel, 16)];
    }
    expect_uniform(pairs, 20000, "pairs of neighbours");
    expect_uniform(seeds, 20000, "seeds");
  }
}

// Poses.

/// By Rodrigues' formula.
DMat3 turn(const DVec3& axis, double angle) {
  const DVec3 k = glm::normalize(axis);
  const DMat3 cross(0, k.z, -k.y, -k.z, 0, k.x, k.y, -k.x, 0);  // by columns
  return DMat3(1.0) + std::sin(angle) * cross + (1 - std::cos(angle)) * cross * cross;
}

DMat3 positive_matrix(TestRandom& random) {
  const DMat3 axes = turn(random.direction(), random.uniform(0, 6));
  DMat3 sizes(0.0);
  for (int i = 0; i < 3; ++i) sizes[i][i] = random.uniform(0.2, 3);
  return axes * sizes * glm::transpose(axes);
}

Affine to_affine(const DMat3& linear, const DVec3& translation) {
  Affine a;
  for (int i = 0; i < 3; ++i)
    a.row[i] = Vec4(glm::dvec4(linear[0][i], linear[1][i], linear[2][i], translation[i]));
  return a;
}

/// A random motion, and what it is in double precision by another way: rotations about an axis.
struct KnownMotion {
  DMat3 rotation, from_stretch, to_stretch;
  DVec3 axis, from, to;
  double angle, sign;

  explicit KnownMotion(TestRandom& random)
      : rotation(turn(random.direction(), random.uniform(0, 3))),
        from_stretch(positive_matrix(random)),
        to_stretch(positive_matrix(random)),
        axis(random.direction()),
        from(random.point(5)),
        to(random.point(5)),
        angle(random.uniform(0, 3.1)),
        sign(random.unit() < 0.3f ? -1 : 1) {}

  Affine at(double u) const {
    return to_affine(
        sign * rotation * turn(axis, u * angle) * (from_stretch + u * (to_stretch - from_stretch)),
        from + u * (to - from));
  }
};

/// A group of one triangle mesh that is moved by these keys.
SceneData moving_scene(std::vector<TransformKey> keys) {
  SceneData scene;
  scene.name = "moving";
  scene.add_material(make_diffuse(Color(0.5f)));
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0.3f}, {-1, 1, -0.3f}};
  mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  mesh.group = 1;
  scene.meshes = {mesh};
  scene.instances = {{1, keys.front().to_world}};
  scene.motion.instances = {{0, std::move(keys)}};
  return scene;
}

double largest_difference(const Affine& a, const Affine& b) {
  double most = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) most = std::max(most, std::abs(double{a.row[i][j] - b.row[i][j]}));
  return most;
}

TEST(Motion, InterpolatesDecomposedTransformations) {
  TestRandom random(3);
  for (int i = 0; i < 300; ++i) {
    const KnownMotion known(random);
    SceneData scene = moving_scene({{2.0f, known.at(0)}, {4.0f, known.at(1)}});
    scene.motion.shutter = {1.0f, 5.0f};
    prepare_motion(scene);
    const Motion& motion = scene.motion.prepared->view;
    for (int k = 0; k <= 16; ++k) {
      const double seconds = 1 + 4.0 * k / 16, u = std::clamp((seconds - 2) / 2, 0.0, 1.0);
      EXPECT_LT(largest_difference(motion.to_world(0, static_cast<float>(k) / 16), known.at(u)),
                2e-5)
          << i << " at " << u;
    }
  }
}

TEST(Motion, GoesThroughAllKeysAndHoldsOutside) {
  TestRandom random(4);
  std::vector<TransformKey> keys;
  for (const float time : {-1.0f, 0.25f, 0.5f, 0.75f})
    keys.push_back({time, KnownMotion(random).at(0)});
  // Keys of one motion all mirror or none.
  for (TransformKey& key : keys)
    if (key.to_world.determinant() < 0)
      for (Vec4& row : key.to_world.row) row = Vec4(-Vec3(row), row.w);
  SceneData scene = moving_scene(keys);
  prepare_motion(scene);
  const Motion& motion = scene.motion.prepared->view;
  for (std::size_t i = 1; i < keys.size(); ++i)
    EXPECT_LT(largest_difference(motion.to_world(0, keys[i].time), keys[i].to_world), 2e-5);
  EXPECT_LT(largest_difference(motion.to_world(0, 0.99f), keys[3].to_world), 2e-5);
  EXPECT_GT(largest_difference(motion.to_world(0, 0.0f), keys[0].to_world), 1e-2);
}

// Boxes and traversal.

TEST(Motion, BoxesHoldAllThatMovesAndLittleMore) {
  TestRandom random(6);
  for (int i = 0; i < 200; ++i) {
    const KnownMotion known(random);
    SceneData scene = moving_scene({{0.0f, known.at(0)}, {1.0f, known.at(1)}});
    prepare_motion(scene);
    TreeOptions options;
    options.accel = AccelKind::bvh2;
    const TriangleTreeData tree =
        build_triangle_tree(scene.meshes, scene.instances, options, scene.motion.tracks());
    const Bounds box = tree.instances.at(0).bounds;
    Bounds seen;
    for (int k = 0; k <= 500; ++k) {
      const Affine pose = known.at(k / 500.0);
      for (int c = 0; c < 8; ++c)
        seen.grow(pose.point({c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 0.3f : -0.3f}));
    }
    const float size = glm::length(seen.max - seen.min);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(box.min[axis], seen.min[axis]) << i;
      EXPECT_GE(box.max[axis], seen.max[axis]) << i;
      EXPECT_GT(box.min[axis], seen.min[axis] - 0.02f * size) << i;
      EXPECT_LT(box.max[axis], seen.max[axis] + 0.02f * size) << i;
    }
  }
}

TEST(Motion, TreesAndBruteForceMeetTheSameAndWhatStandsThere) {
  TestRandom random(7);
  SceneData scene = moving_scene({{0.0f, Affine()}, {1.0f, translate({1, 0, 0})}});
  scene.instances.clear(), scene.motion.instances.clear();
  std::vector<KnownMotion> known;
  for (std::uint32_t i = 0; i < 40; ++i) {
    known.emplace_back(random);
    scene.instances.push_back({1, known[i].at(0)});
    if (i % 4 == 0) continue;  // these stand still
    scene.motion.instances.push_back({i, {{0.0f, known[i].at(0)}, {1.0f, known[i].at(1)}}});
  }
  scene.meshes.push_back(scene.meshes[0]);
  scene.meshes.back().group = 0;
  prepare_motion(scene);
  const auto build = [&](AccelKind accel) {
    TreeOptions options;
    options.accel = accel, options.builder = TreeBuilder::sah;
    return build_triangle_tree(scene.meshes, scene.instances, options, scene.motion.tracks());
  };
  const TriangleTreeData brute = build(AccelKind::brute), tree = build(AccelKind::bvh2),
                         wide = build(AccelKind::cwbvh);
  const Motion& motion = scene.motion.prepared->view;
  int hits = 0, differ = 0;
  for (int t = 0; t < 20; ++t) {
    const float time = random.unit();
    std::vector<Instance> there = scene.instances;
    for (std::size_t i = 0; i < there.size(); ++i)
      if (i % 4 != 0) there[i].to_world = known[i].at(double{time});
    const TriangleTreeData still = brute_kind.build(scene.meshes, there);
    for (int r = 0; r < 500; ++r) {
      const Vec3 from(random.point(12));
      const Ray ray{from, normalize(Vec3(random.point(5)) - from)};
      MovingQuery<ClosestTriangle> by_brute(0.0f, infinite_distance, motion, time);
      MovingQuery<ClosestTriangle> by_tree(0.0f, infinite_distance, motion, time);
      MovingQuery<AnyTriangle> any(0.0f, infinite_distance, motion, time);
      traverse_triangles<Accel::brute, true>(brute.view(), ray, by_brute);
      traverse_triangles<Accel::bvh2, true>(tree.view(), ray, by_tree);
      traverse_triangles<Accel::bvh2, true>(tree.view(), ray, any);
      const Hit a = by_brute.result(), b = by_tree.result(), expected = closest_hit(still, ray);
      ASSERT_EQ(a.t, b.t);
      MovingQuery<ClosestTriangle> by_wide(0.0f, infinite_distance, motion, time);
      MovingQuery<ClosestTriangle> by_avx2(0.0f, infinite_distance, motion, time);
      MovingQuery<AnyTriangle> any_wide(0.0f, infinite_distance, motion, time);
      traverse_triangles<Accel::cwbvh, true>(wide.view(), ray, by_wide);
      ASSERT_EQ(a.t, by_wide.result().t);
      if (has_avx2()) {
        traverse_triangles<Accel::cwbvh_avx2, true>(wide.view(), ray, by_avx2);
        traverse_triangles<Accel::cwbvh_avx2, true>(wide.view(), ray, any_wide);
        ASSERT_EQ(a.t, by_avx2.result().t);
        ASSERT_EQ(a.is_miss(), !any_wide.result());
      }
      ASSERT_EQ(a.is_miss(), !any.result());
      hits += !a.is_miss();
      differ += a.is_miss() != expected.is_miss() ||
                (!a.is_miss() && std::abs(a.t - expected.t) > 1e-3f * (1 + expected.t));
    }
  }
  EXPECT_GT(hits, 3000);
  EXPECT_LE(differ, 10);  // at edges
}

// Deforming meshes: the tree over all sets of vertices against brute force, and what stands there.
TEST(Motion, TreesOfDeformingMeshesMeetTheSameAndWhatStandsThere) {
  TestRandom random(8);
  for (const auto& [placed, sets] : {std::pair{false, 2u}, {true, 2u}, {false, 5u}, {true, 4u}}) {
    SceneData scene;
    scene.name = "deforming";
    scene.add_material(make_diffuse(Color(0.5f)));
    Mesh mesh = deforming_triangles(random, sets);
    mesh.group = placed ? 1 : 0;
    scene.meshes = {mesh};
    if (placed) scene.instances = {{1, translate({1, 2, 3})}, {1, rotate({1, 1, 0}, 40)}};
    const auto prepared = [&](AccelKind accel) {
      SceneData own = scene;
      Options options = motion_options(8, 8, 1);
      options.accel = accel;
      prepare_scene_for(own, options, cpu_of_motion());
      return own;
    };
    const SceneData brute = prepared(AccelKind::brute), tree = prepared(AccelKind::bvh2);
    int hits = 0, differ = 0;
    for (int t = 0; t < 20; ++t) {
      const float time = random.unit();
      Mesh there = mesh;
      there.positions = positions_at(mesh, double{time});
      const TriangleTreeData still = brute_kind.build({there}, scene.instances);
      for (int r = 0; r < 500; ++r) {
        const Ray ray = ray_among(random);
        const auto query = [&](const SceneData& data) {
          return MovingQuery<ClosestTriangle>(0.0f, infinite_distance, data.motion.prepared->view,
                                              time);
        };
        auto by_brute = query(brute), by_tree = query(tree);
        traverse_triangles<Accel::brute, true>(brute.tree.view(), ray, by_brute);
        traverse_triangles<Accel::bvh2, true>(tree.tree.view(), ray, by_tree);
        const Hit a = by_brute.result(), b = by_tree.result(), expected = closest_hit(still, ray);
        ASSERT_EQ(a.t, b.t);
        hits += !a.is_miss();
        differ += a.is_miss() != expected.is_miss() ||
                  (!a.is_miss() && std::abs(a.t - expected.t) > 1e-4f * (1 + expected.t));
      }
    }
    EXPECT_GT(hits, 1000);
    EXPECT_LE(differ, 10);  // at edges
  }
}

// What it is not for.

std::string refusal(SceneData scene, const std::function<void(Options&)>& change = {}) {
  Options options = motion_options(8, 8, 1, 3);
  if (change) change(options);
  try {
    prepare_scene_for(scene, options, cpu_of_motion());
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Motion, RefusesWhatItDoesNotKnow) {
  using testing::IsSubstring;
  EXPECT_EQ(refusal(moving_room()), "");
  const auto expect_refused = [](const std::string& text, const std::string& message) {
    EXPECT_NE(message.find(text), std::string::npos) << message;
  };
  expect_refused(
      "--accel cwbvh: no kernel on the CPU renders scene 'moving room' (triangles, "
      "instances, motion, deforming meshes) so; expected --accel brute or bvh2",
      refusal(moving_room(), [](Options& o) { o.accel = AccelKind::cwbvh; }));
  SceneData torn = moving_room();
  torn.meshes[3].later_positions[0].pop_back();
  expect_refused("mesh 3, which deforms, has 3 positions in a later set; expected 4",
                 refusal(torn));
  torn = moving_room();
  torn.meshes[3].later_normals.clear();
  torn.meshes[1].later_positions = {2, torn.meshes[1].positions};
  expect_refused("mesh 3, which deforms, has 2 sets of vertices; expected 3", refusal(torn));
  torn.meshes[1].later_positions.clear();
  EXPECT_EQ(refusal(torn), "");
  torn.meshes[3].later_normals = {2, torn.meshes[3].normals};
  expect_refused("mesh 3, which deforms, has 3 sets of normals; expected 2", refusal(torn));
  expect_refused("--integrator mlt knows no motion blur",
                 refusal(moving_room(), [](Options& o) { o.integrator = IntegratorKind::mlt; }));
  SceneData masked = moving_room();
  masked.camera.hides_emitters = true;
  EXPECT_EQ(refusal(masked), "");
  masked.media.emplace_back().albedo_grid = 0, masked.grids.emplace_back();
  MaterialDescription& filled = masked.materials[masked.meshes[1].material];
  filled.is_boundary = true, filled.media.inside = 0;
  expect_refused("a grid of a medium does not move with the medium's boundary", refusal(masked));
}

TEST(Motion, RefusesKeysThatAreNone) {
  const auto expect_refused = [](std::vector<TransformKey> keys, const std::string& text,
                                 Shutter shutter = {}) {
    SceneData scene = moving_scene(std::move(keys));
    scene.motion.shutter = shutter;
    const std::string message = refusal(scene);
    EXPECT_NE(message.find(text), std::string::npos) << message;
  };
  expect_refused({{0.0f, {}}}, "instance 0: 1 key of a motion; expected two or more");
  expect_refused({{1.0f, {}}, {1.0f, {}}},
                 "key 1 of its motion at 1 s; expected times that ascend");
  expect_refused({{0.0f, {}}, {1.0f, scale({1, 0, 1})}},
                 "expected a transform that can be inverted");
  expect_refused({{0.0f, {}}, {1.0f, scale({1, -1, 1})}}, "key 1 of its motion mirrors");
  expect_refused({{0.0f, {}}, {1.0f, translate({1, 0, 0})}},
                 "the shutter opens at 1 s and closes at 1 s", {1.0f, 1.0f});
}

TEST(Motion, WhatCannotBeBlurredIsShownWhereItBegins) {
  const TempFolder folder;
  const std::string path = folder.file("moving.pbrt");
  write_text(path, R"(
Camera "perspective"
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
WorldBegin
LightSource "infinite"
AttributeBegin
ActiveTransform EndTime
Translate 1 0 0
ActiveTransform All
Shape "trianglemesh" "point3 P" [0 0 5 1 0 5 0 1 5] "integer indices" [0 1 2]
AttributeEnd
)");
  std::vector<std::string> warnings;
  DeviceInfo device = cpu_of_motion();
  const auto load = [&](const std::function<void(Options&)>& set = {}) {
    Options options;
    options.scene = path, options.device = {DeviceChoice::Kind::cpu, 0};
    if (set) set(options);
    warnings.clear();
    SceneData scene = load_scene(options, {});  // which may be before the device is known
    resolve_scene_for(scene, options, device,
                      [&](const std::string& text) { warnings.push_back(text); });
    EXPECT_EQ(scene.properties.has_motion, scene.moves());
    EXPECT_EQ(scene.motion.prepared != nullptr, scene.moves());
    return scene;
  };
  EXPECT_TRUE(load().moves());
  EXPECT_TRUE(warnings.empty());
  const auto with_chains = [](Options& o) { o.integrator = IntegratorKind::mlt; };
  const SceneData still = load(with_chains);
  EXPECT_FALSE(still.moves());
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("--integrator mlt knows no motion blur"), std::string::npos);
  EXPECT_EQ(still.instances.at(0).to_world.translation(), Vec3(0.0f));
  EXPECT_THROW(load([&](Options& o) { with_chains(o), o.strict = true; }), Error);
  device.properties.is_cuda = true;
  EXPECT_TRUE(load().moves());
  EXPECT_TRUE(warnings.empty());
  EXPECT_FALSE(load([](Options& o) { o.builder = TreeBuilder::hploc; }).moves());
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("--builder hploc fits no tree to a motion"), std::string::npos);
}

}  // namespace
}  // namespace pt
