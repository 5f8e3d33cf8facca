// The words of pbrt's files, errors in them, and what is warned of.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "common/scene/load/pbrt/syntax/tokens.h"
#include "load/expect_near.h"
#include "load/pbrt_scene.h"

namespace pt {
namespace {

TEST(PbrtSyntax, WordsNeedNoSpaceAroundBracketsAndQuotes) {
  const SceneData scene = load_pbrt_silently(pbrt_world(
      lit +
      "AttributeBegin # a comment \" [\n Translate 1 2 3 Shape\"sphere\"\"float radius\"[.5]\n"
      "AttributeEnd"));
  ASSERT_EQ(scene.spheres.size(), 1u);
  expect_near(scene.spheres[0].center, {1, 2, 3});
  EXPECT_FLOAT_EQ(scene.spheres[0].radius(), 0.5f);
}

TEST(PbrtSyntax, ErrorsNameLineAndColumn) {
  const std::string head = "WorldBegin\n";
  const auto expect_error = [&](const std::string& text, const std::string& error) {
    const std::string message = pbrt_error(head + text);
    EXPECT_EQ(message.substr(0, error.size()), error) << text;
  };
  // What is one thing's fault loses that thing.
  const auto expect_warning = [&](const std::string& text, const std::string& warning) {
    EXPECT_EQ(pbrt_error(head + text), "") << text;
    const std::string message = pbrt_complaint(head + text);
    EXPECT_EQ(message.substr(0, warning.size()), warning) << text;
    LoadOptions strict;
    strict.strict = true;
    EXPECT_NE(pbrt_error(head + text, strict), "") << text;
  };
  expect_error("  Shpe \"sphere\"", "scene.pbrt:2:3: 'Shpe'; expected a directive");
  expect_error("Shape sphere", "scene.pbrt:2:7: 'sphere'; expected a \"name\" after Shape");
  expect_error("Translate 1 x 3", "scene.pbrt:2:13: 'x'; expected a finite number");
  expect_error("Translate 1 1e99 3", "scene.pbrt:2:13: '1e99'; expected a finite number");
  expect_error("Translate 1 nan 3", "scene.pbrt:2:13: 'nan'; expected a finite number");
  expect_error("Translate 1 2", "scene.pbrt:2:14: the file ends here; expected a number");
  expect_error("Shape \"sphere", "scene.pbrt:2:7: a string without an end");
  expect_warning("Shape \"sphere\" \"float radius\" [ 1 2 ]",
                 "scene.pbrt:2:16: 'float radius' has 2 values; expected 1");
  expect_error("Shape \"sphere\" \"float radius\" \"1\"",
               "scene.pbrt:2:31: '1' as a value of 'float radius'; expected a number");
  expect_warning("Shape \"sphere\" \"string radius\" \"1\"",
                 "scene.pbrt:2:16: parameter 'radius' of Shape 'sphere' is of type 'string'; "
                 "expected float or integer");
  expect_error("Shape \"sphere\" \"flaot radius\" 1",
               "scene.pbrt:2:16: parameter 'radius' has the unknown type 'flaot'");
  expect_error("Shape \"sphere\" \"radius\" 1", "scene.pbrt:2:16: 'radius'; expected a param");
  expect_error("Shape \"sphere\" \"float radius\" [ 1", "scene.pbrt:2:16: the file ends here");
  expect_error("AttributeEnd", "scene.pbrt:2:1: AttributeEnd without its Begin");
  expect_error("AttributeBegin", "scene.pbrt:1:1: a block without its end");
  expect_error("ObjectBegin \"a\" AttributeEnd", "scene.pbrt:2:17: AttributeEnd without");
  expect_warning("ObjectInstance \"a\"", "scene.pbrt:2:1: there is no object 'a'");
  expect_error("Film \"rgb\"", "scene.pbrt:2:1: Film after WorldBegin");
  expect_warning("NamedMaterial \"a\" Shape \"sphere\"",
                 "scene.pbrt:2:19: there is no material 'a'");
  expect_warning("Rotate 10 0 0 0", "scene.pbrt:2:1: Rotate: expected an axis");
  expect_warning("LookAt 0 0 0  0 1 0  0 1 0", "scene.pbrt:2:1: LookAt: expected two different");
  expect_warning("Material \"diffuse\" \"rgb reflectance\" [1 -1 0] Shape \"sphere\"",
                 "scene.pbrt:2:20: 'rgb reflectance' with a negative number");
  expect_warning("Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"",
                 "scene.pbrt:2:20: there is no spectrum texture 't'");
  EXPECT_NE(pbrt_error(head + "Include \"scene.pbrt\"").find("scene.pbrt includes itself"),
            std::string::npos);
  EXPECT_EQ(pbrt_error("Shape \"sphere\"").substr(0, 36), "scene.pbrt:1:1: Shape before WorldBe");
}

TEST(PbrtSyntax, UnknownThingsAreWarnedOfOnceWithWhatIsExpected) {
  const std::string sphere = "Shape \"sphere\" \"float radios\" 2\n";
  const LoadedScene loaded = load_pbrt_text(
      pbrt_world(lit + sphere + sphere +
                 "Shape \"torus\"\nLightSource \"laser\"\nMaterial \"cheese\"\n" + sphere));
  EXPECT_EQ(loaded.count("parameter 'float radios' of Shape 'sphere' is not supported and ignored; "
                         "expected one of alpha, phimax, radius, zmax, zmin"),
            1);
  EXPECT_EQ(loaded.count("scene.pbrt:7:16: "), 1);
  EXPECT_EQ(loaded.count("shape 'torus' is not supported: it is left out"), 1);
  EXPECT_EQ(loaded.count("light 'laser' is not supported"), 1);
  EXPECT_EQ(loaded.count("material 'cheese' is not known: diffuse grey is used"), 1);
  EXPECT_EQ(loaded.warnings.size(), 4u);
  EXPECT_EQ(loaded.scene.spheres.size(), 3u);
  LoadOptions strict;
  strict.strict = true;
  EXPECT_NE(pbrt_error(pbrt_world(lit + sphere), strict).find("(--strict)"), std::string::npos);
}

TEST(PbrtSyntax, AMissingFileIsNamedWhereItIsNamed) {
  for (const char* name : {"none.ply", "none.ply.gz"}) {
    const std::string message =
        pbrt_complaint(pbrt_world(lit + "Shape \"plymesh\" \"string filename\" \"" + name + "\""));
    EXPECT_EQ(message.substr(0, 17), "scene.pbrt:7:17: ") << message;
    EXPECT_NE(message.find(name), std::string::npos) << message;
  }
}

TEST(PbrtSyntax, MessagesAreOneLineWhateverNamesContain) {
  for (const char* text :
       {"Shape \"sphere\" \"no\\nparameter at all\" 1", "NamedMaterial \"a\\nb\" Shape \"sphere\"",
        "Material \"mix\" \"string materials\" [\"a\\n\" \"b\"] Shape \"sphere\"",
        "Include \"a\\nb\"", "ObjectInstance \"a\\nb\""}) {
    const std::string message = pbrt_complaint(pbrt_world(lit + text));
    EXPECT_EQ(message.substr(0, 13), "scene.pbrt:7:") << message;
    EXPECT_EQ(message.find('\n'), message.npos) << message;
  }
  const LoadedScene loaded =
      load_pbrt_text(pbrt_world(lit + "Material \"a\\nb\" Shape \"sphere\""));
  EXPECT_EQ(loaded.count("material 'a?b' is not known"), 1);
}

TEST(PbrtSyntax, AMediumInterfaceHasOneNameOrTwo) {
  const auto error = [](const std::string& names) {
    return pbrt_complaint(pbrt_world(lit + "MediumInterface " + names + " Shape \"sphere\""));
  };
  EXPECT_EQ(error("\"\" \"\""), "");
  EXPECT_EQ(error("\"\""), "");
  for (const char* names : {"\"\" \"fog\"", "\"fog\" \"\"", "\"fog\""}) {
    EXPECT_NE(error(names).find("there is no medium 'fog'"), std::string::npos) << names;
  }
}

TEST(PbrtSyntax, IncludedFilesShareTheStateAndImportedOnesDoNot) {
  const TempFolder folder;
  write_text(folder.file("part.pbrt"), "Translate 1 0 0\nShape \"sphere\"\n");
  for (const bool import : {false, true}) {
    write_text(folder.file("scene.pbrt"), pbrt_world(lit + (import ? "Import" : "Include") +
                                                     " \"part.pbrt\" Shape \"sphere\""));
    const LoadedScene loaded = load_pbrt_file(folder.file("scene.pbrt"));
    ASSERT_EQ(loaded.scene.spheres.size(), 2u);
    EXPECT_EQ(loaded.scene.spheres[0].center.x, 1.0f);
    EXPECT_EQ(loaded.scene.spheres[1].center.x, import ? 0.0f : 1.0f);
  }
}

TEST(PbrtSyntax, CompressedFilesAreRead) {
  const TempFolder folder;
  const gzFile file = gzopen(folder.file("part.pbrt.gz").c_str(), "wb");
  const std::string text = "Shape \"sphere\"\n";
  ASSERT_GT(gzwrite(file, text.data(), static_cast<unsigned>(text.size())), 0);
  gzclose(file);
  write_text(folder.file("scene.pbrt"), pbrt_world(lit + "Include \"part.pbrt.gz\""));
  EXPECT_EQ(load_pbrt_file(folder.file("scene.pbrt")).scene.spheres.size(), 1u);
  // Its last eight bytes are its checksum and its length.
  const std::string bytes = read_text(folder.file("part.pbrt.gz"));
  for (const std::size_t from_end : {8u, 5u, 4u, 1u}) {
    std::string damaged = bytes;
    damaged[bytes.size() - from_end] ^= 1;
    write_text(folder.file("part.pbrt.gz"), damaged);
    expect_error([&] { pbrt::read_source(folder.file("part.pbrt.gz")); },
                 "corrupted compressed data");
  }
}

TEST(PbrtSyntax, AttributesAreParametersOfWhatFollows) {
  const SceneData scene = load_pbrt_silently(
      pbrt_world(lit + "AttributeBegin Attribute \"shape\" \"float radius\" 2\n"
                       "Shape \"sphere\" Shape \"sphere\" \"float radius\" 3 AttributeEnd\n"
                       "Shape \"sphere\""));
  ASSERT_EQ(scene.spheres.size(), 3u);
  EXPECT_EQ(scene.spheres[0].radius(), 2.0f);
  EXPECT_EQ(scene.spheres[1].radius(), 3.0f);
  EXPECT_EQ(scene.spheres[2].radius(), 1.0f);
}

TEST(PbrtSyntax, NamedMaterialsMayBeDefinedLater) {
  const SceneData scene = load_pbrt_silently(
      pbrt_world(lit + "NamedMaterial \"m\" Shape \"sphere\"\n"
                       "MakeNamedMaterial \"m\" \"string type\" \"diffuse\" \"rgb reflectance\" "
                       "[.1 .2 .3]"));
  expect_near(scene.materials[scene.sphere_material[0]].parameters[0].value, {0.1f, 0.2f, 0.3f});
}

}  // namespace
}  // namespace pt
