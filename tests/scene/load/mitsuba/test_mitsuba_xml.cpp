// Documents: variables, includes, references, dialects, integrators, errors.
#include <gtest/gtest.h>

#include "load/mitsuba_scene.h"

namespace pt {
namespace {

constexpr const char* square = "<shape type=\"rectangle\"/>";

void expect_xml_error(const std::string& inside, const std::string& part) {
  expect_error([&] { load_xml(inside); }, part);
}

TEST(MitsubaXml, defaultsGiveWayToDefinitions) {
  const std::string xml =
      "<default name=\"depth\" value=\"5\"/><default name=\"kind\" value=\"path\"/>"
      "<integrator type=\"$kind\"><integer name=\"max_depth\" value=\"1$depth\"/></integrator>";
  EXPECT_EQ(load_xml(xml).scene.defaults.max_depth, 15);
  LoadOptions options;
  options.definitions = {{"depth", "23"}};
  EXPECT_EQ(load_xml(xml, "3.0.0", options).scene.defaults.max_depth, 123);
  options.definitions = {{"depth", "2"}, {"nowhere", "1"}};
  expect_error([&] { load_xml(xml, "3.0.0", options); }, "-D nowhere");
  expect_xml_error("<shape type=\"$what\"/>", "scene.xml:2: $what is not defined");
}

TEST(MitsubaXml, theLongestNameIsMeant) {
  const LoadedScene loaded = load_xml(
      "<default name=\"a\" value=\"1\"/><default name=\"ab\" value=\"7\"/>"
      "<integrator type=\"path\"><integer name=\"max_depth\" value=\"$ab\"/></integrator>");
  EXPECT_EQ(loaded.scene.defaults.max_depth, 7);
}

TEST(MitsubaXml, camelCaseIsSnakeCase) {
  for (const std::string version : {"0.5.0", "0.6.0", "3.0.0"}) {
    const bool old = version[0] == '0';
    const std::string depth = old ? "maxDepth" : "max_depth", rr = old ? "rrDepth" : "rr_depth";
    const std::string place = old ? "toWorld" : "to_world";
    const LoadedScene loaded = load_xml("<integrator type=\"path\"><integer name=\"" + depth +
                                            "\" value=\"9\"/>"
                                            "<integer name=\"" +
                                            rr +
                                            "\" value=\"4\"/></integrator>"
                                            "<sensor type=\"perspective\"/>"
                                            "<emitter type=\"constant\"/>"
                                            "<shape type=\"sphere\"><transform name=\"" +
                                            place +
                                            "\"><translate x=\"2\"/>"
                                            "</transform></shape>",
                                        version);
    EXPECT_EQ(loaded.scene.defaults.max_depth, 9);
    EXPECT_EQ(loaded.scene.defaults.rr_depth, 4);
    ASSERT_EQ(loaded.scene.spheres.size(), 1u);
    EXPECT_EQ(loaded.scene.spheres[0].center.x, 2.0f);
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings[0];
  }
}

TEST(MitsubaXml, includesAreReadBesideTheFileThatNamesThem) {
  const TempFolder folder;
  std::filesystem::create_directory(folder.file("parts"));
  write_text(folder.file("scene.xml"),
             "<scene version=\"3.0.0\"><default name=\"r\" value=\"2\"/>"
             "<include filename=\"parts/a.xml\"/></scene>");
  write_text(folder.file("parts/a.xml"),
             "<scene><include filename=\"b.xml\"/><shape type=\"sphere\">"
             "<float name=\"radius\" value=\"$r\"/><ref id=\"red\"/></shape></scene>");
  write_text(folder.file("parts/b.xml"),
             "<scene><bsdf type=\"diffuse\" id=\"red\">"
             "<rgb name=\"reflectance\" value=\"0.5 0 0\"/></bsdf></scene>");
  const SceneData scene = load_mitsuba_xml(folder.file("scene.xml"));
  ASSERT_EQ(scene.spheres.size(), 1u);
  EXPECT_EQ(scene.spheres[0].radius_squared, 4.0f);
  EXPECT_EQ(scene.materials[scene.sphere_material[0]].color(0), Color(0.5f, 0, 0));
}

TEST(MitsubaXml, includesThatDoNotEndAreErrors) {
  const TempFolder folder;
  const std::string path = folder.file("scene.xml");
  write_text(path, "<scene version=\"3.0.0\"><include filename=\"b.xml\"/></scene>");
  expect_error([&] { load_mitsuba_xml(path); }, "b.xml");
  write_text(folder.file("b.xml"), "<scene>\n<include filename=\"./scene.xml\"/></scene>");
  expect_error([&] { load_mitsuba_xml(path); }, "b.xml:2: ");
  for (int i = 0; i < 40; ++i) {
    write_text(folder.file("b" + std::string(static_cast<std::size_t>(i), 'b') + ".xml"),
               "<scene><include filename=\"b" + std::string(static_cast<std::size_t>(i) + 1, 'b') +
                   ".xml\"/></scene>");
  }
  expect_error([&] { load_mitsuba_xml(path); }, "deeper than 16");
}

TEST(MitsubaXml, aFileNameThatIsTooLongIsAnError) {
  expect_error([] { load_xml("<include filename=\"" + std::string(5000, 'x') + "\"/>"); },
               "File name too long");
}

TEST(MitsubaXml, referencesAndAliases) {
  const LoadedScene loaded = load_xml(
      "<alias id=\"a\" as=\"b\"/><shape type=\"sphere\"><ref id=\"b\"/></shape>"
      "<bsdf type=\"dielectric\" id=\"a\"><float name=\"int_ior\" value=\"2\"/>"
      "<float name=\"ext_ior\" value=\"1\"/></bsdf>");
  const MaterialDescription& material = loaded.scene.materials[loaded.scene.sphere_material[0]];
  EXPECT_EQ(material.kind, kind_of<Dielectric>);
  EXPECT_EQ(material.scalar(1), 2.0f);
  expect_xml_error("<shape type=\"sphere\"><ref id=\"b\"/></shape>", "scene.xml:2: there is no");
  expect_xml_error("<bsdf type=\"diffuse\" id=\"x\"/>\n<bsdf type=\"diffuse\" id=\"x\"/>",
                   "scene.xml:3: the id 'x' is used twice");
}

TEST(MitsubaXml, objectsThatContainThemselvesAreErrors) {
  expect_xml_error(
      "<bsdf type=\"twosided\" id=\"a\"><ref id=\"b\"/></bsdf>"
      "<bsdf type=\"twosided\" id=\"b\"><ref id=\"a\"/></bsdf>"
      "<shape type=\"sphere\"><ref id=\"a\"/></shape>",
      "contains itself");
  std::string chain;
  for (int i = 0; i < 5000; ++i) {
    chain += "<bsdf type=\"twosided\" id=\"m" + std::to_string(i) + "\"><ref id=\"m" +
             std::to_string(i + 1) + "\"/></bsdf>\n";
  }
  chain += "<bsdf type=\"diffuse\" id=\"m5000\"/>";
  expect_xml_error(chain, "nested deeper than 128");
}

TEST(MitsubaXml, malformedFilesAreErrorsWithTheirLine) {
  const TempFolder folder;
  const std::string path = folder.file("scene.xml");
  const auto expect_file_error = [&](const std::string& text, const std::string& part) {
    write_text(path, text);
    expect_error([&] { load_mitsuba_xml(path); }, part);
  };
  expect_file_error("", "scene.xml");
  expect_file_error("no XML at all", "scene.xml");
  expect_file_error("<scene>\n<shape>\n</scene>", "line 3");
  expect_file_error("<notascene/>", "expected <scene>");
  expect_file_error("<scene version=\"new\"/>", "version 'new'");
  std::string deep = "<scene version=\"3.0.0\">";
  for (int i = 0; i < 100000; ++i) deep += "<shape type=\"merge\">";
  for (int i = 0; i < 100000; ++i) deep += "</shape>";
  expect_file_error(deep + "</scene>", "nested deeper than 64");
  expect_error([&] { load_mitsuba_xml(folder.file("none.xml")); }, "none.xml");
}

TEST(MitsubaXml, valuesThatAreNoneAreErrors) {
  const auto sphere = [](const std::string& radius) {
    return "<shape type=\"sphere\">\n<float name=\"radius\" value=\"" + radius + "\"/></shape>";
  };
  EXPECT_EQ(load_xml(sphere("+1.5e0")).scene.spheres[0].radius_squared, 2.25f);
  for (const char* radius : {"", "x", "1x", "1e999", "nan", "inf", "0x10", "1 2", "1e39"}) {
    expect_xml_error(sphere(radius), "scene.xml:3: radius is");
  }
  for (const char* radius : {"0", "1e-999"}) expect_xml_error(sphere(radius), "above 0");
  const auto film = [](const std::string& width) {
    return "<sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"width\" value=\"" +
           width + "\"/></film></sensor>";
  };
  for (const char* width : {"0", "-5", "70000", "1e30", "1.5", "many"}) {
    expect_xml_error(film(width), "scene.xml:2: ");
  }
  expect_xml_error("<shape type=\"sphere\"><float name=\"radius\"/></shape>", "no attribute");
  expect_xml_error("<shape type=\"sphere\"><float value=\"1\"/></shape>", "no attribute");
  expect_xml_error("<shape type=\"sphere\"><boolean name=\"flip_normals\" value=\"1\"/></shape>",
                   "expected true or false");
  expect_xml_error("<shape type=\"obj\"/>", "has no filename");
  expect_xml_error("<shape type=\"obj\"><string name=\"filename\" value=\"no.obj\"/></shape>",
                   "no.obj");
}

TEST(MitsubaXml, whatIsNotKnownIsReportedOnce) {
  const std::string xml =
      "<shape type=\"wobble\"/>\n<shape type=\"wobble\"/>\n"
      "<shape type=\"rectangle\"><float name=\"wobbliness\" value=\"1\"/></shape>\n"
      "<shape type=\"rectangle\"><bsdf type=\"wobbly\"/></shape>\n"
      "<emitter type=\"wobbler\"/><surprise/><integrator type=\"depth\"/>";
  const LoadedScene loaded = load_xml(xml);
  EXPECT_EQ(loaded.count("scene.xml:2: shape 'wobble'"), 1);
  EXPECT_EQ(loaded.count("'wobble'"), 1);
  EXPECT_EQ(loaded.count("scene.xml:4: not supported in shape 'rectangle' and ignored: wobbliness"),
            1);
  EXPECT_EQ(loaded.count("bsdf 'wobbly'"), 1);
  EXPECT_EQ(loaded.count("emitter 'wobbler'"), 1);
  EXPECT_EQ(loaded.count("<surprise>"), 1);
  EXPECT_EQ(loaded.count("integrator 'depth'"), 1);
  EXPECT_EQ(loaded.count("no sensor"), 1);
  EXPECT_EQ(loaded.count("NO LIGHT OF THE FILE IS LEFT"), 1);
  EXPECT_EQ(loaded.warnings.size(), 8u);
  EXPECT_EQ(loaded.scene.quads.size(), 2u);
  LoadOptions strict;
  strict.strict = true;
  expect_error([&] { load_xml(xml, "3.0.0", strict); }, "--strict");
  const std::string plain = std::string("<sensor type=\"perspective\"/>") + square;
  EXPECT_EQ(load_xml(plain, "3.0.0", strict).scene.quads.size(), 1u);
}

TEST(MitsubaXml, depthCountsRays) {
  const auto depth = [](const std::string& type, const std::string& value) {
    return load_xml("<integrator type=\"" + type + "\"><integer name=\"max_depth\" value=\"" +
                    value + "\"/></integrator>")
        .scene.defaults.max_depth;
  };
  EXPECT_EQ(depth("path", "1"), 1);
  EXPECT_EQ(depth("volpath", "65"), 65);
  EXPECT_EQ(depth("path", "-1"), 64);
  EXPECT_EQ(load_xml("<integrator type=\"path\"/>").scene.defaults.max_depth, 64);
  EXPECT_EQ(load_xml("<integrator type=\"direct\"/>").scene.defaults.max_depth, 2);
  EXPECT_EQ(load_xml("<integrator type=\"aov\"><integrator type=\"path\">"
                     "<integer name=\"max_depth\" value=\"3\"/></integrator></integrator>")
                .scene.defaults.max_depth,
            3);
  EXPECT_FALSE(load_xml(square).scene.defaults.max_depth);
}

TEST(MitsubaXml, howLightIsComputedIsNoFinding) {
  const auto load = [](const std::string& integrator) {
    const std::string rest = "<sensor type=\"perspective\"/><emitter type=\"constant\"/>";
    return load_xml(integrator + rest + square, "0.6.0");
  };
  for (const char* type :
       {"path", "volpath", "ptracer", "sppm", "bdpt", "pssmlt", "photonmapper"}) {
    const LoadedScene loaded =
        load("<integrator type=\"" + std::string(type) +
             "\"><integer name=\"maxDepth\" value=\"7\"/><integer name=\"rrDepth\" value=\"3\"/>"
             "</integrator>");
    EXPECT_TRUE(loaded.warnings.empty()) << type << ": " << loaded.warnings[0];
    EXPECT_EQ(loaded.scene.defaults.max_depth, 7) << type;
    EXPECT_EQ(loaded.scene.defaults.rr_depth, 3) << type;
  }
  const LoadedScene photons = load(
      "<integrator type=\"sppm\"><integer name=\"photonCount\" value=\"250000\"/>"
      "<boolean name=\"hideEmitters\" value=\"true\"/></integrator>");
  EXPECT_TRUE(photons.scene.camera.hides_emitters);
  EXPECT_TRUE(photons.warnings.empty());
  const LoadedScene adaptive =
      load("<integrator type=\"adaptive\"><integrator type=\"bdpt\"/></integrator>");
  EXPECT_TRUE(adaptive.warnings.empty());
  for (const char* type : {"aov", "depth", "ao", "multichannel"}) {
    const LoadedScene other = load("<integrator type=\"" + std::string(type) + "\"/>");
    EXPECT_EQ(other.count("integrator '" + std::string(type) + "'"), 1);
  }
}

}  // namespace
}  // namespace pt
