// Files of a few KB that ask for 2^n work, and of a few MB that could take quadratic time: each
// part is read once, or a limit is stated.
#include <gtest/gtest.h>

#include <chrono>

#include "common/scene/prepare/prepare_scene.h"
#include "load/mitsuba_scene.h"

namespace pt {
namespace {

const std::string start = "<sensor type='perspective'/><emitter type='constant'/>\n";

/// `text` with every # as i and every @ as i - 1, for i from 1 to n.
std::string repeated(const std::string& text, int n) {
  std::string result;
  for (int i = 1; i <= n; ++i) {
    for (const char c : text) {
      if (c == '#')
        result += std::to_string(i);
      else if (c == '@')
        result += std::to_string(i - 1);
      else
        result += c;
    }
  }
  return result;
}

std::string blends(int n) {
  return "<bsdf type='diffuse' id='b0'/>" +
         repeated(
             "<bsdf type='blendbsdf' id='b#'><float name='weight' value='0.5'/><ref id='b@'/>"
             "<ref id='b@'/></bsdf>\n",
             n);
}

void expect_prepared(const std::string& xml, std::size_t most_materials,
                     std::size_t most_textures) {
  SceneData scene = load_xml(start + xml).scene;
  EXPECT_LE(scene.materials.size(), most_materials);
  EXPECT_LE(scene.textures.size(), most_textures);
  prepare_scene(scene, Options());
}

TEST(MitsubaHostile, BlendsOfBlendsAreReadOnce) {
  expect_prepared(blends(60) + "<shape type='sphere'><ref id='b60'/></shape>", 130, 0);
  // Fibonacci's, and with colours of vertices, which make copies.
  const std::string shown =
      "<bsdf type='diffuse' id='t0'><texture type='mesh_attribute' name='reflectance'>"
      "<string name='name' value='vertex_color'/></texture></bsdf>";
  expect_prepared(
      shown + repeated("<bsdf type='twosided' id='t#'><ref id='t@'/><ref id='t@'/></bsdf>", 60) +
          "<shape type='cube'><ref id='t60'/></shape>",
      400, 1);
  std::string uneven = "<bsdf type='diffuse' id='f0'/><bsdf type='plastic' id='f1'/>";
  for (int i = 2; i <= 90; ++i) {
    uneven += fmt::format(
        "<bsdf type='blendbsdf' id='f{}'><float name='weight' value='0.5'/>"
        "<ref id='f{}'/><ref id='f{}'/></bsdf>",
        i, i - 1, i - 2);
  }
  expect_prepared(uneven + "<shape type='sphere'><ref id='f90'/></shape>", 200, 0);
}

TEST(MitsubaHostile, BumpMapsOfBumpMapsAreReadOnce) {
  expect_prepared("<texture type='checkerboard' id='t'/><bsdf type='diffuse' id='b0'/>" +
                      repeated("<bsdf type='bumpmap' id='b#'><ref name='arbitrary' id='t'/>"
                               "<ref id='b@'/></bsdf>",
                               100) +
                      "<shape type='sphere'><ref id='b100'/></shape>",
                  101, 1);
}

TEST(MitsubaHostile, CheckerboardsOfCheckerboardsAreReadOnce) {
  const std::string boards = "<texture type='checkerboard' id='t0'/>" +
                             repeated(
                                 "<texture type='checkerboard' id='t#'><ref name='color0' id='t@'/>"
                                 "<ref name='color1' id='t@'/></texture>",
                                 100);
  expect_prepared(boards +
                      "<shape type='sphere'><bsdf type='roughconductor'><ref name='alpha' "
                      "id='t100'/><ref name='specular_reflectance' id='t100'/></bsdf></shape>",
                  1, 202);
  // Lamps are weighed by their textures: 0.5 (0.4 + 0.2), whatever holds them.
  SceneData scene = load_xml(start + boards +
                             "<shape type='rectangle'><emitter type='area'>"
                             "<ref name='radiance' id='t100'/></emitter></shape>")
                        .scene;
  prepare_scene(scene, Options());
  EXPECT_NEAR(scene.materials.at(0).emission.texture_mean, 0.3f, 1e-5f);
}

TEST(MitsubaHostile, VariablesHaveAnEnd) {
  const std::string tens = "<default name='a0' value='xxxxxxxxxxxxxxxx'/>" +
                           repeated(
                               "<default name='a#' value='$a@ $a@ $a@ $a@ $a@ $a@ $a@ $a@ "
                               "$a@ $a@'/>",
                               12);
  expect_error([&] { load_xml(tens + "<shape type='sphere' id='$a12'/>"); },
               "variables expand to more than 67108864 bytes");
  EXPECT_NO_THROW(load_xml(repeated("<default name='a#' value='1'/>", 1000) +
                           "<shape id='$a1' type='sphere'/>"));
}

TEST(MitsubaHostile, IncludesHaveAnEnd) {
  const TempFolder folder;
  const auto write_levels = [&](int levels, int width) {
    for (int i = 0; i < levels; ++i) {
      std::string inside;
      for (int k = 0; k < width; ++k)
        inside += "<include filename='i" + std::to_string(i + 1) + ".xml'/>";
      write_text(folder.file("i" + std::to_string(i) + ".xml"), "<scene>" + inside + "</scene>");
    }
    write_text(folder.file("i" + std::to_string(levels) + ".xml"),
               "<scene><shape type='sphere'/></scene>");
  };
  write_levels(15, 8);
  expect_error([&] { load_mitsuba_xml(folder.file("i0.xml")); }, "again and again");
  write_levels(3, 8);  // 512 times is a use
  EXPECT_EQ(load_mitsuba_xml(folder.file("i0.xml")).spheres.size(), 512u);
}

TEST(MitsubaHostile, WhatIsNestedTooDeeplyIsAnError) {
  const auto chain = [](const std::string& first, const std::string& link, bool backward) {
    std::vector<std::string> links = {first};
    for (int i = 1; i <= 20000; ++i) {
      std::string one;
      for (const char c : link) {
        if (c == '#')
          one += std::to_string(i);
        else if (c == '@')
          one += std::to_string(i - 1);
        else
          one += c;
      }
      links.push_back(one);
    }
    std::string xml;
    if (backward) std::reverse(links.begin(), links.end());
    for (const std::string& one : links) xml += one + "\n";
    return xml;
  };
  for (const bool backward : {false, true}) {
    expect_error(
        [&] {
          load_xml(chain("<bsdf type='diffuse' id='m0'/>",
                         "<bsdf type='twosided' id='m#'><ref id='m@'/></bsdf>", backward) +
                   "<shape type='sphere'><ref id='m20000'/></shape>");
        },
        "nested deeper than 128");
    expect_error(
        [&] {
          load_xml(chain("<texture type='checkerboard' id='t0'/>",
                         "<texture type='scale' id='t#'><ref id='t@'/></texture>", backward) +
                   "<shape type='sphere'/>");
        },
        "nested deeper than 128");
  }
}

double seconds_to_load(const std::string& xml) {
  const auto begin = std::chrono::steady_clock::now();
  load_xml(start + xml);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// Linear ones take some tenths of a second, quadratic ones minutes.
TEST(MitsubaHostile, NothingIsQuadratic) {
  constexpr int n = 100000;
  const double limit_s = 20;
  EXPECT_LT(seconds_to_load(repeated("<bsdf type='diffuse' id='b#'/>", n)), limit_s);
  EXPECT_LT(seconds_to_load("<shape type='sphere'>" + repeated("<float name='p#' value='1'/>", n) +
                            "</shape>"),
            limit_s);
  EXPECT_LT(seconds_to_load(repeated("<default name='n#' value='1'/>", n) +
                            repeated("<shape type='sphere' id='$n# #'/>", 5000)),
            limit_s);
  const std::string a(200000, 'a');
  EXPECT_LT(seconds_to_load("<default name='a' value='1'/><shape type='sphere' id='$" + a + "'/>"),
            limit_s);
  EXPECT_LT(seconds_to_load("<default name='" + a +
                            "' value='1'/><default name='a' value='1'/>"
                            "<shape type='sphere' id='" +
                            repeated("$aaaa", 100000) + "'/>"),
            limit_s);
  EXPECT_LT(seconds_to_load("<shape type='shapegroup' id='g'><shape type='rectangle'/></shape>" +
                            repeated("<shape type='disk'><bsdf type='mask'><bsdf type='diffuse'/>"
                                     "</bsdf></shape>",
                                     300) +
                            repeated("<shape type='instance'><ref id='g'/></shape>", n)),
            limit_s);
  EXPECT_LT(seconds_to_load(repeated("<shape type='rectangle'><bsdf type='diffuse'><texture "
                                     "type='checkerboard' name='reflectance'><float name='color0' "
                                     "value='0.#'/></texture></bsdf></shape>",
                                     100000)),
            limit_s);
}

TEST(MitsubaHostile, WarningsHaveANumber) {
  const LoadedScene many = load_xml(start + repeated("<wobble#/><shape type='s#'/>", 5000) +
                                    repeated("<shape type='sphere'><float name='x#' value='1'/>"
                                             "</shape>",
                                             5000));
  EXPECT_LE(many.warnings.size(), 500u);
  const LoadedScene twice =
      load_xml(start + "<shape type='sphere'>" +
               repeated("<float name='radius' value='#'/>", 5000) + "</shape>");
  EXPECT_EQ(twice.count("given twice"), 1);
}

std::string message_of(const std::string& xml) {
  try {
    const LoadedScene loaded = load_xml(xml);
    std::string all;
    for (const std::string& warning : loaded.warnings)
      all = std::max(all, warning, [](auto& a, auto& b) { return a.size() < b.size(); });
    return all;
  } catch (const Error& error) {
    return error.what();
  }
}

bool is_utf8(const std::string& text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto c = static_cast<unsigned char>(text[i]);
    const std::size_t n = c < 0x80 ? 1 : c >= 0xf0 ? 4 : c >= 0xe0 ? 3 : c >= 0xc0 ? 2 : 0;
    if (n == 0 || i + n > text.size()) return false;
    for (std::size_t k = 1; k < n; ++k) {
      if ((static_cast<unsigned char>(text[i + k]) & 0xc0) != 0x80) return false;
    }
    i += n;
  }
  return true;
}

TEST(MitsubaHostile, MessagesAreShort) {
  std::string text;
  for (int i = 0; i < 100000; ++i) text += i % 3 == 0 ? "\xe2\x82\xac" : "x\xc3\xa9";
  const std::string many = repeated("<float name='" + text.substr(0, 501) + "#' value='1'/>", 20);
  for (const std::string& xml :
       {"<shape type='sphere'><float name='radius' value='" + text + "'/></shape>",
        "<shape type='sphere'><boolean name='flip_normals' value='" + text + "'/></shape>",
        "<shape type='" + text + "'/>", "<shape type='sphere'><ref id='" + text + "'/></shape>",
        "<shape type='sphere'><bsdf type='" + text + "'/></shape>",
        "<shape type='sphere'><bsdf type='diffuse'><rgb name='reflectance' value='" + text +
            "'/></bsdf></shape>",
        "<shape type='sphere'><bsdf type='dielectric'><string name='int_ior' value='" + text +
            "'/></bsdf></shape>",
        "<shape type='sphere'>" + many + "</shape>", "<shape type='$x" + text + "'/>",
        "<shape type='sphere' id='" + text + "'/><shape type='sphere' id='" + text + "'/>",
        "<include filename='" + text + "'/>", "<path value='" + text + "'/>",
        "<shape type='obj'><string name='filename' value='" + text + "'/></shape>"}) {
    const std::string message = message_of(xml);
    EXPECT_LT(message.size(), 1000u) << xml.substr(0, 60);
    EXPECT_TRUE(is_utf8(message)) << message;
  }
  const std::string radius =
      message_of("<shape type='sphere'><float name='radius' value='" + text + "'/></shape>");
  EXPECT_NE(radius.find("radius is '"), radius.npos) << radius;
  EXPECT_NE(radius.find("'; expected a number"), radius.npos) << radius;
}

}  // namespace
}  // namespace pt
