// <volume>s of heterogeneous media: what is read from files, where it lies, and where it ends.
#include <gtest/gtest.h>

#include "common/medium/sample_grid.h"
#include "common/scene/load/files/volumes/volume_files.h"
#include "load/expect_near.h"
#include "load/mitsuba_scene.h"
#include "load/nanovdb_bytes.h"
#include "load/render_loaded.h"
#include "load/vol_bytes.h"

namespace pt {
namespace {

std::string text(const char* name, const std::string& value) {
  return fmt::format("<string name='{}' value='{}'/>", name, value);
}

std::string grid_volume(const std::string& name, const std::string& file,
                        const std::string& inside = "") {
  return "<volume type='gridvolume' name='" + name + "'>" + text("filename", file) + inside +
         "</volume>";
}

std::string cloud(const std::string& inside) {
  return "<medium type='heterogeneous' name='interior'>" + inside + "</medium>";
}

std::string to_world(const std::string& steps) {
  return "<transform name='to_world'>" + steps + "</transform>";
}

/// A shape between the corners (0, 0, 0) and (1, 1, 1), which is where grids are.
const std::string unit_cube = to_world("<translate x='1' y='1' z='1'/><scale value='0.5'/>");

std::string around(const std::string& medium, const std::string& place = unit_cube) {
  return "<shape type='cube'>" + place + "<bsdf type='null'/>" + medium + "</shape>";
}

/// A folder with the grids that the tests name.
class MitsubaVolumes : public testing::Test {
 protected:
  MitsubaVolumes() {
    VolKind kind;
    write("pair.vol", kind, {1, 3});
    write("bright.vol", kind, {0.5f, 1.5f});
    write("dim.vol", kind, {0.5f, 0.25f});
    kind.x = 1;
    write("one.vol", kind, {2});
    kind.channels = 3;
    write("one_colour.vol", kind, {0.25f, 0.5f, 0.75f});
    kind = {};
    kind.x = 4, kind.y = 3, kind.z = 2, kind.channels = 3, kind.box = {-1, -2, -3, 1, 2, 3};
    std::vector<float> values;
    for (int i = 0; i < 72; ++i) values.push_back(static_cast<float>(i * 7 % 11));
    write("mixed.vol", kind, values);
    kind = {};
    kind.x = kind.y = kind.z = 3;
    values.assign(27, 0.0f);
    values[13] = 5;
    write("island.vol", kind, values);
    write_text(folder_.file("broken.vol"), vol_bytes({}, {1, 2}).substr(0, 55));
  }

  LoadedScene load(const std::string& inside) {
    write_text(path_, "<scene version='3.0.0'>\n" + inside + "\n</scene>\n");
    return load_with_warnings(path_);
  }
  SceneData load_silently(const std::string& inside) {
    const LoadedScene loaded =
        load(inside + "<emitter type='constant'/><sensor type='perspective'/>");
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
    return loaded.scene;
  }

 private:
  void write(const std::string& name, const VolKind& kind, const std::vector<float>& values) {
    write_text(folder_.file(name), vol_bytes(kind, values));
  }

  TempFolder folder_;
  const std::string path_ = folder_.file("scene.xml");
};

VolumeGrids grids_of(const SceneData& scene) {
  return {scene.grids.data(), scene.grid_values.data(), nullptr, scene.grid_nodes.data()};
}

Color extinction_at(const SceneData& scene, const Vec3& point, std::size_t medium = 0) {
  const Medium& m = scene.media.at(medium);
  if (m.is_homogeneous()) return m.extinction;
  return m.extinction * sample_grid(grids_of(scene), scene.grids.at(m.density_grid), point);
}

Color albedo_in(const SceneData& scene, const Vec3& point) {
  return albedo_at(grids_of(scene), scene.media.at(0), point);
}

// Mitsuba 3.9.1's values of these volumes, by Volume::eval.
TEST_F(MitsubaVolumes, AreMitsubas) {
  struct Known {
    Vec3 point;
    Color trilinear, nearest;
  };
  const Known all[] = {
      {{0.82f, 1.68f, 3.52f}, {9.20000f, 5.20000f, 3.40000f}, {10, 6, 2}},
      {{1.03f, 1.51f, 2.89f}, {8.80985f, 4.80985f, 0.80985f}, {9, 5, 1}},
      {{1.12f, 1.59f, 3.25f}, {8.62346f, 4.62346f, 0.62346f}, {9, 5, 1}},
      {{0.68f, 1.87f, 3.21f}, {6.10634f, 3.76356f, 7.18856f}, {6, 2, 9}},
      {{1.08f, 2.10f, 3.28f}, {3.81206f, 2.56206f, 6.81206f}, {5, 1, 8}},
      {{1.48f, 1.74f, 2.93f}, {5.80104f, 4.87705f, 7.36363f}, {7, 3, 10}},
  };
  const std::string place = to_world(
      "<scale x='0.5' y='0.3' z='0.2'/><rotate y='1' angle='30'/><translate x='1' y='2' z='3'/>");
  const std::string on_cube = to_world(
      "<scale x='0.5' y='0.6' z='0.6'/><rotate y='1' angle='30'/><translate x='1' y='2' z='3'/>");
  for (const std::string filter : {"trilinear", "nearest"}) {
    const std::string volume = grid_volume(
        "sigma_t", "mixed.vol",
        place + text("filter_type", filter) +
            "<boolean name='use_grid_bbox' value='true'/><boolean name='raw' value='true'/>");
    const SceneData scene = load_silently(around(cloud(volume + number("scale", 2)), on_cube));
    for (const Known& known : all) {
      expect_near(extinction_at(scene, known.point),
                  2.0f * (filter == "nearest" ? known.nearest : known.trilinear), 2e-4f);
    }
  }
}

TEST_F(MitsubaVolumes, HaveDefaults) {
  const SceneData scene = load_silently(around(cloud(grid_volume("sigma_t", "pair.vol"))));
  ASSERT_EQ(scene.media.size(), 1u);
  EXPECT_EQ(scene.media[0].extinction, Color(1));
  EXPECT_EQ(scene.media[0].albedo, Color(0.75f));
  EXPECT_EQ(scene.media[0].albedo_grid, no_grid);
  EXPECT_EQ(scene.media[0].phase, phase_kind_of<Isotropic>);
  expect_near(extinction_at(scene, {0.5f, 0.5f, 0.5f}), Color(2));
  expect_near(extinction_at(scene, {0.3f, 0.5f, 0.5f}), Color(1.2f));
}

TEST_F(MitsubaVolumes, MayBeAlbedos) {
  const SceneData scene =
      load_silently(around(cloud(grid_volume("albedo", "dim.vol", text("filter_type", "nearest")) +
                                 "<volume type='constvolume' name='sigma_t'>" + number("value", 4) +
                                 "</volume><phase type='hg'/>")));
  EXPECT_TRUE(scene.media.at(0).is_homogeneous());
  EXPECT_EQ(extinction_at(scene, {0.5f, 0.5f, 0.5f}), Color(4));
  EXPECT_EQ(scene.media[0].phase, phase_kind_of<HenyeyGreenstein>);
  EXPECT_EQ(albedo_in(scene, {0.2f, 0.5f, 0.5f}), Color(0.5f));
  EXPECT_EQ(albedo_in(scene, {0.8f, 0.5f, 0.5f}), Color(0.25f));
}

TEST_F(MitsubaVolumes, AnAlbedoIsAtMostOne) {
  const LoadedScene loaded =
      load(around(cloud(grid_volume("albedo", "bright.vol", "") + number("scale", 3))));
  EXPECT_EQ(loaded.count("an albedo above 1: 1 is used"), 1);
  EXPECT_EQ(albedo_in(loaded.scene, {0.9f, 0.5f, 0.5f}), Color(1));
  EXPECT_EQ(albedo_in(loaded.scene, {0.1f, 0.5f, 0.5f}), Color(0.5f));
}

TEST_F(MitsubaVolumes, OfOneVoxelAreNumbers) {
  const SceneData scene =
      load_silently(around(cloud(grid_volume("sigma_t", "one.vol") +
                                 grid_volume("albedo", "one_colour.vol") + number("scale", 3))));
  EXPECT_TRUE(scene.grids.empty());
  EXPECT_EQ(scene.media.at(0).extinction, Color(6));
  EXPECT_EQ(scene.media[0].albedo, Color(0.25f, 0.5f, 0.75f));
}

TEST_F(MitsubaVolumes, AreTheScenesOnce) {
  const std::string shared =
      "<medium type='heterogeneous' id='a'><volume type='gridvolume' id='v' "
      "name='sigma_t'>" +
      text("filename", "pair.vol") +
      "</volume></medium>"
      "<medium type='heterogeneous' id='b'><ref id='v' name='sigma_t'/>" +
      number("scale", 2) + "</medium>";
  const SceneData scene = load_silently(shared + around("<ref id='a' name='interior'/>") +
                                        around("<ref id='b' name='interior'/>") +
                                        around("<ref id='a' name='interior'/>"));
  EXPECT_EQ(scene.media.size(), 2u);
  EXPECT_EQ(scene.grids.size(), 1u);
  expect_near(extinction_at(scene, {0.5f, 0.5f, 0.5f}, 1), Color(4));
}

TEST_F(MitsubaVolumes, WhatIsNotSupportedIsReplaced) {
  const LoadedScene loaded = load(around(cloud(grid_volume(
      "sigma_t", "pair.vol", text("wrap_mode", "repeat") + text("filter_type", "cubic")))));
  EXPECT_EQ(loaded.count("wrap mode 'repeat' of a volume is not supported: clamp"), 1);
  EXPECT_EQ(loaded.count("volume filter 'cubic' is not supported: trilinear"), 1);
  EXPECT_EQ(loaded.scene.grids.size(), 1u);
  const LoadedScene constant = load(around("<medium type='homogeneous' name='interior'>" +
                                           grid_volume("albedo", "pair.vol") + "</medium>"));
  EXPECT_EQ(constant.count("a homogeneous medium of textures or grids is not supported"), 1);
  EXPECT_TRUE(constant.scene.media.empty());
}

// Mitsuba looks for collisions in the box around the grid alone.
TEST_F(MitsubaVolumes, NothingIsBeyondTheGrid) {
  const std::string large = to_world("<scale value='4'/>");
  const std::string nearest = text("filter_type", "nearest");
  const SceneData scene =
      load_silently(around(cloud(grid_volume("sigma_t", "pair.vol", nearest)), large));
  for (const float inside : {0.01f, 0.5f, 0.99f}) {
    EXPECT_EQ(extinction_at(scene, {0.01f, inside, inside}), Color(1));
    EXPECT_EQ(extinction_at(scene, {0.99f, inside, inside}), Color(3));
    for (const float outside : {-3.0f, -0.01f, 1.01f, 3.0f}) {
      EXPECT_EQ(extinction_at(scene, {outside, inside, inside}), Color(0));
      EXPECT_EQ(extinction_at(scene, {inside, outside, inside}), Color(0));
      EXPECT_EQ(extinction_at(scene, {inside, inside, outside}), Color(0));
    }
  }
  const LoadedScene trilinear = load(around(cloud(grid_volume("sigma_t", "pair.vol")), large));
  EXPECT_EQ(trilinear.count("a medium reaches beyond its grid"), 1);
  expect_near(extinction_at(trilinear.scene, {0.5f, 0.5f, 0.5f}), Color(2));
  expect_near(extinction_at(trilinear.scene, {1.25f, 0.5f, 0.5f}), Color(0));
  expect_near(extinction_at(trilinear.scene, {1.0f, 0.5f, 0.5f}), Color(1.5f));  // half of 3
  // This one ends in nothing by itself.
  EXPECT_EQ(
      load_silently(around(cloud(grid_volume("sigma_t", "island.vol")), large)).grid_values.size(),
      27u);
}

TEST_F(MitsubaVolumes, AConstantFillsABox) {
  const std::string place =
      to_world("<scale value='2'/><rotate z='1' angle='90'/><translate x='-1'/>");
  const std::string constant =
      "<volume type='constvolume' name='sigma_t'>"
      "<rgb name='value' value='0.25 0.5 1'/>" +
      place + "</volume>";
  const SceneData scene = load_silently(around(cloud(constant), to_world("<scale value='9'/>")));
  expect_near(extinction_at(scene, {-2.9f, 0.1f, 1.9f}), Color(0.25f, 0.5f, 1));
  for (const Vec3& outside : {Vec3(-3.1f, 1, 1), Vec3(-0.9f, 1, 1), Vec3(-2, -0.1f, 1),
                              Vec3(-2, 2.1f, 1), Vec3(-2, 1, -0.1f), Vec3(-2, 1, 2.1f)}) {
    EXPECT_EQ(extinction_at(scene, outside), Color(0));
  }
}

TEST_F(MitsubaVolumes, RoomIsThatOfAllShapesOfTheMedium) {
  const std::string medium = "<medium type='heterogeneous' id='m'>" +
                             grid_volume("sigma_t", "pair.vol", text("filter_type", "nearest")) +
                             "</medium>";
  const std::string of_it = "<ref id='m' name='interior'/>";
  const auto is_padded = [&](const std::string& more) {
    return load_silently(medium + around(of_it) + more).grid_values.size() > 2;
  };
  EXPECT_FALSE(is_padded(""));
  EXPECT_TRUE(is_padded(around(of_it, "")));
  EXPECT_TRUE(is_padded("<shape type='sphere'><bsdf type='null'/>" + of_it + "</shape>"));
  const std::string group = "<shape type='shapegroup' id='g'>" + around(of_it) + "</shape>";
  EXPECT_FALSE(is_padded(group + "<shape type='instance'><ref id='g'/></shape>"));
  EXPECT_TRUE(is_padded(group + "<shape type='instance'><ref id='g'/>" +
                        to_world("<translate x='0.1'/>") + "</shape>"));
  // Outside of a shape is no end.
  const SceneData outside = load_silently(
      medium + "<shape type='cube'><bsdf type='null'/><ref id='m' name='exterior'/></shape>");
  EXPECT_GT(outside.grid_values.size(), 2u);
}

// The fog of a ball of radius 1 about (3, 4, 5), which grows over 0.375, and of one beside it.
TEST_F(MitsubaVolumes, MayBeOfNanovdb) {
  if (!reads_nanovdb()) GTEST_SKIP() << "built without NanoVDB";
  const std::string place = to_world("<scale value='2'/><translate x='7'/>");
  const std::string large = to_world("<scale value='99'/>");
  const auto load_fog = [&](const char* file, const std::string& more) {
    return load_silently(around(
        cloud(grid_volume("sigma_t", nanovdb_path(file), more) + number("scale", 6)), large));
  };
  const SceneData scene = load_fog("balls.nvdb", place);
  expect_near(extinction_at(scene, {13, 9.5f, 10}), Color(4), 2e-4f);
  expect_near(extinction_at(scene, {16, 8.5f, 10}), Color(4), 2e-4f);
  EXPECT_EQ(extinction_at(scene, {7, 0, 0}), Color(0));
  // One grid of two, by name: 0.75 from the middle of a ball of radius 1.25 with larger voxels.
  const SceneData named = load_fog("two.nvdb", text("grid", "temperature"));
  expect_near(extinction_at(named, {3.25f, 4.75f, 5}), Color(4), 2e-4f);
  expect_near(extinction_at(load_fog("two.nvdb", ""), {3, 4.75f, 5}), Color(4), 2e-4f);
  const auto fails = [&](const char* file, const std::string& more, const std::string& part) {
    expect_error([&] { load(around(cloud(grid_volume("sigma_t", nanovdb_path(file), more)))); },
                 part);
  };
  fails("two.nvdb", text("grid", "smoke"), "no grid 'smoke'; expected one of: ");
  fails("level_set.nvdb", "", "scene.xml:2: cannot read ");
}

// The same image as of the same values in Mitsuba's own format.
TEST_F(MitsubaVolumes, OfNanovdbLookAsOthers) {
  if (!reads_nanovdb()) GTEST_SKIP() << "built without NanoVDB";
  const VolumeData grid = read_nanovdb(nanovdb_path("balls.nvdb"));
  VolKind kind;
  kind.x = static_cast<std::int32_t>(grid.size[0]),
  kind.y = static_cast<std::int32_t>(grid.size[1]);
  kind.z = static_cast<std::int32_t>(grid.size[2]);
  const Vec3 low = grid.to_world.point(Vec3(0)), high = grid.to_world.point(Vec3(1));
  kind.box = {low.x, low.y, low.z, high.x, high.y, high.z};
  const TempFolder folder;
  write_text(folder.file("same.vol"), vol_bytes(kind, grid.values));
  const auto means = [&](const std::string& file, const std::string& more) {
    const std::string medium = cloud(grid_volume("sigma_t", file, more) + number("scale", 2) +
                                     "<rgb name='albedo' value='0.9 0.6 0.3'/>");
    return channel_means(
        load(around(medium, to_world("<scale x='1.5' y='1.1' z='1.1'/>"
                                     "<translate x='3.4' y='4' z='5'/>")) +
             "<emitter type='constant'/><sensor type='perspective'>" + number("fov", 30) +
             to_world("<lookat origin='3.4, 4, 0' target='3.4, 4, 5' up='0, 1, 0'/>") + "</sensor>")
            .scene,
        8, 64);
  };
  const ChannelMeans ours = means(nanovdb_path("balls.nvdb"), "");
  const ChannelMeans others =
      means(folder.file("same.vol"), "<boolean name='use_grid_bbox' value='true'/>");
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(ours.of[c].mean(), others.of[c].mean(), 1e-4) << c;
    EXPECT_LT(ours.of[c].mean(), 0.99) << c;
  }
}

TEST_F(MitsubaVolumes, ErrorsNameFileAndPlace) {
  const auto expect = [&](const std::string& inside, const std::string& part) {
    expect_error([&] { load(around(cloud(inside))); }, part);
  };
  expect("<volume type='gridvolume' name='sigma_t'/>", "volume 'gridvolume' has no filename");
  expect(grid_volume("sigma_t", "none.vol"), "scene.xml:2: cannot read ");
  expect(grid_volume("sigma_t", "broken.vol"), "broken.vol: truncated: 7 bytes of values");
  expect(grid_volume("sigma_t", "pair.vol", to_world("<scale x='0'/>")), "scene.xml:2: ");
  expect(grid_volume("sigma_t", "pair.vol", text("use_grid_bbox", "yes")),
         "expected true or false");
  expect(grid_volume("sigma_t", "pair.vol") + number("scale", -1), "at least 0");
  expect(grid_volume("sigma_t", "pair.vol") + number("scale", 3e38), "expected a finite one");
}

TEST_F(MitsubaVolumes, ABoxWithoutExtentIsRefused) {
  VolKind kind;
  kind.box = {0, 1, 0, 1, 1, 1};
  const TempFolder folder;
  const std::string path = folder.file("flat.vol");
  write_text(path, vol_bytes(kind, {1, 2}));
  EXPECT_EQ(load(around(cloud(grid_volume("sigma_t", path)))).scene.grids.size(), 1u);
  expect_error(
      [&] {
        load(around(
            cloud(grid_volume("sigma_t", path, "<boolean name='use_grid_bbox' value='true'/>"))));
      },
      "the file's box goes from 1 to 1 along axis 1; expected a positive length");
}

}  // namespace
}  // namespace pt
