// What is wrong in a pbrt file loses itself and not the scene; what a file of a few lines asks for
// is bounded.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "common/scene/prepare/prepare_scene.h"
#include "common/texture/sample_texture.h"
#include "load/expect_near.h"
#include "load/pbrt_scene.h"

namespace pt {
namespace {

struct Loss {
  const char* text;
  const char* said;
};

const std::string big_ball = "Shape \"sphere\" \"float radius\" 2\n";

/// After each of these texts the scene still has its sphere, and the warning says what was lost;
/// with --strict that is an error.
TEST(PbrtLosses, OneBadThingLosesItself) {
  const Loss losses[] = {
      {"Shape \"sphere\" \"float radius\" -1", "Shape 'sphere' is left out"},
      {"Shape \"sphere\" \"float radius\" nan", "not finite; Shape 'sphere' is left out"},
      {"Shape \"disk\" \"float radius\" -nan(ind)", "not finite; Shape 'disk' is left out"},
      {"Shape \"cylinder\" \"float radius\" inf", "not finite; Shape 'cylinder' is left out"},
      {"Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 9]",
       "the index 9; expected 0 to 2"},
      {"Shape \"trianglemesh\"", "has no 'point3 P'; Shape 'trianglemesh' is left out"},
      {"Shape \"plymesh\"", "plymesh has no 'string filename'"},
      {"Shape \"plymesh\" \"string filename\" \"none.ply\"", "Shape 'plymesh' is left out"},
      {"Shape \"loopsubdiv\" \"integer levels\" 13 \"point3 P\" [0 0 0 1 0 0 0 1 0] "
       "\"integer indices\" [0 1 2]",
       "13 levels"},
      {"Shape \"curve\" \"point3 P\" [0 0 0 1 0 0]", "2 points in 'P'"},
      {"AttributeBegin Scale 0 1 1 Shape \"disk\" AttributeEnd", "no inverse"},
      {"ObjectInstance \"none\"", "there is no object 'none'"},
      {"ObjectBegin \"a\" Shape \"disk\" ObjectInstance \"a\" ObjectEnd", "inside of an object"},
      {"LightSource \"spot\" \"float coneangle\" 181", "LightSource 'spot' is left out"},
      {"LightSource \"spot\" \"point3 from\" [0 0 1]", "LightSource 'spot' is left out"},
      {"LightSource \"point\" \"float scale\" -1", "LightSource 'point' is left out"},
      {"LightSource \"infinite\" \"string filename\" \"none.exr\"", "a constant sky is used"},
      {"LightSource \"point\" \"spectrum I\" \"none.spd\"",
       "'I' of LightSource 'point' is as if it was not given"},
      {"AttributeBegin AreaLightSource \"diffuse\" \"string filename\" \"none.png\" Shape \"disk\" "
       "AttributeEnd",
       "a constant light is used"},
      {"AttributeBegin AreaLightSource \"diffuse\" \"float scale\" -1 Shape \"disk\" AttributeEnd",
       "AreaLightSource 'diffuse' is dark"},
      {"AttributeBegin Material \"mix\" Shape \"disk\" AttributeEnd",
       "0 names in 'string materials'; expected 2; diffuse grey is used"},
      {"AttributeBegin Material \"dielectric\" \"float eta\" 0 Shape \"disk\" AttributeEnd",
       "diffuse grey is used"},
      {"AttributeBegin Material \"conductor\" \"spectrum eta\" \"none.spd\" Shape \"disk\" "
       "AttributeEnd",
       "is as if it was not given"},
      {"AttributeBegin Material \"diffuse\" \"string normalmap\" \"none.png\" Shape \"disk\" "
       "AttributeEnd",
       "no map of normals is used"},
      {"AttributeBegin Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"none.png\" "
       "Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"disk\" AttributeEnd",
       "its parameter's default is used"},
      {"Texture \"t\" \"normal\" \"constant\"", "expected float or spectrum; Texture is ignored"},
      {"AttributeBegin MediumInterface \"fog\" Shape \"disk\" AttributeEnd",
       "medium 'fog' is left out"},
      {"Attribute \"camera\" \"float x\" 1", "Attribute is ignored"},
      {"ColorSpace \"rgb\"", "ColorSpace is ignored"},
      {"Transform [1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1]", "0 0 0 1 in the last row"},
      {"Scale 1e30 1 1 Scale 1e30 1 1 Identity", "numbers that are not finite; Scale is ignored"},
      {"Include \"none.pbrt\"", "there is no file 'none.pbrt': Include is left out"},
      {"Import \"none.pbrt\"", "there is no file 'none.pbrt': Import is left out"},
  };
  for (const auto& [text, said] : losses) {
    SCOPED_TRACE(text);
    const std::string world = pbrt_world(lit + text + "\n" + big_ball);
    const LoadedScene loaded = load_pbrt_text(world);
    EXPECT_EQ(loaded.count(said), 1) << (loaded.warnings.empty() ? "-" : loaded.warnings.front());
    bool has_ball = false;
    for (const Sphere& sphere : loaded.scene.spheres) has_ball |= sphere.radius() == 2.0f;
    EXPECT_TRUE(has_ball);
    LoadOptions strict;
    strict.strict = true;
    EXPECT_NE(pbrt_error(world, strict), "");
  }
}

TEST(PbrtLosses, ABadViewIsThatOfItsDefaults) {
  const auto defaults = [](const std::string& option) {
    const LoadedScene loaded =
        load_pbrt_text(option + " WorldBegin LightSource \"infinite\" Shape \"sphere\"");
    EXPECT_EQ(loaded.count("is as if it had no parameters"), 1) << option;
    return loaded.scene;
  };
  EXPECT_EQ(defaults("Film \"rgb\" \"integer xresolution\" 0").defaults.width, 1280);
  EXPECT_EQ(defaults("Film \"rgb\" \"integer xresolution\" 65536").defaults.width, 1280);
  EXPECT_EQ(defaults("Film \"rgb\" \"float whitebalance\" 999").sky.zenith, Color(1.0f));
  EXPECT_EQ(defaults("Film \"rgb\" \"float iso\" -1").sky.zenith, Color(1.0f));
  EXPECT_EQ(defaults("Film \"rgb\" \"float cropwindow\" [.5 .5 0 1]").defaults.crop, std::nullopt);
  EXPECT_EQ(defaults("Sampler \"halton\" \"integer pixelsamples\" 0").defaults.spp, 16);
  EXPECT_EQ(defaults("Integrator \"path\" \"integer maxdepth\" -1").defaults.max_depth, 6);
  EXPECT_FLOAT_EQ(defaults("PixelFilter \"box\" \"float xradius\" 0").defaults.filter->a, 0.5f);
  for (const char* fov : {"0", "180"}) {
    const SceneData scene =
        defaults(fmt::format("Translate 0 0 -3 Camera \"perspective\" \"float fov\" {}", fov));
    EXPECT_FLOAT_EQ(scene.camera.fov_degrees, 90.0f);
    expect_near(scene.camera.look_from, {0, 0, 3});
  }
  const SceneData shut =
      defaults("Camera \"perspective\" \"float shutteropen\" 1 \"float shutterclose\" 1");
  EXPECT_EQ(shut.sky.zenith, Color(1.0f));
}

/// A picture that cannot be read has the value that its parameter has by default, times its scale
/// textures.
TEST(PbrtLosses, PicturesHaveStandIns) {
  const auto material = [](const std::string& of, const std::string& use) {
    const LoadedScene loaded = load_pbrt_text(pbrt_world(lit + "Texture \"t\" \"" + of +
                                                         "\" \"imagemap\" \"string filename\" "
                                                         "\"none.png\"\nTexture \"s\" \"" +
                                                         of +
                                                         "\" \"scale\" \"texture tex\" "
                                                         "\"t\" \"float scale\" .25\n" +
                                                         use + " Shape \"disk\""));
    EXPECT_EQ(loaded.count("none.png"), 1);
    return loaded.scene.materials.back();
  };
  expect_near(material("spectrum", "Material \"diffuse\" \"texture reflectance\" \"t\"")
                  .parameters[0]
                  .value,
              Color(0.5f));
  expect_near(material("spectrum", "Material \"diffuse\" \"texture reflectance\" \"s\"")
                  .parameters[0]
                  .value,
              Color(0.25f));
  EXPECT_EQ(material("float", "Attribute \"shape\" \"texture alpha\" \"t\"").opacity.offset, 1.0f);
  EXPECT_EQ(material("float", "Material \"dielectric\" \"texture roughness\" \"t\"").kind,
            kind_of<Dielectric>);
}

TEST(PbrtLosses, ASkyWithoutItsPictureIsGrey) {
  const auto sky = [](const std::string& more) {
    return load_pbrt_text(pbrt_world("LightSource \"infinite\" \"string filename\" \"none.exr\" " +
                                     more + " Shape \"sphere\""))
        .scene.sky.zenith;
  };
  expect_near(sky("\"float scale\" 20"), Color(0.5f));
  expect_near(sky("\"float illuminance\" 3"), Color(3 * inverse_pi));
}

TEST(PbrtLosses, WarningsAreBoundedInNumberAndLength) {
  std::string world = lit + big_ball;
  for (int i = 0; i < 1000; ++i) world += fmt::format("Shape \"sphere\" \"float p{}\" 1\n", i);
  for (int i = 0; i < 1000; ++i) world += fmt::format("Shape \"sphere\" \"float radius\" -{}\n", i);
  for (int i = 0; i < 100; ++i)
    world += fmt::format("Shape \"plymesh\" \"string filename\" \"{}\"\n", i);
  const LoadedScene loaded = load_pbrt_text(pbrt_world(world));
  EXPECT_LE(loaded.warnings.size(), 22u);
  EXPECT_EQ(loaded.count("more warnings like the one before"), 1);
  EXPECT_EQ(loaded.count("are not listed"), 1);
  std::string name;
  for (int i = 0; i < 100000; ++i) name += "\xc3\xa9";  // two bytes
  for (const std::string& text :
       {"Shape \"" + name + "\"", "NamedMaterial \"" + name + "\" Shape \"sphere\"",
        "Material \"diffuse\" \"texture reflectance\" \"" + name + "\" Shape \"sphere\"",
        "Shape \"plymesh\" \"string filename\" \"" + name + "\"", "Include \"" + name + "\"", name,
        "Shape \"sphere\" \"float " + name + "\" 1",
        "Material \"" + name + "\" \"rgb reflectance\" -1 Shape \"sphere\""}) {
    const std::string message = pbrt_complaint(pbrt_world(lit + text));
    EXPECT_LT(message.size(), 1200u);
    EXPECT_NE(message.find("\xc3\xa9..."), message.npos) << message;
  }
}

TEST(PbrtLimits, ManyParametersAreReadOnce) {
  std::string world = lit + "Shape \"sphere\" ";
  for (int i = 0; i < 100000; ++i) world += fmt::format("\"float p{}\" 1\n", i);
  EXPECT_EQ(load_pbrt_text(pbrt_world(world)).scene.spheres.size(), 1u);
}

TEST(PbrtLimits, AttributesAreSharedByTheBlocksThatHaveThem) {
  std::string world = lit + "Attribute \"shape\" \"float x\" [";
  for (int i = 0; i < 100000; ++i) world += "1 ";
  world += "]\n";
  for (int i = 0; i < 2000; ++i) world += "AttributeBegin Attribute \"shape\" \"float radius\" 2\n";
  world += "Shape \"sphere\"\n";
  for (int i = 0; i < 2000; ++i) world += "AttributeEnd\n";
  const SceneData scene = load_pbrt_silently(pbrt_world(world + "Shape \"sphere\""));
  EXPECT_EQ(scene.spheres.at(0).radius(), 2.0f);
  EXPECT_EQ(scene.spheres.at(1).radius(), 1.0f);
  std::string many = lit;
  for (int i = 0; i <= 100; ++i) many += fmt::format("Attribute \"shape\" \"float p{}\" 1\n", i);
  EXPECT_NE(pbrt_error(pbrt_world(many + big_ball)).find("more than 100 parameters"),
            std::string::npos);
}

TEST(PbrtLimits, ChainsAreNestedToALimit) {
  const auto said = [](int length, bool of_textures) {
    std::string world = lit;
    if (of_textures) {
      world += "Texture \"n0\" \"spectrum\" \"constant\"\n";
    } else {
      world += "MakeNamedMaterial \"n0\" \"string type\" \"diffuse\"\n";
    }
    for (int i = 1; i < length; ++i) {
      world += of_textures ? fmt::format(
                                 "Texture \"n{}\" \"spectrum\" \"scale\" \"texture tex\" "
                                 "\"n{}\"\n",
                                 i, i - 1)
                           : fmt::format(
                                 "MakeNamedMaterial \"n{}\" \"string type\" \"mix\" "
                                 "\"string materials\" [\"n{}\" \"n0\"]\n",
                                 i, i - 1);
    }
    world += of_textures
                 ? fmt::format("Material \"diffuse\" \"texture reflectance\" \"n{}\"", length - 1)
                 : fmt::format("NamedMaterial \"n{}\"", length - 1);
    return load_pbrt_text(pbrt_world(world + " Shape \"sphere\"")).count("nested too deeply");
  };
  // The diffuse material is one level above its textures.
  EXPECT_EQ(said(255, true), 0);
  EXPECT_EQ(said(256, true), 1);
  EXPECT_EQ(said(20000, true), 1);
  EXPECT_EQ(said(256, false), 0);
  EXPECT_EQ(said(257, false), 1);
  EXPECT_EQ(said(20000, false), 1);
}

/// 2^40 ways from the last to the first.
TEST(PbrtLimits, PartsOfPartsAreReadOnce) {
  std::string textures = lit + "Texture \"t0\" \"spectrum\" \"constant\"\n", materials = lit;
  for (int i = 1; i <= 40; ++i) {
    textures += fmt::format(
        "Texture \"t{0}\" \"spectrum\" \"mix\" \"texture tex1\" \"t{1}\" "
        "\"texture tex2\" \"t{1}\"\n",
        i, i - 1);
  }
  textures += "Material \"diffuse\" \"texture reflectance\" \"t40\" Shape \"sphere\"";
  expect_near(load_pbrt_silently(pbrt_world(textures)).materials.back().parameters[0].value,
              Color(1.0f));
  for (const char* name : {"a0", "b0"}) {
    materials += fmt::format(
        "MakeNamedMaterial \"{}\" \"string type\" \"diffuse\" \"rgb "
        "reflectance\" [{} 0 0]\n",
        name, name[0] == 'a' ? 1 : 0);
  }
  for (int i = 1; i <= 40; ++i) {
    for (const char name : {'a', 'b'}) {
      materials += fmt::format(
          "MakeNamedMaterial \"{}{}\" \"string type\" \"mix\" \"string "
          "materials\" [\"a{}\" \"b{}\"] \"float amount\" {}\n",
          name, i, i - 1, i - 1, name == 'a' ? 0.4 : 0.6);
    }
  }
  materials += "NamedMaterial \"a40\" Shape \"disk\"";
  EXPECT_EQ(load_pbrt_silently(pbrt_world(materials)).materials.size(), 81u);
}

TEST(PbrtLimits, FilesIncludeEachOtherToALimit) {
  const TempFolder folder;
  for (int i = 0; i < 30; ++i) {
    write_text(folder.file(fmt::format("n{}.pbrt", i)),
               fmt::format("Include \"n{0}.pbrt\" Include \"n{0}.pbrt\"", i + 1));
  }
  write_text(folder.file("n30.pbrt"), "Identity");
  try {
    load_pbrt_file(folder.file("n0.pbrt"));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("more than 20000 files are included"),
              std::string::npos)
        << error.what();
  }
  EXPECT_NO_THROW(load_pbrt_file(folder.file("n18.pbrt")));  // 2^13 - 2 of them
}

TEST(PbrtLimits, CompressedFilesUnpackToALimit) {
  const TempFolder folder;
  const auto write = [&](int mebibytes) {
    const gzFile file = gzopen(folder.file("scene.pbrt").c_str(), "wb9");
    const std::string head = pbrt_world(lit + big_ball), line(1 << 20, '#');
    gzwrite(file, head.data(), static_cast<unsigned>(head.size()));
    for (int i = 0; i < mebibytes; ++i) gzwrite(file, line.data(), 1u << 20);
    gzclose(file);
  };
  write(250);
  EXPECT_EQ(load_pbrt_file(folder.file("scene.pbrt")).scene.spheres.size(), 1u);
  write(260);
  EXPECT_THROW(load_pbrt_file(folder.file("scene.pbrt")), Error);
}

TEST(PbrtLimits, PicturesOfLightsAreFew) {
  const TempFolder folder;
  write_text(folder.file("a.pfm"),
             "PF\n1 1\n-1\n" + std::string("\0\0\x80\x3f\0\0\x80\x3f\0\0\x80\x3f", 12));
  const auto loaded = [&](const char* light, int count, const char* before) {
    std::string world = fmt::format("Shape \"sphere\" {}\n", before);
    for (int i = 0; i < count; ++i) world += fmt::format("LightSource {}\n", light);
    write_text(folder.file("scene.pbrt"), pbrt_world(world));
    return load_pbrt_file(folder.file("scene.pbrt"));
  };
  const char* sky = "\"infinite\" \"string filename\" \"a.pfm\"";
  EXPECT_TRUE(loaded(sky, 16, "").warnings.empty());
  const LoadedScene skies = loaded(sky, 17, "");
  EXPECT_EQ(skies.count("more than 16 infinite lights with pictures"), 1);
  expect_near(skies.scene.environment.pixels.at(99), Color(16.0f), 1e-4f);
  EXPECT_TRUE(loaded("\"spot\"", 100, "Scale 1 2 1").warnings.empty());
  EXPECT_EQ(loaded("\"spot\"", 101, "Scale 1 2 1").count("its cone is round"), 1);
  EXPECT_EQ(loaded("\"spot\" \"float coneangle\" 79", 1, "Scale 1 2 1").count("its cone is round"),
            1);
}

TEST(PbrtLosses, PathsOfWindowsAreFound) {
  const TempFolder folder;
  std::filesystem::create_directories(folder.file("textures"));
  write_text(folder.file("textures/tree.ppm"), "P6 1 1 255\n\xff\xff\xff");
  write_text(folder.file("scene.pbrt"),
             pbrt_world(lit + "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" "
                              "\"textures\\tree.ppm\" Material \"diffuse\" \"texture "
                              "reflectance\" \"t\" Shape \"sphere\""));
  const LoadedScene loaded = load_pbrt_file(folder.file("scene.pbrt"));
  EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
  EXPECT_EQ(loaded.scene.textures.size(), 1u);
}

TEST(PbrtLosses, WhatIsDefinedAgainHoldsFromThereOn) {
  const auto color = [](const char* value) {
    return fmt::format(
        "Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [{0} 0 0]\n"
        "MakeNamedMaterial \"m\" \"string type\" \"diffuse\" \"texture "
        "reflectance\" \"t\"\nNamedMaterial \"m\" Shape \"disk\"\n"
        "ObjectBegin \"o\" Shape \"sphere\" \"float radius\" {0} ObjectEnd\n"
        "ObjectInstance \"o\"\n",
        value);
  };
  const LoadedScene loaded = load_pbrt_text(pbrt_world(lit + color(".25") + color(".75")));
  EXPECT_EQ(loaded.count("was defined before"), 3);
  const SceneData& scene = loaded.scene;
  std::vector<float> reds;
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.group == 0) reds.push_back(scene.materials[mesh.material].parameters[0].value.x);
  }
  EXPECT_EQ(reds, (std::vector<float>{0.25f, 0.75f}));
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_NE(scene.instances[0].group, scene.instances[1].group);
}

}  // namespace
}  // namespace pt
