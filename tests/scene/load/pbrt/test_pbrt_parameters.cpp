// Every parameter of a directive: given its default, it changes nothing; given another value, it
// does. Defaults are those of pbrt-v4's documentation of its file format, and of pbrt-v3's where
// only that version has the directive. And every warning: what it is said of, and what is next to
// that and silent.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "load/expect_near.h"
#include "load/pbrt_scene.h"
#include "load/scene_print.h"

namespace pt {
namespace {

/// Pictures and a file to include, beside the scene.
class PbrtFolder : public TempFolder {
 public:
  PbrtFolder() {
    picture("square.pfm", 2, 2), picture("wide.pfm", 4, 2), picture("odd.pfm", 3, 2);
    write_text(file("part.pbrt"), "# nothing\n");
    write_text(file("mesh.ply"),
               "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
               "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
               "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n3 1 3 2\n");
  }
  LoadedScene load(const std::string& text) const {
    write_text(file("scene.pbrt"), text);
    return load_pbrt_file(file("scene.pbrt"));
  }

 private:
  void picture(const char* name, int width, int height) const {
    std::string bytes = fmt::format("PF\n{} {}\n-1\n", width, height);
    for (int i = 0; i < width * height; ++i) {
      const Color c(0.5f, 0.25f * static_cast<float>(i), 0.125f);
      bytes.append(reinterpret_cast<const char*>(&c), sizeof c);
    }
    write_text(file(name), bytes);
  }
};

/// A directive up to its parameters, what must follow, and (parameter, default, another value).
struct Directive {
  std::string before, after;
  std::vector<std::array<const char*, 3>> parameters;
};

const std::string ball = " Shape \"sphere\"";

void expect_defaults(const std::vector<Directive>& directives) {
  const PbrtFolder folder;
  for (const Directive& d : directives) {
    const auto print = [&](const std::string& parameter) {
      return print_of(folder.load(d.before + " " + parameter + " " + d.after).scene);
    };
    const std::string without = print("");
    for (const auto& [name, usual, other] : d.parameters) {
      const auto given = [name = name](const char* value) {
        return fmt::format("\"{}\" {}", name, value);
      };
      EXPECT_EQ(print(given(usual)), without) << d.before << " " << given(usual);
      EXPECT_NE(print(given(other)), without) << d.before << " " << given(other);
    }
  }
}

std::string world(const std::string& text) { return pbrt_world(lit + text); }

TEST(PbrtParameters, OfLights) {
  const auto light = [](const std::string& type, const std::string& more = {}) {
    return pbrt_world("LightSource \"" + type + "\" " + more);
  };
  const std::string lamp = world("AreaLightSource \"diffuse\" ");
  expect_defaults({{light("point"),
                    ball,
                    {{"float scale", "1", "2"},
                     {"rgb I", "[1 1 1]", "[2 1 1]"},
                     {"point3 from", "[0 0 0]", "[1 0 0]"}}},
                   {light("spot"),
                    ball,
                    {{"float scale", "1", "2"},
                     {"rgb scale", "[1 1 1]", "[1 2 1]"},
                     {"rgb I", "[1 1 1]", "[1 1 2]"},
                     {"point3 from", "[0 0 0]", "[1 0 0]"},
                     {"point3 to", "[0 0 1]", "[1 0 1]"},
                     {"float coneangle", "30", "31"},
                     {"float conedeltaangle", "5", "6"}}},
                   {light("distant"),
                    ball,
                    {{"float scale", "1", "2"},
                     {"rgb L", "[1 1 1]", "[1 2 1]"},
                     {"point3 from", "[0 0 0]", "[1 0 0]"},
                     {"point3 to", "[0 0 1]", "[1 0 1]"}}},
                   {light("infinite"),
                    ball,
                    {{"float scale", "1", "2"},
                     {"rgb L", "[1 1 1]", "[1 2 1]"},
                     {"float illuminance", "0", "1"}}},
                   {light("infinite", "\"string filename\" \"square.pfm\""),
                    ball,
                    {{"float scale", "1", "2"}, {"float illuminance", "0", "1"}}},
                   {lamp,
                    ball,
                    {{"float scale", "1", "2"},
                     {"rgb L", "[1 1 1]", "[1 2 1]"},
                     {"bool twosided", "false", "true"},
                     {"float power", "0", "1"}}}});
}

TEST(PbrtParameters, OfMedia) {
  const auto medium = [](const std::string& type, const std::string& more = {}) {
    return world("MakeNamedMedium \"m\" \"string type\" \"" + type + "\" " + more);
  };
  const std::string use = "MediumInterface \"m\" \"\" Material \"interface\"" + ball;
  const std::vector<std::array<const char*, 3>> coefficients = {
      {"rgb sigma_a", "[1 1 1]", "[1 2 1]"},
      {"rgb sigma_s", "[1 1 1]", "[1 2 1]"},
      {"float g", "0", ".1"}};
  const auto and_more = [&](std::vector<std::array<const char*, 3>> more) {
    more.insert(more.end(), coefficients.begin(), coefficients.end());
    return more;
  };
  const std::string box = "\"integer nx\" 2 \"float density\" [1 2] ";
  expect_defaults(
      {{medium("homogeneous"), use,
        and_more({{"float scale", "1", "2"}, {"rgb Le", "[0 0 0]", "[1 1 1]"}})},
       {medium("homogeneous", "\"rgb Le\" [1 1 1]"), use, {{"float Lescale", "1", "2"}}},
       {medium("uniformgrid", box), use,
        and_more({{"float scale", "1", "2"},
                  {"integer ny", "1", "1 \"integer nz\" 1 \"float scale\" 2"},
                  {"point3 p0", "[0 0 0]", "[-1 0 0]"},
                  {"point3 p1", "[1 1 1]", "[2 1 1]"}})},
       {medium("uniformgrid", box + "\"float temperature\" [2000 3000]"),
        use,
        {{"float temperaturescale", "1", "1.5"},
         {"float temperatureoffset", "0", "100"},
         {"float temperaturecutoff", "0", "100"}}},
       {medium("rgbgrid", "\"rgb sigma_a\" [1 2 3] \"rgb Le\" [1 1 1]"),
        use,
        {{"float scale", "1", "2"},
         {"float Lescale", "1", "2"},
         {"rgb sigma_s", "[1 1 1]", "[1 2 1]"},
         {"float g", "0", ".1"},
         {"integer nx", "1", "1 \"float scale\" 3"}}},
       // a small part of it, to be quick
       {medium("cloud", "\"point3 p0\" [0 .6 0] \"point3 p1\" [.1 .7 .1]"), use,
        and_more({{"float density", "1", "2"},
                  {"float wispiness", "1", "2"},
                  {"float frequency", "5", "4"}})}});
}

TEST(PbrtParameters, OfMaterials) {
  const auto material = [](const std::string& type, const std::string& more = {}) {
    return world("Material \"" + type + "\" " + more);
  };
  const std::string mix =
      "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" MakeNamedMaterial \"b\" \"string type\" "
      "\"dielectric\" Material \"mix\" \"string materials\" [\"a\" \"b\"]";
  const std::array<const char*, 3> half = {"rgb reflectance", "[.5 .5 .5]", "[.5 .6 .5]"};
  const std::array<const char*, 3> remap = {"bool remaproughness", "true", "false"};
  expect_defaults(
      {{material("diffuse"), ball, {half}},
       {material("coateddiffuse"),
        ball,
        {half,
         {"float roughness", "0", ".1"},
         {"float uroughness", "0", ".1"},
         {"float thickness", ".01", ".02"},
         {"float eta", "1.5", "1.6"}}},
       {material("diffusetransmission"),
        ball,
        {{"rgb reflectance", "[.25 .25 .25]", "[.5 .25 .25]"},
         {"rgb transmittance", "[.25 .25 .25]", "[.25 .5 .25]"},
         {"float scale", "1", ".5"}}},
       {material("conductor"),
        ball,
        {{"float roughness", "0", ".1"},
         {"float uroughness", "0", ".1"},
         {"float vroughness", "0", ".1"},
         {"spectrum eta", "\"metal-Cu-eta\"", "\"metal-Au-eta\""},
         {"spectrum k", "\"metal-Cu-k\"", "\"metal-Au-k\""}}},
       {material("conductor", "\"float roughness\" .1"), ball, {remap}},
       {material("coatedconductor"),
        ball,
        {{"float interface.eta", "1.5", "1.6"},
         {"float interface.roughness", "0", ".1"},
         {"float conductor.roughness", "0", ".1"},
         {"float thickness", ".01", ".02"},
         {"spectrum conductor.eta", "\"metal-Cu-eta\"", "\"metal-Au-eta\""},
         {"spectrum conductor.k", "\"metal-Cu-k\"", "\"metal-Au-k\""}}},
       {material("dielectric"),
        ball,
        {{"float eta", "1.5", "1.6"}, {"float roughness", "0", ".1"}}},
       {material("dielectric", "\"float roughness\" .1"), ball, {remap}},
       {material("thindielectric"), ball, {{"float eta", "1.5", "1.6"}}},
       {material("subsurface"), ball, {{"rgb reflectance", "[.7 .7 .7]", "[.5 .7 .7]"}}},
       {material("hair"), ball, {{"rgb reflectance", "[.25 .12 .06]", "[.5 .12 .06]"}}},
       {material("subsurface"),
        ball,
        {{"float eta", "1.33", "1.5"}, {"float roughness", "0", ".1"}}},
       {world(mix), ball, {{"float amount", ".5", ".6"}}},
       // pbrt-v3
       {material("matte"), ball, {{"rgb Kd", "[.5 .5 .5]", "[.5 .6 .5]"}}},
       {material("plastic"),
        ball,
        {{"rgb Kd", "[.25 .25 .25]", "[.5 .25 .25]"},
         {"rgb Ks", "[.25 .25 .25]", "[.5 .25 .25]"},
         {"float roughness", ".1", ".2"},
         remap}},
       {material("metal"), ball, {{"float roughness", ".01", ".2"}, remap}},
       {material("mirror"), ball, {{"rgb Kr", "[.9 .9 .9]", "[1 .9 .9]"}}},
       {material("glass"),
        ball,
        {{"rgb Kr", "[1 1 1]", "[.9 1 1]"},
         {"rgb Kt", "[1 1 1]", "[.9 1 1]"},
         {"float eta", "1.5", "1.6"},
         {"float index", "1.5", "1.6"},
         {"float uroughness", "0", ".1"},
         {"float vroughness", "0", ".1"}}},
       {material("uber"),
        ball,
        {{"rgb Kd", "[.25 .25 .25]", "[.5 .25 .25]"},
         {"rgb Ks", "[.25 .25 .25]", "[.5 .25 .25]"},
         {"rgb Kr", "[0 0 0]", "[1 0 0]"},
         {"rgb Kt", "[0 0 0]", "[1 0 0]"},
         {"float roughness", ".1", ".2"},
         {"float eta", "1.5", "1.6"},
         {"float index", "1.5", "1.6"},
         {"rgb opacity", "[1 1 1]", "[.5 1 1]"}}},
       {material("substrate"),
        ball,
        {{"rgb Kd", "[.5 .5 .5]", "[.6 .5 .5]"},
         {"rgb Ks", "[.5 .5 .5]", "[.6 .5 .5]"},
         {"float uroughness", ".1", ".2"},
         {"float vroughness", ".1", ".2"}}},
       {material("translucent"),
        ball,
        {{"rgb Kd", "[.25 .25 .25]", "[.5 .25 .25]"},
         {"rgb Ks", "[.25 .25 .25]", "[.5 .25 .25]"},
         {"rgb reflect", "[.5 .5 .5]", "[.6 .5 .5]"},
         {"rgb transmit", "[.5 .5 .5]", "[.6 .5 .5]"},
         {"float roughness", ".1", ".2"}}},
       {material("disney"),
        ball,
        {{"rgb color", "[.5 .5 .5]", "[.6 .5 .5]"},
         {"float anisotropic", "0", ".1"},
         {"float clearcoat", "0", ".1"},
         {"float clearcoatgloss", "1", ".9"},
         {"float eta", "1.5", "1.6"},
         {"float metallic", "0", ".1"},
         {"float roughness", ".5", ".6"},
         {"float sheen", "0", ".1"},
         {"float sheentint", ".5", ".6"},
         {"float spectrans", "0", ".1"},
         {"float speculartint", "0", ".1"},
         {"bool thin", "false", "true"}}},
       {material("disney", "\"bool thin\" true"),
        ball,
        {{"float difftrans", "1", ".9"}, {"float flatness", "0", ".1"}}},
       {material("kdsubsurface"),
        ball,
        {{"rgb Kd", "[.5 .5 .5]", "[.6 .5 .5]"}, {"float eta", "1.33", "1.5"}}}});
}

TEST(PbrtParameters, OfTextures) {
  const auto texture = [](const std::string& type, const std::string& more = {}) {
    return world("Texture \"t\" \"spectrum\" \"" + type + "\" " + more);
  };
  const std::string use = "Material \"diffuse\" \"texture reflectance\" \"t\"" + ball;
  const std::vector<std::array<const char*, 3>> mapping = {
      {"string mapping", "\"uv\"", "\"planar\""},
      {"float uscale", "1", "2"},
      {"float vscale", "1", "2"},
      {"float udelta", "0", ".5"},
      {"float vdelta", "0", ".5"}};
  const auto and_mapping = [&](std::vector<std::array<const char*, 3>> more) {
    more.insert(more.end(), mapping.begin(), mapping.end());
    return more;
  };
  expect_defaults(
      {{texture("imagemap", "\"string filename\" \"wide.pfm\""), use,
        and_mapping({{"float scale", "1", "2"},
                     {"bool invert", "false", "true"},
                     {"string wrap", "\"repeat\"", "\"clamp\""},
                     {"string filter", "\"bilinear\"", "\"point\""}})},
       {texture("imagemap", "\"string filename\" \"wide.pfm\" \"string mapping\" \"planar\""),
        use,
        {{"vector3 v1", "[1 0 0]", "[2 0 0]"},
         {"vector3 v2", "[0 1 0]", "[0 2 0]"},
         {"float udelta", "0", ".5"},
         {"float vdelta", "0", ".5"}}},
       {texture("constant"), use, {{"rgb value", "[1 1 1]", "[.5 1 1]"}}},
       {texture("scale"), use, {{"rgb tex", "[1 1 1]", "[.5 1 1]"}, {"float scale", "1", ".5"}}},
       {texture("mix"),
        use,
        {{"rgb tex1", "[0 0 0]", "[.5 0 0]"},
         {"rgb tex2", "[1 1 1]", "[.5 1 1]"},
         {"float amount", ".5", ".6"}}},
       {texture("checkerboard"), use,
        and_mapping({{"rgb tex1", "[1 1 1]", "[.5 1 1]"}, {"rgb tex2", "[0 0 0]", "[.5 0 0]"}})}});
}

TEST(PbrtParameters, OfShapes) {
  const std::string textured = world(
      "Texture \"t\" \"spectrum\" \"checkerboard\" Material \"diffuse\" \"texture reflectance\" "
      "\"t\" ");
  const auto shape = [&](const std::string& type, const std::string& more = {}) {
    return textured + "Shape \"" + type + "\" " + more;
  };
  const std::string curve = "\"point3 P\" [0 0 0 1 0 0 1 1 0 2 1 0] \"string type\" \"cylinder\"";
  const std::string cage = "\"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]";
  expect_defaults({{shape("sphere"),
                    "",
                    {{"float radius", "1", "2"},
                     {"float zmin", "-1", "-.5"},
                     {"float zmax", "1", ".5"},
                     {"float phimax", "360", "350"},
                     {"float alpha", "1", ".5"}}},
                   {shape("disk"),
                    "",
                    {{"float radius", "1", "2"},
                     {"float height", "0", "1"},
                     {"float innerradius", "0", ".5"},
                     {"float phimax", "360", "350"}}},
                   {shape("disk", "\"float radius\" 3"), "", {{"float innerradius", "0", "2"}}},
                   {shape("cylinder"),
                    "",
                    {{"float radius", "1", "2"},
                     {"float zmin", "-1", "-.5"},
                     {"float zmax", "1", ".5"},
                     {"float phimax", "360", "350"}}},
                   {shape("curve", curve),
                    "",
                    {{"float width", "1", "2"},
                     {"float width0", "1", "2"},
                     {"float width1", "1", "2"},
                     {"integer degree", "3", "3 \"float width\" 3"},
                     {"string basis", "\"bezier\"", "\"bspline\""}}},
                   {shape("curve", curve + " \"float width\" 3"),
                    "",
                    {{"float width0", "3", "1"}, {"float width1", "3", "1"}}},
                   {shape("loopsubdiv", cage),
                    "",
                    {{"integer levels", "3", "2"}, {"integer nlevels", "3", "2"}}}});
}

TEST(PbrtParameters, OfViews) {
  const std::string rest = " WorldBegin " + lit + ball;
  expect_defaults(
      {{"Camera \"perspective\"",
        rest,
        {{"float fov", "90", "80"},
         {"float lensradius", "0", ".5"},
         {"float shutteropen", "0", ".5"},
         {"float shutterclose", "1", ".5"}}},
       {"Camera \"perspective\" \"float lensradius\" .5",
        rest,
        {{"float focaldistance", "1e6", "7"}}},
       {"Camera \"orthographic\"",
        rest,
        {{"float shutteropen", "0", ".5"},
         {"float screenwindow", "[-1.7777778 1.7777778 -1 1]", "[-1.7777778 1.7777778 -2 0]"}}},
       {"Film \"rgb\"",
        rest,
        {{"integer xresolution", "1280", "1279"},
         {"integer yresolution", "720", "719"},
         {"float cropwindow", "[0 1 0 1]", "[0 1 0 .5]"},
         {"float iso", "100", "200"},
         {"float whitebalance", "0", "5000"},
         {"string sensor", "\"cie1931\"", "\"canon_eos_5d\""}}},
       {"PixelFilter \"box\"", rest, {{"float xradius", ".5", "1"}}},
       {"PixelFilter \"triangle\"", rest, {{"float xradius", "2", "1"}}},
       {"PixelFilter \"gaussian\"", rest, {{"float sigma", ".5", ".25"}}},
       {"PixelFilter \"mitchell\"",
        rest,
        {{"float B", ".33333334", ".5"}, {"float C", ".33333334", ".5"}}},
       {"PixelFilter \"sinc\"", rest, {{"float tau", "3", "2"}}},
       {"Sampler \"zsobol\"", rest, {{"integer pixelsamples", "16", "17"}}},
       {"Sampler \"stratified\"",
        rest,
        {{"integer xsamples", "4", "5"}, {"integer ysamples", "4", "5"}}},
       {"Integrator \"volpath\"", rest, {{"integer maxdepth", "5", "6"}}}});
}

/// What a text is said to be, in the only warning; nothing: there is none.
struct Said {
  std::string text, message = {};
};

void expect_said(const std::vector<Said>& all) {
  const PbrtFolder folder;
  for (const auto& [text, message] : all) {
    const LoadedScene loaded = folder.load(
        text.starts_with("Film") || text.starts_with("Camera") || text.starts_with("PixelF") ||
                text.starts_with("Integ") || text.starts_with("Renderer")
            ? text + " WorldBegin " + lit + ball
            : world(text + ball));
    int others = 0;
    for (const std::string& w : loaded.warnings)
      others += w.find("pbrt --upgrade") == w.npos && w.find("no Camera") == w.npos &&
                (message.empty() || w.find(message) == w.npos);
    EXPECT_EQ(others, 0) << text << " said " << testing::PrintToString(loaded.warnings);
    if (!message.empty()) {
      EXPECT_EQ(loaded.count(message), 1)
          << text << " said " << testing::PrintToString(loaded.warnings);
    }
  }
}

TEST(PbrtWarnings, OfColoursAndTextures) {
  const std::string use = " Material \"diffuse\" \"texture reflectance\" \"t\"";
  const auto texture = [&](const std::string& text) {
    return "Texture \"t\" \"spectrum\" " + text + use;
  };
  const std::string picture = "\"imagemap\" \"string filename\" \"wide.pfm\" ";
  expect_said(
      {{"Material \"diffuse\" \"float reflectance\" .3",
        "'float reflectance' as a colour: grey is used"},
       {"Material \"diffuse\" \"rgb reflectance\" [1 1 1]"},
       {"Material \"diffuse\" \"rgb reflectance\" [1 1.01 1]",
        "'rgb reflectance' above 1: 1 is used"},
       {"Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"",
        "'spectrum eta': the index of refraction 1.5168"},
       {"Material \"dielectric\" \"float eta\" 1.5"},
       {texture("\"imagemap\" \"string filename\" \"WIDE.pfm\""), "whose case differs, is used"},
       {texture(picture)},
       {texture(picture + "\"string wrap\" \"clamp\"")},
       {texture(picture + "\"string wrap\" \"black\""),
        "wrap 'black' is not supported: clamp is used"},
       {texture(picture + "\"string filter\" \"trilinear\"")},
       {texture(picture + "\"string filter\" \"EWA\"")},
       {texture(picture + "\"string filter\" \"box\""),
        "filter 'box' is not known: bilinear is used"},
       {texture(picture + "\"string mapping\" \"cubic\""),
        "mapping 'cubic' is not known: uv is used"},
       {texture("\"directionmix\" \"vector3 dir\" [0 0 1]"),
        "'directionmix' is not supported: an even mix"},
       {texture("\"checkerboard\" \"integer dimension\" 2")},
       {texture("\"checkerboard\" \"integer dimension\" 3"), "a checkerboard of dimension 3"},
       {texture("\"marble\""), "texture 'marble' is not supported: 0.5 is used"},
       {"Texture \"t\" \"float\" " + picture +
            "Material \"coateddiffuse\" \"texture thickness\" \"t\"",
        "a texture as 'thickness' is not supported: 0.01 is used"},
       {"Texture \"t\" \"float\" \"constant\" Material \"coateddiffuse\" \"texture thickness\" "
        "\"t\""},
       {"Texture \"t\" \"spectrum\" " + picture +
            "Material \"translucent\" \"texture reflect\" \"t\"",
        "a texture as 'reflect' is not supported: 0.5 is used"},
       {"Texture \"t\" \"float\" \"checkerboard\" Material \"diffuse\" \"texture displacement\" "
        "\"t\"",
        "a 'displacement' of a material that is no picture"},
       {"Texture \"t\" \"float\" " + picture +
        "Material \"diffuse\" \"texture displacement\" \"t\""}});
}

TEST(PbrtWarnings, OfMaterials) {
  const auto material = [](const std::string& text) { return "Material " + text; };
  expect_said({{material("\"coateddiffuse\" \"float uroughness\" .1 \"float vroughness\" .1")},
               {material("\"coateddiffuse\" \"float uroughness\" .1 \"float vroughness\" .2"),
                "an anisotropic coat is not supported: uroughness is used for both"},
               {material("\"coateddiffuse\" \"rgb albedo\" [0 0 0]")},
               {material("\"coateddiffuse\" \"rgb albedo\" [0 0 .1]"),
                "a medium in a coat ('albedo', 'g')"},
               {material("\"coatedconductor\""),
                "'coatedconductor' is not supported: a blend of its metal"},
               {material("\"measured\" \"string filename\" \"a.bsdf\""),
                "a rough metal that reflects one half"},
               {material("\"subsurface\""),
                "a coated diffuse surface of its 'reflectance' (or 0.7) is used"},
               {material("\"hair\""), "a diffuse surface of its colour (or brown) is used"},
               {material("\"kdsubsurface\""), "a coated diffuse surface of its 'Kd' is used"},
               {material("\"matte\" \"float sigma\" 0")},
               {material("\"matte\" \"float sigma\" .1"), "'sigma' of material 'matte'"},
               {material("\"velvet\""), "material 'velvet' is not known: diffuse grey is used"}});
}

TEST(PbrtWarnings, OfLights) {
  const std::string spot = "LightSource \"spot\" \"float coneangle\" 20 ",
                    infinite = "LightSource \"infinite\" ";
  const std::string lamp = "AttributeBegin AreaLightSource \"diffuse\" ",
                    end = ball + " AttributeEnd";
  const std::string two =
      " Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] \"integer indices\" [0 1 2 1 "
      "3 2";
  expect_said(
      {{spot + "\"float conedeltaangle\" 40"},
       {spot + "\"float conedeltaangle\" 40.1", "the spot falls off from its axis on"},
       {"Scale 2 1 1 " + spot},
       {"Scale 2 1 1 LightSource \"spot\" \"float coneangle\" 85", "its cone is round"},
       {infinite + "\"point3 portal\" [0 0 0 1 0 0 1 1 0 0 1 0]", "'portal' of an infinite light"},
       {infinite + "\"string filename\" \"square.pfm\""},
       {infinite + "\"string filename\" \"wide.pfm\""},
       {infinite + "\"string filename\" \"odd.pfm\"",
        "3x2 pixels are taken for longitude and latitude"},
       {infinite + "\"string filename\" \"wide.pfm\" \"rgb L\" [1 1 1]",
        "an infinite light of both 'L' and 'filename': 'L' is ignored"},
       {infinite + "\"string mapname\" \"wide.pfm\" \"rgb L\" [1 1 1]"},
       {"LightSource \"goniometric\"", "light 'goniometric' is not supported: it is left out"},
       {lamp + "\"string filename\" \"wide.pfm\"" + end},
       {lamp + "\"string filename\" \"wide.pfm\" \"rgb L\" [1 1 1]" + end,
        "an area light of both 'L' and 'filename': 'L' is ignored"},
       {"AttributeBegin AreaLightSource \"glow\"" + end,
        "area light 'glow' is not known: diffuse is used"},
       {lamp + "\"float power\" 3" + two + "] AttributeEnd"},
       {lamp + "\"float power\" 3" + two + " 0 2 3] AttributeEnd",
        "'power' of a light of many triangles"},
       {lamp + two + " 0 2 3] AttributeEnd"},
       {"ObjectBegin \"o\" " + lamp + end + " ObjectEnd",
        "an area light in an object is not supported"},
       {lamp + " Material \"interface\"" + end, "a light that rays pass"}});
}

TEST(PbrtWarnings, OfShapes) {
  const std::string triangle = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] ";
  const std::string patch = "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] ";
  const std::string curve = "Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 1 1 0 2 1 0] ";
  const std::string ply = "Shape \"plymesh\" \"string filename\" \"mesh.ply\" ";
  const auto mapped = [&](const char* mapping) {
    return fmt::format(
        "Texture \"a\" \"spectrum\" \"checkerboard\" Texture \"b\" \"spectrum\" "
        "\"checkerboard\" \"string mapping\" \"{}\" Texture \"c\" \"spectrum\" "
        "\"mix\" \"texture tex1\" \"a\" \"texture tex2\" \"b\" AttributeBegin "
        "Material \"diffuse\" \"texture reflectance\" \"c\" {} AttributeEnd",
        mapping, triangle);
  };
  expect_said(
      {{patch},
       {patch + "\"string emissionfilename\" \"wide.pfm\"", "'emissionfilename' of bilinearmesh"},
       {curve + "\"string type\" \"cylinder\""},
       {curve + "\"string type\" \"flat\"", "a curve that is flat and turns to its viewer"},
       {curve, "a curve that is flat and turns to its viewer"},
       {triangle + "\"normal N\" [0 0 1 0 0 1 0 0 1]"},
       {triangle + "\"normal N\" [0 0 1 0 0 1]",
        "2 values in 'N' of Shape 'trianglemesh': ignored; expected 3"},
       {triangle + "\"point2 uv\" [0 0 1 0 0 1 1 1]",
        "4 values in 'uv' of Shape 'trianglemesh': ignored"},
       {triangle + "\"point2 st\" [0 0 1 0]", "2 values in 'st'"},
       {triangle + "\"integer indices\" [0 1 2 2 1 0]"},
       {triangle + "\"integer indices\" [0 1 2 0 1]", "5 indices: the last 2 are left out"},
       {ply},
       {ply + "\"texture displacement\" \"d\"", "'displacement' of plymesh is not supported"},
       {mapped("uv")},
       {mapped("planar"), "textures of different mappings on one surface"},
       {"Shape \"hyperboloid\"", "shape 'hyperboloid' is not supported: it is left out"}});
}

TEST(PbrtWarnings, OfDirectives) {
  expect_said(
      {{"Include \"part.pbrt\""},
       {"Include \"PART.pbrt\"", "whose case differs, is used"},
       {"CoordSysTransform \"world\""},
       {"CoordSysTransform \"none\"", "there is no coordinate system 'none'"},
       {"ObjectBegin \"o\" ObjectEnd ObjectBegin \"p\" ObjectEnd"},
       {"ObjectBegin \"o\" ObjectEnd ObjectBegin \"o\" ObjectEnd",
        "an object 'o' was defined before"},
       {"TransformTimes 0 1 ActiveTransform All"},
       {"ActiveTransform EndTime Scale 2 2 2 ActiveTransform All"},
       {"TransformTimes 2 1", "expected the end after the beginning"},
       {"ActiveTransform EndTime Translate 1 0 0 LightSource \"point\"",
        "LightSources that move are not supported"},
       {"ObjectBegin \"m\" ActiveTransform EndTime Translate 1 0 0 " + ball + "ObjectEnd",
        "shapes that move inside of an object are not supported"},
       {"MakeNamedMedium \"m\" \"string type\" \"homogeneous\" MakeNamedMedium \"m\" \"string "
        "type\" "
        "\"homogeneous\"",
        "a medium 'm' was defined before: the new one is ignored"},
       {"MakeNamedMaterial \"m\" \"string type\" \"diffuse\" MakeNamedMaterial \"m\" \"string "
        "type\" "
        "\"diffuse\"",
        "a material 'm' was defined before: from here on the new one is used"},
       {"Texture \"t\" \"float\" \"constant\" Texture \"t\" \"spectrum\" \"constant\""},
       {"Texture \"t\" \"float\" \"constant\" Texture \"t\" \"float\" \"constant\"",
        "a texture 't' was defined before: from here on the new one is used"},
       {"Option \"integer seed\" 3 Option \"disablewavelengthjitter\" true"},
       {"Option \"bool forcediffuse\" true", "Option 'forcediffuse' is not supported and ignored"},
       {"Renderer \"sampler\"", "Renderer 'sampler' is of pbrt-v2 and ignored"},
       {"Volume \"exponential\"", "Volume 'exponential' is of pbrt-v2 and ignored"}});
}

TEST(PbrtWarnings, OfViews) {
  const std::string camera = "Camera \"perspective\" ", film = "Film \"rgb\" ";
  const std::string small = film + "\"integer xresolution\" 20 \"integer yresolution\" 10 ";
  expect_said(
      {{camera},
       {small + camera + "\"float screenwindow\" [-2 2 -1 1]"},
       {small + camera + "\"float screenwindow\" [-1 1 -1 1]", "make pixels that are no squares"},
       {small + camera + "\"float frameaspectratio\" 2"},
       {small + camera + "\"float frameaspectratio\" 1", "make pixels that are no squares"},
       {"Camera \"orthographic\" \"float lensradius\" 0 \"float focaldistance\" 3"},
       {"Camera \"orthographic\" \"float lensradius\" .1", "the lens of an orthographic camera"},
       {"Camera \"realistic\" \"string lensfile\" \"a.dat\"",
        "camera 'realistic' is not supported: perspective"},
       {film + "\"float whitebalance\" 5000", "whitebalance 5000 changes the colours of lights"},
       {film + "\"float whitebalance\" 0"},
       {"Film \"gbuffer\" \"string coordinatesystem\" \"world\"",
        "film 'gbuffer' is not supported: rgb is used"},
       {film + "\"string sensor\" \"canon_eos_5d\"", "sensor 'canon_eos_5d' is not supported"},
       {"PixelFilter \"catmull\"", "filter 'catmull' is not known: box is used"},
       {"PixelFilter \"box\" \"float xradius\" 1 \"float yradius\" 1"},
       {"PixelFilter \"box\" \"float xradius\" 1 \"float yradius\" 2",
        "a radius of our own is used"},
       {"PixelFilter \"mitchell\" \"float xradius\" 2"},
       {"PixelFilter \"mitchell\" \"float xradius\" 1 \"float yradius\" 1",
        "a radius of our own is used"},
       {"Integrator \"sppm\""},
       {"Integrator \"ambientocclusion\"", "integrator 'ambientocclusion' is not supported"}});
}

// Both sides of each limit: an error loses the directive, which then says so.
TEST(PbrtParameters, Limits) {
  const std::string light = "LightSource \"point\" ", disk = "Shape \"disk\" ";
  const std::string curve =
      "Shape \"curve\" \"string type\" \"cylinder\" \"point3 P\" [0 0 0 1 0 0 1 1 0 2 1 0] ";
  const std::string medium = "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" ",
                    inside = " MediumInterface \"m\" \"\"";
  const std::string grid =
      "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"float density\" [1] ";
  expect_said(
      {{light + "\"blackbody I\" 100", "has no light that can be seen"},
       {light + "\"blackbody I\" 99.9", "blackbody 99.9; expected kelvins from 100 to 1e6"},
       {light + "\"blackbody I\" 1e6"},
       {light + "\"blackbody I\" 1000001", "blackbody 1000001; expected kelvins"},
       {light + "\"rgb I\" [0 0 0]"},
       {light + "\"rgb I\" [0 -1 0]", "'rgb I' with a negative number"},
       {light + "\"spectrum I\" [400 1 500 1]"},
       {light + "\"spectrum I\" [400 1 400 1]", "a spectrum whose wavelengths do not grow"},
       {light + "\"spectrum I\" [400 1 500]", "'spectrum I' has 3 numbers; expected pairs"},
       {"LightSource \"spot\" \"float coneangle\" 180"},
       {"LightSource \"spot\" \"float coneangle\" 180.1", "spot: coneangle 180.1"},
       {"LightSource \"spot\" \"float coneangle\" 0", "spot: coneangle 0"},
       {"LightSource \"spot\" \"float conedeltaangle\" 0"},
       {"LightSource \"spot\" \"float conedeltaangle\" -1", "conedeltaangle -1"},
       {curve + "\"float width\" 0", "a mesh without triangles is left out"},
       {curve + "\"float width0\" -.1", "curve: a width below 0"},
       {curve + "\"float width1\" -.1", "curve: a width below 0"},
       {curve + "\"integer degree\" 4", "curve: degree 4"},
       {curve + "\"integer degree\" 1", "curve: degree 1"},
       {disk + "\"float radius\" 0", "radius 0; expected a length above 0"},
       {"Material \"dielectric\" \"float eta\" .01"},
       {"Material \"dielectric\" \"float eta\" 0", "'float eta' of 0; expected one above 0"},
       {"Material \"dielectric\" \"float roughness\" -.1", "expected one that is not negative"},
       {"Material \"glass\" \"float eta\" 0", "an 'eta' of 0; expected one above 0"},
       {"Material \"glass\" \"float index\" 0", "an 'index' of 0; expected one above 0"},
       {"Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"wide.pfm\" \"float scale\" "
        "0 "
        "Material \"diffuse\" \"texture reflectance\" \"t\""},
       {"Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"wide.pfm\" \"float scale\" "
        "-1 "
        "Material \"diffuse\" \"texture reflectance\" \"t\"",
        "imagemap: expected a scale that is not negative"},
       {"Material \"coateddiffuse\" \"float thickness\" 0"},
       {"Material \"coateddiffuse\" \"float thickness\" -1", "a thickness below 0"},
       {medium + "\"float g\" -.99" + inside},
       {medium + "\"float g\" 1" + inside, "'float g' of 1; expected more than -1"},
       {medium + "\"float g\" -1" + inside, "'float g' of -1; expected more than -1"},
       {medium + "\"float scale\" -1" + inside, "'float scale' of -1; expected a finite number"},
       {grid + inside},
       {grid + "\"integer nx\" 0" + inside, "'integer nx' of 0; expected 1 to 65536 samples"},
       {grid + "\"integer nx\" 2" + inside,
        "'float density' has 1 values; expected nx * ny * nz = 2"},
       {grid + "\"point3 p1\" [1 1 0]" + inside, "a grid without volume"}});
  // The same of the view, which is as if it had no parameters.
  const char* defaults = "is as if it had no parameters";
  expect_said({{"Film \"rgb\" \"integer xresolution\" 65535"},
               {"Film \"rgb\" \"integer yresolution\" 65536", defaults},
               {"Film \"rgb\" \"float whitebalance\" 1000", "whitebalance 1000 changes"},
               {"Film \"rgb\" \"float whitebalance\" 25001", defaults},
               {"Film \"rgb\" \"float iso\" 0", defaults},
               {"Camera \"perspective\" \"float fov\" 179.9"},
               {"Camera \"perspective\" \"float lensradius\" -1", defaults},
               {"Camera \"perspective\" \"float focaldistance\" 0", defaults},
               {"Camera \"perspective\" \"float frameaspectratio\" 0", defaults},
               {"Camera \"perspective\" \"float screenwindow\" [1 1 0 2]", defaults},
               {"PixelFilter \"gaussian\" \"float sigma\" 0", defaults},
               {"PixelFilter \"gaussian\" \"float xradius\" 0", defaults},
               {"PixelFilter \"mitchell\" \"float B\" 0"}});
}

// Jensen and others 2001, figure 5: reduced scattering and absorption per millimetre.
TEST(PbrtParameters, OfPresets) {
  const std::tuple<const char*, Color, Color> presets[] = {
      {"Apple", {2.29f, 2.39f, 1.97f}, {0.0030f, 0.0034f, 0.046f}},
      {"Chicken1", {0.15f, 0.21f, 0.38f}, {0.015f, 0.077f, 0.19f}},
      {"Chicken2", {0.19f, 0.25f, 0.32f}, {0.018f, 0.088f, 0.20f}},
      {"Cream", {7.38f, 5.47f, 3.15f}, {0.0002f, 0.0028f, 0.0163f}},
      {"Ketchup", {0.18f, 0.07f, 0.03f}, {0.061f, 0.97f, 1.45f}},
      {"Marble", {2.19f, 2.62f, 3.00f}, {0.0021f, 0.0041f, 0.0071f}},
      {"Potato", {0.68f, 0.70f, 0.55f}, {0.0024f, 0.0090f, 0.12f}},
      {"Skimmilk", {0.70f, 1.22f, 1.90f}, {0.0014f, 0.0025f, 0.0142f}},
      {"Skin1", {0.74f, 0.88f, 1.01f}, {0.032f, 0.17f, 0.48f}},
      {"Skin2", {1.09f, 1.59f, 1.79f}, {0.013f, 0.070f, 0.145f}},
      {"Spectralon", {11.6f, 20.4f, 14.9f}, Color(0.0f)},
      {"Wholemilk", {2.55f, 3.21f, 3.77f}, {0.0011f, 0.0024f, 0.014f}}};
  for (const auto& [name, scattering, absorption] : presets) {
    SCOPED_TRACE(name);
    const Medium medium =
        load_pbrt_silently(
            world(fmt::format("MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string "
                              "preset\" \"{}\" MediumInterface \"m\" \"\" Material \"interface\"",
                              name) +
                  ball))
            .media.at(0);
    expect_near(medium.extinction * medium.albedo, scattering, 1e-4f);
    expect_near(medium.extinction * (Color(1.0f) - medium.albedo), absorption, 1e-4f);
  }
}

// ---- what is seen of shapes and views

SceneData textured_shape(const std::string& shape) {
  return load_pbrt_silently(
      world("Texture \"t\" \"spectrum\" \"checkerboard\" Material \"diffuse\" \"texture "
            "reflectance\" \"t\" " +
            shape));
}

TEST(PbrtParameters, CoordinatesMayBeCalledSt) {
  const std::string triangle = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] ",
                    st = "\"point2 st\" [.5 .25 1 0 0 1] ", uv = "\"point2 uv\" [.75 .5 1 0 0 1] ";
  EXPECT_EQ(textured_shape(triangle + st).meshes.at(0).uvs.at(0), Vec2(0.5f, 0.25f));
  EXPECT_EQ(textured_shape(triangle + uv).meshes.at(0).uvs.at(0), Vec2(0.75f, 0.5f));
}

// v grows with z, whichever of zmin and zmax is the lower one.
TEST(PbrtParameters, CylindersBeginAtTheirFoot) {
  for (const char* ends :
       {"\"float zmin\" -2 \"float zmax\" 3", "\"float zmin\" 3 \"float zmax\" -2"}) {
    const Mesh mesh = textured_shape(fmt::format("Shape \"cylinder\" {}", ends)).meshes.at(0);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      EXPECT_NEAR(mesh.positions[i].z, -2 + 5 * mesh.uvs[i].y, 1e-5f) << ends;
  }
}

// A mirror turns the surface of a quadric inside out, but not its light (pbrt's Disk::Sample).
TEST(PbrtParameters, MirroredQuadrics) {
  const auto normal = [](const std::string& text) {
    const Mesh mesh = load_pbrt_silently(world(text + " Shape \"disk\"")).meshes.at(0);
    const auto& v = mesh.triangles.at(0).v;
    const float winding = glm::cross(mesh.positions[v[1]] - mesh.positions[v[0]],
                                     mesh.positions[v[2]] - mesh.positions[v[0]])
                              .z;
    EXPECT_EQ(winding > 0.0f, mesh.normals.at(0).z > 0.0f);
    return mesh.normals[0].z;
  };
  const std::string lamp = "AreaLightSource \"diffuse\" ";
  EXPECT_EQ(normal(""), 1.0f);
  EXPECT_EQ(normal("Scale -1 1 1"), -1.0f);
  EXPECT_EQ(normal("ReverseOrientation"), -1.0f);
  EXPECT_EQ(normal("ReverseOrientation Scale -1 1 1"), 1.0f);
  EXPECT_EQ(normal(lamp), 1.0f);
  EXPECT_EQ(normal(lamp + "Scale -1 1 1"), 1.0f);
  EXPECT_EQ(normal(lamp + "ReverseOrientation Scale -1 1 1"), -1.0f);
}

TEST(PbrtParameters, ParallelViewsMoveWithTheirWindow) {
  const SceneData scene = load_pbrt_silently(
      "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 20 Camera \"orthographic\" "
      "\"float screenwindow\" [-1 7 1 5] WorldBegin " +
      lit + ball);
  const Camera camera = make_camera(scene.camera, 40, 20);
  expect_near(camera_ray(camera, 0, 0, 0.5f, 0.5f).origin, {-1, 5, 0});
  expect_near(camera_ray(camera, 40, 20, 0.5f, 0.5f).origin, {7, 1, 0});
}

// Film's: the pixels from ceil(x0 width) to ceil(x1 width) exclusive.
TEST(PbrtParameters, CropsAreRoundedUp) {
  const auto crop = [](const char* window) {
    return *load_pbrt_silently(
                fmt::format("Film \"rgb\" \"integer xresolution\" 10 \"integer yresolution\" 20 "
                            "\"float cropwindow\" {} Camera \"perspective\" WorldBegin {} {}",
                            window, lit, ball))
                .defaults.crop;
  };
  EXPECT_EQ(crop("[.11 .52 .26 .74]"), (CropWindow{2, 6, 6, 15}));
  EXPECT_EQ(crop("[.52 .11 .74 .26]"), (CropWindow{2, 6, 6, 15}));
  EXPECT_EQ(crop("[-1 .5 .5 2]"), (CropWindow{0, 10, 5, 20}));
}

TEST(PbrtParameters, WhatMovesHasTwoKeysAsASphereOrAnInstance) {
  const std::string disk = " Shape \"disk\"";
  const SceneData all = load_pbrt_silently(world("ActiveTransform All Translate 1 2 3 " + ball));
  expect_near(all.spheres.at(0).center, {1, 2, 3});
  EXPECT_FALSE(all.motion.moves());
  const SceneData scene = load_pbrt_silently(
      "TransformTimes 0.5 2 " +
      world("ActiveTransform EndTime Translate 1 2 3 ActiveTransform All Translate 0 5 0 " + disk +
            disk + ball + "ActiveTransform StartTime Scale 2 2 2 " + ball));
  ASSERT_EQ(scene.spheres.size(), 1u);  // but not that which shrinks
  expect_near(scene.spheres[0].center, {0, 5, 0});
  ASSERT_EQ(scene.motion.spheres.size(), 1u);
  EXPECT_EQ(scene.motion.spheres[0].sphere, 0u);
  ASSERT_EQ(scene.motion.spheres[0].keys.size(), 2u);
  EXPECT_EQ(scene.motion.spheres[0].keys[1].time, 2.0f);
  expect_near(scene.motion.spheres[0].keys[1].to_world.translation(), {1, 7, 3});
  ASSERT_EQ(scene.instances.size(), 2u);  // the first two move together
  ASSERT_EQ(scene.motion.instances.size(), 2u);
  EXPECT_EQ(scene.meshes.at(0).group, scene.instances[0].group);
  EXPECT_EQ(scene.meshes.at(1).group, scene.instances[0].group);
  EXPECT_EQ(scene.meshes.at(2).group, scene.instances[1].group);
  const auto& keys = scene.motion.instances[0].keys;
  ASSERT_EQ(keys.size(), 2u);
  EXPECT_EQ(keys[0].time, 0.5f);
  EXPECT_EQ(keys[1].time, 2.0f);
  expect_near(keys[0].to_world.translation(), {0, 5, 0});
  expect_near(keys[1].to_world.translation(), {1, 7, 3});
  EXPECT_EQ(scene.motion.instances[1].keys[0].to_world.row[0].x, 2.0f);
  EXPECT_EQ(scene.motion.instances[1].keys[1].to_world.row[0].x, 1.0f);
}

TEST(PbrtParameters, CamerasAndObjectsMove) {
  const SceneData scene = load_pbrt_silently(
      "Film \"rgb\" ActiveTransform EndTime Translate 0 0 4 ActiveTransform All Camera "
      "\"perspective\" \"float shutteropen\" 0.25 \"float shutterclose\" 0.5 WorldBegin " +
      lit + "ObjectBegin \"o\" " + ball +
      "ObjectEnd ActiveTransform EndTime Rotate 90 0 0 1 ActiveTransform All ObjectInstance "
      "\"o\"");
  EXPECT_EQ(scene.motion.shutter.open, 0.25f);
  EXPECT_EQ(scene.motion.shutter.close, 0.5f);
  ASSERT_EQ(scene.motion.camera.size(), 2u);
  expect_near(scene.motion.camera[0].to_world.translation(), {0, 0, 0});
  expect_near(scene.motion.camera[1].to_world.translation(), {0, 0, -4});
  ASSERT_EQ(scene.motion.instances.size(), 1u);
  expect_near(scene.motion.instances[0].keys[1].to_world.point({1, 0, 0}), {0, 1, 0});
}

// A material that is all of the second, or of the first, is that one.
TEST(PbrtParameters, MixesOfAllOrNothing) {
  const auto material = [](const char* amount) {
    return load_pbrt_silently(
               world(fmt::format("MakeNamedMaterial \"a\" \"string type\" \"diffuse\" "
                                 "MakeNamedMaterial \"b\" \"string type\" \"dielectric\" Material "
                                 "\"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" {}",
                                 amount) +
                     ball))
        .materials.back();
  };
  for (const char* none : {"0", "-1"}) EXPECT_EQ(material(none).kind, kind_of<Diffuse>) << none;
  for (const char* all : {"1", "2"}) {
    EXPECT_EQ(material(all).node, MaterialNode::none) << all;
    EXPECT_EQ(material(all).kind, kind_of<Dielectric>) << all;
  }
  for (const char* some : {".01", ".99"})
    EXPECT_EQ(material(some).node, MaterialNode::blend) << some;
}

}  // namespace
}  // namespace pt
