// A crop window has the pixels of the whole image, bit for bit, and no others.
#include "app/options/check_options.h"
#include "common/error/error.h"
#include "film_cases.h"

namespace pt {
namespace {

Options crop_options(const Settings& more) {
  return with(with(Options(), {{"device", "cpu"},
                               {"scene", "cornell"},
                               {"width", "24"},
                               {"height", "18"},
                               {"spp", "3"},
                               {"aov", "depth,material,variance"}}),
              more);
}

TEST(Crop, HasThePixelsOfTheImage) {
  for (const std::string& mode : names_of(Mode::serial)) {
    for (const char* filter : {"box", "lanczos"}) {
      SCOPED_TRACE(std::string(mode) + ' ' + filter);
      const Options options = crop_options({{"mode", mode}, {"filter", filter}});
      const Image whole = render_options(options).image;
      const Rendered cropped = render_options(with(options, {{"crop", "5,2,16,13"}}));
      const Image& image = cropped.image;
      ASSERT_EQ(image.width, 11);
      ASSERT_EQ(image.height, 11);
      EXPECT_EQ(image.place, (ImagePlace{5, 2, 24, 18}));
      EXPECT_EQ(cropped.counts.paths, 11u * 11u * 3u);
      std::size_t differing = 0;
      for (int y = 0; y < 11; ++y) {
        for (int x = 0; x < 11; ++x) {
          const std::size_t a = static_cast<std::size_t>(y) * 11 + static_cast<std::size_t>(x);
          const std::size_t b =
              static_cast<std::size_t>(y + 2) * 24 + static_cast<std::size_t>(x + 5);
          for (std::size_t c = 0; c < 3; ++c)
            differing += image.rgb[3 * a + c] != whole.rgb[3 * b + c];
          differing += image.layers[0].values[a] != whole.layers[0].values[b];
          differing += image.layers[1].numbers[a] != whole.layers[1].numbers[b];
          differing += image.layers[2].values[a] != whole.layers[2].values[b];
        }
      }
      EXPECT_EQ(differing, 0u);
    }
  }
}

TEST(Crop, IsRefusedOutsideTheImage) {
  const auto refusal = [](const char* crop) -> std::string {
    try {
      check_crop(crop_options({{"crop", crop}}));
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(refusal("0,0,24,18"), "no error");
  EXPECT_EQ(refusal("0,0,25,18"), "--crop 0,0,25,18: expected pixels of the image of 24x18");
  EXPECT_EQ(refusal("0,18,24,19"), "--crop 0,18,24,19: expected pixels of the image of 24x18");
  for (const char* crop : {"1,2,3", "3,0,3,5", "4,0,3,5", "0,-1,3,5", "0,0,3,5,6", "0,0,3,x"}) {
    EXPECT_NE(refusal(crop).find("expected pixels x0,y0,x1,y1"), std::string::npos) << crop;
  }
}

// A film that lies outside the crop has no place in the renderer's memory.
TEST(Crop, LimitsFilms) {
  const Options options = crop_options({{"crop", "5,2,16,13"}});
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  const auto renderer = make_renderer(options, scene, device);
  Film film;
  film.window = {5, 2, 4, 11};
  EXPECT_EQ(renderer->render(film, 1, {}).samples_done, 1);
  Film outside;
  outside.window = {4, 2, 4, 11};
  EXPECT_THROW(renderer->render(outside, 1, {}), Error);
}

}  // namespace
}  // namespace pt
