// Every parameter of every plugin that the loader knows: XML -> what the scene holds. Defaults are
// those of traverse() in Mitsuba 3.9.1 (scalar_rgb), and of Mitsuba 0.6's documentation where 3
// lacks the plugin. Where two of the same are given, the last one holds.
#include <gtest/gtest.h>

#include <functional>

#include "load/expect_near.h"
#include "load/mitsuba_scene.h"

namespace pt {
namespace {

using Probe = std::function<double(const SceneData&)>;

struct Row {
  std::string xml;
  Probe probe;
  double expected;
  std::string warning = {};  ///< a part of the only one
  const char* version = "3.0.0";
};

const MaterialDescription& top_of(const SceneData& scene) {
  return scene.materials.at(scene.meshes.empty() ? scene.quad_material.at(0)
                                                 : scene.meshes.at(0).material);
}

/// Probes the material's parameter `index`.
Probe parameter(int index, int component = 0) {
  return [=](const SceneData& scene) {
    return double{top_of(scene).parameters[index].value[component]};
  };
}

template <class Bsdf, class Type>
Probe parameter(Type Bsdf::*member) {
  return parameter(index_of(member));
}

/// Probes anything.
template <class Get>
Probe of(Get get) {
  return [=](const SceneData& scene) { return static_cast<double>(get(scene)); };
}

void expect_rows(const std::vector<Row>& rows, const std::string& around) {
  for (const Row& row : rows) {
    SCOPED_TRACE(row.xml);
    std::string xml = around;
    xml.replace(xml.find('%'), 1, row.xml);
    const LoadedScene loaded = load_xml(xml, row.version);
    EXPECT_NEAR(row.probe(loaded.scene), row.expected, 1e-5 * (1 + std::abs(row.expected)));
    EXPECT_EQ(loaded.warnings.size(), row.warning.empty() ? 0u : 1u)
        << (loaded.warnings.empty() ? "" : loaded.warnings.front());
    if (!row.warning.empty()) {
      EXPECT_EQ(loaded.count(row.warning), 1);
    }
  }
}

const std::string lit = "<sensor type='perspective'/><emitter type='constant'/>";
const std::string lit_square = lit + "<shape type='rectangle'>%</shape>";

std::string text(const char* name, const std::string& value) {
  return fmt::format("<string name='{}' value='{}'/>", name, value);
}

std::string flag(const char* name, bool value) {
  return fmt::format("<boolean name='{}' value='{}'/>", name, value);
}

std::string bsdf(const std::string& type, const std::string& inside = "") {
  return "<bsdf type='" + type + "'>" + inside + "</bsdf>";
}

TEST(MitsubaParameters, OfSurfaces) {
  const double bk7 = 1.5046 / 1.000277, plastic = 1.49 / 1.000277;  // golden: 1.504183, 1.489587
  std::vector<Row> rows = {
      {bsdf("diffuse"), parameter(0), 0.5},
      {bsdf("diffuse", number("reflectance", 0.25)), parameter(0), 0.25},
      {bsdf("diffuse", number("reflectance", 0.25) + number("reflectance", 0.125)), parameter(0),
       0.125, "given twice"},
      {bsdf("diffuse", number("reflectance", 1)), parameter(0), 1},
      {bsdf("diffuse", number("reflectance", 1.0001)), parameter(0), 1, "above 1"},
      {bsdf("diffuse", number("reflectance", 0)), parameter(0), 0},
      {bsdf("diffuse", number("reflectance", -0.001)), parameter(0), 0, "a negative component"},
      {bsdf("lambertian", number("reflectance", 0.25)), parameter(0), 0.25, "", "0.6.0"},
      {bsdf("roughdiffuse"), parameter(1), 0.2 * std::sqrt(0.5), "", "0.6.0"},
      {bsdf("roughdiffuse", number("alpha", 0.4)), parameter(1), 0.4 * std::sqrt(0.5), "", "0.6.0"},
      {bsdf("plastic"), parameter(0), 0.5},
      {bsdf("plastic"), parameter(1), 1},
      {bsdf("plastic", number("specular_reflectance", 0.3)), parameter(1), 0.3},
      {bsdf("plastic", number("diffuse_reflectance", 0.3)), parameter(0), 0.3},
      {bsdf("roughplastic"), parameter(&RoughPlastic::alpha), 0.1},
      {bsdf("roughplastic", number("alpha", 0.3)), parameter(&RoughPlastic::alpha), 0.3},
      {bsdf("phong"), parameter(0), 0.5, "", "0.6.0"},
      {bsdf("phong"), parameter(1), 0.2, "", "0.6.0"},
      {bsdf("phong", number("exponent", 50)), parameter(&Phong::exponent), 50, "", "0.6.0"},
      {bsdf("ward"), parameter(1), 0.2, "", "0.6.0"},
      {bsdf("ward"), parameter(&Ward::alpha_y), 0.1, "", "0.6.0"},
      {bsdf("ward", text("variant", "ward")), parameter(1), 0.2, "variant 'ward'", "0.6.0"},
      {bsdf("ward", number("alpha", 0.3) + number("alpha_u", 0.4)), parameter(&Ward::alpha_y), 0.3,
       "", "0.6.0"},
      {bsdf("dielectric"), parameter(1), bk7},
      {bsdf("dielectric", number("int_ior", 1.8)), parameter(1), 1.8 / 1.000277},
      {bsdf("dielectric", number("ext_ior", 1.25)), parameter(1), 1.5046 / 1.25},
      {bsdf("dielectric", text("int_ior", "Diamond") + text("ext_ior", "water")), parameter(1),
       2.419 / 1.333},
      {bsdf("dielectric", number("specular_transmittance", 0.5)),
       parameter(&RoughDielectric::passed), 0.5},
      {bsdf("dielectric", number("specular_reflectance", 0.5)),
       parameter(&RoughDielectric::reflected), 0.5},
      {bsdf("dielectric", number("specular_reflectance", 0.5)), parameter(&RoughDielectric::passed),
       1},
      {bsdf("dielectric", number("specular_reflectance", 0.5)), parameter(&RoughDielectric::eta),
       bk7},
      {bsdf("roughdielectric"), parameter(&RoughDielectric::alpha_x), 0.1},
      {bsdf("roughdielectric"), parameter(&RoughDielectric::eta), bk7},
      {bsdf("roughdielectric"), parameter(&RoughDielectric::is_beckmann), 1},
      {bsdf("roughdielectric", text("distribution", "GGX")),
       parameter(&RoughDielectric::is_beckmann), 0},
      {bsdf("roughdielectric", number("alpha", 0)), parameter(&RoughDielectric::alpha_y), 1e-4},
      {bsdf("roughdielectric", number("alpha", 1e-3)), parameter(&RoughDielectric::alpha_y), 1e-3},
      {bsdf("thindielectric"), parameter(&ThinDielectric::eta), bk7},
      {bsdf("thindielectric", number("specular_transmittance", 0.4)),
       parameter(&ThinDielectric::passed), 0.4},
      {bsdf("thindielectric", number("specular_reflectance", 0.4)),
       parameter(&ThinDielectric::reflected), 0.4},
      {bsdf("conductor"), parameter(&Conductor::eta), 0},
      {bsdf("conductor"), parameter(&Conductor::k), 1},
      {bsdf("conductor"), parameter(&Conductor::tint), 1},
      {bsdf("conductor", number("eta", 2)), parameter(&Conductor::k), 1},
      {bsdf("conductor", number("eta", 2)), parameter(&Conductor::eta), 2},
      {bsdf("conductor", number("k", 2)), parameter(&Conductor::eta), 0},
      {bsdf("conductor", number("k", 2)), parameter(&Conductor::k), 2},
      {bsdf("conductor", number("eta", -2)), parameter(&Conductor::eta), 0,
       "an index of refraction"},
      {bsdf("conductor", text("material", "none")), parameter(&Conductor::k), 1},
      {bsdf("conductor", text("material", "Unobtainium")), parameter(&Conductor::tint), 1,
       "the conductor 'Unobtainium'"},
      {bsdf("conductor", number("specular_reflectance", 0.3)), parameter(&Conductor::tint), 0.3},
      {bsdf("conductor"), parameter(&Conductor::alpha_x), 0},
      {bsdf("roughconductor"), parameter(&Conductor::alpha_x), 0.1},
      {bsdf("roughconductor"), parameter(&Conductor::is_beckmann), 1},
      {bsdf("roughconductor", number("alpha", 0.3)), parameter(&Conductor::alpha_y), 0.3},
      {bsdf("roughconductor", number("alpha_u", 0.2) + number("alpha_v", 0.3)),
       parameter(&Conductor::alpha_x), 0.2},
      {bsdf("roughconductor", number("alpha_u", 0.2) + number("alpha_v", 0.3)),
       parameter(&Conductor::alpha_y), 0.3},
      {bsdf("roughconductor", number("alpha_u", 0.2)), parameter(&Conductor::alpha_y), 0.1},
      {bsdf("roughconductor", text("distribution", "ggx")), parameter(&Conductor::is_beckmann), 0},
      {bsdf("roughconductor", text("distribution", "phong")), parameter(&Conductor::is_beckmann), 1,
       "distribution 'phong'", "0.6.0"},
      {bsdf("principled"), parameter(&Principled::base_color), 0.5},
      {bsdf("principled"), parameter(&Principled::roughness), 0.5},
      {bsdf("principled"), parameter(&Principled::eta), 1.5},
      {bsdf("principled", number("specular", 0)), parameter(&Principled::eta), 1},
      {bsdf("principled", number("specular", 1)), parameter(&Principled::eta),
       2 / (1 - std::sqrt(0.08)) - 1},
      {bsdf("principled", number("specular", 12.5)), parameter(&Principled::eta), 1.5,
       "specular 12.5"},
      {bsdf("principled", number("eta", 1.8)), parameter(&Principled::eta), 1.8},
      {bsdf("principled", number("spec_trans", 1) + number("eta", 1)), parameter(&Principled::eta),
       1.001},
      {bsdf("principled", number("eta", 1)), parameter(&Principled::eta), 1},
      {bsdf("principledthin"), parameter(&PrincipledThin::base_color), 0.5},
      {bsdf("principledthin"), parameter(&PrincipledThin::roughness), 0.5},
      {bsdf("principledthin"), parameter(&PrincipledThin::eta), 1.5},
      {bsdf("principledthin", number("eta", 1.2)), parameter(&PrincipledThin::eta), 1.2},
      {bsdf("coating", bsdf("diffuse", number("reflectance", 0.25))), parameter(0), 0.25,
       "bsdf 'coating'", "0.6.0"},
      {bsdf("mask", bsdf("diffuse")), of([](const auto& s) { return top_of(s).opacity.offset; }),
       0.5},
      {bsdf("mask", number("opacity", 0.25) + bsdf("diffuse")),
       of([](const auto& s) { return top_of(s).opacity.offset; }), 0.25},
      {bsdf("blendbsdf", number("weight", 0.25) + bsdf("diffuse") + bsdf("plastic")), parameter(0),
       0.25},
      {bsdf("blendbsdf", bsdf("diffuse") + bsdf("plastic")), parameter(0), 0.5},
      {bsdf("blendbsdf",
            number("weight", 0) + bsdf("diffuse", number("reflectance", 0.125)) + bsdf("plastic")),
       parameter(0), 0.125},
      {bsdf("blendbsdf",
            number("weight", 1) + bsdf("plastic") + bsdf("diffuse", number("reflectance", 0.125))),
       parameter(0), 0.125},
      {bsdf("hair"), parameter(0), 0.5, "bsdf 'hair' is not supported"},
  };
  const auto zero_and_given = [&](const char* type, const char* name, int index) {
    rows.push_back({bsdf(type), parameter(index), 0});
    rows.push_back({bsdf(type, number(name, 0.375)), parameter(index), 0.375});
  };
  zero_and_given("principled", "metallic", index_of(&Principled::metallic));
  zero_and_given("principled", "spec_trans", index_of(&Principled::spec_trans));
  zero_and_given("principled", "anisotropic", index_of(&Principled::anisotropic));
  zero_and_given("principled", "spec_tint", index_of(&Principled::spec_tint));
  zero_and_given("principled", "sheen", index_of(&Principled::sheen));
  zero_and_given("principled", "sheen_tint", index_of(&Principled::sheen_tint));
  zero_and_given("principled", "flatness", index_of(&Principled::flatness));
  zero_and_given("principled", "clearcoat", index_of(&Principled::clearcoat));
  zero_and_given("principled", "clearcoat_gloss", index_of(&Principled::clearcoat_gloss));
  zero_and_given("principledthin", "spec_trans", index_of(&PrincipledThin::spec_trans));
  zero_and_given("principledthin", "anisotropic", index_of(&PrincipledThin::anisotropic));
  zero_and_given("principledthin", "spec_tint", index_of(&PrincipledThin::spec_tint));
  zero_and_given("principledthin", "sheen", index_of(&PrincipledThin::sheen));
  zero_and_given("principledthin", "sheen_tint", index_of(&PrincipledThin::sheen_tint));
  zero_and_given("principledthin", "flatness", index_of(&PrincipledThin::flatness));
  zero_and_given("principledthin", "diff_trans", index_of(&PrincipledThin::diff_trans));
  expect_rows(rows, lit_square);
  // The coat's index, seen in what make_plastic() derives from it.
  const auto coat = [](const std::string& inside) {
    return load_xml(lit + "<shape type='rectangle'>" + bsdf("plastic", inside) + "</shape>")
        .scene.materials.at(0);
  };
  for (int i = 2; i < 6; ++i) {
    EXPECT_NEAR(coat("").scalar(i),
                coat(number("int_ior", plastic) + number("ext_ior", 1)).scalar(i), 1e-5f);
  }
  EXPECT_NE(coat("").scalar(2), coat(number("int_ior", 1.8)).scalar(2));
}

TEST(MitsubaParameters, OfEmitters) {
  const auto light = [](auto member) {
    return of([=](const SceneData& s) { return s.delta_lights.at(0).*member; });
  };
  const auto intensity = of([](const SceneData& s) { return s.delta_lights.at(0).intensity.y; });
  const auto position_z = of([](const SceneData& s) { return s.delta_lights.at(0).position.z; });
  const auto direction_z = of([](const SceneData& s) { return s.delta_lights.at(0).direction.z; });
  const auto degrees = [](double value) { return std::cos(value * std::acos(-1.0) / 180); };
  const auto emitter = [](const std::string& type, const std::string& inside = "") {
    return "<emitter type='" + type + "'>" + inside + "</emitter>";
  };
  const auto moved = "<transform name='to_world'><translate z='4'/></transform>";
  const auto turned = "<transform name='to_world'><rotate y='1' angle='180'/></transform>";
  const auto inner = light(&DeltaLight::cos_inner), outer = light(&DeltaLight::cos_outer);
  const auto zenith = of([](const SceneData& s) { return s.sky.zenith.y; });
  const auto count = of([](const SceneData& s) { return s.delta_lights.size(); });
  const std::vector<Row> rows = {
      {emitter("point"), intensity, 1},
      {emitter("point", number("intensity", 3)), intensity, 3},
      {emitter("point", number("intensity", -3)), intensity, 0, "a negative component"},
      {emitter("point", moved), position_z, 4},
      {emitter("point", "<point name='position' x='1' y='2' z='3'/>"), position_z, 3},
      {emitter("point", "<point name='position' value='3'/>"), position_z, 3},
      {emitter("point", number("sampling_weight", 2)), intensity, 1},
      {emitter("spot"), intensity, 1},
      {emitter("spot"), outer, degrees(20)},
      {emitter("spot"), inner, degrees(15)},
      {emitter("spot", number("cutoff_angle", 40)), outer, degrees(40)},
      {emitter("spot", number("cutoff_angle", 40)), inner, degrees(30)},
      {emitter("spot", number("beam_width", 5)), inner, degrees(5)},
      {emitter("spot", number("beam_width", 20)), inner, degrees(20)},
      {emitter("spot", number("beam_width", 21)), inner, degrees(20), "beam_width 21"},
      {emitter("spot", number("beam_width", -1)), inner, 1, "beam_width -1"},
      {emitter("spot", number("cutoff_angle", 180)), outer, -1},
      {emitter("spot", number("cutoff_angle", 200)), outer, -1, "cutoff_angle 200"},
      {emitter("spot", number("cutoff_angle", 0)), count, 0, "cutoff_angle 0"},
      {emitter("spot"), direction_z, 1},
      {emitter("spot", turned), direction_z, -1},
      {emitter("spot", moved), position_z, 4},
      {emitter("directional"), intensity, 1},
      {emitter("directional", number("irradiance", 2)), intensity, 2},
      {emitter("directional"), direction_z, 1},
      {emitter("directional", turned), direction_z, -1},
      {emitter("directional", "<vector name='direction' x='3' z='-4'/>"), direction_z, -0.8},
      {emitter("directional", "<vector name='direction' value='0'/>"), count, 0, "length zero"},
      {emitter("projector"), intensity, std::acos(-1.0)},
      {emitter("projector", number("scale", 2) + number("irradiance", 3)), intensity,
       6 * std::acos(-1.0)},
      {emitter("constant"), zenith, 1},
      {emitter("constant", number("radiance", 2)), zenith, 2},
      {emitter("constant", number("radiance", 2)) + emitter("constant"), zenith, 3},
      {emitter("sunsky", number("sun_scale", 0)),
       of([](const SceneData& s) { return s.sun.one_minus_cos; }), 0},
      {emitter("sunsky", number("sky_scale", 0)),
       of([](const SceneData& s) { return s.environment.width; }), 0},
      {emitter("measured") + emitter("point"), intensity, 1, "emitter 'measured'"},
  };
  expect_rows(rows, "<sensor type='perspective'/>%<shape type='sphere'/>");
  const auto area = of([](const SceneData& s) { return s.materials.at(0).emission.radiance.y; });
  expect_rows(
      {{emitter("area"), area, 1},
       {emitter("area", number("radiance", 4)), area, 4},
       {emitter("area", number("radiance", 4) + number("radiance", 5)), area, 5, "twice"},
       {"<luminaire type='area'>" + number("radiance", 4) + "</luminaire>", area, 4, "", "0.5.0"}},
      "<sensor type='perspective'/><shape type='rectangle'>%</shape>");
}

// Golden: traverse() of a sunsky.
TEST(MitsubaParameters, OfSunAndSky) {
  const auto sky = [](const std::string& inside, const char* type = "sunsky",
                      const char* version = "3.0.0") {
    return load_xml(fmt::format("<emitter type='{}'>{}</emitter>", type, inside), version).scene;
  };
  const auto expect_sun = [&](const std::string& inside, const Vec3& direction) {
    SCOPED_TRACE(inside);
    expect_near(sky(inside).sun.direction, direction, 2e-4f);
  };
  const auto integer = [](const char* name, int n) {
    return fmt::format("<integer name='{}' value='{}'/>", name, n);
  };
  expect_sun("", {0.0513854f, 0.691748f, 0.720308f});
  expect_sun(number("latitude", -20), {-0.566034f, 0.69174f, 0.448443f});
  expect_sun(number("longitude", 120), {0.166385f, 0.444057f, 0.880414f});
  expect_sun(number("timezone", 8), {-0.0652906f, 0.827357f, 0.557869f});
  expect_sun(integer("year", 2024) + integer("month", 2) + integer("day", 3),
             {0.619224f, 0.692225f, 0.370658f});
  expect_sun(integer("month", 12), {0.650361f, 0.721261f, 0.238357f});
  expect_sun(integer("day", 31), {0.11526f, 0.706659f, 0.698103f});
  expect_sun(number("hour", 9), {0.0956952f, -0.614786f, 0.782867f});
  expect_sun(number("minute", 30), {-0.00436178f, 0.766109f, 0.642696f});
  expect_sun(number("second", 50), {0.0499142f, 0.693982f, 0.71826f});
  expect_sun("<vector name='sun_direction' x='0' y='3' z='4'/>", {0, 0.6f, 0.8f});

  const auto disk = [&](const std::string& inside) {  // its half angle in degrees
    return std::acos(1.0 - sky(inside).sun.one_minus_cos) * 180 / std::acos(-1.0);
  };
  EXPECT_NEAR(disk(""), 0.2679, 1e-3);
  EXPECT_NEAR(disk(number("sun_radius_scale", 10)), 2.679, 1e-3);
  EXPECT_NEAR(disk(number("sun_aperture", 3)), 1.5, 1e-3);

  // Defaults are what is said aloud.
  const auto zenith = [&](const std::string& inside, const char* type = "sunsky",
                          const char* version = "3.0.0") {
    return sky(inside, type, version).environment.pixels.at(0);
  };
  EXPECT_EQ(zenith(""), zenith(number("albedo", 0.3) + number("turbidity", 3)));
  EXPECT_NE(zenith(""), zenith(number("albedo", 0.31)));
  EXPECT_NE(zenith(""), zenith(number("turbidity", 3.1)));
  EXPECT_EQ(zenith("", "sky", "0.6.0"), zenith(number("albedo", 0.15), "sky", "0.6.0"));
  expect_near(zenith(number("sky_scale", 2)), 2.0f * zenith(""), 1e-5f);
  expect_near(zenith(number("scale", 2)), 2.0f * zenith(""), 1e-5f);
  const Color sun = sky("").sun.radiance;
  EXPECT_NEAR(sky(number("sun_scale", 2)).sun.radiance.y / sun.y, 2.0f, 1e-5f);
  EXPECT_EQ(sky("", "sky", "0.6.0").sun.one_minus_cos, 0.0f);
  EXPECT_EQ(sky("", "sun", "0.6.0").environment.width, 0);
  for (const double bad : {0.99, 10.01}) {
    expect_error([&] { sky(number("turbidity", bad)); }, "expected 1 to 10");
  }
  EXPECT_NO_THROW(sky(number("turbidity", 1)));
  EXPECT_NO_THROW(sky(number("turbidity", 10)));
  expect_error([&] { sky(integer("month", 13)); }, "expected 1 to 12");
  expect_error([&] { sky(integer("day", 0)); }, "expected 1 to 31");
}

// What editing calls them.
TEST(MitsubaParameters, OfNames) {
  const SceneNames names =
      load_xml(
          "<shape type='rectangle' id='lamp'><bsdf type='diffuse' id='grey'/>"
          "<emitter type='area'/></shape><shape type='rectangle' id='panel'>"
          "<emitter type='area' id='glow'/></shape><emitter type='point' id='bulb'/>"
          "<emitter type='point'/>")
          .scene.names;
  using Names = std::map<std::uint32_t, std::string>;
  EXPECT_EQ(names.materials, (Names{{0, "grey"}, {1, "panel.bsdf"}}));
  EXPECT_EQ(names.emitters, (Names{{0, "lamp"}, {1, "glow"}}));
  EXPECT_EQ(names.delta_lights, (Names{{0, "bulb"}}));
}

// Read once, it is a colour here and a number there, which begins with the other square.
TEST(MitsubaParameters, OfACheckerboardThatIsBoth) {
  const SceneData scene = load_xml("<texture type='checkerboard' id='t'/><shape type='rectangle'>" +
                                   bsdf("roughconductor",
                                        "<ref name='specular_reflectance' id='t'/>"
                                        "<ref name='alpha' id='t'/>") +
                                   "</shape>")
                              .scene;
  const MaterialDescription& metal = top_of(scene);
  const Texture& color = scene.textures.at(metal[&Conductor::tint].texture);
  const Texture& alpha = scene.textures.at(metal[&Conductor::alpha_x].texture);
  EXPECT_EQ(color.color0, Color(0.4f));
  EXPECT_EQ(alpha.color0, Color(0.2f));
}

TEST(MitsubaParameters, OfSensorsAndFilms) {
  const auto camera = [](auto member) {
    return of([=](const SceneData& s) { return s.camera.*member; });
  };
  const auto value = [](auto member) {
    return of([=](const SceneData& s) { return (s.defaults.*member).value_or(-1); });
  };
  const auto width = value(&SceneDefaults::width), height = value(&SceneDefaults::height);
  const auto spp = value(&SceneDefaults::spp);
  const auto x_fov = of([](const SceneData& s) {  // of a 3:2 image
    const double vertical = vertical_tangent(s.camera, 300, 200);
    return 2 * std::atan(1.5 * vertical) * 180 / std::acos(-1.0);
  });
  const auto fov = camera(&CameraParameters::fov_degrees);
  const auto near = camera(&CameraParameters::near_clip);
  const auto far = camera(&CameraParameters::far_clip);
  const auto sensor = [](const std::string& inside, const char* type = "perspective") {
    return fmt::format("<sensor type='{}'>{}</sensor>", type, inside);
  };
  const auto film = [&](const std::string& inside) {
    return sensor("<film type='hdrfilm'>" + inside + "</film>");
  };
  const auto integer = [](const char* name, int n) {
    return fmt::format("<integer name='{}' value='{}'/>", name, n);
  };
  const auto filter = [&](const std::string& type, const std::string& inside = "") {
    return film("<rfilter type='" + type + "'>" + inside + "</rfilter>");
  };
  const auto kind = of([](const SceneData& s) { return s.defaults.filter->kind; });
  const auto a = of([](const SceneData& s) { return s.defaults.filter->a; });
  const auto b = of([](const SceneData& s) { return s.defaults.filter->b; });
  const auto crop = [](auto member) {
    return of([=](const SceneData& s) { return s.defaults.crop.value_or(CropWindow{}).*member; });
  };
  const double pi_degrees = 180 / std::acos(-1.0);
  const double diagonal = 2 * std::atan(0.5 * std::hypot(36, 24) / 50) * pi_degrees;
  const std::vector<Row> rows = {
      {sensor(""), width, 768},
      {sensor(""), height, 576},
      {sensor(""), spp, -1},
      {sensor(""), fov, diagonal},
      {sensor(text("focal_length", "50mm")), fov, diagonal},
      {sensor(text("focal_length", "35")), fov,
       2 * std::atan(0.5 * std::hypot(36, 24) / 35) * pi_degrees},
      {sensor(number("fov", 30)), fov, 30},
      {sensor(integer("fov", 30)), x_fov, 30},
      {sensor(number("fov", 30) + text("fov_axis", "x")), x_fov, 30},
      {sensor(number("fov", 30) + text("fov_axis", "larger")), x_fov, 30},
      {sensor(number("fov", 30) + text("fov_axis", "y")), x_fov,
       2 * std::atan(1.5 * std::tan(15 / pi_degrees)) * pi_degrees},
      {sensor(number("fov", 30) + text("fov_axis", "smaller")), x_fov,
       2 * std::atan(1.5 * std::tan(15 / pi_degrees)) * pi_degrees},
      {sensor(number("fov", 30) + text("fov_axis", "diagonal")), x_fov,
       2 * std::atan(1.5 / std::hypot(1.5, 1.0) * std::tan(15 / pi_degrees)) * pi_degrees},
      {sensor(""), near, 0.01},
      {sensor(""), far, 1e4},
      {sensor(number("near_clip", 1)), near, 1},
      {sensor(number("far_clip", 10)), far, 10},
      {sensor(number("principal_point_offset_x", 0.1)),
       of([](const SceneData& s) { return s.camera.principal_point.x; }), 0.1},
      {sensor(number("principal_point_offset_y", 0.1)),
       of([](const SceneData& s) { return s.camera.principal_point.y; }), 0.1},
      {sensor(number("shutter_open", 0.1) + number("shutter_close", 0.2)), width, 768},
      {sensor(number("aperture_radius", 0.1) + number("focus_distance", 3), "thinlens"),
       camera(&CameraParameters::aperture), 0.2},
      {sensor(number("aperture_radius", 0.1) + number("focus_distance", 3), "thinlens"),
       camera(&CameraParameters::focus_distance), 3},
      {sensor("", "thinlens"), camera(&CameraParameters::aperture), 0},
      {sensor(number("aperture_radius", -0.1), "thinlens"), camera(&CameraParameters::aperture),
       0.2},
      {sensor(number("focus_distance", 0), "thinlens"), camera(&CameraParameters::focus_distance),
       1},
      {sensor(number("focus_distance", -3) + number("aperture_radius", 0.1), "thinlens"),
       camera(&CameraParameters::aperture), 0, "focus_distance -3"},
      {sensor("", "orthographic"), camera(&CameraParameters::orthographic), 1},
      {sensor("", "fisheye"), camera(&CameraParameters::orthographic), 0, "sensor 'fisheye'"},
      {"<camera type='perspective'>" + number("fov", 30) + "</camera>", fov, 30, "", "0.5.0"},
      {sensor("") + sensor(number("fov", 30)), fov, diagonal, "more than one sensor"},
      {film(integer("width", 20)), width, 20},
      {film(integer("width", 20)), height, 576},
      {film(integer("height", 30)), height, 30},
      {film(integer("width", 1) + integer("height", 65535)), height, 65535},
      {film(number("width", 20)), width, 20},
      {film(integer("crop_offset_x", 3) + integer("crop_width", 700)), crop(&CropWindow::x0), 3},
      {film(integer("crop_width", 768)), crop(&CropWindow::x1), 0},
      {film(integer("crop_width", 767)), crop(&CropWindow::x1), 767},
      {film(integer("crop_height", 100) + integer("crop_offset_y", 476)), crop(&CropWindow::y1),
       576},
      {film(text("file_format", "openexr") + text("pixel_format", "rgb") + flag("banner", false)),
       width, 768},
      {sensor("<sampler type='independent'>" + integer("sample_count", 7) + "</sampler>"), spp, 7},
      {sensor("<sampler type='independent'>" + integer("sample_count", 1) + "</sampler>"), spp, 1},
      {sensor("<sampler type='independent'>" + integer("sample_count", 0) + "</sampler>"), spp, -1,
       "sample_count 0"},
      {sensor("<sampler type='multijitter'>" + integer("seed", 7) + "</sampler>"), spp, -1},
      {sensor(""), kind, static_cast<double>(FilterKind::gaussian)},
      {sensor(""), a, 0.5},
      {filter("box"), kind, static_cast<double>(FilterKind::box)},
      {filter("box"), a, 0.5},
      {filter("box", number("radius", 1.5)), a, 1.5},
      {filter("tent"), a, 1},
      {filter("tent", number("radius", 1.5)), a, 1.5},
      {filter("gaussian", number("stddev", 0.7)), a, 0.7},
      {filter("gaussian", number("stddev", 0)), a, 0.5, "of size 0"},
      {filter("mitchell"), a, 1.0 / 3},
      {filter("mitchell"), b, 1.0 / 3},
      {filter("mitchell", number("A", 0.1) + number("B", 0.2)), a, 0.2, "ignored: a"},
      {filter("mitchell", number("C", 0.2)), b, 0.2},
      {filter("catmullrom"), a, 0},
      {filter("catmullrom"), b, 0.5},
      {filter("lanczos"), a, 3},
      {filter("lanczos", integer("lobes", 4)), a, 4},
      {filter("wobble"), kind, static_cast<double>(FilterKind::box), "filter 'wobble'"},
  };
  expect_rows(rows, "<emitter type='constant'/>%<shape type='sphere'/>");
  const auto fails = [&](const std::string& xml, const std::string& part) {
    expect_error([&] { load_xml(xml); }, part);
  };
  for (const char* angle : {"0", "-1", "180"}) {
    fails(sensor(text("fov", angle)), "expected degrees between 0 and 180");
  }
  fails(sensor(text("fov_axis", "z")), "fov_axis 'z'");
  fails(sensor(text("focal_length", "0mm")), "focal_length '0mm'");
  fails(sensor(number("near_clip", 0)), "near_clip 0");
  fails(sensor(number("near_clip", 2) + number("far_clip", 2)), "near_clip 2, far_clip 2");
  fails(film(integer("width", 65536)), "width of the film is 65536");
  fails(film(integer("crop_width", 769)), "a crop of 769x576");
  fails(film(integer("crop_offset_x", -1)), "a crop of");
  fails(film(integer("crop_offset_x", 1) + integer("crop_width", 768)), "a crop of");
  fails(film(integer("crop_height", 0)), "a crop of");
}

TEST(MitsubaParameters, OfIntegrators) {
  const auto value = [](auto member) {
    return of([=](const SceneData& s) { return (s.defaults.*member).value_or(-1); });
  };
  const auto depth = value(&SceneDefaults::max_depth), rr = value(&SceneDefaults::rr_depth);
  const auto hides = of([](const SceneData& s) { return s.camera.hides_emitters; });
  const auto integrator = [](const std::string& inside, const char* type = "path") {
    return fmt::format("<integrator type='{}'>{}</integrator>", type, inside);
  };
  const auto integer = [](const char* name, int n) {
    return fmt::format("<integer name='{}' value='{}'/>", name, n);
  };
  expect_rows(
      {{"", depth, -1},
       {integrator(""), depth, 64},
       {integrator(integer("max_depth", -1)), depth, 64},
       {integrator(integer("max_depth", 0)), depth, 1, "max_depth 0: 1 is used"},
       {integrator(integer("max_depth", 1)), depth, 1},
       {integrator(integer("max_depth", 65535)), depth, 65535},
       {integrator(integer("max_depth", 65536)), depth, 65535, "max_depth 65536"},
       {integrator(integer("max_depth", 5) + integer("max_depth", 6)), depth, 6, "twice"},
       {integrator(""), rr, -1},
       {integrator(integer("rr_depth", 3)), rr, 3},
       {integrator(""), hides, 0},
       {integrator(flag("hide_emitters", true)), hides, 1},
       {integrator(text("hide_emitters", "True")), hides, 1},
       {integrator(text("hide_emitters", "FALSE")), hides, 0},
       {integrator("", "direct"), depth, 2},
       {integrator(integer("max_depth", 7), "direct"), depth, 2},
       {integrator(integer("max_depth", 7), "volpath"), depth, 7},
       {integrator(integer("max_depth", 7), "wobble"), depth, 7, "integrator 'wobble'"},
       {integrator(flag("strict_normals", true) + integer("emitter_samples", 2)), depth, 64},
       {integrator(integer("wobble", 2)), depth, 64, "ignored: wobble"}},
      lit + "%<shape type='sphere'/>");
  expect_error([&] { load_xml(integrator(integer("max_depth", -2))); }, "max_depth -2");
}

TEST(MitsubaParameters, OfShapes) {
  const auto shape = [](const std::string& type, const std::string& inside = "") {
    return "<shape type='" + type + "'>" + inside + "</shape>";
  };
  const auto radius =
      of([](const SceneData& s) { return std::sqrt(s.spheres.at(0).radius_squared); });
  const auto center = of([](const SceneData& s) { return s.spheres.at(0).center.y; });
  const auto side = of([](const SceneData& s) {
    return s.sphere_frames.empty() ? 1.0f : s.sphere_frames.at(0).side;
  });
  const auto normal_z = of([](const SceneData& s) { return s.quads.at(0).normal.z; });
  const auto spheres = of([](const SceneData& s) { return s.spheres.size(); });
  const auto placed = [](const std::string& steps) {
    return "<transform name='to_world'>" + steps + "</transform>";
  };
  const std::string ball = shape("sphere");
  const std::string flip = flag("flip_normals", true);
  const auto mirror = placed("<scale x='-1'/>"), minus = placed("<scale value='-1'/>");
  // Golden: the side of the normals that ray_intersect() of Mitsuba 3.9.1 finds.
  expect_rows(
      {{shape("sphere"), radius, 1},
       {shape("sphere", number("radius", 2.5)), radius, 2.5},
       {shape("sphere", number("radius", 1e-3)), radius, 1e-3},
       {shape("sphere", number("radius", -0.9)), radius, 0.9},
       {shape("sphere", number("radius", -0.9)), side, -1},
       {shape("sphere", number("radius", -0.9) + flip), side, 1},
       {shape("sphere", flip), side, -1},
       {shape("sphere", mirror), side, -1},
       {shape("sphere", minus), side, -1},
       {shape("sphere", mirror + number("radius", -0.9)), side, 1},
       {shape("sphere", minus + number("radius", -0.9)), side, 1},
       {shape("sphere", minus + number("radius", -0.9) + flip), side, -1},
       {shape("sphere", placed("<scale value='-2'/>") + number("radius", 0.9)), radius, 1.8},
       {shape("sphere", number("radius", 0)) + ball, spheres, 1, "radius of shape 'sphere' is 0"},
       {shape("sphere", placed("<scale value='0'/>")) + ball, spheres, 1, "singular"},
       {shape("sphere", "<point name='center' x='1' y='2' z='3'/>"), center, 2},
       {shape("sphere", "<point name='center' value='2'/>"), center, 2},
       {shape("sphere", "<vector name='center' value='1 2 3'/>"), center, 2},
       {shape("sphere", placed("<translate value='2'/>")), center, 2},
       {shape("sphere", placed("<matrix value='1 0 0 0  0 1 0 2  0 0 1 0  0 0 1e-9 "
                               "1.0000001'/>")),
        center, 2},
       {shape("sphere",
              "<animation name='to_world'><transform time='0'><translate y='2'/>"
              "</transform><transform time='1'/></animation>"),
        center, 2, "<animation> is not supported"},
       {shape("rectangle"), normal_z, 1},
       {shape("rectangle", flip), normal_z, -1},
       {shape("rectangle", mirror), normal_z, 1},
       {shape("rectangle", mirror + flip), normal_z, -1},
       {shape("rectangle", placed("<scale z='0'/>")), normal_z, 1, "squeezes a shape flat"},
       {shape("rectangle", placed("<scale x='0'/>")) + ball, spheres, 1, "singular"},
       {shape("cube"), of([](const SceneData& s) { return s.quads.size(); }), 6},
       {shape("cylinder", "<point name='p1' x='0' y='0' z='0'/>") + ball, spheres, 1,
        "p0 and p1 are the same point"},
       {shape("cylinder", number("radius", 0)) + ball, spheres, 1,
        "radius of shape 'cylinder' is 0"},
       {shape("hair") + ball, spheres, 1, "shape 'hair' is not supported"}},
      lit + "%");
}

// A quad has no coordinates: shapes of materials that ask for them are meshes, also where a part
// asks.
TEST(MitsubaParameters, OfWhatNeedsCoordinates) {
  const std::string brushed =
      bsdf("roughconductor", number("alpha_u", 0.1) + number("alpha_v", 0.3));
  const std::string round = bsdf("roughconductor", number("alpha", 0.1));
  const std::string board = bsdf("diffuse", "<texture type='checkerboard' name='reflectance'/>");
  const auto blend = [](const std::string& a, const std::string& b) {
    return bsdf("blendbsdf", number("weight", 0.5) + a + b);
  };
  const auto meshes = of([](const SceneData& s) { return s.meshes.size(); });
  expect_rows({{round, meshes, 0},
               {brushed, meshes, 1},
               {board, meshes, 1},
               {blend(round, round), meshes, 0},
               {blend(round, brushed), meshes, 1},
               {blend(blend(round, board), round), meshes, 1}},
              lit_square);
  const auto vertices = [](const std::string& material) {
    return load_xml(lit + "<shape type='disk'>" + material + "</shape>")
        .scene.meshes.at(0)
        .positions.size();
  };
  EXPECT_EQ(vertices(round), vertices(board));
  EXPECT_GT(vertices(brushed), 10 * vertices(board));  // 64 rings
  EXPECT_EQ(vertices(blend(round, brushed)), vertices(brushed));
}

// Golden: of the first vertex that Mitsuba 3.9.1 sees from +x; a negative radius turns a cylinder
// by half a turn and leaves its normals where they are.
TEST(MitsubaParameters, OfCylindersAndDisks) {
  const auto outward = [](const std::string& type, const std::string& inside) {
    const Mesh mesh =
        load_xml(lit + "<shape type='" + type + "'>" + inside + "</shape>").scene.meshes.at(0);
    const Vec3 axis =
        type == "disk" ? Vec3(0, 0, 1) : Vec3(mesh.positions.at(0).x, mesh.positions.at(0).y, 0);
    return glm::dot(mesh.normals.at(0), axis) > 0;
  };
  const std::string flip = flag("flip_normals", true), negative = number("radius", -0.9);
  for (const std::string steps :
       {"", "<scale x='-1'/>", "<scale z='-1'/>", "<scale value='-1'/>"}) {
    const std::string place = "<transform name='to_world'>" + steps + "</transform>";
    EXPECT_TRUE(outward("cylinder", place)) << steps;
    EXPECT_TRUE(outward("cylinder", place + negative)) << steps;
    EXPECT_FALSE(outward("cylinder", place + flip)) << steps;
    EXPECT_FALSE(outward("cylinder", place + negative + flip)) << steps;
    const bool turned = steps.find("z=") != steps.npos || steps.find("value") != steps.npos;
    EXPECT_EQ(outward("disk", place), !turned) << steps;
    EXPECT_EQ(outward("disk", place + flip), turned) << steps;
  }
  const Mesh cylinder = load_xml(lit + "<shape type='cylinder'>" + negative +
                                 "<point name='p0' value='1 2 3'/><point name='p1' value='1 2 7'/>"
                                 "</shape>")
                            .scene.meshes.at(0);
  for (const Vec3& p : cylinder.positions) {
    EXPECT_NEAR(std::hypot(p.x - 1, p.y - 2), 0.9, 1e-5);
    EXPECT_GE(p.z, 3 - 1e-5f);
    EXPECT_LE(p.z, 7 + 1e-5f);
  }
}

TEST(MitsubaParameters, OfTextures) {
  const auto bitmap = [](const std::string& inside, const std::string& type = "checkerboard") {
    return bsdf("diffuse",
                "<texture type='" + type + "' name='reflectance'>" + inside + "</texture>");
  };
  const auto u_row = [](int i) {
    return of([=](const SceneData& s) { return s.textures.at(0).u_row[i]; });
  };
  const auto color0 = of([](const SceneData& s) { return s.textures.at(0).color0.x; });
  const auto color1 = of([](const SceneData& s) { return s.textures.at(0).color1.x; });
  const auto to_uv = [](const std::string& steps) {
    return "<transform name='to_uv'>" + steps + "</transform>";
  };
  const auto factor = parameter(0);
  const std::string board = "<texture type='checkerboard'/>";
  expect_rows(
      {{bitmap(""), color0, 0.4},
       {bitmap(""), color1, 0.2},
       {bitmap(number("color0", 0.7)), color0, 0.7},
       {bitmap(number("color1", 0.7)), color1, 0.7},
       {bitmap(number("color1", 2)), color1, 1, "above 1"},
       {bitmap(""), u_row(0), 1},
       {bitmap(to_uv("<scale x='3'/>")), u_row(0), 3},
       {bitmap(to_uv("<translate x='3'/>")), u_row(2), 3},
       {bitmap(to_uv("<scale value='0'/>")), u_row(0), 0},
       {bitmap(number("uscale", 3)), u_row(0), 3, "", "0.6.0"},
       {bitmap(number("uvscale", 3)), u_row(0), 3, "", "0.6.0"},
       {bitmap(number("uvscale", 3) + number("uscale", 4)), u_row(0), 4, "", "0.6.0"},
       {bitmap(number("uoffset", 0.3)), u_row(2), 0.3, "", "0.6.0"},
       {bitmap(number("scale", 0.25) + board, "scale"), factor, 0.25, "", "0.6.0"},
       {bitmap(board, "scale"), factor, 1, "", "0.6.0"},
       {bitmap(number("value", 0.5) + number("scale", 0.25), "scale"), factor, 0.125, "", "0.6.0"},
       {bitmap("", "wobble"), factor, 0.5, "texture 'wobble' is not supported: 0.5"}},
      lit_square);
}

TEST(MitsubaParameters, OfMedia) {
  const auto medium = [](const std::string& inside) {
    return "<shape type='sphere'><bsdf type='null'/><medium type='homogeneous' name='interior'>" +
           inside + "</medium></shape>";
  };
  const auto t = of([](const SceneData& s) { return s.media.at(0).extinction.x; });
  const auto albedo = of([](const SceneData& s) { return s.media.at(0).albedo.x; });
  const auto g = of([](const SceneData& s) { return s.media.at(0).phase_parameter; });
  const auto phase = [](const std::string& type, const std::string& inside) {
    return "<phase type='" + type + "'>" + inside + "</phase>";
  };
  expect_rows({{medium(""), t, 1},
               {medium(""), albedo, 0.75},
               {medium(number("sigma_t", 2)), t, 2},
               {medium(number("sigma_t", 2) + number("scale", 3)), t, 6},
               {medium(number("sigma_t", -2)), t, 0, "a negative component"},
               {medium(number("albedo", 1)), albedo, 1},
               {medium(number("albedo", 1.5)), albedo, 1, "above 1"},
               {medium(number("sigma_s", 3) + number("sigma_a", 1)), t, 4},
               {medium(number("sigma_s", 3) + number("sigma_a", 1)), albedo, 0.75},
               {medium(number("sigma_a", 1)), albedo, 0},
               {medium(phase("hg", "")), g, 0.8},
               {medium(phase("hg", number("g", -0.99))), g, -0.99},
               {medium(phase("wobble", "")), albedo, 0.75, "phase function 'wobble'"}},
              lit + "%");
  for (const double bad : {1.0, -1.0, 2.0}) {
    expect_error([&] { load_xml(medium(phase("hg", number("g", bad)))); }, "more than -1");
  }
}

// Substitution in Mitsuba 3.9.1: longest names first, \$ is a dollar, -D before <default>.
TEST(MitsubaParameters, OfTheCommandLine) {
  const auto named = [](const std::string& name, std::map<std::string, std::string> given = {}) {
    LoadOptions options;
    options.definitions = std::move(given);
    const SceneData scene = load_xml(
                                "<default name='a' value='one'/><default name='ab' value='two'/>"
                                "<shape type='rectangle'><bsdf type='diffuse' id='" +
                                    name + "'/></shape>",
                                "3.0.0", options)
                                .scene;
    return scene.names.materials.at(0);
  };
  EXPECT_EQ(named("$a"), "one");
  EXPECT_EQ(named("$ab"), "two");
  EXPECT_EQ(named("$abc"), "twoc");
  EXPECT_EQ(named("$ac"), "onec");
  EXPECT_EQ(named("$a$ab-$a"), "onetwo-one");
  EXPECT_EQ(named("\\$a"), "$a");
  EXPECT_EQ(named("\\a$a\\"), "\\aone\\");
  EXPECT_EQ(named("$a", {{"a", "with spaces = and 'quotes'"}}), "with spaces = and 'quotes'");
}

}  // namespace
}  // namespace pt
