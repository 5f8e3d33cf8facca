// A checkpoint that says what cannot be, or not what was written, is refused; a write that fails
// leaves the one before.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <zlib.h>

#include <csignal>

#include "checkpoint_films.h"
#include "common/film/checkpoint.h"
#include "common/film/develop.h"
#include "temp_folder.h"

namespace pt {
namespace {

const ImageMetadata metadata{{"ptexp.option.spp", "64"}, {"ptexp.scene_hash", "0123456789abcdef"}};

class DamagedCheckpoints : public testing::Test {
 protected:
  std::string path() const { return folder_.file("c.exr"); }

  /// Writes the file again with another value of an attribute, and checksums that agree with it.
  void change(const std::string& key, const std::string& value) {
    ImageMetadata header;
    const Image image = read_image_with_numbers(path(), "film.", header);
    header[key] = value;
    header.erase("ptexp.film.header_checksum");
    uLong sum = 0;
    for (const auto& [name, text] : header) {
      for (const std::string& s : {name, text}) {
        sum =
            crc32(sum, reinterpret_cast<const Bytef*>(s.c_str()), static_cast<uInt>(s.size() + 1));
      }
    }
    header["ptexp.film.header_checksum"] = std::to_string(sum);
    write_image(path(), image, header);
  }

  TempFolder folder_;
};

TEST_F(DamagedCheckpoints, AnyByteOfTheHeaderCounts) {
  const ImageFilm film = random_film({2, 1, 5, 4}, {aov_bit<aov::Depth>, false, false}, 1);
  write_checkpoint(path(), {film, metadata}, {}, {0, 0, 30, 40});
  const std::string bytes = read_text(path());
  const std::size_t end = bytes.find("screenWindowWidth");
  ASSERT_LT(end, bytes.size());
  for (std::size_t i = 0; i < end; ++i) {
    std::string changed = bytes;
    changed[i] =
        static_cast<char>(static_cast<unsigned char>(changed[i]) ^ (i % 2 ? 0x01u : 0x80u));
    write_text(path(), changed);
    try {
      const Checkpoint read = read_checkpoint(path());
      EXPECT_TRUE(is_same(read.film, film)) << "byte " << i << ", " << bytes.substr(i, 20);
      EXPECT_EQ(read.metadata, metadata) << "byte " << i;
    } catch (const Error&) {
    }
  }
}

TEST_F(DamagedCheckpoints, AChangedAttributeIsNamedDamage) {
  write_checkpoint(path(), {random_film({0, 0, 4, 4}, {}, 2), metadata}, {});
  ImageMetadata header;
  const Image image = read_image_with_numbers(path(), "film.", header);
  for (const char* key : {"ptexp.option.spp", "ptexp.film.parts", "ptexp.film.tally"}) {
    ImageMetadata changed = header;
    std::string& text = changed[key];
    text.back() = text.back() == '7' ? '8' : '7';
    write_image(path(), image, changed);
    expect_error([&] { read_checkpoint(path()); }, path());
    expect_error([&] { read_checkpoint(path()); }, "header_checksum");
  }
}

// What has statistics among its layers is developed from moments.
TEST_F(DamagedCheckpoints, StatisticsNeedMoments) {
  write_checkpoint(path(), {random_film({0, 0, 4, 4}, {}, 3), metadata}, {});
  change("ptexp.film.aovs", "variance");
  expect_error([&] { read_checkpoint(path()); }, "ptexp.film.plan");
}

TEST_F(DamagedCheckpoints, APixelHasNoMoreSamplesThanItsWindow) {
  for (const bool two_signs : {false, true}) {
    ImageFilm film = random_film({0, 0, 6, 1}, {0, false, two_signs}, 4);
    for (FilmPixel& pixel : film.pixels) pixel.samples = two_signs ? 2 : 4;
    write_checkpoint(path(), {film, metadata}, {});
    EXPECT_TRUE(is_same(read_checkpoint(path()).film, film));
    change("ptexp.film.parts", "0 0 6 1 0 3");
    expect_error([&] { read_checkpoint(path()); }, "pixel 0,0");
    expect_error([&] { read_checkpoint(path()); }, "expected 3");
    film.pixels.back().samples = ~std::uint64_t{0};  // with the other sign's the sum would be 1
    expect_error([&] { write_checkpoint(path(), {film, metadata}, {}); }, "pixel 5,0");
  }
}

// Samples that were cleared leave their sums behind.
TEST_F(DamagedCheckpoints, PixelsWithoutSamplesMayHaveAnySums) {
  ImageFilm film = random_film({0, 0, 6, 3}, {}, 5);
  film.clear();
  write_checkpoint(path(), {film, metadata}, {});
  EXPECT_TRUE(is_same(read_checkpoint(path()).film, film));
}

// In a time that does not grow with the square of their number.
TEST_F(DamagedCheckpoints, EveryPixelAWindow) {
  ImageFilm film({0, 0, 300, 300}, {});
  for (std::uint32_t y = 0; y < 300; ++y) {
    for (std::uint32_t x = 0; x < 300; ++x) film.parts.push_back({{x, y, 1, 1}, 0, x + y});
  }
  write_checkpoint(folder_.file("few.exr"), {ImageFilm({0, 0, 300, 300}, {}), metadata}, {});
  ImageMetadata header;
  const Image image = read_image_with_numbers(folder_.file("few.exr"), "film.", header);
  std::string parts;
  for (const FilmPart& p : film.parts) {
    parts += (parts.empty() ? "" : " ") + std::to_string(p.window.x) + ' ' +
             std::to_string(p.window.y) + " 1 1 0 " + std::to_string(p.next_sample);
  }
  write_image(path(), image, header);
  change("ptexp.film.parts", parts);
  EXPECT_EQ(read_checkpoint(path()).film.parts, film.parts);
  change("ptexp.film.parts", parts + " 299 299 1 1 0 1");
  expect_error([&] { read_checkpoint(path()); }, "disjoint");
}

TEST_F(DamagedCheckpoints, AWriteThatFailsLeavesTheOldOne) {
  const ImageFilm old = random_film({0, 0, 20, 20}, {0, true, true}, 6);
  write_checkpoint(path(), {old, metadata}, {});
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit full{1000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &full);
  expect_error(
      [&] {
        write_checkpoint(path(), {random_film({0, 0, 20, 20}, {}, 7), metadata}, {});
      },
      path());
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_TRUE(is_same(read_checkpoint(path()).film, old));
  EXPECT_EQ(folder_.entries(), std::vector<std::string>{"c.exr"});
}

TEST_F(DamagedCheckpoints, ACropKeepsItsPlaceInTheImage) {
  const ImageFilm film = random_film({5, 9, 8, 7}, {}, 8);
  write_checkpoint(path(), {film, metadata}, {}, {0, 0, 40, 30});
  const std::string bytes = read_text(path());
  const auto box = [&](const std::string& name) {
    const std::string key = name + std::string("\0box2i\0\x10\0\0\0", 11);
    std::int32_t values[4];
    std::memcpy(values, bytes.data() + bytes.find(key) + key.size(), sizeof values);
    return std::vector<int>(values, values + 4);
  };
  EXPECT_EQ(box("dataWindow"), (std::vector<int>{5, 9, 12, 15}));
  EXPECT_EQ(box("displayWindow"), (std::vector<int>{0, 0, 39, 29}));
}

}  // namespace
}  // namespace pt
