// How bright pbrt's lights are, and where they are: an rgb of 1 is a radiance of 1.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/light/sky/environment.h"
#include "common/scene/prepare/prepare_scene.h"
#include "load/expect_near.h"
#include "load/pbrt_scene.h"
#include "render_serial.h"

namespace pt {
namespace {

/// The mean of an image of 16 x 16 pixels.
Color mean_color(const SceneData& loaded, int spp = 16, int depth = 2) {
  SceneData scene = loaded;
  Options options = image_options(16, 16, spp, depth);
  options.filter = FilterChoice();
  prepare_scene(scene, options);
  const Image image = render(scene, options).image;
  Color sum(0.0f);
  for (std::size_t i = 0; i < image.rgb.size(); ++i) sum[static_cast<int>(i % 3)] += image.rgb[i];
  return sum / 256.0f;
}

const std::string black = "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\n";
const std::string white = "Material \"diffuse\" \"rgb reflectance\" [ 1 1 1 ]\n";

/// Behind the camera: scenes need something.
const std::string dot_behind =
    " AttributeBegin Translate 0 0 -9 Shape \"sphere\" \"float radius\" .001 AttributeEnd ";

float luminance_of(const Color& c) { return dot(c, Color(0.2126f, 0.7152f, 0.0722f)); }

TEST(PbrtLights, AnRgbOfOneIsARadianceOfOne) {
  expect_near(mean_color(load_pbrt_silently(pbrt_world("LightSource \"infinite\"" + dot_behind))),
              Color(1.0f));
  expect_near(mean_color(load_pbrt_silently(pbrt_world(
                  "LightSource \"infinite\" \"rgb L\" [.1 .2 .3] \"float scale\" 2" + dot_behind))),
              {0.2f, 0.4f, 0.6f});
  expect_near(
      mean_color(load_pbrt_silently(pbrt_world(
          "AreaLightSource \"diffuse\" \"rgb L\" [.1 .2 .3] \"float scale\" 2\n" + facing_wall))),
      {0.2f, 0.4f, 0.6f});
}

TEST(PbrtLights, TheFilmsExposureMultipliesAll) {
  const auto color = [](const std::string& film, const std::string& camera) {
    return mean_color(
        load_pbrt_silently("Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16 " +
                           film + " PixelFilter \"box\" Camera \"perspective\" " + camera +
                           " WorldBegin LightSource \"infinite\"" + dot_behind));
  };
  expect_near(color("\"float iso\" 250", ""), Color(2.5f));
  expect_near(color("\"float iso\" 400", "\"float shutteropen\" 0 \"float shutterclose\" 0.125"),
              Color(0.5f));
}

TEST(PbrtLights, TheFilmsWhiteIsWhite) {
  const auto color = [](const std::string& film, const std::string& light) {
    return mean_color(
        load_pbrt_text("Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16 " +
                       film +
                       " PixelFilter \"box\" Camera \"perspective\" WorldBegin LightSource "
                       "\"infinite\" \"spectrum L\" \"" +
                       light + "\"" + dot_behind)
            .scene);
  };
  expect_near(color("\"float whitebalance\" 5000", "stdillum-D50"), Color(1.0f), 2e-3f);
  const Color lamp = color("\"float whitebalance\" 2855.5", "stdillum-A");
  expect_near(lamp, Color(1.0f), 3e-3f);
  // A camera's sensor takes daylight for white unless it is told otherwise.
  const std::string sensor = "\"string sensor\" \"canon_eos_100d\" ";
  expect_near(color(sensor, "stdillum-D65"), Color(1.0f), 3e-3f);
  expect_near(color(sensor + "\"float whitebalance\" 5000", "stdillum-D50"), Color(1.0f), 2e-3f);
  // Daylight is blue where a lamp is white.
  const Color blue = color("\"float whitebalance\" 3200", "stdillum-D65");
  EXPECT_GT(blue.z, 1.5f * blue.x);
}

TEST(PbrtLights, SpectraHaveLuminanceOneWhateverTheirMagnitude) {
  const auto sky = [](const std::string& L) {
    return load_pbrt_silently(pbrt_world("LightSource \"infinite\" " + L)).sky.zenith;
  };
  for (const char* L : {"\"blackbody L\" 3000", "\"spectrum L\" \"stdillum-F2\"",
                        "\"spectrum L\" [ 400 7 700 7 ]", "\"spectrum L\" \"stdillum-A\""}) {
    EXPECT_NEAR(luminance_of(sky(L)), 1.0f, 1e-3f) << L;
  }
  // Illuminant A is a black body of 2856 K.
  expect_near(sky("\"spectrum L\" \"stdillum-A\""), sky("\"blackbody L\" 2856"), 0.01f);
  expect_near(sky("\"spectrum L\" \"stdillum-D65\""), Color(1.0f), 2e-3f);
}

TEST(PbrtLights, ColorSpacesBecomeSrgb) {
  const auto sky = [](const std::string& space, const std::string& L) {
    return load_pbrt_silently(pbrt_world("ColorSpace \"" + space + "\" LightSource \"infinite\" " +
                                         "\"rgb L\" " + L))
        .sky.zenith;
  };
  expect_near(sky("rec2020", "[1 1 1]"), Color(1.0f), 1e-4f);
  // ITU-R BT.2087, the inverse of its matrix, of the colour (0.6274, 0.0691, 0.0164): sRGB's red.
  expect_near(sky("rec2020", "[.627404 .069097 .016391]"), {1, 0, 0}, 1e-3f);
  expect_near(sky("dci-p3", "[.822462 .033194 .017083]"), {1, 0, 0}, 1e-3f);
}

TEST(PbrtLights, PointAndSpotIlluminateAsTheirPowerSays) {
  const auto light = [](const std::string& text) {
    return load_pbrt_silently(pbrt_world("Translate 1 2 3 " + text)).delta_lights.at(0);
  };
  const DeltaLight point = light("LightSource \"point\" \"point3 from\" [1 0 0] \"rgb I\" [1 2 3]");
  expect_near(point.position, {2, 2, 3});
  expect_near(point.intensity, {1, 2, 3});
  expect_near(light("LightSource \"point\" \"float power\" 10").intensity, Color(10 / (4 * pi)));
  const DeltaLight spot = light(
      "LightSource \"spot\" \"float coneangle\" 60 \"float conedeltaangle\" 15 \"float power\" 3 "
      "\"point3 to\" [0 2 0]");
  EXPECT_NEAR(spot.cos_outer, 0.5f, 1e-6f);
  EXPECT_NEAR(spot.cos_inner, std::sqrt(0.5f), 1e-6f);
  expect_near(spot.direction, {0, 1, 0});
  // The integral of smoothstep(cos) over the sphere, by the midpoint rule.
  double sum = 0;
  constexpr int steps = 10000;
  for (int i = 0; i < steps; ++i) {
    const double c = 0.5 + 0.5 * (i + 0.5) / steps;
    const double t = std::clamp((c - 0.5) / (std::sqrt(0.5) - 0.5), 0.0, 1.0);
    sum += 2 * double{pi} * t * t * (3 - 2 * t) * 0.5 / steps;
  }
  EXPECT_NEAR(spot.intensity.x * sum, 3.0, 0.01);
}

TEST(PbrtLights, DistantLightFallsFromFromToTo) {
  const DeltaLight light =
      load_pbrt_silently(pbrt_world("LightSource \"distant\" \"point3 from\" [0 3 0] \"point3 to\" "
                                    "[0 1 0] \"rgb L\" [2 2 2] \"float illuminance\" 5"))
          .delta_lights.at(0);
  expect_near(light.direction, {0, -1, 0});
  expect_near(light.intensity, Color(10.0f));
  // On a white wall: irradiance 2 across it, radiance 2 / pi.
  expect_near(mean_color(load_pbrt_silently(
                  pbrt_world(white + facing_wall + "LightSource \"distant\" \"rgb L\" [2 2 2]"))),
              Color(2.0f * inverse_pi), 1e-4f);
}

TEST(PbrtLights, PowerOfAnAreaLightIsSpreadOverItsShape) {
  const auto radiance = [](const std::string& text) {
    const SceneData scene =
        load_pbrt_silently(pbrt_world("AreaLightSource \"diffuse\" \"float power\" 12 " + text));
    return scene.materials.back().emission.radiance.x;
  };
  EXPECT_NEAR(radiance("Scale 2 2 2 Shape \"sphere\" \"float radius\" .5"), 12 / (pi * 4 * pi),
              1e-4);
  // The disk is a polygon of 256 sides here.
  EXPECT_NEAR(radiance("Shape \"disk\" \"float radius\" 2"), 12 / (pi * 4 * pi), 2e-4);
  EXPECT_NEAR(radiance("Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]"), 12 / (pi * 0.5f),
              1e-4);
  EXPECT_NEAR(radiance("\"bool twosided\" true Shape \"disk\" \"float radius\" 2"),
              12 / (2 * pi * 4 * pi), 2e-4);
}

/// Radiance seen by the camera, which looks along +z, of a lamp in its way.
float seen(const std::string& lamp) {
  return mean_color(load_pbrt_silently(pbrt_world(black + lamp)), 1).x;
}

TEST(PbrtLights, ASurfaceShinesToTheSideOfItsNormal) {
  const std::string light = "AreaLightSource \"diffuse\" ";
  const std::string triangle = "Shape \"trianglemesh\" \"point3 P\" [0 9 1  9 -9 1  -9 -9 1] ";
  // Counterclockwise from +z: dark to us, who are at -z of it.
  EXPECT_EQ(seen(light + "Shape \"trianglemesh\" \"point3 P\" [0 9 1  -9 -9 1  9 -9 1]"), 0.0f);
  EXPECT_EQ(seen(light + triangle), 1.0f);
  EXPECT_EQ(seen(light + "ReverseOrientation " + triangle), 0.0f);
  // A mirror turns the winding, not the normal.
  EXPECT_EQ(seen(light + "Scale -1 1 1 " + triangle), 1.0f);
  EXPECT_EQ(seen(light + "Scale -1 1 1 ReverseOrientation " + triangle), 0.0f);
  // Given normals decide.
  EXPECT_EQ(seen(light + triangle + "\"normal N\" [0 0 1 0 0 1 0 0 1]"), 0.0f);
  EXPECT_EQ(seen(light + triangle + "\"normal N\" [0 0 -1 0 0 -1 0 0 -1]"), 1.0f);
  EXPECT_EQ(seen(light + "Translate 0 0 2 Shape \"disk\" \"float radius\" 9"), 0.0f);
  EXPECT_EQ(seen(light + "ReverseOrientation Translate 0 0 2 Shape \"disk\" \"float radius\" 9"),
            1.0f);
  EXPECT_EQ(seen(light + "Shape \"sphere\" \"float radius\" 3"), 0.0f);
  EXPECT_EQ(seen(light + "ReverseOrientation Shape \"sphere\" \"float radius\" 3"), 1.0f);
}

TEST(PbrtLights, TwoSidedLampsShineOnBothSides) {
  for (const char* reverse : {"", "ReverseOrientation "}) {
    const std::string both =
        std::string("AreaLightSource \"diffuse\" \"bool twosided\" true ") + reverse;
    EXPECT_EQ(seen(both + "Shape \"trianglemesh\" \"point3 P\" [0 9 1  9 -9 1  -9 -9 1] "), 1.0f);
    EXPECT_EQ(seen(both + "Shape \"sphere\" \"float radius\" 3"), 1.0f);
    EXPECT_EQ(seen(both + "Translate 0 0 9 Shape \"disk\" \"float radius\" 99"), 1.0f);
  }
}

// ---- pictures of all directions

/// pbrt-v4, section 3.8.3: from the unit square to the sphere, written from the text.
Vec3 sphere_of_square(double px, double py) {
  const double u = 2 * px - 1, v = 2 * py - 1;
  const double d = 1 - (std::abs(u) + std::abs(v)), r = 1 - std::abs(d);
  const double phi = (r == 0 ? 1 : (std::abs(v) - std::abs(u)) / r + 1) * double{pi} / 4;
  const double z = std::copysign(1 - r * r, d), s = r * std::sqrt(2 - r * r);
  return {std::copysign(std::cos(phi), u) * s, std::copysign(std::sin(phi), v) * s, z};
}

Color glow(const Vec3& d) { return {1.0f + 0.9f * d.x, 1.0f + 0.9f * d.y, 1.0f + 0.9f * d.z}; }

void write_pfm(const std::string& path, int width, int height,
               const std::function<Color(double, double)>& color) {
  std::string bytes = fmt::format("PF\n{} {}\n-1\n", width, height);
  for (int y = height - 1; y >= 0; --y) {  // from its foot
    for (int x = 0; x < width; ++x) {
      const Color c = color((x + 0.5) / width, (y + 0.5) / height);
      bytes.append(reinterpret_cast<const char*>(&c), sizeof c);
    }
  }
  write_text(path, bytes);
}

Color map_at(const EnvironmentData& map, const Vec3& world) {
  const Vec3 d = inverse(map.to_world).vector(world);
  Environment view;
  view.width = static_cast<std::uint32_t>(map.width);
  view.height = static_cast<std::uint32_t>(map.height);
  const MapPoint p = environment_point(view, d);
  const auto x = static_cast<std::size_t>(p.x) % view.width;
  const auto y = static_cast<std::size_t>(p.y + 0.5f);
  return map.pixels[y * view.width + x];
}

void expect_glow(const std::string& transform, int width, int height, bool equal_area,
                 const std::function<Vec3(const Vec3&)>& to_light) {
  SCOPED_TRACE(transform);
  const TempFolder folder;
  write_pfm(folder.file("sky.pfm"), width, height, [&](double u, double v) {
    if (equal_area) return glow(sphere_of_square(u, v));
    const double theta = double{pi} * v, phi = 2 * double{pi} * u;
    return glow(
        Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)));
  });
  write_text(folder.file("scene.pbrt"),
             pbrt_world(transform + "LightSource \"infinite\" \"string filename\" \"sky.pfm\""));
  const SceneData scene = load_pbrt_file(folder.file("scene.pbrt")).scene;
  for (const Vec3& v : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(-1, 0, 0), Vec3(0, -1, 0),
                        Vec3(0, 0, -1), Vec3(1, 2, 3), Vec3(-3, 1, -2), Vec3(2, -3, 1)}) {
    const Vec3 d = glm::normalize(v);
    expect_near(map_at(scene.environment, d), glow(to_light(d)), 0.04f);
  }
}

TEST(PbrtEnvironment, PicturesLieAroundTheSceneAsInPbrt) {
  const auto same = [](const Vec3& d) { return d; };
  expect_glow("", 128, 128, true, same);
  expect_glow("Rotate -90 1 0 0 ", 128, 128, true,
              [](const Vec3& d) { return Vec3(d.x, -d.z, d.y); });
  expect_glow("Scale -1 1 1 ", 128, 128, true, [](const Vec3& d) { return Vec3(-d.x, d.y, d.z); });
  expect_glow("Scale 1 1 -2 Rotate -90 1 0 0 ", 128, 128, true, [](const Vec3& d) {
    const Vec3 flipped = glm::normalize(Vec3(d.x, d.y, -0.5f * d.z));
    return Vec3(flipped.x, -flipped.z, flipped.y);
  });
  expect_glow("", 256, 128, false, same);
}

TEST(PbrtEnvironment, AConstantPictureOfAnIlluminance) {
  const TempFolder folder;
  write_pfm(folder.file("sky.pfm"), 32, 32, [](double, double) { return Color(3.0f); });
  const auto sky = [&](const std::string& more) {
    write_text(folder.file("scene.pbrt"),
               pbrt_world("LightSource \"infinite\" \"string filename\" \"sky.pfm\" " + more));
    return load_pbrt_file(folder.file("scene.pbrt")).scene.environment.pixels.at(1234);
  };
  expect_near(sky(""), Color(3.0f));
  expect_near(sky("\"float scale\" .5"), Color(1.5f));
  // pbrt takes the hemisphere's solid angle for pi, so that the radiance is twice E / pi.
  expect_near(sky("\"float illuminance\" 7"), Color(2 * 7 * inverse_pi), 1e-3f);
  EXPECT_NEAR(load_pbrt_silently(pbrt_world("LightSource \"infinite\" \"float illuminance\" 7"))
                  .sky.zenith.x,
              7 * inverse_pi, 1e-5f);
}

}  // namespace
}  // namespace pt
