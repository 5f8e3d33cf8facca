// What is said of each thing in a Mitsuba file that the loader cannot do as it is: one warning, and
// none of what is next to it.
#include <gtest/gtest.h>

#include "load/expect_near.h"
#include "load/mitsuba_scene.h"
#include "load/scene_print.h"

namespace pt::mitsuba_warnings {
namespace {

/// Within <scene>; the message, or nothing: nothing is said.
struct Said {
  std::string xml, message = {};
  const char* version = "3.0.0";
};

class MitsubaFolder : public TempFolder {
 public:
  MitsubaFolder() {
    std::string pfm = "PF\n2 1\n-1\n";
    for (const float v : {0.5f, 0.25f, 0.125f, 1.0f, 0.5f, 0.75f})
      pfm.append(reinterpret_cast<const char*>(&v), sizeof v);
    write_text(file("a.pfm"), pfm);
    const std::string head =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property float z\n";
    const std::string square = "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n3 1 3 2\n";
    const std::string faces = "element face 2\nproperty list uchar int vertex_indices\n";
    write_text(file("a.ply"), head + faces + square);
    write_text(file("half.ply"), "ply\nformat ascii 1.0\ncomment TextureFile a.png\n" +
                                     (head + faces + square).substr(21));
    write_text(file("none.ply"), head +
                                     "element face 0\nproperty list uchar int vertex_indices\n"
                                     "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n");
  }
  LoadedScene load(const Said& said) const {
    write_text(file("scene.xml"),
               fmt::format("<scene version=\"{}\">\n{}\n</scene>\n", said.version, said.xml));
    return load_with_warnings(file("scene.xml"));
  }
};

const std::string seen = "<sensor type='perspective'/><emitter type='constant'/>";
const std::string square = "<shape type='rectangle'/>";

void expect_said(const std::vector<Said>& all) {
  const MitsubaFolder folder;
  for (const Said& said : all) {
    const LoadedScene loaded = folder.load(said);
    EXPECT_EQ(loaded.warnings.size(), said.message.empty() ? 0u : 1u)
        << said.xml << testing::PrintToString(loaded.warnings);
    if (!said.message.empty()) {
      EXPECT_EQ(loaded.count(said.message), 1)
          << said.xml << testing::PrintToString(loaded.warnings);
    }
  }
}

std::string text(const char* name, const std::string& value) {
  return fmt::format("<string name='{}' value='{}'/>", name, value);
}
std::string object(const char* tag, const std::string& type, const std::string& inside = {},
                   const std::string& name = {}) {
  return fmt::format("<{} type='{}'{}>{}</{}>", tag, type,
                     name.empty() ? "" : " name='" + name + "'", inside, tag);
}
std::string to_world(const std::string& steps) {
  return "<transform name='to_world'>" + steps + "</transform>";
}
std::string bitmap(const std::string& name, const std::string& more = {}) {
  return object("texture", "bitmap", text("filename", "a.pfm") + more, name);
}

TEST(MitsubaWarnings, OfEmitters) {
  const auto with = [](const std::string& emitters) {
    return "<sensor type='perspective'/>" + emitters + square;
  };
  const std::string map = text("filename", "a.pfm");
  const std::string area = object("emitter", "area");
  expect_said(
      {{with(object("emitter", "sky")), ""},
       {with(object("emitter", "sky") + object("emitter", "sun")), ""},
       {with(object("emitter", "sky") + object("emitter", "sky")),
        "the sky is left out: there is an environment already"},
       {with(object("emitter", "sun") + object("emitter", "sun")),
        "more than one sun: the first is used"},
       {with(object("emitter", "sunsky", "<boolean name='complex_sun' value='false'/>")), ""},
       {with(object("emitter", "sunsky", "<boolean name='complex_sun' value='true'/>")),
        "complex_sun is ignored"},
       {with(object("emitter", "sunsky", "<vector name='sun_direction' x='1' y='0' z='0.01'/>")),
        ""},
       {with(object("emitter", "sunsky", "<vector name='sun_direction' x='1' y='0' z='-0.01'/>")),
        "the sun is below the horizon: sky and sun are black"},
       {with(object("emitter", "envmap", map)), ""},
       {with(object("emitter", "envmap",
                    map + to_world("<rotate y='1' angle='30'/><scale value='2'/>"))),
        ""},
       {with(object("emitter", "envmap", map + to_world("<scale x='-1' y='1' z='1'/>"))), ""},
       {with(object("emitter", "envmap", map + to_world("<scale x='1' y='1.01' z='1'/>"))),
        "to_world of 'envmap' is no rotation: the nearest one is used"},
       {with(object("emitter", "envmap", map) + object("emitter", "envmap", map)),
        "more than one environment: the first is used"},
       {with(object("emitter", "envmap", text("filename", "b.pfm"))),
        "radiance 1 from all sides is used"},
       {with(area + object("emitter", "constant")), "an emitter 'area' that is in no shape"},
       {seen + object("shape", "rectangle", area), ""},
       {seen + object("shape", "rectangle", object("emitter", "directionalarea")),
        "emitter 'directionalarea' on a shape is not supported: it is left out"},
       {seen + square + object("shape", "rectangle", area + object("bsdf", "null")),
        "an emitter that light passes is not supported: it is black instead"},
       {seen +
            object("shape", "shapegroup", object("shape", "rectangle", area)).insert(6, " id='g'") +
            object("shape", "instance", "<ref id='g'/>"),
        "an emitter in a shapegroup is not supported: it is black instead"}});
}

TEST(MitsubaWarnings, OfShapesAndSensors) {
  const auto shape = [](const std::string& type, const std::string& inside = {}) {
    return seen + square + object("shape", type, inside);
  };
  const std::string group = object("shape", "shapegroup", object("shape", "rectangle"));
  const std::string inner = std::string(group).insert(6, " id='g'");
  const std::string outer =
      object("shape", "shapegroup", square + object("shape", "instance", "<ref id='g'/>"))
          .insert(6, " id='h'");
  const auto sensor = [](const std::string& steps, const char* type = "perspective") {
    return object("sensor", type, to_world(steps)) + object("emitter", "constant") + square;
  };
  expect_said(
      {{shape("ply", text("filename", "a.ply")), ""},
       {shape("ply", text("filename", "half.ply")), "the picture that it names is ignored"},
       {shape("ply", text("filename", "none.ply")), "a mesh without triangles is left out"},
       {shape("ply", text("filename", "b.ply")), "the shape is left out"},
       {shape("torus"), "shape 'torus' is not supported: it is left out"},
       {shape("sphere"), ""},
       {shape("sphere", to_world("<scale value='2'/><rotate x='1' angle='20'/>")), ""},
       {shape("sphere", to_world("<scale x='1' y='1' z='1.01'/>")), "a sphere that is squeezed"},
       {shape("sphere", number("radius", -1)), ""},
       {shape("sphere", number("radius", 0)), "radius of shape 'sphere' is 0"},
       {shape("cylinder", "<point name='p1' x='0' y='0' z='0'/>"), "p0 and p1 are the same point"},
       {shape("rectangle", to_world("<scale x='1' y='1' z='0'/>")),
        "to_world squeezes a shape flat"},
       {shape("rectangle", to_world("<scale x='1' y='0' z='0'/>")), "<transform> is singular"},
       {seen + inner + object("shape", "instance", "<ref id='g'/>"), ""},
       {seen + inner + outer + object("shape", "instance", "<ref id='h'/>"),
        "an instance in a shapegroup is not supported: it is left out"},
       {sensor("<rotate y='1' angle='20'/><translate x='3'/>"), ""},
       {sensor("<scale x='-1' y='1' z='1'/>"), ""},
       {sensor("<scale value='2'/>"), "to_world of the sensor scales or shears"},
       {sensor("<scale x='1' y='1.01' z='1'/>"), "to_world of the sensor scales or shears"},
       {sensor("<scale x='2' y='3' z='1'/>", "orthographic"), ""},
       {sensor("<matrix value='1 0.1 0 0 0 1 0 0 0 0 1 0 0 0 0 1'/>", "orthographic"),
        "to_world of the sensor scales or shears"},
       {seen + object("integrator", "aov", object("integrator", "path")) + square,
        "integrator 'aov' is not supported: the one inside is used"},
       {seen + object("integrator", "adaptive", object("integrator", "path")) + square, "",
        "0.6.0"}});
}

TEST(MitsubaWarnings, OfSurfacesAndTextures) {
  const auto bsdf = [](const std::string& type, const std::string& inside = {}) {
    return seen + object("shape", "rectangle", object("bsdf", type, inside));
  };
  const auto wrapped = [&](const std::string& more) {
    return bsdf("diffuse", bitmap("reflectance", more));
  };
  const std::string diffuse = object("bsdf", "diffuse"),
                    half = object("bsdf", "mask", number("opacity", 0.5) + diffuse),
                    quarter = object("bsdf", "mask", number("opacity", 0.25) + diffuse),
                    masked = object("bsdf", "mask", bitmap("opacity") + diffuse);
  const auto attribute = [&](const std::string& inside) {
    return bsdf("diffuse", object("texture", "mesh_attribute", inside, "reflectance"));
  };
  expect_said(
      {{wrapped(""), ""},
       {wrapped(text("wrap_mode", "mirror") + text("wrap_mode_u", "clamp")), ""},
       {wrapped(text("wrap_mode", "zero")), "wrap mode 'zero' is not supported: clamp is used"},
       {wrapped(text("filter_type", "nearest")), ""},
       {wrapped(text("filter_type", "bilinear")), ""},
       {wrapped(text("filter_type", "trilinear")), "", "0.6.0"},
       {wrapped(text("filter_type", "cubic")),
        "texture filter 'cubic' is not supported: bilinear is used"},
       {wrapped(number("gamma", -1)), "", "0.6.0"},
       {wrapped(number("gamma", 1)), "", "0.6.0"},
       {wrapped(number("gamma", 2.2)), "", "0.6.0"},
       {wrapped(number("gamma", 1.8)), "gamma 1.8 of a bitmap is not supported: sRGB is used",
        "0.6.0"},
       {bsdf("diffuse", object("texture", "marble", "", "reflectance")),
        "texture 'marble' is not supported: 0.5 is used"},
       {bsdf("diffuse", object("spectrum", "fluorescent", "", "reflectance")),
        "spectrum 'fluorescent' is not supported: 0.5 is used"},
       {attribute(text("name", "vertex_weight")),
        "mesh_attribute 'vertex_weight' is not supported here"},
       {bsdf("principled", object("texture", "bitmap", text("filename", "a.pfm"), "eta")),
        "a texture as eta of bsdf 'principled' is not supported: 1.5 is used"},
       {bsdf("roughplastic", bitmap("alpha")), "a texture as alpha of bsdf 'roughplastic'"},
       {bsdf("twosided", diffuse + diffuse), ""},
       {bsdf("twosided", half + half), ""},
       {bsdf("twosided", half + quarter), "opacities that differ inside of bsdf 'twosided'"},
       {bsdf("blendbsdf", half + quarter), ""},
       {bsdf("blendbsdf", masked + diffuse), "opacities that differ inside of bsdf 'blendbsdf'"},
       {bsdf("mask", number("opacity", 0.5) + masked), ""},
       {bsdf("mask", bitmap("opacity") + half), ""},
       {bsdf("mask", bitmap("opacity") + masked), "two textures as opacity are not supported"},
       {bsdf("normalmap", bitmap("normalmap") + diffuse), ""},
       {bsdf("normalmap", object("texture", "uniform", "", "normalmap") + diffuse),
        "a map that is no image is left out"},
       {bsdf("bumpmap", bitmap("") + diffuse), ""}});
}

// The defaults and effects of what stands inside of other things: (parameter, default, another).
TEST(MitsubaWarnings, DefaultsOfScales) {
  const MitsubaFolder folder;
  const auto expect = [&](const std::string& before, const std::string& after, const char* name,
                          double usual, double other) {
    const auto print = [&](const std::string& parameter) {
      return print_of(folder.load({before + parameter + after}).scene);
    };
    EXPECT_EQ(print(""), print(number(name, usual))) << before << name;
    EXPECT_NE(print(""), print(number(name, other))) << before << name;
  };
  const std::string bsdf = seen + "<shape type='rectangle'><bsdf type='";
  expect("<sensor type='perspective'/><emitter type='envmap'>" + text("filename", "a.pfm"),
         "</emitter>" + square, "scale", 1, 2);
  expect("<sensor type='perspective'/><emitter type='envmap'>" + text("filename", "lost.pfm"),
         "</emitter>" + square, "scale", 1, 2);
  expect(bsdf + "bumpmap'>" + bitmap("") + object("bsdf", "diffuse"), "</bsdf></shape>", "scale", 1,
         2);
  expect(bsdf + "diffuse'><texture type='mesh_attribute' name='reflectance'>" +
             text("name", "vertex_color"),
         "</texture></bsdf></shape>", "scale", 1, 2);
  expect(bsdf + "diffuse'><spectrum type='blackbody' name='reflectance'>" + number("scale", 1e-5),
         "</spectrum></bsdf></shape>", "temperature", 6500, 6000);
  expect(bsdf + "diffuse'><spectrum type='blackbody' name='reflectance'>" + number("scale", 1e-5),
         "</spectrum></bsdf></shape>", "wavelength_max", 830, 600);
  expect(bsdf + "diffuse'><spectrum type='blackbody' name='reflectance'>" + number("scale", 1e-5),
         "</spectrum></bsdf></shape>", "wavelength_min", 360, 500);
  for (const auto& [name, usual, other] : {std::tuple{"lambda_min", 360, 400},
                                           {"lambda_max", 830, 780},
                                           {"wavelength_min", 360, 400},
                                           {"wavelength_max", 830, 780}}) {
    expect(bsdf + "diffuse'><spectrum type='regular' name='reflectance'>" +
               text("values", "0, 0.5, 1"),
           "</spectrum></bsdf></shape>", name, usual, other);
  }
}

// p0 is the origin, p1 (0, 0, 1), the radius 1 (Mitsuba's documentation of `cylinder`).
TEST(MitsubaWarnings, ACylinderIsOneHigh) {
  const auto bounds = [](const std::string& inside) {
    const Mesh mesh = load_xml(object("shape", "cylinder", inside)).scene.meshes.at(0);
    Bounds box;
    for (const Vec3& p : mesh.positions) box.grow(p);
    return box;
  };
  expect_near(bounds("").min, {-1, -1, 0}, 1e-3f);
  expect_near(bounds("").max, {1, 1, 1}, 1e-3f);
  const Bounds other = bounds(number("radius", 2) + "<point name='p0' x='0' y='0' z='-3'/>");
  expect_near(other.min, {-2, -2, -3}, 1e-3f);
  expect_near(other.max, {2, 2, 1}, 1e-3f);
}

// Half of what is seen of a sky's lowest row lies below the horizon, and nothing further down.
TEST(MitsubaWarnings, TheSkyEndsAtTheHorizon) {
  const EnvironmentData map = load_xml(object("emitter", "sky") + square).scene.environment;
  const auto row = [&](int y) {
    double sum = 0;
    for (int x = 0; x < map.width; ++x)
      sum += double{map.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
                               static_cast<std::size_t>(x)]
                        .y};
    return sum;
  };
  const int horizon = map.height / 2;
  EXPECT_EQ(map.height % 2, 1);
  EXPECT_NEAR(row(horizon) / row(horizon - 1), 0.5, 0.05);
  EXPECT_NEAR(row(horizon - 1) / row(horizon - 2), 1, 0.1);
  EXPECT_EQ(row(horizon + 1), 0.0);
}

// A pane that shines is a lamp, which shadow rays meet (Mitsuba's null interaction is none there).
TEST(MitsubaWarnings, PanesThatShineStayInTheWay) {
  const auto passes = [](const std::string& inside, const char* integrator) {
    return load_xml(seen + object("integrator", integrator) +
                    object("shape", "rectangle", object("bsdf", "thindielectric") + inside))
        .scene.materials.at(0)
        .passes;
  };
  EXPECT_TRUE(passes("", "volpath"));
  EXPECT_TRUE(passes("", "volpathmis"));
  EXPECT_FALSE(passes("", "path"));
  EXPECT_FALSE(passes(object("emitter", "area"), "volpath"));
}

TEST(MitsubaWarnings, KelvinsMayHaveTheirUnit) {
  const auto color = [](const char* temperature) {
    return load_xml(fmt::format("<emitter type='constant'><blackbody name='radiance' "
                                "temperature='{}' scale='1e-5'/></emitter>{}",
                                temperature, square))
        .scene.sky.zenith;
  };
  for (const char* same : {"5000K", "5000k", "5000.0"})
    EXPECT_EQ(color(same), color("5000")) << same;
  expect_error([&] { color("5000C"); }, "temperature '5000C'; expected kelvins above 0");
  expect_error([&] { color("0K"); }, "temperature '0'; expected kelvins above 0");
}

}  // namespace
}  // namespace pt::mitsuba_warnings
