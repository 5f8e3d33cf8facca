// A film of some pixels or of some samples is a part of the image's, bit for bit.
#include <functional>

#include "common/error/error.h"
#include "common/render/batches.h"
#include "film_cases.h"

namespace pt {
namespace {

class FilmWindows : public testing::TestWithParam<Settings> {
 protected:
  static Options options(const Settings& more) {
    const Settings small{{"device", "cpu"}, {"width", "19"},  {"height", "11"},
                         {"spp", "5"},      {"threads", "2"}, {"max-depth", "5"}};
    return with(with(with(Options(), small), GetParam()), more);
  }
};
INSTANTIATE_TEST_SUITE_P(Images, FilmWindows,
                         testing::Values(Settings{{"scene", "spheres"}},
                                         Settings{{"scene", "cornell"}, {"rng", "xorwow"}},
                                         Settings{{"scene", "boxes"}, {"aperture", "0.1"}}));

TEST_P(FilmWindows, MakeTheWholeInAllModes) {
  const Options serial = options({{"mode", "serial"}});
  expect_parts_make_the_whole(serial, serial);
  for (const std::string& work : names_of(Work::persistent)) {
    expect_parts_make_the_whole(options({{"mode", "megakernel"}, {"work", work}}), serial);
  }
  for (const std::string& compaction : names_of(Compaction::atomic)) {
    expect_parts_make_the_whole(
        options({{"mode", "wavefront"}, {"compaction", compaction}, {"pool-size", "100"}}), serial);
  }
}

// Another renderer, of another mode, goes on where the first was interrupted.
TEST_P(FilmWindows, AFilmIsContinued) {
  const Options serial = options({{"mode", "serial"}});
  const Rendered expected = render_options(serial);
  const DeviceInfo device = choose_device(serial.device);
  const SceneData scene = make_scene_for(serial, device);
  Film film = blank_film(serial.width, serial.height);
  const std::pair<const char*, int> steps[] = {{"serial", 1}, {"wavefront", 3}, {"megakernel", 1}};
  for (const auto& [mode, samples] : steps) {
    const auto renderer = make_renderer(options({{"mode", mode}}), scene, device);
    renderer->render(film, samples, {});
    expect_film(film, last_image(*renderer));
  }
  EXPECT_EQ(film.next_sample, 5u);
  expect_film(film, expected);
}

// The films of the first and of the last samples have what the whole has, up to rounding: these
// sums are the ones that may not be added if bits are to stay.
TEST(FilmSamples, MayBeginLater) {
  const Options options = with(
      Options(),
      {{"device", "cpu"}, {"width", "19"}, {"height", "11"}, {"spp", "6"}, {"mode", "megakernel"}});
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  const auto renderer = make_renderer(options, scene, device);
  Film whole = blank_film(19, 11), first = whole, last = whole;
  last.first_sample = last.next_sample = 2;
  renderer->render(whole, 6, {});
  renderer->render(first, 2, {});
  renderer->render(last, 4, {});
  EXPECT_EQ(last.next_sample, 6u);
  for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
    EXPECT_EQ(last.pixels[i].samples, 4u);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(first.pixels[i].sum[c] + last.pixels[i].sum[c], whole.pixels[i].sum[c], 1e-13);
    }
  }
  expect_same_counts(summarize(first.tally + last.tally), summarize(whole.tally));
}

Film film_of(const Window& window, std::uint32_t next_sample = 4) {
  Film film;
  film.window = window;
  film.next_sample = next_sample;
  film.pixels.resize(window.pixel_count());
  film.parts = {window};
  return film;
}

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(FilmMerge, RefusesWhatWouldCountTwiceOrChangeBits) {
  const auto refused = [](Film film, const Film& part) {
    return refusal([&] { merge(film, part); });
  };
  const Film left = film_of({0, 0, 4, 3});
  Film image = blank_film(8, 3);
  merge(image, left);
  EXPECT_FALSE(image.is_complete());
  EXPECT_NE(refused(image, left).find("has samples of 4x3 at 0,0"), std::string::npos);
  EXPECT_NE(refused(image, film_of({3, 2, 1, 1})).find("1x1 at 3,2"), std::string::npos);
  EXPECT_NE(refused(image, film_of({4, 0, 5, 3})).find("expected pixels of"), std::string::npos);
  EXPECT_NE(refused(image, film_of({~0u, 0, 2, 3})).find("expected pixels of"), std::string::npos);
  EXPECT_NE(refused(image, film_of({4, 0, 4, 3}, 5)).find("0 to 4 and one of 0 to 5"),
            std::string::npos);
  Film later = film_of({0, 0, 4, 3}, 8);
  later.first_sample = 4;
  EXPECT_NE(refused(left, later).find("more samples come from continuing a film"),
            std::string::npos);
  merge(image, film_of({4, 1, 4, 2}));
  EXPECT_FALSE(image.is_complete());
  merge(image, film_of({4, 0, 4, 1}));
  EXPECT_TRUE(image.is_complete());
}

TEST(FilmMerge, ARendererRefusesWhatItCannotContinue) {
  const Options options =
      with(Options(), {{"device", "cpu"}, {"width", "8"}, {"height", "3"}, {"mode", "serial"}});
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  const auto renderer = make_renderer(options, scene, device);
  const auto refused = [&](Film film, int samples = 1) {
    return refusal([&] { renderer->render(film, samples, {}); });
  };
  EXPECT_NE(refused(blank_film(9, 3)).find("expected a part of the image of 8x3"),
            std::string::npos);
  EXPECT_NE(refused(blank_film(0, 3)).find("expected a part of the image"), std::string::npos);
  EXPECT_NE(refused(blank_film(8, 3), 0).find("expected at least 1"), std::string::npos);
  Film late = blank_film(8, 3);
  late.first_sample = late.next_sample = ~0u;
  EXPECT_NE(refused(late).find("fewer than 2^32"), std::string::npos);
  Film half = blank_film(8, 3);
  merge(half, film_of({0, 0, 4, 3}));
  EXPECT_NE(refused(half).find("some lack samples"), std::string::npos);
}

std::string plan_error(int width, std::uint64_t free_bytes) {
  Options options;
  options.width = width, options.height = width, options.spp = 8;
  return refusal([&] { plan_batches(options, {"device memory", free_bytes, 32, 16, 1 << 20}); });
}

TEST(BatchPlan, FitsTheMemory) {
  Options options;
  options.width = options.height = 100, options.spp = 8;
  const auto plan = [&](std::uint64_t free_bytes, std::uint64_t paths_max) {
    return plan_batches(options, {"memory", free_bytes, 32, 16, paths_max});
  };
  EXPECT_EQ(plan(1 << 30, 1 << 20), 80000u);
  EXPECT_EQ(plan(1 << 30, 79999), 40000u) << "batches of equal size";
  EXPECT_EQ(plan(1 << 30, 1), 10000u) << "one sample at least";
  EXPECT_EQ(plan(480000, 1 << 20), 10000u) << "all that is free";
  EXPECT_EQ(plan(2 * (320000 + 4 * 160000), 1 << 20), 40000u) << "half of what is free";
  EXPECT_EQ(plan_error(100, 479999),
            "not enough device memory: an image of 100 x 100 pixels needs 0 MiB, 0 MiB are free");
  EXPECT_NE(plan_error(65535, std::uint64_t{1} << 32).find("needs 196602 MiB, 4096 MiB are free"),
            std::string::npos);
  EXPECT_EQ(plan_error(65535, ~std::uint64_t{0}),
            "--width 65535 --height 65535: expected fewer than 2^31 pixels");
}

}  // namespace
}  // namespace pt
