// The glTF loader: animations at a time, against poses in closed form and against other ways to
// compute them (rotations about axes, Bezier's construction of cubic curves, sums in double).
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "common/math/transform.h"
#include "common/scene/prepare/prepare_scene.h"
#include "load/expect_near.h"
#include "load/gltf_files.h"
#include "load/png_bytes.h"

namespace pt {
namespace {

constexpr float pi_f = 3.14159265f;

/// Adds a channel with a sampler of its own to animation `animation`, which may be a new one.
void animate(GltfMaker& maker, int node, const char* path, int input, int output,
             const char* interpolation = "LINEAR", std::size_t animation = 0) {
  Json& all = maker.root["animations"];
  if (all.size() <= animation)
    all.push_back({{"channels", Json::array()}, {"samplers", Json::array()}});
  Json& one = all[animation];
  one["channels"].push_back(
      {{"sampler", one["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
  one["samplers"].push_back(
      {{"input", input}, {"output", output}, {"interpolation", interpolation}});
}

const Mesh& first_mesh(const Loaded& loaded) { return loaded.scene.meshes.at(0); }

Vec3 first_vertex(const Loaded& loaded) { return first_mesh(loaded).positions.at(0); }

/// Where (1, 0, 0) is.
Vec3 second_vertex(const Loaded& loaded) { return first_mesh(loaded).positions.at(1); }

/// A turn about z in five keys, of which the fourth and fifth have the other sign: the same
/// rotations.
GltfMaker turning_triangle() {
  GltfMaker maker = triangle_file();
  maker.root["bufferViews"][0]["target"] = 34962;  // not a channel's
  const float h = std::sqrt(0.5f);
  animate(maker, 0, "rotation", maker.floats({1, 1.25f, 1.5f, 1.75f, 2}, "SCALAR"),
          maker.floats({0, 0, 0, 1, 0, 0, h, h, 0, 0, 1, 0, 0, 0, -h, h, 0, 0, 0, 1}, "VEC4"));
  return maker;
}

TEST(GltfAnimations, ANodeTurnsOnce) {
  const GltfMaker maker = turning_triangle();
  for (int i = 0; i <= 16; ++i) {
    const float turn = static_cast<float>(i) / 16, angle = 2 * pi_f * turn;
    const Loaded loaded = at_time(maker, 1 + turn);
    expect_near(second_vertex(loaded), {std::cos(angle), std::sin(angle), 0});
    expect_near(first_mesh(loaded).positions[2], {-2 * std::sin(angle), 2 * std::cos(angle), 0});
    EXPECT_EQ(loaded.count("animation"), 0u);
  }
  // Before the first key and after the last.
  expect_near(second_vertex(at_time(maker, -3)), {1, 0, 0});
  expect_near(second_vertex(at_time(maker, 0.9f)), {1, 0, 0});
  expect_near(second_vertex(at_time(maker, 7)), {1, 0, 0});
}

// Evenly about one axis, the shorter way round, whatever the quaternions' signs and lengths are.
TEST(GltfAnimations, RotationsTakeTheShorterArc) {
  const Vec3 axis = normalize(Vec3(1, 2, 3));
  for (const float degrees : {100.0f, -100.0f, 170.0f, 1e-3f}) {
    for (const float length : {1.0f, -1.0f, 0.5f}) {
      GltfMaker maker = triangle_file();
      const float half = 0.5f * degrees * pi_f / 180, s = length * std::sin(half);
      animate(
          maker, 0, "rotation", maker.floats({0, 2}, "SCALAR"),
          maker.floats({0, 0, 0, 1, s * axis.x, s * axis.y, s * axis.z, length * std::cos(half)},
                       "VEC4"));
      for (const float t : {0.0f, 0.25f, 0.7f, 1.0f}) {
        expect_near(second_vertex(at_time(maker, 2 * t)),
                    rotate(axis, t * degrees).vector({1, 0, 0}));
      }
    }
  }
}

TEST(GltfAnimations, StepsAndLinesOfTranslationAndScale) {
  GltfMaker maker = triangle_file();
  const int keys = maker.floats({0, 1, 3}, "SCALAR");
  animate(maker, 0, "translation", keys, maker.floats({0, 0, 0, 2, 0, 0, 2, 8, 0}, "VEC3"));
  animate(maker, 0, "scale", keys, maker.floats({1, 1, 1, 3, 1, 1, 5, 1, 1}, "VEC3"), "STEP");
  maker.root["nodes"][0]["translation"] = {100, 100, 100};
  const auto expect_at = [&](float time, const Vec3& translation, float scale) {
    const Loaded loaded = at_time(maker, time);
    expect_near(first_vertex(loaded), translation);
    expect_near(second_vertex(loaded), translation + Vec3(scale, 0, 0));
  };
  expect_at(-1, {0, 0, 0}, 1);
  expect_at(0.25f, {0.5f, 0, 0}, 1);
  expect_at(1, {2, 0, 0}, 3);
  expect_at(2.5f, {2, 6, 0}, 3);
  expect_at(3, {2, 8, 0}, 5);
  expect_at(9, {2, 8, 0}, 5);
  // What is not animated stays: here the mesh's node is below one that turns.
  maker.root["nodes"][0]["children"] = {1};
  maker.root["nodes"][0].erase("mesh");
  maker.root["nodes"].push_back({{"mesh", 0}, {"translation", {0, 0, 7}}});
  expect_near(second_vertex(at_time(maker, 2.5f)), {5, 6, 7});
}

/// A cubic curve by Bezier's construction from values and derivatives at its ends.
double bezier(double p, double out, double in, double q, double seconds, double t) {
  double points[4] = {p, p + seconds * out / 3, q - seconds * in / 3, q};
  for (int count = 3; count > 0; --count) {
    for (int i = 0; i < count; ++i) points[i] = (1 - t) * points[i] + t * points[i + 1];
  }
  return points[0];
}

TEST(GltfAnimations, CubicSplinesScaleTheirTangentsByTheInterval) {
  GltfMaker maker = triangle_file();
  // In-tangent, value, out-tangent of each key.
  const float v[3][9] = {{9, 9, 9, 0, 1, 2, 1, -2, 0.5f},
                         {2, 3, -1, 4, 0, 1, -1, 5, 2},
                         {0.25f, -3, 1, 2, 2, 2, 9, 9, 9}};
  const float times[3] = {0.5f, 1.2f, 4.2f};
  std::string bytes(sizeof v, '\0');
  std::memcpy(bytes.data(), v, sizeof v);
  animate(maker, 0, "translation", maker.floats({times[0], times[1], times[2]}, "SCALAR"),
          maker.accessor(maker.view(bytes), 5126, 9, "VEC3"), "CUBICSPLINE");
  for (int key = 0; key < 2; ++key) {
    const double seconds = double{times[key + 1]} - times[key];
    for (const float t : {0.0f, 0.1f, 0.5f, 0.8f}) {
      const float time = times[key] + t * static_cast<float>(seconds);
      const double at = (double{time} - times[key]) / seconds;
      Vec3 expected;
      for (int i = 0; i < 3; ++i) {
        expected[i] = static_cast<float>(
            bezier(v[key][3 + i], v[key][6 + i], v[key + 1][i], v[key + 1][3 + i], seconds, at));
      }
      expect_near(first_vertex(at_time(maker, time)), expected, 3e-5f);
    }
  }
  expect_near(first_vertex(at_time(maker, 0)), {0, 1, 2});
  expect_near(first_vertex(at_time(maker, 5)), {2, 2, 2});
}

TEST(GltfAnimations, CubicRotationsAreNormalised) {
  GltfMaker maker = triangle_file();
  const float h = std::sqrt(0.5f);
  animate(maker, 0, "rotation", maker.floats({0, 2}, "SCALAR"),
          maker.floats({0, 0, 0,    0,     0, 0, 0, 1, 0, 0, 0.6f, 0.2f,  //
                        0, 0, 0.1f, -0.4f, 0, 0, h, h, 0, 0, 0,    0},
                       "VEC4"),
          "CUBICSPLINE");
  for (const float time : {0.0f, 0.3f, 1.0f, 1.9f, 2.0f}) {
    const double z = bezier(0, 0.6, 0.1, h, 2, time / 2), w = bezier(1, 0.2, -0.4, h, 2, time / 2);
    const double angle = 2 * std::atan2(z, w);
    expect_near(second_vertex(at_time(maker, time)),
                {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0});
  }
}

TEST(GltfAnimations, OutputsMayBeNormalisedIntegersAndSparse) {
  // Half a turn in bytes, a quarter in shorts.
  for (const bool shorts : {false, true}) {
    GltfMaker maker = triangle_file();
    const int output =
        shorts ? maker.accessor(
                     maker.view(bytes_of<std::int16_t>({0, 0, 0, 32767, 0, 0, 23170, 23170})), 5122,
                     2, "VEC4")
               : maker.accessor(maker.view(bytes_of<std::int8_t>({0, 0, 0, 127, 0, 0, 127, 0})),
                                5120, 2, "VEC4");
    maker.root["accessors"][output]["normalized"] = true;
    animate(maker, 0, "rotation", maker.floats({0, 1}, "SCALAR"), output);
    const float angle = 0.5f * (shorts ? 0.5f : 1) * pi_f;
    expect_near(second_vertex(at_time(maker, 0.5f)), {std::cos(angle), std::sin(angle), 0}, 1e-4f);
  }
  // An output of zeros, but for the second key, and only keys that are replaced.
  GltfMaker maker = triangle_file();
  const auto sparse = [&](const char* type, std::initializer_list<std::uint8_t> indices,
                          std::initializer_list<float> values) {
    const int accessor =
        maker.push("accessors", {{"componentType", 5126}, {"count", 3}, {"type", type}});
    maker.root["accessors"][accessor]["sparse"] = {
        {"count", indices.size()},
        {"indices", {{"bufferView", maker.view(bytes_of(indices))}, {"componentType", 5121}}},
        {"values", {{"bufferView", maker.view(bytes_of(values))}}}};
    return accessor;
  };
  const int keys = sparse("SCALAR", {1, 2}, {2, 4});
  animate(maker, 0, "translation", keys, sparse("VEC3", {1}, {0, 8, 0}));
  expect_near(first_vertex(at_time(maker, 0.5f)), {0, 2, 0});
  expect_near(first_vertex(at_time(maker, 3)), {0, 4, 0});
}

/// The triangle with two targets, which move positions, texture coordinates and colours.
GltfMaker morphing_triangle() {
  GltfMaker maker = triangle_file();
  Json& primitive = maker.root["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = maker.floats({0, 0, 1, 0, 0, 1}, "VEC2");
  primitive["attributes"]["COLOR_0"] =
      maker.floats({0.5f, 0.25f, 0, 0.5f, 0.25f, 0, 0.5f, 0.25f, 0}, "VEC3");
  const int all_by_x = maker.floats({1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3");
  const int all_by_y = maker.floats({0, 1, 0, 0, 1, 0, 0, 1, 0}, "VEC3");
  primitive["targets"] = {
      {{"POSITION", all_by_x}, {"TEXCOORD_0", maker.floats({0, 4, 0, 4, 0, 4}, "VEC2")}},
      {{"POSITION", all_by_y}, {"COLOR_0", all_by_x}}};
  primitive["material"] = 0;
  maker.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  maker.root["textures"] = {{{"source", 0}}};
  const std::string png = png_file(1, 1, 8, 2, "\xff\xff\xff");
  maker.root["images"] = {{{"uri", "data:image/png;base64," + base64(png)}}};
  maker.root["meshes"][0]["weights"] = {3, 3};
  return maker;
}

TEST(GltfAnimations, WeightsOfMorphTargets) {
  GltfMaker maker = morphing_triangle();
  const int keys = maker.floats({0, 2}, "SCALAR");
  animate(maker, 0, "weights", keys, maker.floats({0, 1, 0.5f, 0}, "SCALAR"));
  expect_near(first_vertex(at_time(maker, 0)), {0, 1, 0});
  expect_near(first_vertex(at_time(maker, 1)), {0.25f, 0.5f, 0});
  expect_near(first_vertex(at_time(maker, 3)), {0.5f, 0, 0});
  // Of each key the in-tangents of both targets, the values, the out-tangents.
  maker.root["animations"] = Json::array();
  animate(maker, 0, "weights", keys,
          maker.floats({9, 9, 0, 1, 1, -2, 3, 0.5f, 0.5f, 0, 9, 9}, "SCALAR"), "CUBICSPLINE");
  const auto near = [](double x, double y) { return Vec3(float(x), float(y), 0); };
  expect_near(first_vertex(at_time(maker, 0.5f)),
              near(bezier(0, 1, 3, 0.5, 2, 0.25), bezier(1, -2, 0.5, 0, 2, 0.25)));
  // Without a time they are the mesh's.
  expect_near(first_vertex(Loaded(maker)), {3, 3, 0});
}

TEST(GltfAnimations, TargetsMoveTextureCoordinatesAndColours) {
  GltfMaker maker = morphing_triangle();
  maker.root["meshes"][0]["weights"] = {0.5, 0.25};
  const Loaded loaded(maker);
  const Mesh& mesh = first_mesh(loaded);
  ASSERT_EQ(mesh.uvs.size(), 3u);
  EXPECT_FLOAT_EQ(mesh.uvs[0].x, 0);
  EXPECT_FLOAT_EQ(mesh.uvs[0].y, 1 - 2);
  EXPECT_FLOAT_EQ(mesh.uvs[2].y, 0 - 2);
  // The mean colour, since the texture needs the mesh's coordinates.
  std::size_t found = 0;
  for (const Parameter& p : loaded.scene.materials.at(mesh.material).parameters)
    found += glm::length(p.value - Color(0.75f, 0.25f, 0)) < 1e-5f;
  EXPECT_EQ(found, 1u);
}

/// A strip of pairs of vertices along y, bent by the joint of node 2 at y = 1; the weights go from
/// the joint of node 1 to this one.
struct Strip : GltfMaker {
  static constexpr int rows = 5;
  std::vector<float> positions, weights;

  explicit Strip(bool is_colored = false) {
    std::vector<float> colors;
    std::vector<std::uint8_t> joints;
    std::vector<std::uint16_t> indices;
    for (int i = 0; i < rows; ++i) {
      for (int side = 0; side < 2; ++side) {
        const float second = static_cast<float>(i) / (rows - 1);
        for (const float x : {side - 0.5f, 2 * second, 0.0f}) positions.push_back(x);
        for (const float w : {1 - second, second, 0.0f, 0.0f}) weights.push_back(w);
        for (const float c : {second, 0.5f, 1.0f}) colors.push_back(c);
        for (const int joint : {0, 1, 0, 0}) joints.push_back(static_cast<std::uint8_t>(joint));
      }
      const auto v = static_cast<std::uint16_t>(2 * i);
      if (i + 1 < rows) {
        for (const int corner : {0, 1, 3, 0, 3, 2})
          indices.push_back(static_cast<std::uint16_t>(v + corner));
      }
    }
    const auto bytes = [](const auto& values) {
      return std::string(reinterpret_cast<const char*>(values.data()),
                         values.size() * sizeof values[0]);
    };
    const auto vertex = [&](const auto& values, int type, const char* shape) {
      return accessor(view(bytes(values)), type, 2 * rows, shape);
    };
    mesh({{"attributes",
           {{"POSITION", vertex(positions, 5126, "VEC3")},
            {"JOINTS_0", vertex(joints, 5121, "VEC4")},
            {"WEIGHTS_0", vertex(weights, 5126, "VEC4")}}},
          {"indices", accessor(view(bytes(indices)), 5123, indices.size(), "SCALAR")}});
    if (is_colored)
      root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = vertex(colors, 5126, "VEC3");
    root["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {50, 0, 0}}},
                     {{"children", {2}}, {"translation", {0, 0, 0}}},
                     {{"translation", {0, 1, 0}}}};
    root["scenes"][0]["nodes"] = {0, 1};
    root["skins"] = {{{"joints", {1, 2}}}};
    root["skins"][0]["inverseBindMatrices"] =
        accessor(view(bytes_of<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,  //
                                       1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1})),
                 5126, 2, "MAT4");
  }

  /// A vertex when the joint has turned by `angle` about z, and both have gone by `z`.
  Vec3 bent(std::size_t v, double angle, double z = 0) const {
    const double c = std::cos(angle), s = std::sin(angle);
    const auto x = double{positions[3 * v]}, y = double{positions[3 * v + 1]};
    const auto w = double{weights[4 * v + 1]};
    const double bent_x = c * x - s * (y - 1), bent_y = s * x + c * (y - 1) + 1;
    return Vec3(glm::dvec3((1 - w) * x + w * bent_x, (1 - w) * y + w * bent_y, z));
  }
};

TEST(GltfAnimations, ASkinnedStripBends) {
  Strip strip;
  const int keys = strip.floats({0, 1}, "SCALAR");
  const float h = std::sqrt(0.5f);
  animate(strip, 2, "rotation", keys, strip.floats({0, 0, 0, 1, 0, 0, h, h}, "VEC4"));
  animate(strip, 1, "translation", keys, strip.floats({0, 0, 0, 0, 0, 4}, "VEC3"));
  // The mesh's node moves, too, without effect.
  animate(strip, 0, "translation", keys, strip.floats({0, 9, 0, 9, 0, 0}, "VEC3"));
  for (const double time : {0.0, 0.4, 1.0}) {
    const Loaded loaded = at_time(strip, static_cast<float>(time));
    ASSERT_EQ(first_mesh(loaded).positions.size(), 2u * Strip::rows);
    for (std::size_t v = 0; v < 2 * Strip::rows; ++v)
      expect_near(first_mesh(loaded).positions[v], strip.bent(v, time * pi_f / 2, 4 * time));
  }
  expect_near(Loaded(strip).scene.meshes.at(0).positions[2 * Strip::rows - 1], {0.5f, 2, 0});
}

TEST(GltfAnimations, CamerasAndLampsMoveWithTheirNodes) {
  GltfMaker maker = triangle_file();
  maker.root["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  maker.root["extensionsUsed"] = {"KHR_lights_punctual"};
  maker.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "directional"}}};
  maker.root["nodes"].push_back({{"camera", 0}});
  maker.root["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  maker.root["scenes"][0]["nodes"] = {0, 1, 2};
  const int keys = maker.floats({0, 1}, "SCALAR");
  const float h = std::sqrt(0.5f);
  animate(maker, 1, "translation", keys, maker.floats({0, 0, 0, 0, 6, 8}, "VEC3"));
  animate(maker, 2, "rotation", keys, maker.floats({0, 0, 0, 1, h, 0, 0, h}, "VEC4"));
  const Loaded half = at_time(maker, 0.5f);
  expect_near(half.scene.camera.look_from, {0, 3, 4});
  ASSERT_EQ(half.scene.delta_lights.size(), 1u);
  // -z turned by 45 degrees about x
  expect_near(half.scene.delta_lights[0].direction, {0, h, -h});
  expect_near(Loaded(maker).scene.delta_lights.at(0).direction, {0, 0, -1});
}

/// The triangle, whose translation is animated by (0, 4, 0) at 1 s.
struct Sliding : GltfMaker {
  int keys = 0, moves = 0;  ///< accessors

  Sliding() : GltfMaker(triangle_file()) {
    keys = floats({0, 2}, "SCALAR");
    moves = floats({0, 0, 0, 0, 8, 0}, "VEC3");
    animate(*this, 0, "translation", keys, moves);
  }
  Json& channel() { return root["animations"][0]["channels"][0]; }
  Json& sampler() { return root["animations"][0]["samplers"][0]; }
};

// A channel that cannot be used is lost with one message, and the file is not.
TEST(GltfAnimations, BadChannelsLoseThemselves) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  using Change = void (*)(Sliding&);
  const std::pair<Change, const char*> cases[] = {
      {[](Sliding& s) { s.channel()["target"]["path"] = "pointer"; },
       "animations[0].channels[0]: path 'pointer': expected translation, rotation, scale or "
       "weights: the channel is left out"},
      {[](Sliding& s) { s.channel().erase("target"); }, "path ''"},
      {[](Sliding& s) {
         s.channel()["target"] = {0, 1};
       },
       "path ''"},
      {[](Sliding& s) { s.channel()["target"]["path"] = 4; }, "path: expected a string"},
      {[](Sliding& s) { s.channel()["target"]["node"] = 9; },
       "animations[0].channels[0].target: nodes[9] does not exist, there are 1: the channel"},
      {[](Sliding& s) { s.channel()["sampler"] = 1; },
       "animations[0].channels[0]: samplers[1] does not exist, there are 1: the channel"},
      {[](Sliding& s) { s.channel().erase("sampler"); }, "samplers[2147483647] does not exist"},
      {[](Sliding& s) { s.sampler()["interpolation"] = "CATMULLROMSPLINE"; },
       "interpolation 'CATMULLROMSPLINE': expected STEP, LINEAR or CUBICSPLINE: the channel"},
      {[](Sliding& s) {
         s.sampler()["input"] = s.floats({0, nan}, "SCALAR");
       },
       "animations[0].channels[0]: key 1 is nan: expected seconds: the channel is left out"},
      {[](Sliding& s) {
         s.sampler()["input"] = s.floats({0, infinity}, "SCALAR");
       },
       "key 1 is inf"},
      {[](Sliding& s) {
         s.sampler()["input"] = s.floats({2, 0}, "SCALAR");
       },
       "order of keys: key 1 is 0 s after 2 s, expected ascending ones: the channel is left out"},
      {[](Sliding& s) { s.root["accessors"][s.moves]["count"] = 1; },
       "output has 1 elements, expected 2 for 2 keys: the channel is left out"},
      {[](Sliding& s) { s.sampler()["interpolation"] = "CUBICSPLINE"; },
       "output has 2 elements, expected 6 for 2 keys"},
      {[](Sliding& s) {
         s.sampler()["output"] = s.floats({0, 0, 0, 0, nan, 0}, "VEC3");
       },
       "value at 1 s: expected finite numbers: the channel is left out"},
      {[](Sliding& s) {
         s.channel()["target"]["path"] = "rotation";
         s.sampler()["output"] = s.floats({0, 0, 0, 0, 0, 0, 0, 0}, "VEC4");
         s.sampler()["interpolation"] = "STEP";
       },
       "a rotation that is not zero"},
      {[](Sliding& s) { s.channel()["target"]["path"] = "weights"; },
       "weights: nodes[0] has no morph targets: the channel is left out"},
      {[](Sliding& s) {
         s.root["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
       },
       "matrix: nodes[0] has one and cannot be animated: the channel is left out"},
  };
  for (const auto& [change, message] : cases) {
    Sliding maker;
    change(maker);
    const Loaded loaded = at_time(maker, 1);
    EXPECT_EQ(loaded.count(message), 1u)
        << message << " in " << testing::PrintToString(loaded.messages);
    expect_near(first_vertex(loaded), {0, 0, 0}, 0);
    EXPECT_THROW(at_time(maker, 1, "", true), Error) << message;
  }
  expect_near(first_vertex(at_time(Sliding(), 1)), {0, 4, 0});
}

TEST(GltfAnimations, WhatTheSpecificationForbidsAndFilesHave) {
  Sliding equal;  // of equal keys the later one counts
  equal.sampler()["input"] = equal.floats({1, 1}, "SCALAR");
  expect_near(first_vertex(at_time(equal, 1)), {0, 8, 0});
  expect_near(first_vertex(at_time(equal, 0.5f)), {0, 0, 0});
  EXPECT_EQ(at_time(equal, 1).count("channels[0]: equal keys 0 and 1: the later one counts"), 1u);
  Sliding twice;
  animate(twice, 0, "translation", twice.keys, twice.moves, "STEP");
  EXPECT_EQ(at_time(twice, 1).count("channels[1]: twice: nodes[0].translation is animated already"),
            1u);
  expect_near(first_vertex(at_time(twice, 1)), {0, 4, 0});
  Sliding nowhere;  // legal: an extension might say what it moves
  nowhere.channel()["target"].erase("node");
  EXPECT_EQ(at_time(nowhere, 1, "", true).count("animation"), 0u);
  EXPECT_EQ(Loaded(nowhere).scene.meshes.size(), 1u);
  // Arrays that exceed their buffers are errors, as those of meshes are.
  Sliding beyond;
  beyond.root["accessors"][beyond.moves]["count"] = 1000;
  expect_error([&] { at_time(beyond, 1); },
               "animations[0].channels[0].sampler.output = accessors[2]");
  Sliding scalar;
  scalar.sampler()["output"] = scalar.keys;
  expect_error([&] { at_time(scalar, 1); }, "expected VEC3");
  EXPECT_EQ(Loaded(beyond).scene.meshes.size(), 1u);
}

TEST(GltfAnimations, TheOptionsChoose) {
  Sliding maker;  // the second animation moves another property, the third the same
  maker.root["animations"][0]["name"] = "Slide";
  animate(maker, 0, "scale", maker.keys, maker.floats({3, 1, 1, 3, 1, 1}, "VEC3"), "LINEAR", 1);
  maker.root["animations"][1]["name"] = "Grow";
  animate(maker, 0, "scale", maker.keys, maker.floats({5, 1, 1, 5, 1, 1}, "VEC3"), "LINEAR", 2);
  maker.root["animations"][2]["name"] = "1";
  const Loaded all = at_time(maker, 1);
  expect_near(second_vertex(all), {3, 4, 0});
  EXPECT_EQ(all.count("1 of 3 animations move what one before them moves and are left out: "
                      "--animation takes one of 0 'Slide', 1 'Grow', 2 '1'"),
            1u);
  expect_near(second_vertex(at_time(maker, 1, "", true)), {3, 4, 0});  // it is no fault of the file
  expect_near(second_vertex(at_time(maker, 1, "Slide", true)), {1, 4, 0});
  expect_near(second_vertex(at_time(maker, 1, "0", true)), {1, 4, 0});
  expect_near(second_vertex(at_time(maker, 1, "Grow")), {3, 0, 0});
  expect_near(second_vertex(at_time(maker, 1, "1")), {5, 0, 0});  // names come first
  EXPECT_EQ(at_time(maker, 1, "2").count("animation"), 0u);
  for (const char* wrong : {"3", "-1", "slide", "0x1", "1.0"}) {
    expect_error([&] { at_time(maker, 1, wrong); },
                 fmt::format("scene.gltf: animations: --animation {}: expected name or number of "
                             "one of 0 'Slide', 1 'Grow', 2 '1'",
                             wrong));
  }
}

// Motion while the shutter is open.

Loaded open_for(const GltfMaker& maker, float time, float shutter) {
  LoadOptions options;
  options.time = time, options.shutter = shutter;
  return Loaded(maker.gltf(), false, "scene.gltf", options);
}

TEST(GltfShutter, NodesAndCamerasThatMoveGetKeys) {
  GltfMaker maker = turning_triangle();
  maker.root["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  maker.root["nodes"][0]["camera"] = 0;
  maker.root["nodes"][0]["scale"] = {3, 3, 3};
  const Loaded loaded = open_for(maker, 1.125f, 0.25f);
  const SceneData& scene = loaded.scene;
  EXPECT_EQ(scene.motion.shutter.close - scene.motion.shutter.open, 0.25f);
  ASSERT_EQ(scene.instances.size(), 1u);
  ASSERT_EQ(scene.motion.instances.size(), 1u);
  EXPECT_EQ(scene.meshes.at(0).group, scene.instances[0].group);
  const auto& keys = scene.motion.instances[0].keys;
  ASSERT_EQ(keys.size(), scene.motion.camera.size());
  EXPECT_EQ(keys.front().time, 0.0f);
  EXPECT_EQ(keys.back().time, 0.25f);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const float angle = 2 * pi_f * (0.125f + keys[i].time);
    const Vec3 x(std::cos(angle), std::sin(angle), 0);
    expect_near(keys[i].to_world.point({1, 0, 0}), 3.0f * x);
    expect_near(scene.motion.camera[i].to_world.vector({-1, 0, 0}), x);  // its x is to the left
  }
  expect_near(scene.camera.up, scene.motion.camera[0].to_world.vector({0, 1, 0}));
  // What stands still has none.
  const Loaded still = open_for(maker, 5, 1);
  EXPECT_FALSE(still.scene.moves());
  EXPECT_TRUE(still.scene.instances.empty());
  LoadOptions options;
  options.shutter = 1.0f;
  expect_error([&] { Loaded(maker.gltf(), false, "scene.gltf", options); },
               "scene.gltf: --shutter: expected --time, when it opens");
}

TEST(GltfShutter, MorphTargetsDeformMeshes) {
  GltfMaker maker = morphing_triangle();
  animate(maker, 0, "weights", maker.floats({0, 2}, "SCALAR"),
          maker.floats({0, 1, 0.5f, 0}, "SCALAR"));
  maker.root["meshes"][0]["primitives"][0]["targets"][0].erase("TEXCOORD_0");
  const Loaded loaded = open_for(maker, 0, 1);
  const Mesh& mesh = first_mesh(loaded);
  EXPECT_FALSE(loaded.scene.motion.moves());
  ASSERT_EQ(mesh.vertex_sets(), 2u);  // linear all the time
  expect_near(mesh.positions[0], {0, 1, 0});
  expect_near(mesh.later_positions[0][0], {0.25f, 0.5f, 0});
}

// Deformations have the sets of vertices that they need: two for what is linear.
TEST(GltfShutter, MorphTargetsMayGoAndComeBack) {
  GltfMaker maker = morphing_triangle();
  animate(maker, 0, "weights", maker.floats({0, 0.5f, 1}, "SCALAR"),
          maker.floats({0, 0, 1, 0, 0, 0}, "SCALAR"));
  const Loaded loaded = open_for(maker, 0, 1);
  const Mesh& mesh = first_mesh(loaded);
  ASSERT_EQ(mesh.vertex_sets(), 3u);
  expect_near(mesh.positions_of(1)[0], {1, 0, 0});
  EXPECT_EQ(mesh.positions_of(2), mesh.positions);
  EXPECT_EQ(open_for(maker, 5, 1).scene.vertex_sets(), 1u);  // they stay
}

TEST(GltfShutter, ASkinThatTurnsByHalfACircle) {
  Strip strip;
  animate(strip, 2, "rotation", strip.floats({0, 0.5f, 1}, "SCALAR"),
          strip.floats({0, 0, 0, 1, 0, 0, std::sqrt(0.5f), std::sqrt(0.5f), 0, 0, 1, 0}, "VEC4"));
  const auto sets = [&](float shutter) { return open_for(strip, 0, shutter).scene.vertex_sets(); };
  EXPECT_EQ(sets(2 / 180.0f), 2u);  // so many degrees
  EXPECT_EQ(sets(45 / 180.0f), 9u);
  const SceneData scene = open_for(strip, 0, 1).scene;
  const Mesh& mesh = scene.meshes.at(0);
  ASSERT_EQ(mesh.vertex_sets(), 17u);
  for (std::size_t v = 0; v < 2 * Strip::rows; ++v)
    for (std::size_t set = 0; set < 17; ++set)
      expect_near(mesh.positions_of(set)[v], strip.bent(v, static_cast<double>(set) * pi_f / 16));
  // Between two sets a vertex is on the chord of its arc about the joint.
  for (const float time : {0.03f, 0.47f, 0.71f, 0.97f}) {
    SceneData held = scene;
    hold_still_at(held, time);
    for (std::size_t v = 0; v < 2 * Strip::rows; ++v)
      EXPECT_LT(glm::length(held.meshes.at(0).positions[v] - strip.bent(v, time * pi_f)),
                1.12f * (1 - std::cos(pi_f / 32)) + 1e-5f)
          << v << " at " << time;
  }
}

// Colours of vertices give each corner of a triangle a vertex of its own, at all times.
TEST(GltfShutter, WhatDeformsMayHaveColours) {
  Strip strip(true);
  animate(strip, 2, "rotation", strip.floats({0, 1}, "SCALAR"),
          strip.floats({0, 0, 0, 1, 0, 0, std::sqrt(0.5f), std::sqrt(0.5f)}, "VEC4"));
  const Loaded loaded = open_for(strip, 0, 1);
  const Mesh& mesh = first_mesh(loaded);
  ASSERT_GT(mesh.vertex_sets(), 2u);
  ASSERT_EQ(mesh.positions.size(), 3 * mesh.triangles.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    std::size_t own = 0;
    while (glm::length(strip.bent(own, 0) - mesh.positions[v]) > 1e-6f) ++own;
    expect_near(mesh.later_positions.back().at(v), strip.bent(own, pi_f / 2));
  }
}

TEST(GltfAnimations, WithoutATimeOrWithoutAnimations) {
  const Sliding maker;
  const Loaded still(maker);
  expect_near(first_vertex(still), {0, 0, 0}, 0);
  EXPECT_EQ(still.count("animations are ignored"), 1u);
  EXPECT_EQ(still.count("--time evaluates them"), 1u);
  EXPECT_EQ(at_time(triangle_file(), 1).count("no animations: --time has no effect"), 1u);
  TempFolder folder;
  write_text(folder.file("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  LoadOptions options;
  options.time = 0.5f;
  expect_error([&] { load_scene_file(folder.file("a.obj"), options); },
               "a.obj: --time 0.5: has no effect; it applies to .gltf and .glb");
}

}  // namespace
}  // namespace pt
