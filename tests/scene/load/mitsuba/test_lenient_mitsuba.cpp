// Mitsuba files with a trifle wrong: they load, with a warning.
#include "common/scene/data/scene_data.h"
#include "load/expect_near.h"
#include "load/mitsuba_scene.h"

namespace pt {
namespace {

const std::string lamp = "<emitter type=\"constant\"/>";

MaterialDescription material_of(const LoadedScene& loaded) {
  return loaded.scene.materials.at(loaded.scene.sphere_material.at(0));
}

std::string sphere(const std::string& bsdf) {
  return lamp + "<shape type=\"sphere\">" + bsdf + "</shape>";
}

TEST(LenientMitsuba, ThePropertyGivenLastHolds) {
  const std::string xml = sphere(
      "<bsdf type=\"diffuse\">\n<rgb name=\"reflectance\" value=\"0.1\"/>\n"
      "<rgb name=\"reflectance\" value=\"0.3\"/></bsdf>");
  const LoadedScene loaded = load_xml(xml);
  EXPECT_EQ(material_of(loaded).color(0), Color(0.3f));
  EXPECT_EQ(loaded.count("scene.xml:4: 'reflectance' is given twice"), 1);
  expect_error([&] { load_xml(xml, "3.0.0", {{}, true, {}}); }, "given twice");
}

TEST(LenientMitsuba, AnIndexOfRefractionBelowZeroIsZero) {
  const LoadedScene loaded =
      load_xml(sphere("<bsdf type=\"conductor\"><rgb name=\"eta\" value=\"-0.5 1 2\"/>"
                      "<rgb name=\"k\" value=\"3 -1 0\"/></bsdf>"));
  EXPECT_EQ(material_of(loaded).color(1), Color(0, 1, 2));
  EXPECT_EQ(material_of(loaded).color(2), Color(3, 0, 0));
  EXPECT_EQ(loaded.count("negative component"), 1);
  expect_error(
      [&] {
        load_xml(
            sphere("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" "
                   "value=\"-1\"/></bsdf>"));
      },
      "not negative");
}

TEST(LenientMitsuba, DiffuseReflectanceOfDiffuse) {
  const LoadedScene loaded = load_xml(
      sphere("<bsdf type=\"diffuse\"><rgb name=\"diffuseReflectance\" value=\"0.7\"/></bsdf>"),
      "0.6.0");
  EXPECT_EQ(material_of(loaded).color(0), Color(0.7f));
  EXPECT_EQ(loaded.count("diffuse"), 0);
}

TEST(LenientMitsuba, AShapeAroundAMediumThatIsNotSupportedIsNotThere) {
  const auto with = [](const std::string& more) {
    return load_xml(sphere("<medium type=\"wobbling\" name=\"interior\"/>" + more));
  };
  const LoadedScene loaded = with("");
  EXPECT_TRUE(loaded.scene.spheres.empty());
  EXPECT_EQ(loaded.count("medium 'wobbling' is not supported"), 1);
  EXPECT_EQ(with("<bsdf type=\"diffuse\"/>").scene.spheres.size(), 1u);
  EXPECT_EQ(with("<emitter type=\"area\"/>").scene.spheres.size(), 1u);
}

TEST(LenientMitsuba, NoLightIsLeft) {
  const std::string shape = "<shape type=\"sphere\"/>";
  const LoadedScene loaded = load_xml(shape + "\n<emitter type=\"wobbler\"/>");
  EXPECT_EQ(loaded.count("NO LIGHT OF THE FILE IS LEFT: not supported: 'wobbler' of line 3; "
                         "default lighting"),
            1);
  EXPECT_GT(loaded.scene.environment.width, 0);
  EXPECT_EQ(load_xml(shape).count("no light: default lighting"), 1);

  const LoadedScene dark =
      load_xml(shape + "<emitter type=\"constant\"><rgb name=\"radiance\" value=\"0\"/></emitter>");
  EXPECT_EQ(dark.scene.environment.width, 0) << "as the file says";
  const LoadedScene other = load_xml(shape + lamp + "<emitter type=\"wobbler\"/>");
  EXPECT_EQ(other.count("LIGHT"), 0);
  EXPECT_EQ(other.scene.environment.width, 0);
}

TEST(LenientMitsuba, AnAreaEmitterInNoShapeIsCalledThat) {
  const LoadedScene loaded = load_xml(sphere("") + "<emitter type=\"area\"/>");
  EXPECT_EQ(loaded.count("emitter 'area' that is in no shape"), 1);
  EXPECT_EQ(loaded.count("not supported"), 0);
}

TEST(LenientMitsuba, WithoutASensorTheSceneIsFramed) {
  const LoadedScene loaded = load_xml(
      lamp + "<shape type=\"sphere\"><point name=\"center\" x=\"50\" y=\"60\" z=\"70\"/></shape>");
  EXPECT_EQ(loaded.count("no sensor: a camera that frames"), 1);
  expect_near(loaded.scene.camera.look_at, {50, 60, 70}, 1e-4f);
}

TEST(LenientMitsuba, NamesOfFilesInAnyCase) {
  const TempFolder folder;
  std::filesystem::create_directories(folder.file("Parts/Meshes"));
  write_text(folder.file("Parts/Room.XML"),
             "<scene>" + lamp +
                 "<shape type=\"obj\"><string name=\"filename\" value=\"meshes/one.OBJ\"/></shape>"
                 "</scene>");
  write_text(folder.file("Parts/Meshes/One.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write_text(folder.file("scene.xml"),
             "<scene version=\"3.0.0\"><include filename=\"parts/room.xml\"/></scene>");
  const LoadedScene loaded = load_with_warnings(folder.file("scene.xml"));
  EXPECT_EQ(loaded.scene.meshes.size(), 1u);
  EXPECT_EQ(loaded.count("whose case differs"), 2);
  EXPECT_EQ(loaded.count("'parts/room.xml' does not exist: "), 1);
  expect_error(
      [&] {
        load_mitsuba_xml(folder.file("scene.xml"), {{}, true, {}});
      },
      "whose case differs");
}

}  // namespace
}  // namespace pt
