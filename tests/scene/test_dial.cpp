// The divergence dial: its name, its materials, how they lie, and that its room has no gap.
#include <gtest/gtest.h>

#include <set>

#include "common/scene/builtin/builtin_scenes.h"
#include "common/scene/builtin/dial.h"
#include "material/each_bsdf.h"
#include "temp_folder.h"

namespace pt {
namespace {

DialSettings parse(const std::string& name) { return parse_dial(parse_scene_name(name)); }

TEST(Dial, ReadsItsName) {
  const auto expect = [](const std::string& name, std::uint32_t materials, float coherence,
                         bool closed) {
    SCOPED_TRACE(name);
    const DialSettings settings = parse(name);
    EXPECT_EQ(settings.materials, materials);
    EXPECT_EQ(settings.coherence, coherence);
    EXPECT_EQ(settings.closed, closed);
  };
  expect("dial", 16, 0, true);
  expect("dial:8", 8, 0, true);
  expect("dial:32:0.5", 32, 0.5f, true);
  expect("dial:1:1:open", 1, 1, false);
  expect("dial:13:0:closed", 13, 0, true);
}

TEST(Dial, RefusesWhatItCannotRead) {
  const auto refused = [](const std::string& name, const std::string& what) {
    expect_error([&] { parse(name); }, "--scene " + name + ": " + what);
    expect_error([&] { parse(name); }, "in dial:K:C:F");
  };
  for (const char* k : {"0", "33", "-1", "1.5", "8K", "x", "", " 8"}) {
    refused("dial:" + std::string(k) + ":0", "K is '" + std::string(k) + "', expected a whole");
  }
  for (const char* c : {"1.01", "-0.1", "nan", "half", ""}) {
    refused("dial:8:" + std::string(c), "C is '" + std::string(c) + "', expected a coherence");
  }
  for (const char* f : {"ajar", "", "Open", "open:1"}) {
    refused("dial:8:1:" + std::string(f), "F is '" + std::string(f) + "', expected open or closed");
  }
}

/// Everything about a material but its emission.
std::vector<float> values_of(const MaterialDescription& m) {
  std::vector<float> values{static_cast<float>(m.kind)};
  for (const Parameter& p : m.parameters)
    values.insert(values.end(), {p.value.x, p.value.y, p.value.z});
  return values;
}

TEST(Dial, HasAllKindsBeforeAnyRepeats) {
  for (std::uint32_t count = 1; count <= dial_materials_most; ++count) {
    std::set<MaterialKind> kinds;
    std::set<std::vector<float>> different;
    const SceneData scene = make_dial_scene({count, 0, false});
    ASSERT_EQ(scene.materials.size(), count);
    for (const MaterialDescription& m : scene.materials) {
      kinds.insert(m.kind);
      different.insert(values_of(m));
    }
    EXPECT_EQ(kinds.size(), std::min(count, dial_kinds));
    EXPECT_EQ(different.size(), count);
  }
  EXPECT_EQ(make_dial_material(0).kind, kind_of<Diffuse>);
}

/// The part of light from all of a hemisphere, from each direction alike, that leaves again.
double albedo(const MaterialDescription& material) {
  constexpr int samples = 20'000;
  double sum = 0;
  visit(material.kind, material, [&](const auto& bsdf) {
    TestRandom random;
    for (int i = 0; i < samples; ++i) {
      const Vec3 wo = sample_cosine_hemisphere(random.unit(), random.unit());
      const BsdfSample s = bsdf.sample(wo, random_numbers(random));
      sum += static_cast<double>(mean(s.weight) * s.eta * s.eta);  // power, not radiance
    }
  });
  return sum / samples;
}

// So the length of paths hardly depends on how many materials there are.
TEST(Dial, AlbedosAreAlike) {
  for (std::uint32_t i = 0; i < dial_materials_most; ++i) {
    const MaterialDescription material = make_dial_material(i);
    const double a = albedo(material);
    SCOPED_TRACE(testing::Message() << "material " << i << ", albedo " << a);
    if (i % dial_kinds < 10) {
      EXPECT_NEAR(a, 0.75, 0.03);
    } else {
      EXPECT_GT(a, 0.95) << "glass";
    }
  }
}

/// The materials of the floor's cells, by the triangles' place: row by row from the near left.
std::vector<std::uint32_t> floor_materials(const SceneData& scene) {
  constexpr int n = dial_floor_cells;
  std::vector<std::uint32_t> materials(n * n, ~0u);
  for (std::size_t m = 0; m + 1 < scene.meshes.size(); ++m) {  // the last one lies below
    const Mesh& mesh = scene.meshes[m];
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 2) {
      const Vec3 corner = mesh.positions[mesh.triangles[t].v[0]];
      const int column = static_cast<int>(corner.x) + n / 2,
                row = n / 2 - static_cast<int>(corner.z);
      materials.at(static_cast<std::size_t>(row * n + column)) = mesh.material;
    }
  }
  return materials;
}

// Along a stripe, two cells are alike if both took the stripe's material, or else by chance.
TEST(Dial, CoherenceSaysHowManyNeighboursAreAlike) {
  constexpr std::size_t n = dial_floor_cells;
  for (const std::uint32_t materials : {1u, 2u, 16u, 32u}) {
    for (const float coherence : {0.0f, 0.3f, 0.5f, 0.9f, 1.0f}) {
      SCOPED_TRACE(testing::Message() << materials << " materials, coherence " << coherence);
      const auto cells = floor_materials(make_dial_scene({materials, coherence, false}));
      std::vector<int> count(materials);
      double alike = 0, stripe = 0;
      for (std::size_t i = 0; i < cells.size(); ++i) {
        ASSERT_LT(cells[i], materials);
        ++count[cells[i]];
        alike += i >= n && cells[i] == cells[i - n];
        stripe += cells[i] == i % n * materials / n;
      }
      const double c = static_cast<double>(coherence), pairs = n * (n - 1), any = 1.0 / materials;
      const double expected = c * c + (1 - c * c) * any, own = c + (1 - c) * any;
      // A cell is in two pairs, so that their number varies by up to three times that of pairs
      // without common cells.
      const double sigma = std::sqrt(3 * expected * (1 - expected) / pairs);
      EXPECT_NEAR(alike / pairs, expected, 5 * sigma);
      EXPECT_NEAR(stripe / (n * n), own, 5 * std::sqrt(own * (1 - own) / (n * n)));
      for (const int cells_of_one : count) {
        const double mean = n * n * any;
        EXPECT_NEAR(cells_of_one, mean, 5 * std::sqrt(mean));
      }
    }
  }
}

TEST(Dial, MoreCoherenceChangesNoCellBackToNoise) {
  const auto half = floor_materials(make_dial_scene({32, 0.5f, false}));
  const auto more = floor_materials(make_dial_scene({32, 0.8f, false}));
  const auto stripes = floor_materials(make_dial_scene({32, 1, false}));
  for (std::size_t i = 0; i < half.size(); ++i) {
    EXPECT_TRUE(more[i] == half[i] || more[i] == stripes[i]);
  }
}

TEST(Dial, TheRoomHasSixWallsOfCellsThatFaceInward) {
  const SceneData scene = make_dial_scene({7, 0.5f, true});
  ASSERT_EQ(scene.meshes.size(), 7u + 2u);
  double cells = 0, volume = 0;
  const Vec3d middle(0, dial_wall_cells / 2, 0);
  for (std::size_t m = 0; m < 7; ++m) {
    for (const TriangleIndices& t : scene.meshes[m].triangles) {
      const auto& p = scene.meshes[m].positions;
      const Vec3d a = Vec3d(p[t.v[0]]) - middle, b = Vec3d(p[t.v[1]]) - middle;
      const Vec3d c = Vec3d(p[t.v[2]]) - middle;
      EXPECT_EQ(glm::length(glm::cross(b - a, c - a)), 1.0);
      cells += 0.5;
      volume -= glm::dot(a, glm::cross(b, c)) / 6;  // below 0 where a face turns away
      EXPECT_LT(glm::dot(a, glm::cross(b, c)), 0);
    }
  }
  const double n = dial_wall_cells;
  EXPECT_EQ(cells, 6 * n * n);
  EXPECT_NEAR(volume, n * n * n, 1e-6 * n * n * n) << "the walls close the room";
}

TEST(Dial, TheLampHangsInTheRoomAndShinesDown) {
  const SceneData scene = make_dial_scene({2, 0, true});
  const Mesh& lamp = scene.meshes.back();
  EXPECT_FALSE(is_black(scene.materials[lamp.material].emission.radiance));
  const auto& p = lamp.positions;
  for (const TriangleIndices& t : lamp.triangles) {
    EXPECT_LT(glm::cross(p[t.v[1]] - p[t.v[0]], p[t.v[2]] - p[t.v[0]]).y, 0);
    for (const std::uint32_t v : t.v) EXPECT_LT(p[v].y, dial_wall_cells);
  }
  EXPECT_EQ(make_dial_scene({2, 0, false}).meshes.size(), 3u) << "the floor has a sky alone";
}

// Whatever BSDFs there are: the scene is a benchmark.
TEST(Dial, HasItsOwnListOfKinds) {
  constexpr MaterialKind kinds[] = {
      kind_of<Diffuse>,        kind_of<Conductor>,      kind_of<Plastic>,
      kind_of<RoughPlastic>,   kind_of<Principled>,     kind_of<Phong>,
      kind_of<Ward>,           kind_of<OrenNayar>,      kind_of<Metal>,
      kind_of<PrincipledThin>, kind_of<ThinDielectric>, kind_of<Dielectric>,
      kind_of<RoughDielectric>};
  ASSERT_EQ(std::size(kinds), dial_kinds);
  for (std::uint32_t i = 0; i < 40; ++i) {
    EXPECT_EQ(make_dial_material(i).kind, kinds[i % dial_kinds]) << i;
  }
}

}  // namespace
}  // namespace pt
