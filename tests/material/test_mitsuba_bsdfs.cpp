// BSDFs against values of Mitsuba 3, which scripts/mitsuba_bsdf_values wrote: read from the same
// XML by the loader, evaluated in the same directions, sampled on average.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "load/mitsuba_scene.h"
#include "statistics.h"
#include "test_data.h"

namespace pt {
namespace {

struct MitsubaValue {
  Vec3 wo, wi;
  Color f;
  float pdf;
};
struct MitsubaMean {
  Vec3 wo;
  glm::dvec3 mean[2], error[2];  ///< of what is reflected, of what passes
};
struct MitsubaBsdf {
  std::string name, xml;
  std::vector<MitsubaValue> values;
  std::vector<MitsubaMean> means;
};

template <class Vector>
std::istream& operator>>(std::istream& in, Vector& v) requires requires {
  v.z;
}
{ return in >> v.x >> v.y >> v.z; }

std::vector<MitsubaBsdf> read_values() {
  std::ifstream file(test_data("mitsuba_bsdfs.txt"));
  std::vector<MitsubaBsdf> all;
  for (std::string line, kind; std::getline(file, line);) {
    std::istringstream in(line);
    in >> kind;
    if (kind == "bsdf") {
      const std::size_t colon = line.find(": ");
      all.push_back({line.substr(5, colon - 5), line.substr(colon + 2), {}, {}});
    } else if (kind == "value") {
      MitsubaValue v;
      in >> v.wo >> v.wi >> v.f >> v.pdf;
      all.back().values.push_back(v);
    } else if (kind == "mean") {
      MitsubaMean m;
      in >> m.wo >> m.mean[0] >> m.mean[1] >> m.error[0] >> m.error[1];
      all.back().means.push_back(m);
    }
    EXPECT_FALSE(in.fail()) << line;
  }
  return all;
}

/// Calls test(of Mitsuba, material) for every BSDF that the file has.
template <class Test>
void for_each_of_mitsuba(const Test& test) {
  const std::vector<MitsubaBsdf> all = read_values();
  ASSERT_GE(all.size(), 27u);
  for (const MitsubaBsdf& one : all) {
    SCOPED_TRACE(one.name);
    const LoadedScene loaded = load_xml(
        "<sensor type=\"perspective\"/><emitter type=\"constant\"/>"
        "<shape type=\"rectangle\">" +
        one.xml + "</shape>");
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
    test(one, loaded.scene.materials.at(0));
  }
}

/// Mitsuba takes for Beckmann's shadowing a fit that is off by up to 0.35 % (Walter et al. 2007,
/// equation 27), for each of two directions. Else floats are what differs.
double tolerance_of(const MitsubaBsdf& one) {
  const bool beckmann = one.xml.find("type=\"rough") != std::string::npos &&
                        one.xml.find("\"ggx\"") == std::string::npos;
  return beckmann ? 7e-3 : 2e-4;
}

/// Black from behind: the path sees to that (shade_surface).
bool is_hidden(const MaterialDescription& material, const Vec3& wo) {
  return material.one_sided && wo.z < 0.0f;
}

TEST(MitsubaBsdfs, ValuesAreTheSame) {
  for_each_of_mitsuba([](const MitsubaBsdf& one, const MaterialDescription& material) {
    const double tolerance = tolerance_of(one);
    // Those have lobes that are chosen otherwise here.
    const bool same_density = one.name.find("principled") == std::string::npos;
    for (const MitsubaValue& v : one.values) {
      SCOPED_TRACE(testing::Message() << "cosines " << v.wo.z << ", " << v.wi.z);
      BsdfValue ours;
      if (!is_hidden(material, v.wo)) {
        ours = visit(material.kind, material,
                     [&](const auto& bsdf) { return bsdf.evaluate(v.wo, v.wi); });
      }
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(ours.f[c], v.f[c], tolerance * v.f[c] + 1e-6);
      if (same_density) {
        EXPECT_NEAR(ours.pdf, v.pdf, tolerance * v.pdf + 1e-6);
      }
    }
  });
}

TEST(MitsubaBsdfs, SamplesHaveTheSameMeans) {
  TestRandom random;
  for_each_of_mitsuba([&](const MitsubaBsdf& one, const MaterialDescription& material) {
    for (const MitsubaMean& expected : one.means) {
      SCOPED_TRACE(testing::Message() << "cosine " << expected.wo.z);
      if (is_hidden(material, expected.wo)) {
        EXPECT_EQ(expected.mean[0], glm::dvec3(0)) << "reflects from behind in Mitsuba";
        continue;
      }
      MeanEstimate means[2][3];
      visit(material.kind, material, [&](const auto& bsdf) {
        for (int i = 0; i < 100'000; ++i) {
          const BsdfSample s =
              bsdf.sample(expected.wo, {random.unit(), random.unit(), random.unit()});
          const int side = same_side(s.wi, expected.wo) ? 0 : 1;
          for (int c = 0; c < 3; ++c) {
            means[side][c].add(s.weight[c]);
            means[1 - side][c].add(0);
          }
        }
      });
      for (int side = 0; side < 2; ++side) {
        for (int c = 0; c < 3; ++c) {
          const double mean = expected.mean[side][c], error = expected.error[side][c];
          EXPECT_NEAR(
              means[side][c].mean(), mean,
              5 * std::hypot(error, means[side][c].sigma()) + 0.5 * tolerance_of(one) * mean + 1e-6)
              << (side == 0 ? "reflected" : "passed");
        }
      }
    }
  });
}

}  // namespace
}  // namespace pt
