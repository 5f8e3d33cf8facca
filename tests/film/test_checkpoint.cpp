// Checkpoints: every bit of a film's sums comes back, any viewer sees the image, and a file that is
// damaged or none is refused.
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "checkpoint_films.h"
#include "common/error/error.h"
#include "common/film/aov.h"
#include "common/film/checkpoint.h"
#include "common/film/develop.h"
#include "temp_folder.h"

namespace pt {
namespace {

const FilmPlan checkpoint_plans[] = {
    {}, {0, true, false}, {0, false, true}, {all_aovs, true, true}};

class Checkpoints : public testing::Test {
 protected:
  std::string path() const { return folder_.file("c.exr"); }

  /// What reading a file says that differs in one attribute.
  std::string refusal(const std::string& key, const std::string& value) {
    ImageMetadata header;
    Image image = read_image_with_numbers(path(), "film.", header);
    header[key] = value;
    if (value == "(none)") header.erase(key);
    write_image(folder_.file("d.exr"), image, header);
    return error_of(folder_.file("d.exr"));
  }
  static std::string error_of(const std::string& file) {
    try {
      read_checkpoint(file);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  TempFolder folder_;
};

TEST_F(Checkpoints, KeepEveryBit) {
  for (const FilmPlan& plan : checkpoint_plans) {
    for (const Window& window : {Window{0, 0, 33, 17}, Window{5, 9, 8, 8}, Window{0, 0, 1, 1}}) {
      const ImageFilm film = random_film(window, plan, 5);
      const ImageMetadata metadata{{"ptexp.option.spp", "64"}, {"note", "x = y"}};
      write_checkpoint(path(), {film, metadata}, {}, {0, 0, 40, 40});
      const Checkpoint read = read_checkpoint(path());
      EXPECT_TRUE(is_same(read.film, film));
      EXPECT_EQ(read.metadata, metadata);
    }
  }
}

TEST_F(Checkpoints, ShowTheImageSoFar) {
  const Window window{5, 9, 8, 8};
  const ImageFilm film = random_film(window, {all_aovs, true, false}, 6);
  write_checkpoint(path(), {film, {}}, {}, {0, 0, 40, 40});
  const Image image = read_image(path()), expected = develop(film, {});
  EXPECT_EQ(image.width, 8);
  EXPECT_TRUE(same_bits(image.rgb, expected.rgb));
  for (int x = 0; x < 8; ++x) EXPECT_EQ(image.pixel(x, 1)[0], 0.0f);  // no samples there
}

// The file format, by hand: what files of other versions have. The last number is zlib's CRC-32 of
// the attributes before it.
TEST(CheckpointHeader, IsWhatItWas) {
  ImageFilm film({5, 9, 8, 7}, {0, true, false});
  film.pixels.clear(), film.moments.clear(), film.features.clear();  // their checksum is 0
  film.plan.aovs = aov_bit<aov::Albedo> | aov_bit<aov::Depth>;
  film.parts = {{{5, 9, 8, 3}, 1, 4}, {{5, 12, 6, 2}, 0, 2}};
  film.tally.rays = 100, film.tally.shadow_rays = 20, film.tally.nonfinite = 3;
  film.tally.lengths[0] = 11, film.tally.lengths[1] = 12, film.tally.lengths[127] = 13;
  ImageMetadata header{{"note", "x"}};
  add_film_header(film, header);
  std::string tally = "100 20 3 11 12";
  for (int i = 2; i < 127; ++i) tally += " 0";
  const ImageMetadata expected{{"note", "x"},
                               {"ptexp.film.format", "1"},
                               {"ptexp.film.window", "5 9 8 7"},
                               {"ptexp.film.aovs", "albedo,depth"},
                               {"ptexp.film.plan", "1 0"},
                               {"ptexp.film.parts", "5 9 8 3 1 4 5 12 6 2 0 2"},
                               {"ptexp.film.tally", tally + " 13"},
                               {"ptexp.film.checksum", "0"},
                               {"ptexp.film.header_checksum", "1669735562"}};
  EXPECT_EQ(header, expected);
  const FilmHeader read = parse_film_header(header, 8, 7);
  EXPECT_EQ(read.plan.aovs, film.plan.aovs);
  EXPECT_TRUE(read.plan.moments && !read.plan.two_signs);
  EXPECT_EQ(read.parts, film.parts);
  EXPECT_EQ(read.tally.rays, 100u);
  EXPECT_EQ(read.tally.shadow_rays, 20u);
  EXPECT_EQ(read.tally.nonfinite, 3u);
  EXPECT_EQ(read.tally.lengths[127], 13u);
}

TEST_F(Checkpoints, AreRefusedWhereTheHeaderIsWrong) {
  write_checkpoint(path(), {random_film({0, 0, 8, 8}, {}, 7), {}}, {});
  const auto expect = [&](const char* key, const char* value, const char* text) {
    const std::string said = refusal(std::string("ptexp.film.") + key, value);
    EXPECT_NE(said.find(text), std::string::npos) << key << ": " << said;
    EXPECT_NE(said.find("d.exr"), std::string::npos) << said;
  };
  EXPECT_EQ(refusal("ptexp.film.format", "1"), "");
  expect("format", "(none)", "expected a checkpoint");
  expect("format", "2", "this program reads 1");
  expect("format", "1 1", "expected 1 numbers");
  expect("window", "0 0 9 8", "the image has 8x8");
  expect("window", "0 0 99999 8", "expected 0 to 65535");
  expect("window", "(none)", "no attribute ptexp.film.window");
  expect("plan", "1 0", "no layer film.luminance_squares.high");
  expect("plan", "0 1", "no layer film.negative.sum.high");
  expect("plan", "2 0", "two numbers, 0 or 1");
  expect("plan", "(none)", "no attribute ptexp.film.plan");
  expect("aovs", "uv", "no layer film.feature_samples.high");
  expect("aovs", "uv,,uv", "no layer '' in this program");
  expect("aovs", "albido", "no layer 'albido' in this program");
  expect("parts", "0 0 8", "found 3 numbers");
  expect("parts", "0 0 8 9 0 1", "disjoint windows of the image");
  expect("parts", "0 0 8 2 0 1 0 1 8 2 0 1", "disjoint windows of the image");
  expect("parts", "0 0 8 2 3 1", "samples that ascend");
  expect("parts", "0 0 -8 2 3 1", "expected whole numbers");
  expect("tally", "1 2 3", "expected 131 numbers");
  expect("checksum", "12345", "damaged");
  EXPECT_NE(error_of(folder_.file("nothing.exr")).find("nothing.exr"), std::string::npos);
}

// A value that another program has changed, in a file that is whole.
TEST_F(Checkpoints, ChangedSumsAreRefused) {
  for (const FilmPlan& plan : checkpoint_plans) {
    write_checkpoint(path(), {random_film({0, 0, 8, 8}, plan, 10), {}}, {});
    ImageMetadata header;
    const Image image = read_image_with_numbers(path(), "film.", header);
    for (std::size_t layer = 0; layer < image.layers.size(); ++layer) {
      Image changed = image;
      changed.layers[layer].numbers[5] ^= 1;
      write_image(folder_.file("d.exr"), changed, header);
      EXPECT_NE(error_of(folder_.file("d.exr")).find("damaged"), std::string::npos)
          << image.layers[layer].name;
    }
  }
}

// Not every byte matters: where the file is read, it must be the film that was written.
TEST_F(Checkpoints, DamagedFilesAreRefused) {
  const ImageFilm film = random_film({0, 0, 24, 16}, {0, true, false}, 8);
  write_checkpoint(path(), {film, {{"a", "b"}}}, {});
  std::ifstream stream(path(), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  const std::string damaged = folder_.file("damaged.exr");
  std::mt19937 random(9);
  int refused = 0;
  const auto attempt = [&](const std::string& changed) {
    std::ofstream(damaged, std::ios::binary) << changed;
    try {
      const Checkpoint read = read_checkpoint(damaged);
      EXPECT_TRUE(same_bits(read.film.pixels, film.pixels));
      EXPECT_TRUE(same_bits(read.film.moments, film.moments));
    } catch (const Error&) {
      ++refused;
    }
  };
  for (int i = 0; i < 100; ++i) attempt(bytes.substr(0, bytes.size() * i / 100));
  EXPECT_EQ(refused, 100);
  for (int i = 0; i < 300; ++i) {
    std::string changed = bytes;
    changed[random() % changed.size()] ^= static_cast<char>(1 << random() % 8);
    attempt(changed);
  }
  EXPECT_GT(refused, 250);
}

}  // namespace
}  // namespace pt
