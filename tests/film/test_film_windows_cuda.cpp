// On a GPU a film of some pixels or of some samples is a part of the image's, bit for bit.
#include "cuda_test.h"
#include "film_cases.h"

namespace pt {
namespace {

class FilmWindowsOf : public CudaTest, public testing::WithParamInterface<Settings> {
 protected:
  static Options options(const std::string& mode, const Settings& more = {}) {
    const Settings small{{"width", "37"}, {"height", "23"}, {"spp", "5"}, {"max-depth", "5"}};
    return with(with(cuda_options(mode, small), GetParam()), more);
  }
};
INSTANTIATE_TEST_SUITE_P(Cuda, FilmWindowsOf,
                         testing::Values(Settings{{"scene", "spheres"}},
                                         Settings{{"scene", "spheres"}, {"rng", "xorwow"}},
                                         Settings{{"scene", "boxes"}, {"accel", "cwbvh"}}));

TEST_P(FilmWindowsOf, MakeTheWholeInBothModes) {
  const Options reference = options("megakernel");
  for (const std::string& work : names_of(Work::persistent)) {
    for (const char* block : {"16x16", "5x3"}) {
      expect_parts_make_the_whole(options("megakernel", {{"work", work}, {"block", block}}),
                                  reference);
    }
  }
  for (const std::string& compaction : names_of(Compaction::atomic)) {
    for (const std::string& schedule : names_of(Schedule::graph, {Schedule::automatic})) {
      for (const char* pool : {"auto", "300"}) {
        expect_parts_make_the_whole(
            options("wavefront",
                    {{"compaction", compaction}, {"schedule", schedule}, {"pool-size", pool}}),
            reference);
      }
    }
  }
}

// Windows of one size, one after the other: the graph of the first is not that of the second.
TEST_P(FilmWindowsOf, OfEqualSizeAreNotTakenForEachOther) {
  const Options options = FilmWindowsOf::options("wavefront", {{"width", "40"}, {"height", "20"}});
  const Rendered expected = render_options(options);
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  const auto renderer = make_renderer(options, scene, device);
  const std::vector<Window> quarters{
      {0, 0, 20, 10}, {20, 0, 20, 10}, {0, 10, 20, 10}, {20, 10, 10, 10}, {30, 10, 10, 10}};
  expect_film(render_windows(*renderer, options, quarters, 5), expected);
}

// A film goes from one renderer to another.
TEST_P(FilmWindowsOf, AFilmIsContinued) {
  const Options reference = options("megakernel");
  const Rendered expected = render_options(reference);
  const DeviceInfo device = choose_device(reference.device);
  const SceneData scene = make_scene_for(reference, device);
  Film film = blank_film(reference.width, reference.height);
  const std::pair<const char*, int> steps[] = {
      {"wavefront", 1}, {"megakernel", 3}, {"wavefront", 1}};
  for (const auto& [mode, samples] : steps) {
    const auto renderer = make_renderer(options(mode), scene, device);
    renderer->render(film, samples, {});
    expect_film(film, last_image(*renderer));
  }
  expect_film(film, expected);
}

}  // namespace
}  // namespace pt
