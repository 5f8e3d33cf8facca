// NanoVDB's files, by vdb_tool of OpenVDB: fogs of balls, whose values are known.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/scene/load/files/volumes/volume_files.h"
#include "load/expect_near.h"
#include "load/nanovdb_bytes.h"

namespace pt {
namespace {

class NanovdbFile : public NanovdbTest {};

/// The fog of a ball is 1 from a depth of three voxels on and 0 at its surface.
float fog_of_ball(const Vec3& point, const Vec3& middle, float radius, float voxel) {
  return glm::clamp((radius - glm::length(point - middle)) / (3 * voxel), 0.0f, 1.0f);
}

float fog_of_balls(const Vec3& point) {
  return std::max(fog_of_ball(point, {3, 4, 5}, 1, 0.125f),
                  fog_of_ball(point, {4, 4.25f, 5}, 0.75f, 0.125f));
}

template <class Fog>
void expect_fog(const VolumeData& grid, float tolerance, Fog&& fog) {
  auto value = grid.values.begin();
  const Vec3 size(grid.size[0], grid.size[1], grid.size[2]);
  for (std::uint32_t k = 0; k < grid.size[2]; ++k) {
    for (std::uint32_t j = 0; j < grid.size[1]; ++j) {
      for (std::uint32_t i = 0; i < grid.size[0]; ++i, ++value) {
        const Vec3 point = grid.to_world.point((Vec3(i, j, k) + 0.5f) / size);
        ASSERT_NEAR(*value, fog(point), tolerance) << i << " " << j << " " << k;
      }
    }
  }
  EXPECT_EQ(value, grid.values.end());
}

std::vector<std::uint32_t> size_of(const VolumeData& grid) { return {grid.size, grid.size + 3}; }

VolumeData decode(const UnpackedNanovdb& file, const std::string& grid = {}) {
  return decode_nanovdb(file.bytes, grid, "a.nvdb");
}

void expect_refused(const std::string& bytes, const std::string& part) {
  expect_error([&] { decode_nanovdb(bytes, "", "a.nvdb"); }, "cannot read a.nvdb: ");
  expect_error([&] { decode_nanovdb(bytes, "", "a.nvdb"); }, part);
}

TEST_F(NanovdbFile, HasValuesInTheirPlace) {
  for (const char* name : {"balls.nvdb", "balls_blosc.nvdb"}) {
    const VolumeData grid = read_nanovdb(nanovdb_path(name));
    EXPECT_EQ(size_of(grid), (std::vector<std::uint32_t>{23, 17, 17}));  // a rim of zeros included
    EXPECT_EQ(grid.channels, 1u);
    EXPECT_TRUE(grid.interpolates);
    expect_near(grid.to_world.point(Vec3(0)), Vec3(1.9375f, 2.9375f, 3.9375f));
    expect_near(grid.to_world.point(Vec3(1)), Vec3(4.8125f, 5.0625f, 6.0625f));
    expect_fog(grid, 2e-5f, fog_of_balls);
  }
}

// The map is world = matrix index + vector, the matrix row by row (nanovdb::Map::applyMap). This
// one turns, scales, shears and mirrors, so that neither its transpose nor its inverse will do.
TEST_F(NanovdbFile, LiesWhereItsMapTurnsIt) {
  UnpackedNanovdb file("balls.nvdb");
  const VolumeData plain = decode(file);
  constexpr std::size_t vector_at = UnpackedNanovdb::matrix_at + 2 * 9 * sizeof(double);
  Vec3 origin;
  for (int i = 0; i < 3; ++i) {
    origin[i] = static_cast<float>(file.at<double>(file.grid + vector_at + std::size_t{8} * i));
  }
  constexpr double matrix[3][3] = {{0.0, -0.25, 0.0}, {0.125, 0.0, 0.5}, {0.0625, 0.0, -1.0}};
  constexpr double vector[3] = {10, -20, 30};
  for (std::size_t i = 0; i < 3; ++i) {
    file.put(file.grid + vector_at + 8 * i, vector[i]);
    for (std::size_t j = 0; j < 3; ++j) {
      file.put(file.grid + UnpackedNanovdb::matrix_at + 8 * (3 * i + j), matrix[i][j]);
    }
  }
  const VolumeData turned = decode(file.without_checksum());
  EXPECT_EQ(turned.values, plain.values);
  EXPECT_EQ(size_of(turned), size_of(plain));
  for (const Vec3& corner : {Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1)}) {
    const Vec3 index = (plain.to_world.point(corner) - origin) / 0.125f;
    Vec3 expected;
    for (int i = 0; i < 3; ++i) {
      expected[i] = static_cast<float>(matrix[i][0] * index.x + matrix[i][1] * index.y +
                                       matrix[i][2] * index.z + vector[i]);
    }
    EXPECT_LT(glm::length(turned.to_world.point(corner) - expected), 1e-4f);
  }
}

TEST_F(NanovdbFile, MayBeQuantized) {
  for (const auto& [name, tolerance] :
       {std::pair{"fp4", 0.5f / 15}, {"fp8", 0.5f / 255}, {"fp16", 0.5f / 65535}, {"fpn", 0.01f}}) {
    SCOPED_TRACE(name);
    const VolumeData grid = read_nanovdb(nanovdb_path(fmt::format("balls_{}.nvdb", name)));
    EXPECT_EQ(size_of(grid), (std::vector<std::uint32_t>{23, 17, 17}));
    expect_fog(grid, tolerance + 2e-5f, fog_of_balls);
  }
}

// Its middle is a tile of 8^3 voxels, which no leaf has.
TEST_F(NanovdbFile, HasTiles) {
  const VolumeData grid = read_nanovdb(nanovdb_path("tile.nvdb"));
  EXPECT_EQ(size_of(grid), (std::vector<std::uint32_t>{26, 26, 26}));
  expect_fog(grid, 2e-5f,
             [](const Vec3& p) { return fog_of_ball(p, Vec3(4.4375f), 1.5f, 0.125f); });
}

TEST_F(NanovdbFile, HasGridsOfAName) {
  const std::string path = nanovdb_path("two.nvdb");
  expect_fog(read_nanovdb(path), 2e-5f, fog_of_balls);
  expect_fog(read_nanovdb(path, "temperature"), 2e-5f, [](const Vec3& p) {
    return fog_of_ball(p, {3.25f, 4, 5}, 1.25f, 0.25f);
  });
  EXPECT_TRUE(has_nanovdb_grid(path, "temperature"));
  EXPECT_FALSE(has_nanovdb_grid(path, "smoke"));
  expect_error([&] { read_nanovdb(path, "smoke"); },
               path + ": no grid 'smoke'; expected one of: 'temperature', 'density'");
  // The only one is taken for what has no name, but not for another.
  EXPECT_FALSE(read_nanovdb(nanovdb_path("tile.nvdb")).values.empty());
  expect_error([] { read_nanovdb(nanovdb_path("tile.nvdb"), "density"); },
               "no grid 'density'; expected one of: 'smoke'");
}

TEST_F(NanovdbFile, HasARimWhereItDoesNotEndInNothing) {
  UnpackedNanovdb file("balls.nvdb");
  file.without_checksum();
  const auto leaves = file.at<std::uint32_t>(file.grid + 672 + 32);
  constexpr std::size_t head = 96, length = 512 * sizeof(float);
  for (std::size_t i = 0; i < leaves; ++i) {
    file.bytes.replace(file.leaf + i * (head + length) + head, length, length, '\0');
  }
  const VolumeData grid = decode(file);
  EXPECT_EQ(size_of(grid), (std::vector<std::uint32_t>{21, 15, 15}));
}

// That of the headers at hand has other magic numbers and checksums than later ones, whose grids
// are laid out alike.
TEST_F(NanovdbFile, MayBeOfALaterVersion) {
  UnpackedNanovdb file("balls.nvdb");
  constexpr std::uint32_t version = 32u << 21 | 7u << 10;
  file.bytes.replace(0, 8, "NanoVDB2"), file.bytes.replace(file.grid, 8, "NanoVDB1");
  file.put(UnpackedNanovdb::version_at, version);
  file.put(file.grid + UnpackedNanovdb::grid_version_at, version);
  expect_fog(decode(file), 2e-5f, fog_of_balls);
}

TEST_F(NanovdbFile, OtherFormatsAreRefused) {
  expect_refused("", "expected 'NanoVDB'");
  expect_refused("NanoVDB", "expected 'NanoVDB'");
  expect_refused(std::string(1000, 'a'), "expected 'NanoVDB'");
  expect_refused(std::string(" BDV\0\0\0\0", 8) + std::string(100, '\0'),
                 "a file of OpenVDB, expected one of NanoVDB: 'vdb_tool -read a.vdb");
  expect_error([] { read_nanovdb("/nowhere/a.nvdb"); },
               "cannot read /nowhere/a.nvdb: No such file");
  UnpackedNanovdb file("balls.nvdb");
  expect_refused(UnpackedNanovdb(file).put<std::uint16_t>(UnpackedNanovdb::codec_at, 7).bytes,
                 "codec 7, expected 0, 1 or 2");
  expect_refused(
      UnpackedNanovdb(file).put(UnpackedNanovdb::version_at, 31u << 21 | 2u << 10 | 3).bytes,
      "version 31.2.3 of the format, expected 32");
  expect_refused(
      UnpackedNanovdb(file).put(file.grid + UnpackedNanovdb::grid_version_at, 33u << 21).bytes,
      "version 33.0.0 of the format, expected 32");
}

TEST_F(NanovdbFile, OtherGridsAreRefused) {
  expect_refused(nanovdb_bytes("level_set.nvdb"),
                 "grid 'ball': a level set, expected a fog volume: 'vdb_tool");
  expect_refused(nanovdb_bytes("vectors.nvdb"), "values of type Vec3f, expected floats");
  UnpackedNanovdb file("balls.nvdb");
  file.without_checksum();
  expect_refused(UnpackedNanovdb(file).put(file.root + 28, 0.5f).bytes,
                 "a background of 0.5, expected 0");
  expect_refused(UnpackedNanovdb(file).put(file.root + 24, 0u).bytes, "no active voxels");
  expect_refused(UnpackedNanovdb(file).put(file.grid + UnpackedNanovdb::matrix_at, 0.0).bytes,
                 "a map to the world that has no inverse");
  // The root's only entry becomes a tile: its child's offset, its state and its value.
  UnpackedNanovdb huge = file;
  huge.put<std::int64_t>(file.root + 72, 0).put(file.root + 80, 1u).put(file.root + 84, 1.0f);
  expect_error([&] { decode_nanovdb(huge.bytes, "", "a.nvdb", VolumeStorage::dense); },
               "4098 x 4098 x 4098 voxels around its active ones, expected at most");
  EXPECT_TRUE(decode(huge).is_sparse());
}

TEST_F(NanovdbFile, OtherValuesAreRefused) {
  for (const float value : {-1.0f, std::nanf(""), std::numeric_limits<float>::infinity()}) {
    UnpackedNanovdb file("balls.nvdb");
    file.without_checksum();
    for (std::size_t voxel = 0; voxel < 512; ++voxel) file.put(file.leaf + 96 + 4 * voxel, value);
    expect_refused(file.bytes, fmt::format("the value {} in voxel (", value));
    expect_refused(file.bytes, "expected finite ones, at least 0");
  }
}

TEST_F(NanovdbFile, TruncatedOnesAreRefused) {
  for (const char* name : {"balls.nvdb", "balls_blosc.nvdb"}) {
    const std::string bytes = nanovdb_bytes(name);
    for (std::size_t size = 8; size < bytes.size(); size += 1 + size / 100) {
      expect_refused(bytes.substr(0, size), "truncated: ");
    }
    expect_refused(bytes + "more of it", "expected the end or 'NanoVDB' behind its grids");
  }
}

TEST_F(NanovdbFile, DamagedOnesAreRefused) {
  std::string zip = nanovdb_bytes("balls.nvdb"), blosc = nanovdb_bytes("balls_blosc.nvdb");
  zip[1500] ^= 4, blosc[5000] ^= 4;
  expect_refused(zip, "bytes packed by zip");
  expect_refused(blosc, "grid 'density': damaged: ");
  // A grid that is said to be larger than its bytes could tell.
  std::string large = nanovdb_bytes("balls.nvdb");
  large[16 + 6] = 1;
  expect_refused(large, "expected those of a grid of");
  // The head has a checksum, and the nodes where the file was made so.
  const UnpackedNanovdb file("balls.nvdb"), full("balls_fp16.nvdb");
  EXPECT_EQ(decode(full).values, read_nanovdb(nanovdb_path("balls_fp16.nvdb")).values);
  expect_refused(UnpackedNanovdb(file).put(file.grid + 600, 1).bytes, "its checksum is another");
  expect_refused(UnpackedNanovdb(full).put(full.leaf + 300, 1).bytes, "its checksum is another");
  expect_refused(UnpackedNanovdb(file).put(file.grid, 1).bytes,
                 "expected 'NanoVDB' where it begins");
}

// What is written into one would change another, which has been checked.
TEST_F(NanovdbFile, NodesThatOverlapAreRefused) {
  UnpackedNanovdb file("balls.nvdb");
  file.without_checksum();
  const std::size_t at = file.first_child(file.lower, 4096);
  const auto offset = file.at<std::int64_t>(at);
  for (const std::int64_t other : {offset + 32, offset - 32, std::int64_t{0}}) {
    expect_refused(UnpackedNanovdb(file).put(at, other).bytes, "damaged: nodes used twice");
  }
}

TEST_F(NanovdbFile, NodesElsewhereAreRefused) {
  UnpackedNanovdb file("balls.nvdb");
  file.without_checksum();
  const std::size_t offsets[] = {file.root + 72, file.first_child(file.upper, 32768),
                                 file.first_child(file.lower, 4096)};
  for (const std::size_t at : offsets) {
    const auto offset = file.at<std::int64_t>(at);
    for (const std::int64_t other :
         {offset + 1, -offset * 1000, std::int64_t{1} << 40, std::int64_t{1} << 62,
          std::numeric_limits<std::int64_t>::min(),
          static_cast<std::int64_t>(file.bytes.size()) - 64}) {
      expect_refused(UnpackedNanovdb(file).put(at, other).bytes, "a node outside of its grid");
    }
  }
  expect_refused(UnpackedNanovdb(file).put(file.root + 24, 0xffffffffu).bytes,
                 "a node outside of its grid");
  expect_refused(UnpackedNanovdb(file).put(file.grid + 672 + 24, std::uint64_t{1} << 40).bytes,
                 "a node outside of its grid");
  for (const std::int64_t root : {-672, -640, 0, 32}) {
    expect_refused(UnpackedNanovdb(file).put(file.grid + 672 + 24, root).bytes,
                   "damaged: a root in its grid's head");
  }
  // All of the upper node's entries become the same child.
  UnpackedNanovdb cyclic = file;
  const std::size_t first = file.first_child(file.upper, 32768), table = file.upper + 8256;
  for (std::size_t n = 0; n < 32768; ++n) {
    const auto child = static_cast<std::int64_t>(file.lower - file.upper);
    cyclic.put(table + 8 * n, child);
    cyclic.put<std::uint8_t>(file.upper + 32 + 4096 + n / 8, 0xff);
  }
  EXPECT_LT(first, table + 8 * 32768);
  expect_refused(cyclic.bytes, "nodes used twice");
}

}  // namespace
}  // namespace pt
