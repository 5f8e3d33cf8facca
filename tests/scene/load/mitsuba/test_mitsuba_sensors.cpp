// Mitsuba's sensors: where their rays begin and go, between which planes they meet things, and
// whether they see lamps.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/light/sky/environment.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/scene/prepare/prepare_steps.h"
#include "load/expect_near.h"
#include "load/mitsuba_modes.h"
#include "render_serial.h"

namespace pt {
namespace {

std::string sensor(const std::string& type, const std::string& inside) {
  return fmt::format("<sensor type='{}'>{}</sensor>", type, inside);
}

const std::string black = "<bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf>";

/// A square that shines towards -z, with edges of 2 * size, around (x, 0, z).
std::string wall(double z, const char* color, double size = 50, double x = 0) {
  return fmt::format(
      "<shape type='rectangle'><transform name='to_world'><scale value='{}'/>"
      "<rotate y='1' angle='180'/><translate x='{}' z='{}'/></transform>{}"
      "<emitter type='area'><rgb name='radiance' value='{}'/></emitter></shape>",
      size, x, z, black, color);
}

std::string ball(double z, double radius, const char* color) {
  return fmt::format(
      "<shape type='sphere'><float name='radius' value='{}'/>"
      "<point name='center' x='0' y='0' z='{}'/>{}"
      "<emitter type='area'><rgb name='radiance' value='{}'/></emitter></shape>",
      radius, z, black, color);
}

const std::string sky = "<emitter type='constant'><rgb name='radiance' value='0.25'/></emitter>";

/// Expects no warnings.
SceneData load_silently(const std::string& xml) {
  const LoadedScene loaded = load_xml(xml);
  EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
  return loaded.scene;
}

Camera camera_of(const std::string& type, const std::string& inside, int width = 40,
                 int height = 20) {
  return make_camera(load_silently(sensor(type, inside) + sky + wall(5, "1")).camera, width,
                     height);
}

Image image_of(const SceneData& loaded, Options options) {
  SceneData scene = loaded;
  prepare_scene(scene, options);
  return render(scene, options).image;
}

/// Serial, 16 x 16 pixels, one sample each.
Image image_of(const std::string& xml, int depth = 3) {
  Options options = image_options(16, 16, 1, depth);
  options.filter = FilterChoice();  // no sample outside of its pixel
  return image_of(load_silently(xml), options);
}

void expect_all(const Image& image, const Color& color) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) ASSERT_EQ(image.pixel(x, y)[c], color[c]) << x << ", " << y;
    }
  }
}

const std::string three_walls = wall(1, "1 0 0") + wall(3, "0 1 0") + wall(6, "0 0 1") + sky;

std::string clipped(const std::string& type, double near, double far,
                    const std::string& more = number("fov", 90)) {
  return sensor(type, number("near_clip", near) + number("far_clip", far) + more);
}

// sample_ray() of Mitsuba 3.9.1.
TEST(MitsubaSensor, OrthographicRaysAreMitsubas) {
  const Camera camera = camera_of("orthographic",
                                  "<transform name='to_world'><scale x='3' y='5' z='7'/><lookat "
                                  "origin='1,2,3' target='1,2,10' up='0,1,0'/></transform>" +
                                      number("near_clip", 2) + number("far_clip", 10));
  const Ray first = camera_ray(camera, 0, 0, 0.3f, 0.7f), other = camera_ray(camera, 30, 15, 0, 0);
  expect_near(first.origin, {4, 4.5f, 17});
  expect_near(other.origin, {-0.5f, 0.75f, 17});
  for (const Ray& ray : {first, other}) expect_near(ray.direction, {0, 0, 1}, 0.0f);
  EXPECT_EQ(camera.near_clip, 14.0f);
  EXPECT_EQ(camera.distance_in_view(first.direction), 8.0f);
}

TEST(MitsubaSensor, PerspectiveRaysAreMitsubas) {
  const Camera camera =
      camera_of("perspective",
                "<transform name='to_world'><lookat origin='1,2,3' target='2,2.5,10' up='0,1,0'/>"
                "</transform>" +
                    number("fov", 60) + number("near_clip", 2) + number("far_clip", 10));
  const Ray first = camera_ray(camera, 0, 0, 0.3f, 0.7f), other = camera_ray(camera, 30, 15, 0, 0);
  expect_near(first.origin, {2.41947f, 2.71698f, 4.77135f});
  expect_near(first.direction, {0.596299f, 0.301192f, 0.744118f});
  EXPECT_NEAR(camera.distance_in_view(first.direction), 9.521904f, 1e-5f);
  expect_near(other.origin, {0.71347f, 1.85311f, 5.07677f});
  EXPECT_NEAR(camera.distance_in_view(other.direction), 8.406346f, 1e-5f);
}

// What is changed later begins with what was written; the view is that of the matrix.
TEST(MitsubaSensor, TheTargetIsTheWrittenOne) {
  const auto camera_by = [](const std::string& transform) {
    const std::string to_world = "<transform name='to_world'>" + transform + "</transform>";
    return load_silently(sensor("perspective", to_world) + sky + wall(5, "1")).camera;
  };
  const std::string look = "<lookat origin='1,2,3' target='2,0,2.5' up='0,1,0.3'/>";
  for (const std::string before : {"", "<scale x='-1'/>"}) {
    const CameraParameters camera = camera_by(before + look);
    EXPECT_EQ(camera.look_from, Vec3(1, 2, 3)) << before;
    EXPECT_EQ(camera.look_at, Vec3(2, 0, 2.5f)) << before;
    EXPECT_EQ(camera.up, Vec3(0, 1, 0.3f)) << before;
  }
  // Another view than the written one: along z turned about, moved, or upside down.
  const Vec3 forward = glm::normalize(Vec3(1, -2, -0.5f));
  const CameraParameters turned = camera_by("<rotate y='1' angle='180'/>" + look);
  expect_near(glm::normalize(turned.look_at - turned.look_from), -forward);
  const CameraParameters moved = camera_by(look + "<translate x='5'/>");
  EXPECT_EQ(moved.look_from, Vec3(6, 2, 3));
  expect_near(glm::normalize(moved.look_at - moved.look_from), forward);
  const CameraParameters down = camera_by("<scale y='-1'/>" + look);
  EXPECT_EQ(down.look_at, Vec3(2, 0, 2.5f));
  EXPECT_LT(down.up.y, 0);
}

// They lie on the lines of the rays that begin on the lens.
TEST(MitsubaSensor, RaysOfALensBeginAtTheNearPlane) {
  const std::string lens =
      number("fov", 60) + number("aperture_radius", 0.2) + number("focus_distance", 4);
  const Camera camera = camera_of("thinlens", lens + number("near_clip", 1.5));
  CameraParameters parameters = load_silently(sensor("thinlens", lens) + sky + wall(5, "1")).camera;
  parameters.near_clip = 0;
  const Camera from_lens = make_camera(parameters, 40, 20);
  for (const float u : {0.0f, 0.3f, 0.9f}) {
    const Ray ray = camera_ray(camera, 7, 3, u, 0.7f), other = camera_ray(from_lens, 7, 3, u, 0.7f);
    const float distance = camera.distance_of_near_plane(ray.direction);
    EXPECT_NEAR(glm::dot(ray.origin - from_lens.origin, from_lens.forward), 1.5f, 1e-5f);
    expect_near(ray.origin, other.origin + distance * other.direction);
    expect_near(ray.direction, other.direction);
  }
}

TEST(MitsubaSensor, OrthographicPixelsAreSquaresOfTheScene) {
  // 16 pixels see [-1, 1]: the wall from x = 0.25 to 0.75 fills 4 columns. Mitsuba's +x is left.
  const Image image = image_of(sensor("orthographic", "") + wall(5, "1 2 3", 0.25, 0.5) + sky);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const bool inside = x >= 2 && x < 6 && y >= 6 && y < 10;
      EXPECT_EQ(image.pixel(x, y)[2], inside ? 3.0f : 0.25f) << x << ", " << y;
    }
  }
}

TEST(MitsubaSensor, OptionsMoveAnOrthographicCamera) {
  const SceneData scene = load_silently(sensor("orthographic", "") + wall(5, "1") + sky);
  CameraParameters moved = scene.camera;
  CameraOverrides place, fov, lens;
  place.look_from = {3, 4, 0}, place.look_at = {3, 4, 9};
  fov.vertical_fov_degrees = 50.0f, fov.aperture = lens.aperture = 0.1f;
  override_camera(moved, place);
  expect_near(camera_ray(make_camera(moved, 2, 2), 1, 1, 0, 0).origin, {3, 4, 0.01f});
  EXPECT_TRUE(moved.orthographic);
  CameraParameters perspective = scene.camera;
  override_camera(perspective, fov);
  EXPECT_FALSE(perspective.orthographic);
  CameraParameters refused = scene.camera;
  EXPECT_THROW(override_camera(refused, lens), Error);
}

// sample_ray() of Mitsuba 3.9.1; its thin lens has no such parameters, ours has the same.
TEST(MitsubaSensor, PrincipalPointIsMitsubas) {
  for (const char* type : {"perspective", "thinlens"}) {
    const std::string lens = type == std::string("thinlens") ? number("aperture_radius", 0) : "";
    const Camera camera =
        camera_of(type, number("fov", 60) + lens + number("principal_point_offset_x", 0.1) +
                            number("principal_point_offset_y", 0.2));
    expect_near(camera_ray(camera, 10, 5, 0, 0).direction, {0.170595f, 0.0284325f, 0.984931f});
  }
}

TEST(MitsubaSensor, PrincipalPointShiftsByPixels) {
  const Camera plain = camera_of("perspective", number("fov", 60));
  const Camera shifted =
      camera_of("perspective", number("fov", 60) + number("principal_point_offset_x", 0.1) +
                                   number("principal_point_offset_y", -0.25));
  for (const Vec2& at : {Vec2(3, 7), Vec2(36, 19)}) {
    expect_near(camera_ray(shifted, at.x, at.y, 0, 0).direction,
                camera_ray(plain, at.x + 4, at.y - 5, 0, 0).direction);
  }
}

TEST(MitsubaSensor, ClipPlanesCut) {
  for (const std::string type : {"perspective", "thinlens", "orthographic"}) {
    SCOPED_TRACE(type);
    const std::string more = type == "orthographic" ? ""
                             : type == "thinlens"
                                 ? number("fov", 90) + number("aperture_radius", 0.1)
                                 : number("fov", 90);
    const auto image = [&](double near, double far) {
      return image_of(clipped(type, near, far, more) + three_walls);
    };
    expect_all(image(0.5, 100), {1, 0, 0});
    expect_all(image(0.999, 1.001), {1, 0, 0});  // planes, not distances along the rays
    expect_all(image(1.001, 3.001), {0, 1, 0});
    expect_all(image(3.001, 100), {0, 0, 1});
    expect_all(image(3.001, 5.999), Color(0.25f));
    expect_all(image(0.1, 0.999), Color(0.25f));
  }
}

// By default the planes are at 0.01 and 10000.
TEST(MitsubaSensor, ClipPlanesHaveMitsubasDefaults) {
  const auto image = [&](const std::string& shapes) {
    return image_of(sensor("perspective", "") + shapes + sky);
  };
  expect_all(image(wall(0.0099, "1 0 0") + wall(2, "0 1 0")), {0, 1, 0});
  expect_all(image(wall(0.0101, "1 0 0") + wall(2, "0 1 0")), {1, 0, 0});
  expect_all(image(wall(10001, "1 0 0", 2e4)), Color(0.25f));
  expect_all(image(wall(9999, "1 0 0", 2e4)), {1, 0, 0});
}

TEST(MitsubaSensor, NearPlaneInsideASphereShowsItsFarSide) {
  const std::string glow = ball(5, 2, "1 2 3") + sky;
  expect_all(image_of(clipped("perspective", 1, 100, number("fov", 5)) + glow), {1, 2, 3});
  expect_all(image_of(clipped("perspective", 5, 100, number("fov", 5)) + glow), Color(0.0f));
  expect_all(image_of(clipped("perspective", 5, 6, number("fov", 5)) + glow), Color(0.25f));
  expect_all(image_of(clipped("perspective", 8, 100, number("fov", 5)) + glow), Color(0.25f));
}

TEST(MitsubaSensor, AFarPlaneBehindAllCostsNothing) {
  const auto camera = [](double near, double far, const std::string& shapes) {
    SceneData scene =
        load_silently(clipped("perspective", near, far, number("fov", 40)) + shapes + sky);
    drop_idle_far_plane(scene);
    return scene.camera;
  };
  EXPECT_FALSE(is_limited(camera(0.9, 1.1, wall(1, "1"))));
  EXPECT_EQ(camera(0.1, 0.99, wall(1, "1")).far_clip, 0.99f);
  EXPECT_FALSE(is_limited(camera(1.01, 5, wall(-1, "1"))));
  EXPECT_FALSE(is_limited(camera(3, 9, ball(5, 2.1, "1"))));
  EXPECT_TRUE(is_limited(camera(3, 7, ball(5, 2.1, "1"))));
}

TEST(MitsubaSensor, ClipPlanesMustBeInOrder) {
  for (const auto& [near, far] : {std::pair(0.0, 1.0), {2.0, 2.0}, {3.0, 1.0}}) {
    EXPECT_THROW(load_xml(clipped("perspective", near, far) + three_walls), Error);
  }
}

const std::string hide =
    "<integrator type='path'><boolean name='hide_emitters' value='true'/></integrator>";

/// A grey wall behind lamps, lit by them alone.
std::string lit_wall(const std::string& integrator) {
  return integrator + sensor("perspective", number("fov", 20)) +
         "<shape type='rectangle'><transform name='to_world'><scale value='50'/><rotate y='1' "
         "angle='180'/><translate z='9'/></transform></shape>" +
         "<shape type='rectangle'><transform name='to_world'><translate z='5'/></transform>" +
         black + "<emitter type='area'><rgb name='radiance' value='9'/></emitter></shape>" +
         ball(3, 0.5, "4 5 6");
}

TEST(MitsubaSensor, HiddenEmittersLightAndAreNotSeen) {
  expect_all(image_of(hide + sensor("perspective", "") + three_walls), Color(0.0f));
  expect_all(image_of(hide + sensor("perspective", "") + ball(5, 2, "1") + sky), Color(0.0f));
  const Image image = image_of(lit_wall(hide), 2);
  for (int c = 0; c < 3; ++c) {
    float sum =
        0;  // of the wall, through both lamps; a sample of the ball is in the other's shadow
    for (int i = 0; i < 256; ++i) sum += image.pixel(i % 16, i / 16)[c];
    EXPECT_GT(sum / 256, 0.05f);
    EXPECT_LT(sum / 256, 1.5f);
  }
}

TEST(MitsubaSensor, ModesAreEqual) {
  const std::string room =
      wall(9, "0.2 0.3 0.1") + ball(3, 0.5, "4 5 6") +
      "<shape type='sphere'><point name='center' x='0.4' y='0.3' z='4'/></shape>"
      "<shape type='cube'><transform name='to_world'><scale value='0.6'/><rotate x='1' y='2' "
      "angle='40'/><translate x='-0.8' y='0.2' z='4'/></transform></shape>" +
      sky;
  const std::string views[] = {
      clipped("perspective", 3.2, 8.5, number("fov", 50)) + room,
      clipped("thinlens", 3.2, 4.1,
              number("fov", 50) + number("aperture_radius", 0.2) + number("focus_distance", 4)) +
          room,
      clipped("orthographic", 3.3, 20, "") + room,
      hide + clipped("perspective", 0.1, 4.2, number("fov", 50)) + room,
      lit_wall(hide),
      sensor("perspective", number("principal_point_offset_x", 0.1)) + room,
  };
  for (const std::string& view : views) expect_modes_are_equal(view);
}

// --- Defaults and axes

TEST(MitsubaSensor, LookatStraightDownNeedsNoUp) {
  const auto look = [](const char* up) {
    return camera_of("perspective", fmt::format("<transform name='to_world'><lookat origin='0,5,0' "
                                                "target='0,0,0'{}/></transform>",
                                                up));
  };
  const Camera free = look(""), down = look(" up='1,0,0'");
  for (const float x : {0.0f, 33.0f}) {
    expect_near(camera_ray(free, x, 4, 0, 0).direction, camera_ray(down, x, 4, 0, 0).direction);
  }
}

TEST(MitsubaSensor, FiltersAreMitsubas) {
  const auto filter = [](const std::string& inside) {
    return load_silently(sensor("perspective", "<film type='hdrfilm'>" + inside + "</film>") +
                         wall(5, "1"))
        .defaults.filter.value();
  };
  EXPECT_EQ(filter("").kind, FilterKind::gaussian);
  EXPECT_EQ(filter("").a, 0.5f);
  EXPECT_EQ(load_silently(sensor("perspective", "") + wall(5, "1")).defaults.filter->kind,
            FilterKind::gaussian);
  EXPECT_EQ(filter("<rfilter type='gaussian'>" + number("stddev", 0.7) + "</rfilter>").a, 0.7f);
}

TEST(MitsubaSensor, CropHasTwoOffsets) {
  const SceneData scene = load_silently(
      sensor("perspective",
             "<film type='hdrfilm'><integer name='width' value='64'/><integer name='height' "
             "value='48'/><integer name='crop_offset_x' value='5'/><integer name='crop_offset_y' "
             "value='11'/><integer name='crop_width' value='20'/><integer name='crop_height' "
             "value='30'/></film>") +
      wall(5, "1"));
  const CropWindow crop = scene.defaults.crop.value();
  EXPECT_TRUE(crop == (CropWindow{5, 11, 25, 41}));
}

TEST(MitsubaTransform, AxesMayHaveAnyLength) {
  const auto corner = [](const char* axis) {
    return load_silently(sensor("perspective", "") + sky +
                         fmt::format("<shape type='rectangle'><transform name='to_world'><rotate "
                                     "{} angle='50'/></transform></shape>",
                                     axis))
        .quads.at(0)
        .corner;
  };
  expect_near(corner("x='3' z='4'"), corner("x='0.6' z='0.8'"));
  const float c = std::cos(50.0f * pi / 180.0f), s = std::sin(50.0f * pi / 180.0f);
  expect_near(corner("x='2'"), {-1, -c, -s});
}

// The picture is mirrored with the world: what was seen towards d is seen towards d, mirrored.
TEST(MitsubaEnvironment, MirrorsWithItsMap) {
  const TempFolder folder;
  std::string pixels;
  for (int i = 0; i < 32; ++i) {
    pixels += {static_cast<char>(8 * i), static_cast<char>(255 - 7 * i), static_cast<char>(3 * i)};
  }
  write_text(folder.file("sky.ppm"), "P6\n8 4\n255\n" + pixels);
  const auto map = [&](const char* steps) {
    const std::string path = folder.file("scene.xml");
    write_text(path, fmt::format("<scene version='3.0.0'><emitter type='envmap'><string "
                                 "name='filename' value='sky.ppm'/><transform name='to_world'>{}"
                                 "<rotate y='1' angle='35'/></transform></emitter>{}</scene>",
                                 steps, wall(5, "1")));
    const EnvironmentData data = load_with_warnings(path).scene.environment;
    return make_environment(data.width, data.height, data.pixels, data.to_world);
  };
  const EnvironmentMap plain = map(""), mirrored = map("<scale x='-1'/>");
  const Affine turn = rotate({0, 1, 0}, 35.0f), back = rotate({0, 1, 0}, -35.0f);
  for (const Vec3& d :
       {Vec3(0.5f, 0.2f, 0.8f), Vec3(-0.9f, -0.3f, 0.1f), Vec3(0.1f, 0.7f, -0.6f)}) {
    const Vec3 own = back.vector(glm::normalize(d));
    const Vec3 other = turn.vector({-own.x, own.y, own.z});
    expect_near(environment_radiance(mirrored.view(), glm::normalize(d)),
                environment_radiance(plain.view(), other), 1e-3f);
  }
}

TEST(MitsubaEnvironment, SunsScaleIsItsRadiances) {
  const auto sun = [](const std::string& type, const std::string& inside) {
    return load_silently(sensor("perspective", "") + wall(5, "1") +
                         fmt::format("<emitter type='{}'>{}</emitter>", type, inside))
        .sun.radiance;
  };
  for (const char* type : {"sun", "sunsky"}) {
    const Color one = sun(type, ""), three = sun(type, number("scale", 3)),
                six = sun(type, number("scale", 3) + number("sun_scale", 2));
    EXPECT_GT(one.x, 0.0f);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(three[c], 3 * one[c], 1e-5f * three[c]);
      EXPECT_NEAR(six[c], 6 * one[c], 1e-5f * six[c]);
    }
  }
}

}  // namespace
}  // namespace pt
