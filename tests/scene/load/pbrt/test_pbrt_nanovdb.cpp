// pbrt's media of .nvdb files: a fog of balls whose densities are known, about (3, 4, 5).
#include <gtest/gtest.h>

#include <cmath>

#include "common/medium/sample_grid.h"
#include "common/scene/load/files/volumes/volume_files.h"
#include "common/scene/load/pbrt/scene_parts.h"
#include "load/expect_near.h"
#include "load/nanovdb_bytes.h"
#include "load/pbrt_scene.h"
#include "load/render_loaded.h"

namespace pt {
namespace {

class PbrtNanovdb : public NanovdbTest {};

std::string gas(const std::string& file, const std::string& parameters) {
  return "MakeNamedMedium \"fog\" \"string type\" \"nanovdb\" \"string filename\" \"" +
         nanovdb_path(file) + "\" " + parameters + "\n";
}

/// In a sphere about the origin, of a radius that pbrt's limits allow.
std::string world_of_gas(const std::string& medium) {
  return lit + "AttributeBegin " + medium +
         "AttributeEnd MediumInterface \"fog\" \"\" Material \"interface\" Shape \"sphere\"";
}

Color grid_value(const SceneData& scene, std::uint32_t grid, const Vec3& point) {
  return sample_grid(
      {scene.grids.data(), scene.grid_values.data(), nullptr, scene.grid_nodes.data()},
      scene.grids.at(grid), point);
}

// 0.75 from the middle of a ball of radius 1, whose fog grows over 0.375.
const Vec3 point_of_known_density(3, 4.75f, 5);
constexpr float known_density = 0.25f / 0.375f;

TEST_F(PbrtNanovdb, DensitiesAreInTheMediumsSpace) {
  const SceneData scene = load_pbrt_silently(pbrt_world(
      world_of_gas("Translate 7 0 0 Scale 2 2 2 " +
                   gas("balls.nvdb",
                       "\"rgb sigma_a\" [1 .5 0] \"rgb sigma_s\" [1 2 3] \"float scale\" 3 "
                       "\"float g\" .5"))));
  const Medium& medium = scene.media.at(0);
  expect_near(medium.extinction, Color(6, 7.5f, 9));
  expect_near(medium.albedo, Color(0.5f, 0.8f, 1));
  EXPECT_EQ(medium.phase, phase_kind_of<HenyeyGreenstein>);
  EXPECT_EQ(medium.emission, Color(0));
  const Vec3 moved(7, 0, 0);
  expect_near(grid_value(scene, medium.density_grid, 2.0f * point_of_known_density + moved),
              Color(known_density), 2e-5f);
  expect_near(grid_value(scene, medium.density_grid, 2.0f * Vec3(4.5f, 4.25f, 5) + moved),
              Color(0.25f / 0.375f), 2e-5f);
  expect_near(grid_value(scene, medium.density_grid, moved), Color(0));
}

TEST_F(PbrtNanovdb, CoefficientsAreOneUnlessTheyAreGiven) {
  const SceneData scene =
      load_pbrt_silently(pbrt_world(world_of_gas(gas("tile.nvdb", "\"float Lescale\" 2"))));
  expect_near(scene.media.at(0).extinction, Color(2));
  expect_near(scene.media[0].albedo, Color(0.5f));
  EXPECT_EQ(scene.grids.size(), 1u);  // and nothing glows
}

// Also where the film's white changes the colours that both have.
TEST_F(PbrtNanovdb, AFileInTwoPlacesIsReadAsOneGrid) {
  const auto load = [](const std::string& more) {
    const std::string parameters = "\"float Lescale\" 3 \"float temperaturescale\" 5000";
    return load_pbrt_text(
               "Film \"rgb\" \"float whitebalance\" 4000 Camera \"perspective\" WorldBegin " +
               world_of_gas(gas("two.nvdb", parameters)) + more)
        .scene;
  };
  const auto second = [](const std::string& name) {
    return "AttributeBegin Translate 7 0 0 MakeNamedMedium \"b\" \"string type\" \"nanovdb\" "
           "\"string filename\" \"" +
           nanovdb_path(name) +
           "\" \"float Lescale\" 3 "
           "\"float temperaturescale\" 5000 "
           "MediumInterface \"b\" \"\" Shape \"sphere\" AttributeEnd";
  };
  const SceneData one = load(""), two = load(second("two.nvdb"));
  ASSERT_EQ(two.grids.size(), 4u);
  EXPECT_EQ(two.grid_values, one.grid_values);
  EXPECT_EQ(two.grid_nodes.size(), one.grid_nodes.size());
  const Vec3 warm(3.25f, 4.75f, 5);
  const Color light = grid_value(one, one.media.at(0).emission_grid, warm);
  EXPECT_FALSE(is_black(light));
  for (int i = 0; i < 2; ++i) {
    expect_near(grid_value(two, two.media.at(i).emission_grid, warm + Vec3(7.0f * i, 0, 0)), light,
                1e-4f);
  }
}

// From a grid with other voxels, elsewhere: 0.75 from the middle of a ball of radius 1.25.
TEST_F(PbrtNanovdb, TemperaturesAreBlackbodies) {
  const SceneData scene = load_pbrt_silently(pbrt_world(
      world_of_gas("Translate 7 0 0 " + gas("two.nvdb",
                                            "\"float Lescale\" 3 \"float temperatureoffset\" .1 "
                                            "\"float temperaturescale\" 5000"))));
  const Medium& medium = scene.media.at(0);
  ASSERT_NE(medium.emission_grid, no_grid);
  const float kelvins = 5000 * (0.5f / 0.75f - 0.1f);
  const Color expected = 3.0f * pbrt::GlowingGas(kelvins).radiance(kelvins);
  const Color light = medium.emission * grid_value(scene, medium.emission_grid,
                                                   Vec3(3.25f, 4.75f, 5) + Vec3(7, 0, 0));
  expect_near(light / expected, Color(1), 5e-3f);
  EXPECT_EQ(grid_value(scene, medium.emission_grid, Vec3(3.25f, 5.25f, 5) + Vec3(7, 0, 0)),
            Color(0));  // its surface
  expect_near(grid_value(scene, medium.density_grid, point_of_known_density + Vec3(7, 0, 0)),
              Color(known_density), 2e-5f);
  const std::string hot = world_of_gas(gas("two.nvdb", "\"float temperaturescale\" 5000"));
  expect_near(
      load_pbrt_silently(pbrt_world(hot, "Film \"rgb\" \"float iso\" 300")).media.at(0).emission,
      3.0f * load_pbrt_silently(pbrt_world(hot)).media.at(0).emission);
  EXPECT_EQ(load_pbrt_silently(pbrt_world(world_of_gas(gas("two.nvdb", "\"float Lescale\" 0 "))))
                .media.at(0)
                .emission_grid,
            no_grid);
}

TEST_F(PbrtNanovdb, GasLightsAScene) {
  const std::string glowing = gas("two.nvdb", "\"float temperaturescale\" 5000") +
                              "MediumInterface \"fog\" \"\" Material \"interface\"\n"
                              "Shape \"sphere\"";
  EXPECT_TRUE(load_pbrt_text(pbrt_world(glowing)).warnings.empty());
}

TEST_F(PbrtNanovdb, FilesAreBesideTheScene) {
  const TempFolder folder;
  write_text(folder.file("smoke.nvdb"), nanovdb_bytes("tile.nvdb"));
  write_text(folder.file("scene.pbrt"),
             pbrt_world(world_of_gas("MakeNamedMedium \"fog\" \"string type\" \"nanovdb\" "
                                     "\"string filename\" \"smoke.nvdb\"\n")));
  EXPECT_EQ(load_pbrt_file(folder.file("scene.pbrt")).scene.grids.size(), 1u);
}

TEST_F(PbrtNanovdb, ErrorsNameThePlace) {
  const auto expect = [](const std::string& medium, const std::string& part) {
    const std::string message = pbrt_complaint(pbrt_world(world_of_gas(medium)));
    EXPECT_EQ(message.substr(0, 13), "scene.pbrt:7:") << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect("MakeNamedMedium \"fog\" \"string type\" \"nanovdb\"\n", "no 'string filename'");
  expect(gas("none.nvdb", ""), "cannot read ");
  expect(gas("level_set.nvdb", ""), "level_set.nvdb: grid 'ball': a level set, expected a fog");
  expect(gas("balls.nvdb", "\"float scale\" -1"), "at least 0");
  expect(gas("two.nvdb", "\"float temperaturescale\" 3e38 \"float temperatureoffset\" -9"),
         "a temperature of inf K");
}

// Through the middle of a ball the fog's density is that of a depth of 0.625 + 0.375 / 2, twice.
TEST_F(PbrtNanovdb, LightGetsThroughAsItShould) {
  const std::string text =
      "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n"
      "PixelFilter \"box\" Camera \"perspective\" \"float fov\" .2\nWorldBegin\n" +
      lit + "AttributeBegin Translate -3 -4 -2\n" +
      gas("balls.nvdb", "\"rgb sigma_a\" [.2 .6 1.2] \"rgb sigma_s\" [0 0 0]") +
      "AttributeEnd\nMediumInterface \"fog\" \"\" Material \"interface\"\n"
      "Translate 0 0 3 Shape \"sphere\" \"float radius\" 1.3\n";
  const ChannelMeans means = channel_means(load_pbrt_silently(text), 8, 512);
  for (int c = 0; c < 3; ++c) {
    const double expected = std::exp(-2 * (0.625 + 0.375 / 2) * std::array{0.2, 0.6, 1.2}[c]);
    EXPECT_NEAR(means.of[c].mean(), expected, 5 * means.of[c].sigma() + 1e-4) << c;
    EXPECT_LT(means.of[c].sigma(), 0.02 * expected) << c;
  }
}

}  // namespace
}  // namespace pt
