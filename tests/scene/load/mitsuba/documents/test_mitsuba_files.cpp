// Files that a scene names: where they are looked for, and what is used where they are missing.
#include <gtest/gtest.h>

#include "load/expect_near.h"
#include "load/mitsuba_scene.h"

namespace pt {
namespace {

namespace fs = std::filesystem;

constexpr const char* triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

std::string file_name(const std::string& name) {
  return "<string name='filename' value='" + name + "'/>";
}

std::string obj(const std::string& name) {
  return "<shape type='obj'>" + file_name(name) + "</shape>";
}

std::string bitmap(const char* parameter, const std::string& file = "none.png") {
  return std::string("<texture type='bitmap' name='") + parameter + "'>" + file_name(file) +
         "</texture>";
}

std::string square(const std::string& inside) {
  return "<shape type='rectangle'>" + inside + "</shape>";
}

std::string surface(const std::string& type, const std::string& inside) {
  return "<bsdf type='" + type + "'>" + inside + "</bsdf>";
}

/// A grey picture of one texel.
std::string grey_picture(char value) {
  return std::string("P6\n1 1\n255\n") + value + value + value;
}

/// A folder with a scene and what lies around it.
class MitsubaFiles : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.file(name); }

  void write(const std::string& name, const std::string& text) const {
    fs::create_directories(fs::path(path(name)).parent_path());
    write_text(path(name), text);
  }
  void write_scene(const std::string& name, const std::string& inside) const {
    write(name, "<scene version='3.0.0'>\n" + inside + "</scene>");
  }
  /// The radii of the spheres in a scene in which each included file adds one.
  std::vector<float> radii(const std::string& inside) const {
    write_scene("scene.xml", inside);
    std::vector<float> result;
    for (const Sphere& sphere : load_mitsuba_xml(path("scene.xml")).spheres) {
      result.push_back(std::sqrt(sphere.radius_squared));
    }
    return result;
  }
  LoadedScene load(const std::string& inside) const {
    write_scene("scene.xml", "<sensor type='perspective'/><emitter type='constant'/>\n" + inside);
    return load_with_warnings(path("scene.xml"));
  }

 private:
  TempFolder folder_;
};

std::string ball(double radius) {
  return "<shape type='sphere'>" + number("radius", radius) + "</shape>";
}

// The order is that of Mitsuba 3.9.1's FileResolver, tried out with the same files.
TEST_F(MitsubaFiles, IncludesAreFoundAsMitsubaFindsThem) {
  using Radii = std::vector<float>;
  write_scene("sub/a.xml", "<include filename='b.xml'/>");
  write_scene("sub/b.xml", ball(2));
  EXPECT_EQ(radii("<include filename='sub/a.xml'/>"), Radii{2}) << "beside";
  write_scene("b.xml", ball(3));
  EXPECT_EQ(radii("<include filename='sub/a.xml'/>"), Radii{2}) << "beside comes first";
  write_scene("sub/c.xml", "<include filename='sub/b.xml'/>");
  EXPECT_EQ(radii("<include filename='sub/c.xml'/>"), Radii{2}) << "in the first file's folder";
  write_scene("lib/d.xml", ball(4));
  write_scene("other/d.xml", ball(5));
  const std::string lib = "<path value='lib'/>", other = "<path value='other'/>";
  const std::string d = "<include filename='d.xml'/>";
  EXPECT_EQ(radii(lib + d), Radii{4});
  EXPECT_EQ(radii(lib + other + d), Radii{5}) << "the last <path> comes first";
  EXPECT_EQ(radii("<path value='" + path("other") + "'/>" + d), Radii{5});
  write_scene("d.xml", ball(6));
  EXPECT_EQ(radii(lib + d), Radii{6}) << "beside comes before <path>s";
  write_scene("lib/e.xml", "<path value='deep'/><include filename='f.xml'/>");
  write_scene("lib/deep/f.xml", ball(7));
  EXPECT_EQ(radii(lib + "<include filename='e.xml'/>"), Radii{7}) << "a <path> in an included file";
  write_scene("lib/chain.xml", "<include filename='sub/c.xml'/>");
  EXPECT_EQ(radii("<include filename='lib/chain.xml'/>"), Radii{2});
}

TEST_F(MitsubaFiles, IncludesOfOtherThingsThanScenes) {
  write("grey.xml",
        "<bsdf type='diffuse' version='3.0.0' id='g'>"
        "<rgb name='reflectance' value='0.25'/></bsdf>");
  const LoadedScene loaded = load("<shape type='sphere'><include filename='grey.xml'/></shape>");
  EXPECT_EQ(loaded.scene.materials.at(0).color(0), Color(0.25f));
  write_scene("parts.xml", number("radius", 3));
  const LoadedScene part = load("<shape type='sphere'><include filename='parts.xml'/></shape>");
  EXPECT_EQ(part.scene.spheres.at(0).radius_squared, 9.0f);
  write("named.xml",
        "<texture type='uniform' version='3.0.0' name='x'>" + number("value", 0.75) + "</texture>");
  const LoadedScene named =
      load(square(surface("diffuse", "<include filename='named.xml' name='reflectance'/>")));
  EXPECT_EQ(named.scene.materials.at(0).color(0), Color(0.75f));
}

TEST_F(MitsubaFiles, WhatIsNotThereIsAnErrorOrAWarning) {
  write_scene("scene.xml", "<include filename='none.xml'/>");
  expect_error([&] { load_mitsuba_xml(path("scene.xml")); }, "none.xml");
  const LoadedScene loaded = load("<path value='none'/>" + ball(1));
  EXPECT_EQ(loaded.count("scene.xml:3: <path>: there is no folder 'none': it is ignored"), 1);
}

// Mitsuba resolves names of other files after it has read all: <path>s, the last first, then the
// scene's folder. Beside an included file is ours.
TEST_F(MitsubaFiles, PicturesAndMeshesAreFoundAsMitsubaFindsThem) {
  const auto shown = [&](const std::string& inside) {
    const SceneData scene =
        load(inside + square(surface("diffuse", bitmap("reflectance", "t.ppm")))).scene;
    return std::to_integer<int>(scene.texels.at(0));
  };
  write("lib/t.ppm", grey_picture(40));
  write("sub/t.ppm", grey_picture(50));
  EXPECT_EQ(shown("<path value='lib'/>"), 40);
  EXPECT_EQ(shown("<path value='lib'/><path value='sub'/>"), 50);
  write("t.ppm", grey_picture(60));
  EXPECT_EQ(shown(""), 60);
  EXPECT_EQ(shown("<path value='lib'/>"), 40) << "before the scene's folder";

  write_scene("sub/part.xml", square(surface("diffuse", bitmap("reflectance", "t.ppm"))));
  EXPECT_EQ(std::to_integer<int>(load("<include filename='sub/part.xml'/>").scene.texels.at(0)),
            60);
  fs::remove(path("t.ppm"));
  EXPECT_EQ(std::to_integer<int>(load("<include filename='sub/part.xml'/>").scene.texels.at(0)),
            50);

  write("lib/one.obj", triangle);
  EXPECT_EQ(load("<path value='lib'/>" + obj("one.obj")).scene.meshes.size(), 1u);
}

TEST_F(MitsubaFiles, SpectraAreFoundBesideTheirFile) {
  write("sub/s.spd", "400 0.25\n700 0.25\n");
  write("s.spd", "400 0.75\n700 0.75\n");
  write_scene("sub/part.xml",
              square(surface("diffuse", "<spectrum name='reflectance' filename='s.spd'/>")));
  EXPECT_NEAR(load("<include filename='sub/part.xml'/>").scene.materials.at(0).color(0).y, 0.25f,
              0.01f);
}

TEST_F(MitsubaFiles, NamesFromWindows) {
  write("parts/one.obj", triangle);
  write("two.obj", triangle);
  const LoadedScene loaded = load(obj("parts\\one.obj") + obj("C:\\Users\\someone\\two.obj") +
                                  obj("parts\\ONE.obj") + obj("C:/Users/someone/two.obj"));
  EXPECT_EQ(loaded.scene.meshes.size(), 4u);
  EXPECT_EQ(loaded.count("whose case differs"), 1);
}

// A picture that cannot be read: the parameter is what it is without one.
TEST_F(MitsubaFiles, PicturesThatCannotBeReadHaveAStandIn) {
  write("broken.png", "\x89PNG\r\n\x1a\n");
  struct StandIn {
    std::string xml;
    float expected;
    int parameter = 0;
  };
  const std::vector<StandIn> rows = {
      {surface("diffuse", bitmap("reflectance")), 0.5f},
      {surface("diffuse", bitmap("reflectance", "broken.png")), 0.5f},
      {surface("principled", bitmap("base_color")), 0.5f},
      {surface("principled", bitmap("roughness")), 0.5f, 1},
      {surface("plastic", bitmap("specular_reflectance")), 1.0f, 1},
      {surface("roughconductor", bitmap("alpha")), 0.1f, 3},
      {surface("conductor", bitmap("k")), 1.0f, 2},
      {surface("bumpmap", bitmap("map") + surface("diffuse", bitmap("reflectance"))), 0.5f},
      {surface("normalmap", bitmap("normalmap") + surface("diffuse", "")), 0.5f},
      {surface("diffuse", "<spectrum name='reflectance' filename='none.spd'/>"), 0.5f},
      {surface("conductor", "<spectrum name='eta' filename='none.spd'/>"), 0.0f, 1},
  };
  for (const StandIn& row : rows) {
    const LoadedScene loaded = load(square(row.xml));
    const MaterialDescription& material = loaded.scene.materials.at(0);
    EXPECT_FLOAT_EQ(material.parameters[row.parameter].value.x, row.expected) << row.xml;
    EXPECT_FALSE(material.is_textured()) << row.xml;
    EXPECT_EQ(loaded.count("scene.xml:3: "), static_cast<int>(loaded.warnings.size())) << row.xml;
    EXPECT_GE(loaded.count("what is without it is used"), 1) << row.xml;
  }
  const SceneData masked =
      load(square(surface("mask", bitmap("opacity") + surface("diffuse", "")))).scene;
  EXPECT_TRUE(masked.materials.at(0).opacity.is_opaque()) << "rather than half there";
  const SceneData lamp =
      load(square("<emitter type='area'>" + bitmap("radiance") + "</emitter>")).scene;
  EXPECT_EQ(lamp.materials.at(0).emission.radiance, Color(1.0f));
  const SceneData squares = load(square(surface("diffuse",
                                                "<texture type='checkerboard' "
                                                "name='reflectance'>" +
                                                    bitmap("color1") + "</texture>")))
                                .scene;
  EXPECT_EQ(squares.textures.at(0).color1, Color(0.2f));
  const SceneData twice =
      load(square(surface("diffuse", "<texture type='scale' name='reflectance'>" +
                                         number("scale", 0.5) + bitmap("") + "</texture>")))
          .scene;
  EXPECT_EQ(twice.materials.at(0).color(0), Color(0.25f));
}

TEST_F(MitsubaFiles, AnEnvironmentThatCannotBeReadIsConstant) {
  const LoadedScene loaded = load("<emitter type='envmap'>" + file_name("none.exr") +
                                  number("scale", 3) + "</emitter>" + ball(1));
  EXPECT_EQ(loaded.count("none.exr"), 1);
  EXPECT_EQ(loaded.count("radiance 1 from all sides is used"), 1);
  ASSERT_EQ(loaded.scene.environment.pixels.size(), 1u);
  EXPECT_EQ(loaded.scene.environment.pixels[0], Color(3.0f));
}

TEST_F(MitsubaFiles, MeshesThatCannotBeReadAreLeftOut) {
  write("broken.ply", "ply\nformat ascii 1.0\nelement vertex 3\n");
  const LoadedScene loaded = load(
      obj("none.obj") + ball(1) + obj("none.obj") + "<shape type='ply'>" + file_name("broken.ply") +
      "</shape>" + "<shape type='serialized'>" + file_name("none.serialized") + "</shape>");
  EXPECT_EQ(loaded.scene.spheres.size(), 1u);
  EXPECT_TRUE(loaded.scene.meshes.empty());
  EXPECT_EQ(loaded.count("none.obj"), 1) << "once for each file";
  EXPECT_EQ(loaded.count(": the shape is left out"), 3);
  expect_error([&] { load(obj("none.obj")); }, "no shape is left");
  const LoadedScene group = load("<shape type='shapegroup' id='g'>" + obj("none.obj") +
                                 "</shape><shape type='instance'><ref id='g'/></shape>" + ball(1));
  EXPECT_TRUE(group.scene.instances.empty());
}

TEST_F(MitsubaFiles, StrictMakesThemErrors) {
  write_scene("scene.xml", square(surface("diffuse", bitmap("reflectance"))));
  LoadOptions strict;
  strict.strict = true;
  expect_error([&] { load_mitsuba_xml(path("scene.xml"), strict); }, "none.png");
  write_scene("scene.xml", ball(1) + obj("none.obj"));
  expect_error([&] { load_mitsuba_xml(path("scene.xml"), strict); }, "none.obj");
}

}  // namespace
}  // namespace pt
