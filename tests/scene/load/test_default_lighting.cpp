// Which models are lit by what they bring, and which get default lighting.
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <map>

#include "common/image/codecs/image_io.h"
#include "common/scene/load/files/default_lighting.h"
#include "common/scene/load/load_scene.h"
#include "load/gltf_files.h"

namespace pt {
namespace {

/// An OBJ file in the making, and its MTL file.
class ObjMaker {
 public:
  ObjMaker& material(const std::string& name, const std::string& lines) {
    mtl_ += "newmtl " + name + "\n" + lines + "\n";
    return *this;
  }
  /// Seen from where a, b, c, d go counterclockwise.
  ObjMaker& quad(const char* material, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    obj_ += fmt::format("usemtl {}\n", material);
    for (const Vec3& p : {a, b, c, d}) obj_ += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
    obj_ += "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf -4/-4 -3/-3 -2/-2 -1/-1\n";
    return *this;
  }
  /// Level, of half the width `half`, about `center`; it faces up or down.
  ObjMaker& level(const char* material, Vec3 center, float half, bool up) {
    const Vec3 x(half, 0, 0), z(0, 0, up ? half : -half);
    return quad(material, center - x + z, center + x + z, center + x - z, center - x - z);
  }
  /// All or some of the faces of a box, outwards or inwards.
  ObjMaker& box(const char* material, Vec3 center, Vec3 half, bool inwards,
                const std::string& faces = "-x +x -y +y -z +z") {
    for (int axis = 0; axis < 3; ++axis) {
      for (const float sign : {-1.0f, 1.0f}) {
        const char name[] = {sign < 0 ? '-' : '+', "xyz"[axis], 0};
        if (faces.find(name) == std::string::npos) continue;
        Vec3 n(0.0f), u(0.0f), v(0.0f);
        n[axis] = sign * half[axis];
        u[(axis + 1) % 3] = half[(axis + 1) % 3];
        v[(axis + 2) % 3] = half[(axis + 2) % 3] * (inwards ? -sign : sign);
        quad(material, center + n - u - v, center + n + u - v, center + n + u + v,
             center + n - u + v);
      }
    }
    return *this;
  }
  ObjMaker& ball(const char* material, Vec3 center, float radius) {
    constexpr int rows = 12, columns = 24;
    const auto at = [&](int row, int column) {
      const float theta = pi * static_cast<float>(row) / rows;
      const float phi = 2 * pi * static_cast<float>(column) / columns;
      return center + radius * Vec3(std::sin(theta) * std::sin(phi), std::cos(theta),
                                    std::sin(theta) * std::cos(phi));
    };
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j)
        quad(material, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1), at(i, j));
    return *this;
  }
  void write(const TempFolder& folder) const {
    write_text(folder.file("m.mtl"), mtl_);
    write_text(folder.file("m.obj"), "mtllib m.mtl\n" + obj_);
  }

 private:
  std::string mtl_ = "newmtl grey\nKd .7 .7 .7\n", obj_;
};

const std::string lamp = "Kd 0 0 0\nKe 15 15 15";

/// A box of 2 x 2 x 2 that is open towards +z or -z, with a lamp below its ceiling.
ObjMaker room(const std::string& emission, bool to_back = false) {
  ObjMaker maker;
  maker.material("lamp", emission)
      .box("grey", {0, 0, 0}, {1, 1, 1}, true, to_back ? "-x +x -y +y +z" : "-x +x -y +y -z");
  maker.box("grey", {0.3f, -0.7f, 0}, {0.3f, 0.3f, 0.3f}, false);
  return maker.level("lamp", {0, 0.99f, 0}, 0.25f, false);
}

struct Result {
  SceneData scene;
  std::string said;

  bool is_default() const { return scene.environment.width > 0; }
};

Result load(const std::string& path, LoadOptions options = {}) {
  Result result;
  options.warn = [&](const std::string& message) { result.said += message + '\n'; };
  result.scene = load_scene_file(path, options);
  EXPECT_EQ(result.said.find("default lighting") != std::string::npos, result.is_default())
      << result.said;
  return result;
}

Result load(const ObjMaker& maker, const LoadOptions& options = {}) {
  const TempFolder folder;
  maker.write(folder);
  write_image(folder.file("black.png"), {4, 4, std::vector<float>(48, 0.0f)}, {}, {});
  return load(folder.file("m.obj"), options);
}

LoadOptions seen_from(float x, float y, float z) {
  LoadOptions options;
  options.camera.look_from = {x, y, z};
  return options;
}

TEST(DefaultLighting, ARoomIsLitByItsLamp) {
  EXPECT_FALSE(load(room(lamp)).is_default());
  EXPECT_FALSE(load(room("Kd 0 0 0\nKe 1 1 1")).is_default());
  EXPECT_FALSE(load(room("Kd .8 .8 .8\nKe 40 30 20")).is_default());
  EXPECT_FALSE(load(room(lamp, true), seen_from(0, 0, -4)).is_default());
  ObjMaker closed;
  closed.material("lamp", lamp).box("grey", {0, 0, 0}, {1, 1, 1}, true);
  closed.level("lamp", {0, 0.99f, 0}, 0.25f, false);
  EXPECT_FALSE(load(closed, seen_from(0, 0, 0.9f)).is_default());
  ObjMaker yard;
  yard.material("lamp", lamp).level("grey", {0, 0, 0}, 2, true).level("lamp", {0, 2, 0}, 1, false);
  EXPECT_FALSE(load(yard).is_default());
}

TEST(DefaultLighting, WhatTheLampsOfAModelDoNotShow) {
  const auto model = [](const std::string& emission) {
    ObjMaker maker;
    maker.material("lamp", emission);
    return maker;
  };
  struct Case {
    const char* name;
    ObjMaker maker;
  };
  const Case cases[] = {
      {"a weak one", model("Kd .8 .3 .2\nKe .001 .001 .001").level("lamp", {}, 1, true)},
      {"a sign beside a dark wall", model("Kd .8 .8 .8\nKe .5 .5 .5")
                                        .level("lamp", {}, 1, true)
                                        .level("grey", {1.6f, 0, 0}, 0.6f, true)},
      {"a wide weak one",
       model("Ke .009 .009 .009").level("grey", {}, 2, true).level("lamp", {0, 1, 0}, 2, false)},
      {"a weak one in a room", room("Ke .001 .001 .001")},
      {"a black picture", model("Kd .8 .3 .2\nmap_Ke black.png").level("lamp", {}, 1, true)},
      {"a ball with a small one",
       model("Ke 5 5 5").ball("grey", {}, 1).level("lamp", {0, 1.01f, 0}, 0.1f, true)},
      {"in a closed box", model(lamp).box("grey", {}, {1, 1, 1}, false).ball("lamp", {}, 0.2f)},
      {"away from all",
       model(lamp).level("grey", {0, 0, 0}, 1, true).level("lamp", {0, 0.5f, 0}, 0.4f, true)},
      {"a car", model("Ke 5 5 5")
                    .level("grey", {0, 0, 0}, 6, true)
                    .box("grey", {0, 1, 0}, {2, 0.7f, 1}, false)
                    .ball("lamp", {2.1f, 0.8f, 0.7f}, 0.15f)
                    .ball("lamp", {2.1f, 0.8f, -0.7f}, 0.15f)},
      {"a lantern", model("Ke 1 1 1")
                        .box("grey", {0, 2, 0}, {0.15f, 2, 0.15f}, false)
                        .box("grey", {0.5f, 3.8f, 0}, {0.5f, 0.1f, 0.1f}, false)
                        .box("grey", {1, 3, 0}, {0.3f, 0.4f, 0.3f}, false, "-y +y")
                        .ball("lamp", {1, 3, 0}, 0.2f)},
      {"the back of a room", room(lamp, true)},
  };
  for (const Case& one : cases) {
    const Result result = load(one.maker);
    EXPECT_TRUE(result.is_default()) << one.name;
    EXPECT_NE(result.said.find("the file's emission lights little or nothing"), std::string::npos)
        << one.name << ": " << result.said;
    EXPECT_NE(result.said.find("--default-lighting off"), std::string::npos);
    EXPECT_TRUE(result.scene.defaults.measure_exposure) << one.name;
  }
}

/// A camera of the file's own shows what its author wants seen.
TEST(DefaultLighting, OtherDirectionsCountForCamerasThatWereGuessed) {
  const TempFolder folder;
  room(lamp).write(folder);
  LoadOptions off;
  off.default_lighting = DefaultLighting::off;
  SceneData scene = load_scene_file(folder.file("m.obj"), off);
  scene.camera.look_from = {5, 2.5f, 4};  // a third of what it sees is the inside
  EXPECT_EQ(light_model({}, true, scene), "");
  EXPECT_NE(light_model({}, false, scene), "");
}

TEST(DefaultLighting, WhatShinesAllOverIsAsItIs) {
  ObjMaker maker;
  maker.material("lamp", "Kd .5 .5 .5\nKe .5 .5 .5").ball("lamp", {}, 1);
  const Result result = load(maker);
  EXPECT_FALSE(result.is_default());
  EXPECT_FALSE(result.scene.defaults.measure_exposure);
}

TEST(DefaultLighting, TheOptionDecides) {
  LoadOptions off, on;
  off.default_lighting = DefaultLighting::off, on.default_lighting = DefaultLighting::on;
  ObjMaker dark;
  dark.level("grey", {}, 1, true);
  EXPECT_TRUE(load(dark).is_default());
  LoadOptions said = off;
  EXPECT_NE(load(dark, off).said.find("nothing lights the picture"), std::string::npos);
  const TempFolder folder;
  room(lamp).write(folder);
  EXPECT_GT(load_scene_file(folder.file("m.obj"), on).environment.width, 0);
  write_text(folder.file("a.xml"), "<scene version=\"3.0.0\"><shape type=\"cube\"/></scene>");
  write_text(folder.file("a.pbrt"), "WorldBegin\nShape \"sphere\"\n");
  for (const char* name : {"a.xml", "a.pbrt"}) {
    EXPECT_GT(load_scene_file(folder.file(name)).environment.width, 0) << name;
    EXPECT_EQ(load_scene_file(folder.file(name), off).environment.width, 0) << name;
  }
}

TEST(DefaultLighting, OtherFilesStayDarkAndSayIt) {
  const TempFolder folder;
  const auto said = [&](const char* name, const std::string& text) {
    write_text(folder.file(name), text);
    const Result result = load(folder.file(name));
    EXPECT_FALSE(result.is_default()) << text;
    return result.said.find("nothing lights the picture") != std::string::npos;
  };
  const auto xml = [&](const std::string& emitter) {
    return said("a.xml",
                "<scene version=\"3.0.0\"><shape type=\"sphere\"/>" + emitter + "</scene>");
  };
  EXPECT_TRUE(xml("<emitter type=\"constant\"><rgb name=\"radiance\" value=\"0\"/></emitter>"));
  EXPECT_TRUE(xml("<emitter type=\"point\"><rgb name=\"intensity\" value=\"0\"/></emitter>"));
  EXPECT_FALSE(xml("<emitter type=\"point\"><rgb name=\"intensity\" value=\"1e-9\"/></emitter>"));
  EXPECT_FALSE(xml("<emitter type=\"constant\"/>"));
  const std::string pbrt = "WorldBegin\nShape \"sphere\"\n";
  EXPECT_TRUE(said("a.pbrt", pbrt + "LightSource \"point\" \"rgb I\" [0 0 0]\n"));
  EXPECT_FALSE(said("a.pbrt", pbrt + "LightSource \"point\" \"rgb I\" [1 1 1]\n"));
}

// Each kind of light counts by itself, however little it gives; one that is black does not.
TEST(DefaultLighting, WhatCountsAsALight) {
  using Change = std::function<void(SceneData&, const Color&)>;
  const auto emitting = [](SceneData& scene, const Color& radiance) {
    return scene.add_material(make_diffuse(Color(0.0f), radiance));
  };
  const std::map<std::string, Change> kinds = {
      {"nadir", [](SceneData& s, const Color& c) { s.sky.nadir = c; }},
      {"zenith", [](SceneData& s, const Color& c) { s.sky.zenith = c; }},
      {"sun",
       [](SceneData& s, const Color& c) { s.sun.radiance = c, s.sun.one_minus_cos = 1e-5f; }},
      {"picture",
       [](SceneData& s, const Color& c) {
         s.environment.width = 2, s.environment.height = 1;
         s.environment.pixels = {Color(0.0f), c};
       }},
      {"medium",
       [](SceneData& s, const Color& c) {
         s.media.resize(2);
         s.media[1].emission = c;
       }},
      {"lamp",
       [](SceneData& s, const Color& c) {
         s.delta_lights.resize(2);
         s.delta_lights[0].intensity = Color(0.0f), s.delta_lights[1].intensity = c;
       }},
      {"quad",
       [&](SceneData& s, const Color& c) {
         s.add_quad({}, {1, 0, 0}, {0, 1, 0}, emitting(s, c));
       }},
      {"sphere", [&](SceneData& s, const Color& c) { s.add_sphere({}, 1, emitting(s, c)); }},
      {"mesh", [&](SceneData& s, const Color& c) {
         Mesh mesh;
         mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, mesh.triangles = {{{0, 1, 2}}};
         mesh.material = emitting(s, c);
         s.meshes.push_back(mesh);
       }}};
  for (const auto& [name, change] : kinds) {
    for (const float blue : {0.0f, 1e-6f}) {
      SceneData scene;
      scene.add_quad({}, {1, 0, 0}, {0, 1, 0}, scene.add_material(make_diffuse(Color(0.5f))));
      change(scene, {0, 0, blue});
      EXPECT_EQ(light_scene({}, scene).empty(), blue > 0) << name;
      EXPECT_EQ(scene.environment.width, name == "picture" ? 2 : 0) << name;
    }
  }
}

/// The triangle of triangle_file(), two-sided, with a point light of this intensity at z.
Result lit_triangle(float intensity, float z, bool is_glowing = false) {
  GltfMaker maker = with_material({{"doubleSided", true}});
  if (is_glowing) maker.root["materials"][0]["emissiveFactor"] = {1, 1, 1};
  maker.root["extensionsUsed"] = {"KHR_lights_punctual"};
  maker.root["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"intensity", intensity}}};
  maker.root["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}},
                                 {"translation", {0.3f, 0.5f, z}}});
  maker.root["scenes"][0]["nodes"] = {0, 1};
  const TempFolder folder;
  write_text(folder.file("a.gltf"), maker.gltf());
  return load(folder.file("a.gltf"));
}

TEST(DefaultLighting, AGltfWithLights) {
  EXPECT_FALSE(lit_triangle(1, 1).is_default());
  EXPECT_FALSE(lit_triangle(0.01f, 3).is_default());
  EXPECT_FALSE(lit_triangle(1000, 30).is_default());
  const Result weak = lit_triangle(1e-9f, 1);
  EXPECT_TRUE(weak.is_default());
  EXPECT_NE(weak.said.find("the file's lights light little"), std::string::npos) << weak.said;
  EXPECT_TRUE(lit_triangle(0, 1).is_default());
  EXPECT_TRUE(lit_triangle(5, -1).is_default()) << "behind what is seen";
}

TEST(DefaultLighting, ExposureIsMeasuredWhereEmissionAloneIsFarFromADisplaysRange) {
  for (const float radiance : {0.5f, 15.0f, 5000.0f}) {
    const Result result = load(room(fmt::format("Kd 0 0 0\nKe {0} {0} {0}", radiance)));
    EXPECT_FALSE(result.is_default()) << radiance;
    EXPECT_EQ(result.scene.defaults.measure_exposure, radiance != 15.0f) << radiance;
  }
}

/// Below the middle of a square lamp of half side a at height h: the irradiance of a rectangle by
/// its corner, four times (Howell, configuration factor B-4).
double incident_below(double radiance, double a, double h) {
  const double x = a / h, s = std::sqrt(1 + x * x);
  return radiance * 4 / (2 * double{pi}) * 2 * (x / s * std::atan(x / s));
}

TEST(DefaultLighting, TheEstimateIsTheRadianceReflected) {
  ObjMaker maker;
  maker.material("lamp", lamp).level("grey", {0, 0, 0}, 0.01f, true);
  maker.level("lamp", {0, 1, 0}, 0.5f, false);
  const TempFolder folder;
  maker.write(folder);
  const SceneData scene = load_scene_file(folder.file("m.obj"));
  CameraParameters camera = scene.camera;
  camera.look_from = {0, 0.05f, 0.05f}, camera.look_at = {0, 0, 0}, camera.fov_degrees = 1;
  const Glimpse glimpse = LightEstimate(scene).look(camera, {1e-3f, 0.2f});
  EXPECT_EQ(glimpse.lit_share, 1.0);
  double mean = 0;
  for (const float x : glimpse.picture.rgb)
    mean += x / static_cast<double>(glimpse.picture.rgb.size());
  EXPECT_NEAR(mean, 0.7 * incident_below(15, 0.5, 1), 0.01 * mean);
}

}  // namespace
}  // namespace pt
