// Images of small scenes against those of Mitsuba 3, which scripts/mitsuba_suite rendered.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "load/mitsuba_suite.h"
#include "statistics.h"
#include "temp_folder.h"
#include "test_data.h"

namespace pt {
namespace {

std::string suite_file(const std::string& name) { return test_data("mitsuba_suite/" + name); }

/// The names of all scenes, sorted.
std::vector<std::string> suite_scenes() {
  std::vector<std::string> names;
  std::error_code missing;
  for (const auto& entry : std::filesystem::directory_iterator(suite_file(""), missing)) {
    if (entry.path().extension() == ".xml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// How far ours is from Mitsuba's: the largest differences of pixels, of tiles of 4 x 4 pixels and
/// of the image's mean, all channels.
struct Distance {
  Difference pixel, tile, mean;
  double all_tiles = 0;  ///< their squares' sum, as standard deviations of a normal distribution
  double relative_mean = 0, relative_noise = 0;  ///< of the mean: difference, its standard error

  bool is_far(double sigmas) const {
    return std::max({pixel.z, tile.z, mean.z, all_tiles}) > sigmas ||
           std::abs(relative_mean) > 0.005 + relative_noise;
  }
};

/// Floats, and the tables of both programs' filters and textures, are right to this part of a
/// value.
constexpr double rounding = 3e-4;

Distance compare(const Estimates& ours, const Estimates& theirs) {
  Distance d;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto worst = [&](const std::vector<Estimate>& x, const std::vector<Estimate>& y) {
      return worst_of(differences(x, y, rounding));
    };
    d.pixel.take(worst(ours.single(c), theirs.single(c)));
    d.tile.take(worst(ours.tiles(4, c), theirs.tiles(4, c)));
    d.all_tiles =
        std::max(d.all_tiles,
                 chi_square_sigmas(differences(ours.tiles(4, c), theirs.tiles(4, c), rounding)));
    const Estimate a = ours.mean(c), b = theirs.mean(c);
    d.mean.take(worst({a}, {b}));
    const double relative = (a.value - b.value) / b.value;
    if (std::abs(relative) > std::abs(d.relative_mean)) d.relative_mean = relative;
    d.relative_noise = std::max(d.relative_noise, std::sqrt(a.variance + b.variance) / b.value);
  }
  return d;
}

std::ostream& operator<<(std::ostream& out, const Distance& d) {
  return out << "pixel " << d.pixel << ", tile " << d.tile << ", all tiles " << d.all_tiles
             << " sigmas, mean " << d.mean << ", off by " << 100 * d.relative_mean << " %, noise "
             << 100 * d.relative_noise << " %";
}

/// Standard deviations that all pixels and tiles of all scenes together exceed once in 1000 times.
double limit() {
  constexpr std::size_t pixels = 24 * 24, tiles = pixels / 16;
  return sidak_sigmas(suite_scenes().size() * 3 * (pixels + tiles + 2));
}

class MitsubaSuite : public testing::TestWithParam<std::string> {
 protected:
  std::string xml = suite_file(GetParam() + ".xml");
  Estimates reference = read_reference(suite_file(GetParam() + ".exr"));
};

/// NaN is far from nothing: no comparison would fail.
bool is_finite(const Estimates& image) {
  return std::ranges::all_of(image.pixels, [](const auto& pixel) {
    return std::ranges::all_of(pixel, [](const Estimate& e) {
      return std::isfinite(e.value) && std::isfinite(e.variance);
    });
  });
}

/// What a scene's probe is multiplied by, for a look at what the suite would notice: 1, or the
/// environment variable PTEXP_SUITE_CHANGE. Then all scenes that have a probe must fail.
std::map<std::string, std::string> changed_probe(const std::string& xml) {
  const char* change = std::getenv("PTEXP_SUITE_CHANGE");
  const std::string text = read_text(xml), before = "name=\"probe\" value=\"";
  const std::size_t at = text.find(before);
  if (change == nullptr || at == std::string::npos) return {};
  const double value = std::stod(text.substr(at + before.size()));
  return {{"probe", std::to_string(std::stod(change) * value)}};
}

TEST_P(MitsubaSuite, SameImage) {
  ASSERT_TRUE(is_finite(reference));
  const Estimates ours = render_estimates(xml, changed_probe(xml));
  ASSERT_TRUE(is_finite(ours));
  const Distance d = compare(ours, reference);
  EXPECT_FALSE(d.is_far(limit())) << d;
  EXPECT_LT(d.relative_noise, 0.003) << "too noisy to tell";
  if (std::getenv("PTEXP_SUITE_PRINT")) std::cout << GetParam() << ": " << d << "\n";
}

INSTANTIATE_TEST_SUITE_P(, MitsubaSuite, testing::ValuesIn(suite_scenes()),
                         [](const auto& scene) { return scene.param; });

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(MitsubaSuite);

TEST(MitsubaSuiteFolder, HasScenes) { EXPECT_GE(suite_scenes().size(), 100u); }

}  // namespace
}  // namespace pt
