// Reconstruction filters: what is drawn from their tables is the filter, sign and all.
#include <cmath>
#include <functional>

#include "common/error/error.h"
#include "common/scene/prepare/prepare_filter.h"
#include "common/scene/prepare/prepare_scene.h"
#include "film_cases.h"

namespace pt {
namespace {

using Function = std::function<double(double)>;

double simpson(const Function& f, double a, double b) {
  constexpr int n = 4000;
  const double h = (b - a) / n;
  double sum = f(a) + f(b);
  for (int i = 1; i < n; ++i) sum += (i % 2 == 1 ? 4 : 2) * f(a + i * h);
  return sum * h / 3;
}

/// Filters as the literature writes them, each between the places where its formula changes.
struct Case {
  const char* option;
  Function f;
  std::vector<double> knots;
};

double pi_sinc(double x) { return x == 0 ? 1 : std::sin(M_PI * x) / (M_PI * x); }

double cubic(double x, double b, double c) {
  x = std::abs(x);
  const double x2 = x * x, x3 = x2 * x;
  return x < 1 ? (2 - 1.5 * b - c) * x3 + (-3 + 2 * b + c) * x2 + 1 - b / 3
               : (-b / 6 - c) * x3 + (b + 5 * c) * x2 + (-2 * b - 8 * c) * x + 4 * b / 3 + 4 * c;
}

std::vector<Case> cases() {
  return {{"box:0.75", [](double) { return 1.0; }, {-0.75, 0.75}},
          {"tent", [](double x) { return 1 - std::abs(x); }, {-1, 0, 1}},
          {"tent:1.5", [](double x) { return 1 - std::abs(x) / 1.5; }, {-1.5, 0, 1.5}},
          {"gaussian", [](double x) { return std::exp(-2 * x * x) - std::exp(-8.0); }, {-2, 2}},
          {"mitchell", [](double x) { return cubic(x, 1.0 / 3, 1.0 / 3); }, {-2, -1, 0, 1, 2}},
          {"mitchell:0:0.5", [](double x) { return cubic(x, 0, 0.5); }, {-2, -1, 0, 1, 2}},
          {"lanczos", [](double x) { return pi_sinc(x) * pi_sinc(x / 3); }, {-3, 3}},
          {"lanczos:2", [](double x) { return pi_sinc(x) * pi_sinc(x / 2); }, {-2, 2}}};
}

double integral(const Case& filter, const Function& g) {
  double sum = 0;
  for (std::size_t i = 1; i < filter.knots.size(); ++i) {
    sum +=
        simpson([&](double x) { return filter.f(x) * g(x); }, filter.knots[i - 1], filter.knots[i]);
  }
  return sum;
}

SceneData scene_with(const std::string& filter) {
  SceneData scene;
  prepare_filter(scene, *with(Options(), {{"filter", filter}}).filter);
  scene.filter.quantiles = scene.filter_quantiles.data();
  return scene;
}

// Along one axis, with numbers u side by side: the signed mean of a test function is its integral
// with the filter. The sum itself is exact; in a cell with a change of sign, or at the end of a
// filter, places are off by a part of the cell, which 1024 of equal weight keep below 5e-4 here.
TEST(Filters, DrawWhatTheyAre) {
  for (const Case& filter : cases()) {
    SCOPED_TRACE(filter.option);
    const SceneData scene = scene_with(filter.option);
    const Function tests[] = {
        [](double) { return 1.0; }, [](double x) { return x; }, [](double x) { return x * x; },
        [](double x) { return std::cos(1.3 * x); }, [](double x) { return std::cos(4 * x + 1); }};
    // u1 in the middle is where the filter is positive.
    ASSERT_FALSE(scene.filter.is_negative(0.5f, 0.5f));
    const double absolute = integral(filter, [&](double x) { return filter.f(x) < 0 ? -1 : 1; });
    const double whole = integral(filter, tests[0]);
    for (const Function& g : tests) {
      constexpr int count = 1 << 20;
      double sum = 0;
      for (int i = 0; i < count; ++i) {
        const float u = (static_cast<float>(i) + 0.5f) / count;
        const double x = double{scene.filter.offset(u)} - 0.5;
        sum += (scene.filter.is_negative(u, 0.5f) ? -1 : 1) * g(x);
      }
      EXPECT_NEAR(sum / count * absolute / whole, integral(filter, g) / whole,
                  &g == &tests[0] ? 1e-5 : 5e-4);
    }
  }
}

// Over the plane the weights of the two signs are those of f(x) f(y).
TEST(Filters, WeighTheirSigns) {
  for (const Case& filter : cases()) {
    SCOPED_TRACE(filter.option);
    const SceneData scene = scene_with(filter.option);
    const double absolute = integral(filter, [&](double x) { return filter.f(x) < 0 ? -1 : 1; });
    const double whole = integral(filter, [](double) { return 1.0; });
    const double ratio = absolute * absolute / (whole * whole);
    EXPECT_NEAR(scene.filter.positive_weight, 0.5 * (ratio + 1), 1e-5);
    EXPECT_NEAR(scene.filter.negative_weight, 0.5 * (ratio - 1), 1e-5);
    int negative = 0;
    constexpr int side = 1000;
    for (int i = 0; i < side * side; ++i) {
      negative += scene.filter.is_negative((i % side + 0.5f) / side, (i / side + 0.5f) / side);
    }
    EXPECT_NEAR(negative / double{side * side}, 0.5 * (ratio - 1) / ratio, 2e-3);
  }
}

TEST(Filters, ABoxOfOnePixelIsNoFilter) {
  const SceneData scene = scene_with("box");
  EXPECT_EQ(scene.filter.has_table, 0u);
  EXPECT_EQ(scene.filter.offset(0.3f), 0.3f);
  EXPECT_EQ(render_options(with(Options(), {{"device", "cpu"},
                                            {"width", "8"},
                                            {"height", "8"},
                                            {"spp", "2"},
                                            {"filter", "box"}}))
                .image.rgb,
            render_options(
                with(Options(), {{"device", "cpu"}, {"width", "8"}, {"height", "8"}, {"spp", "2"}}))
                .image.rgb);
}

TEST(Filters, AreRefusedWithBadParameters) {
  EXPECT_NE(refusal_of({{"filter", "sinc"}}).find("--filter sinc: expected one of box, tent"),
            std::string::npos);
  EXPECT_NE(refusal_of({{"filter", "lanczos:2.5"}}).find("expected lanczos:LOBES"),
            std::string::npos);
  EXPECT_NE(refusal_of({{"filter", "tent:1:2"}}).find("expected tent:RADIUS"), std::string::npos);
  EXPECT_NE(refusal_of({{"filter", "gaussian:0"}}).find("expected gaussian:DEV"),
            std::string::npos);
  SceneData scene;
  EXPECT_THROW(prepare_filter(scene, {FilterKind::mitchell, 100.0f, 100.0f}), Error);
  EXPECT_NE(refusal_of({{"filter", "lanczos"}, {"rng", "xorwow"}, {"device", "cpu"}, {"spp", "1"}})
                .find("--rng xorwow: its numbers cannot be drawn twice"),
            std::string::npos);
}

class FilteredImages : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Kinds, FilteredImages, testing::ValuesIn(names_besides(FilterKind::box)));

Options small(const std::string& filter) {
  return with(Options(), {{"device", "cpu"},
                          {"scene", "cornell"},
                          {"width", "17"},
                          {"height", "11"},
                          {"spp", "9"},
                          {"threads", "2"},
                          {"max-depth", "4"},
                          {"filter", filter}});
}

TEST_P(FilteredImages, AreTheSameInAllModesAndOfParts) {
  const Options serial = with(small(GetParam()), {{"mode", "serial"}});
  for (const std::string& mode : names_of(Mode::serial)) {
    expect_parts_make_the_whole(with(serial, {{"mode", mode}}), serial);
  }
}

// White light from everywhere and nothing else: the filter's weights are 1 in every pixel, however
// few samples there are.
TEST_P(FilteredImages, OfAConstantAreConstant) {
  for (const char* spp : {"1", "2", "7", "64"}) {
    Options options = with(small(GetParam()), {{"spp", spp}});
    SceneData scene;
    scene.name = "white";
    scene.sky.nadir = scene.sky.zenith = Color(1.0f);
    scene.camera.look_from = {0, 0, 10};
    scene.camera.look_at = {0, 0, 11};
    scene.add_sphere({0, 0, 0}, 1.0f, scene.add_material(make_diffuse(Color(0.5f))));
    prepare_scene(scene, options);
    const auto renderer = make_renderer(options, scene, choose_device(options.device));
    for (const float value : take_image(*renderer).image.rgb) ASSERT_NEAR(value, 1.0f, 1e-6f);
  }
}

// Stripes that shine, seen without noise but for where a pixel's samples lie: the image is that of
// a box of a 32nd of a pixel, convolved with the filter by hand.
TEST_P(FilteredImages, AreConvolutions) {
  constexpr int width = 12, fine = 32;
  const auto stripes = [](int columns, int rows, const Settings& more) {
    Options options = with(Options(), {{"device", "cpu"},
                                       {"mode", "megakernel"},
                                       {"max-depth", "1"},
                                       {"width", std::to_string(columns)},
                                       {"height", std::to_string(rows)}});
    apply(options, more);
    SceneData scene;
    scene.name = "stripes";
    scene.sky.nadir = scene.sky.zenith = Color(0.0f);
    scene.camera.look_from = {0, 0, 6};
    for (const auto& [x, w, y, h] : {std::array<float, 4>{-1.5f, 0.3f, -2, 4},
                                     {-0.8f, 0.1f, -2, 4},
                                     {0.2f, 0.8f, -2, 1.9f},
                                     {1.3f, 0.15f, -2, 4}}) {
      scene.add_quad({x, y, 0}, {w, 0, 0}, {0, h, 0},
                     scene.add_material(make_diffuse(Color(0.0f), Color(1.0f))));
    }
    prepare_scene(scene, options);
    return take_image(*make_renderer(options, scene, choose_device(options.device))).image;
  };
  const Image box = stripes(width * fine, width * fine, {{"spp", "16"}});
  const FilterChoice filter = *with(Options(), {{"filter", GetParam()}}).filter;
  const Image image = stripes(width, width, {{"spp", "20000"}, {"filter", GetParam()}});
  const int radius = static_cast<int>(filter_radius(filter) * fine);
  std::vector<double> weights;
  double total = 0;
  for (int k = -radius; k < radius; ++k) {
    weights.push_back(filter_value(filter, (k + 0.5) / fine));
    total += weights.back();
  }
  // Six standard deviations of 20,000 samples of 0 or 1: those of the two signs, n P / (P + N) and
  // n N / (P + N), have a variance of at most (P + N)^2 / 4 n in P a - N b.
  const SceneData weighed = scene_with(GetParam());
  const double spread =
      0.5 * (weighed.filter.positive_weight + weighed.filter.negative_weight) / std::sqrt(20000.0);
  int compared = 0;
  for (int y = 3; y < width - 3; ++y) {
    for (int x = 3; x < width - 3; ++x) {
      double sum = 0;
      for (int j = -radius; j < radius; ++j) {
        for (int i = -radius; i < radius; ++i) {
          sum += weights[static_cast<std::size_t>(j + radius)] *
                 weights[static_cast<std::size_t>(i + radius)] *
                 box.pixel(x * fine + fine / 2 + i, y * fine + fine / 2 + j)[0];
        }
      }
      EXPECT_NEAR(image.pixel(x, y)[0], sum / (total * total), 6 * spread) << x << ' ' << y;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 36);
}

}  // namespace
}  // namespace pt
