// What a film says of its samples: by hand, sample by sample, and after it was continued.
#include "common/film/pixel_statistics.h"
#include "common/sampling/random.h"
#include "common/scene/prepare/prepare_scene.h"
#include "film_cases.h"

namespace pt {
namespace {

// Samples of luminance 1, 2 and 6 and one that is not finite, of 4, 5, 5 and 6 rays.
TEST(PixelStatistics, ByHand) {
  FilmSums sums;
  sums.pixels = {{{9, 9, 9}, 3}};
  sums.moments = {{1 + 4 + 36, 4 + 5 + 5 + 6, 7}};
  const FilmPlan plan{0, true, false};
  const PixelFilter filter;
  const PixelStatistics found = PixelReader(sums, plan, filter, 1).statistics(0, 4);
  EXPECT_DOUBLE_EQ(found.samples, 3);
  EXPECT_NEAR(found.variance, 7.0 / 3, 1e-12);  // ((1 - 3)^2 + (2 - 3)^2 + (6 - 3)^2) / 2 / 3
  EXPECT_DOUBLE_EQ(found.bounces, 4);           // 20 rays of 4 samples, the camera's taken off
  EXPECT_DOUBLE_EQ(found.rays, 27);
}

// Three samples where a filter is positive, of luminance 1, 2 and 6, and two where it is negative,
// 1 and 3: 1.5 * 3 - 0.5 * 2, whose variance is 1.5^2 * 7 / 3 + 0.5^2 * 1.
TEST(PixelStatistics, OfTwoSignsByHand) {
  PixelFilter filter;
  filter.positive_weight = 1.5f, filter.negative_weight = 0.5f;
  const FilmPlan plan{0, true, true};
  const FilmPixel three{{9, 9, 9}, 3}, two{{4, 4, 4}, 2}, one{{8, 8, 8}, 1}, none{};
  struct Case {
    FilmPixel positive, negative;
    double value, variance, samples;
  };
  const Case cases[] = {{three, two, 3.5, 5.25 + 0.25, 5},
                        {three, none, 3, 7.0 / 3, 3},
                        {none, two, 2, 1, 2},
                        {one, two, 11, 0.25, 3},
                        {three, one, 0.5, 5.25, 4},
                        {one, none, 8, 0, 1},
                        {none, none, 0, 0, 0}};
  for (const Case& c : cases) {
    SCOPED_TRACE(testing::Message() << c.positive.samples << " and " << c.negative.samples);
    FilmSums sums;
    sums.pixels = {c.positive, c.negative};
    const auto squares = [](const FilmPixel& p) {
      return p.samples == 3 ? 41.0 : p.samples == 2 ? 10 : p.samples == 1 ? 64 : 0;
    };
    sums.moments = {{squares(c.positive), 6, 2}, {squares(c.negative), 4, 1}};
    const PixelReader reader(sums, plan, filter, 1);
    EXPECT_NEAR(reader.value(0)[1], c.value, 1e-12);
    const PixelStatistics found = reader.statistics(0, 5);
    EXPECT_NEAR(found.variance, c.variance, 1e-12);
    EXPECT_EQ(found.samples, c.samples);
    EXPECT_EQ(found.bounces, 1);  // 10 rays of 5 samples
    EXPECT_EQ(found.rays, 13);
  }
}

// Pixels of 3 and -5, variances 7 / 3 and 1 * 0.25: the mean is -1, the error that of a mean pixel.
TEST(PixelStatistics, TheRelativeErrorIsPositive) {
  PixelFilter filter;
  filter.positive_weight = 1.5f, filter.negative_weight = 0.5f;
  FilmSums sums;
  sums.pixels = {{{9, 9, 9}, 3}, {{0, 0, 0}, 1}, {{0, 0, 0}, 0}, {{20, 20, 20}, 2}};
  sums.moments = {{41, 3, 0}, {0, 1, 0}, {}, {202, 2, 0}};  // 9 and 11: 202 - 400 / 2
  const FilmPlan plan{0, true, true};
  EXPECT_NEAR(relative_error(PixelReader(sums, plan, filter, 2), 2, 3),
              std::sqrt((7.0 / 3 + 0.25) / 2) / 1, 1e-12);
}

class SignedFilm : public testing::Test {
 protected:
  SignedFilm()
      : options_(with(Options(), {{"device", "cpu"},
                                  {"scene", "cornell"},
                                  {"width", "16"},
                                  {"height", "12"},
                                  {"spp", "9"},
                                  {"max-depth", "4"},
                                  {"mode", "megakernel"},
                                  {"filter", "lanczos"},
                                  {"seed", "5"},
                                  {"output", "a.exr"},
                                  {"aov", "depth,samples,bounces,rays"}})),
        device_(choose_device(options_.device)),
        scene_(make_scene_for(options_, device_)),
        renderer_(make_renderer(options_, scene_, device_)) {}

  Film film_of(std::uint32_t first, int samples) {
    Film film = blank_film(options_.width, options_.height);
    film.first_sample = film.next_sample = first;
    renderer_->render(film, samples, {});
    return film;
  }

  Options options_;
  DeviceInfo device_;
  SceneData scene_;
  std::unique_ptr<Renderer> renderer_;
};

// Films of one sample each, whose sign is asked of the filter itself.
TEST_F(SignedFilm, KeepsTheSignsApart) {
  const Film whole = film_of(0, 9);
  const std::size_t count = whole.window.pixel_count();
  ASSERT_EQ(whole.pixels.size(), 2 * count);
  ASSERT_EQ(whole.features.size(), 2 * 2 * count);  // how many, depth
  std::vector<double> radiance(2 * count), samples(2 * count), depth(2 * count), rays(2 * count);
  for (std::uint32_t k = 0; k < 9; ++k) {
    const Film single = film_of(k, 1);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec4 u = PhiloxSource{5}.open({pack_pixel(i % 16, i / 16), k, 0}).draw(0);
      const std::size_t at = i + (scene_.filter.is_negative(u.x, u.y) ? count : 0);
      ++samples[at];
      radiance[at] += single.pixels[i].sum[1] + single.pixels[count + i].sum[1];
      depth[at] += single.features[count + i] + single.features[3 * count + i];
      rays[at] += static_cast<double>(single.moments[i].rays + single.moments[count + i].rays);
    }
  }
  double negative = 0;
  for (std::size_t i = 0; i < 2 * count; ++i) {
    const std::size_t plane = 2 * (i / count) * count + i % count;
    EXPECT_EQ(static_cast<double>(whole.pixels[i].samples), samples[i]);
    EXPECT_EQ(whole.pixels[i].sum[1], radiance[i]);
    EXPECT_EQ(whole.features[plane], samples[i]);
    EXPECT_EQ(whole.features[plane + count], depth[i]);
    EXPECT_EQ(static_cast<double>(whole.moments[i].rays), rays[i]);
    if (i >= count) negative += samples[i];
  }
  EXPECT_GT(negative, 0.1 * 9 * static_cast<double>(count));
}

// Means are over all samples of the film, not over those of its last part.
TEST_F(SignedFilm, ContinuedIsThatOfAllSamples) {
  const Film whole = film_of(0, 9);
  const Rendered expected = last_image(*renderer_);
  Film film = film_of(0, 2);
  renderer_->render(film, 3, {});
  renderer_->render(film, 4, {});
  const Rendered found = last_image(*renderer_);
  EXPECT_EQ(film.next_sample, 9u);
  EXPECT_EQ(differing_sums(film, whole), 0u);
  expect_same_counts(summarize(film.tally), expected.counts);
  expect_same_counts(found.counts, expected.counts);
  EXPECT_EQ(found.counts.paths, 9u * 16 * 12);
  ASSERT_EQ(found.image.layers.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(found.image.layers[i].values, expected.image.layers[i].values)
        << expected.image.layers[i].name;
  }
  EXPECT_EQ(found.image.rgb, expected.image.rgb);
}

}  // namespace
}  // namespace pt
