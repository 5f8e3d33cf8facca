// Mitsuba's .vol.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "common/scene/load/files/volumes/volume_files.h"
#include "load/vol_bytes.h"
#include "temp_folder.h"

namespace pt {
namespace {

/// 0, 1, 2, ...
std::vector<float> counted(std::size_t count) {
  std::vector<float> values(count);
  std::iota(values.begin(), values.end(), 0.0f);
  return values;
}

void expect_refused(const VolKind& kind, const std::vector<float>& values,
                    const std::string& part) {
  expect_error([&] { decode_vol(vol_bytes(kind, values), "a.vol"); }, "cannot read a.vol: " + part);
}

TEST(VolFile, HasValuesAndABox) {
  VolKind kind;
  kind.x = 4, kind.y = 3, kind.z = 2, kind.box = {-1, -2, -3, 1, 2.5f, 3};
  for (const int channels : {1, 3}) {
    kind.channels = channels;
    const std::vector<float> values = counted(24u * static_cast<std::size_t>(channels));
    const VolFile file = decode_vol(vol_bytes(kind, values), "a.vol");
    EXPECT_EQ((std::vector<std::uint32_t>(file.grid.size, file.grid.size + 3)),
              (std::vector<std::uint32_t>{4, 3, 2}));
    EXPECT_EQ(file.grid.channels, static_cast<std::uint32_t>(channels));
    EXPECT_EQ(file.grid.values, values);
    EXPECT_EQ(file.low, Vec3(-1, -2, -3));
    EXPECT_EQ(file.high, Vec3(1, 2.5f, 3));
  }
}

// As in Mitsuba.
TEST(VolFile, MayGoOnBehindItsValues) {
  EXPECT_EQ(decode_vol(vol_bytes({}, {1, 2, 3, 4}), "a.vol").grid.values,
            (std::vector<float>{1, 2}));
}

TEST(VolFile, IsReadFromDisk) {
  const TempFolder folder;
  const std::string path = folder.file("a.vol");
  expect_error([&] { read_vol(path); }, "cannot read " + path + ": No such file");
  write_text(path, vol_bytes({}, {0.5f, 2}));
  EXPECT_EQ(read_vol(path).grid.values, (std::vector<float>{0.5f, 2}));
}

TEST(VolFile, OtherFormatsAreRefused) {
  expect_error([] { decode_vol("", "a.vol"); }, "expected 'VOL'");
  expect_error([] { decode_vol("VO", "a.vol"); }, "expected 'VOL'");
  VolKind kind;
  kind.magic = "VOX";
  expect_refused(kind, {1, 2}, "not a .vol file: expected 'VOL'");
  kind = {};
  kind.version = 2;
  expect_refused(kind, {1, 2}, "version 2 of the format, expected 3");
  for (const int encoding : {0, 2, 3, 4, -1}) {
    kind = {};
    kind.encoding = encoding;
    expect_refused(kind, {1, 2}, "encoding " + std::to_string(encoding) + ", expected 1");
  }
}

TEST(VolFile, WrongShapesAreRefused) {
  for (const int size : {0, -1, std::numeric_limits<int>::min()}) {
    VolKind kind;
    kind.y = size;
    expect_refused(kind, {1, 2}, "2 x " + std::to_string(size) + " x 1 voxels, expected at least");
  }
  for (const int channels : {0, 2, 6, -3}) {
    VolKind kind;
    kind.channels = channels;
    expect_refused(kind, counted(12), std::to_string(channels) + " channels, expected 1 or 3");
  }
}

TEST(VolFile, TruncatedOnesAreRefused) {
  const std::string good = vol_bytes({}, {1, 2});
  EXPECT_EQ(decode_vol(good, "a.vol").grid.values.size(), 2u);
  for (std::size_t size = 0; size < good.size(); ++size) {
    expect_error([&] { decode_vol(good.substr(0, size), "a.vol"); },
                 size < 3 ? "not a .vol file" : "truncated");
  }
  // Each size alone would fit.
  VolKind kind;
  kind.y = 2, kind.channels = 3;
  EXPECT_EQ(decode_vol(vol_bytes(kind, counted(12)), "a.vol").grid.values.size(), 12u);
  expect_refused(kind, counted(11), "truncated: 44 bytes of values, expected those of 2 x 2 x 1");
}

// Before anything is allocated: these would not fit into any memory.
TEST(VolFile, SizesBeyondTheFileAreRefused) {
  constexpr int huge = std::numeric_limits<int>::max();
  VolKind kind;
  kind.x = kind.y = kind.z = huge, kind.channels = 3;
  expect_refused(kind, {1, 2}, "truncated: 8 bytes of values");
  kind.x = kind.z = 1, kind.channels = 1;
  expect_refused(kind, {1, 2}, "truncated: 8 bytes of values");
  // Modulo 2^32 and 2^64 one value.
  kind.x = 1 << 30, kind.y = 1 << 30, kind.z = 1 << 4;
  expect_refused(kind, {1, 2}, "truncated: 8 bytes of values");
}

TEST(VolFile, WrongValuesAreRefused) {
  VolKind kind;
  kind.x = 2, kind.y = 5, kind.z = 3, kind.channels = 3;
  for (const float wrong :
       {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    std::vector<float> values = counted(90);
    values[3 * (1 + 2 * (3 + 5 * 2)) + 2] = wrong;
    expect_refused(kind, values, fmt::format("the value {} in voxel (1, 3, 2)", wrong));
  }
}

}  // namespace
}  // namespace pt
