// Files that are read whole: those that change, are none, or unpack to much.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>

#include <atomic>
#include <filesystem>
#include <thread>

#include "common/scene/load/files/images/image_files.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/volumes/volume_files.h"
#include "common/scene/load/files/whole_file.h"
#include "common/scene/load/load_scene.h"
#include "load/mesh_bytes.h"
#include "temp_folder.h"

namespace pt {
namespace {

TEST(WholeFiles, HaveTheirBytes) {
  const TempFolder folder;
  std::string bytes(70'000'001, 'x');
  for (std::size_t i = 0; i < bytes.size(); i += 997) bytes[i] = static_cast<char>(i >> 8);
  write_text(folder.file("a"), bytes);
  EXPECT_TRUE(WholeFile(folder.file("a")).bytes() == bytes);
  write_text(folder.file("b"), "");
  EXPECT_TRUE(WholeFile(folder.file("b")).bytes().empty());
}

// A mapped file that becomes shorter ends the program at the next look at it (SIGBUS).
TEST(WholeFiles, MayBecomeShorterMeanwhile) {
  const TempFolder folder;
  const std::string path = folder.file("a");
  constexpr std::uintmax_t size = 20'000'000;
  write_text(path, std::string(size, 'x'));
  std::atomic<bool> goes_on = true;
  std::thread changes([&] {
    while (goes_on) std::filesystem::resize_file(path, 0), std::filesystem::resize_file(path, size);
  });
  std::size_t sum = 0;
  for (int i = 0; i < 20; ++i) {
    try {
      const WholeFile file(path);
      for (std::size_t k = 0; k < file.bytes().size(); k += 4096) sum += file.bytes()[k] == 'x';
    } catch (const Error& error) {
      EXPECT_STREQ(error.what(), "it became shorter while it was read");
    }
  }
  goes_on = false;
  changes.join();
  EXPECT_LT(sum, 20u * size);
}

TEST(WholeFiles, AreNoPipesDevicesOrFolders) {
  const TempFolder folder;
  ASSERT_EQ(::mkfifo(folder.file("pipe").c_str(), 0600), 0);
  for (const std::string& path : {folder.file("pipe"), std::string("/dev/zero"), folder.file("")}) {
    SCOPED_TRACE(path);
    const std::string reason = "cannot read " + path + ": not a regular file";
    expect_error([&] { read_ply(path); }, reason);
    expect_error([&] { read_obj(path); }, reason);
    expect_error([&] { read_serialized(path, 0); }, path + ": not a regular file");
    expect_error([&] { read_vol(path); }, reason);
    expect_error([&] { read_texture_image(path); }, reason);
    expect_error([&] { read_radiance_image(path); }, reason);
    if (reads_nanovdb()) expect_error([&] { read_nanovdb(path); }, reason);
  }
  for (const char* ending : {".ply", ".obj", ".xml", ".pbrt"}) {
    const std::string path = folder.file(std::string("a") + ending);
    ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    expect_error([&] { load_scene_file(path, {}); }, "not a regular file");
  }
}

std::string deflated(const std::string& bytes, int window_bits) {
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

TEST(PackedFiles, UnpackToAHundredTimesTheirSizeAtMost) {
  constexpr std::uint64_t always = 256u << 20;
  EXPECT_EQ(most_unpacked_bytes(0), always);
  EXPECT_EQ(most_unpacked_bytes(10'000'000), 1'000'000'000u);
  const std::string little = deflated(std::string(1'000'000, 'x'), 15);
  Inflater inflater(little);
  EXPECT_EQ(inflater.next_array<char>(1'000'000).size(), 1'000'000u);
  expect_error(
      [&] { Inflater(little).next_array<float>(always / 4 + 1); },
      "bytes unpack to more than 256 MiB; expected at most 256 MiB, or 100 bytes for each");
  // A count that the limit allows and that is a lie costs no memory.
  expect_error([&] { Inflater(little).next_array<float>(always / 4); }, "data end here");
}

TEST(PackedFiles, OfPbrtAreNoBombs) {
  const TempFolder folder;
  const std::string path = folder.file("a.pbrt");
  write_text(path, deflated("WorldBegin\n" + std::string(258u << 20, '#'), 31));
  ASSERT_LT(std::filesystem::file_size(path), 1'000'000u);
  expect_error([&] { load_scene_file(path, {}); }, "unpack to more than 256 MiB");
}

}  // namespace
}  // namespace pt
