#include "common/scene/load/mitsuba/sensor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/scene/load/mitsuba/media/media.h"
#include "common/scene/load/mitsuba/xml/values.h"
#include "common/scene/prepare/prepare_filter.h"

namespace pt::mitsuba {
namespace {

FovAxis fov_axis_of(const Object& sensor) {
  static const std::map<std::string_view, FovAxis> axes = {{"x", FovAxis::horizontal},
                                                           {"y", FovAxis::vertical},
                                                           {"diagonal", FovAxis::diagonal},
                                                           {"smaller", FovAxis::smaller},
                                                           {"larger", FovAxis::larger}};
  const std::string name = sensor.text("fov_axis", "x");
  const auto axis = axes.find(name);
  if (axis != axes.end()) return axis->second;
  fail(*sensor.find("fov_axis"),
       fmt::format("fov_axis '{}'; expected x, y, diagonal, smaller or larger", name));
}

/// Millimetres, of film 36 mm x 24 mm: "50mm".
double focal_length_mm(const Object& sensor) {
  const std::string given = sensor.text("focal_length", "50mm");
  std::string text = given;
  if (text.size() > 2 && text.ends_with("mm")) text.resize(text.size() - 2);
  const std::optional<double> length = parse_number(text);
  if (!length || !(*length > 0)) {
    fail(sensor.element(),
         fmt::format("focal_length '{}'; expected a length above 0, such as 50mm", given));
  }
  return *length;
}

/// Mitsuba's camera looks along its z, with y up and x to the left of the image.
void place_camera(Context& context, const Object& sensor, bool may_scale) {
  const Affine map = sensor.transform("to_world");
  const Vec3 left = map.vector({1, 0, 0}), up = map.vector({0, 1, 0});
  const Vec3 forward = map.vector({0, 0, 1});
  CameraParameters& camera = context.scene.camera;
  camera.look_from = map.translation();
  // Far enough that rounding does not turn the view.
  const float distance = std::max(1.0f, max_abs(camera.look_from));
  camera.look_at = camera.look_from + distance * glm::normalize(forward);
  camera.up = up;
  camera.mirrored = map.determinant() < 0.0f;
  const float size = glm::length(forward);
  const auto differs = [&](float a, float b) { return std::abs(a - b) > 1e-3f * size; };
  const bool scales =
      differs(size, 1.0f) || differs(glm::length(left), size) || differs(glm::length(up), size);
  const auto leans = [&](const Vec3& a, const Vec3& b) {
    return std::abs(glm::dot(a, b)) > 1e-3f * glm::length(a) * glm::length(b);
  };
  if ((scales && !may_scale) || leans(left, forward) || leans(up, forward) || leans(left, up)) {
    context.warn_once("camera scale", sensor.element(),
                      "to_world of the sensor scales or shears: its view and up direction are "
                      "used without that");
  }
}

/// What Mitsuba's [-1, 1]^2 of the sensor's plane measures.
void read_orthographic(Context& context, const Object& sensor) {
  const Affine map = sensor.transform("to_world");
  CameraParameters& camera = context.scene.camera;
  camera.orthographic = true;
  camera.orthographic_size = {glm::length(map.vector({1, 0, 0})),
                              glm::length(map.vector({0, 1, 0}))};
}

/// Distances from the pinhole, the lens or the sensor, along the axis. Rays of Mitsuba's
/// orthographic sensor begin at the near plane as to_world scales it and are far - near long.
void read_clips(const Object& sensor, CameraParameters& camera) {
  const float near = sensor.number("near_clip", 1e-2f), far = sensor.number("far_clip", 1e4f);
  if (!(near > 0.0f) || !(far > near)) {
    fail(sensor.element(),
         fmt::format("near_clip {}, far_clip {}; expected 0 < near_clip < far_clip", near, far));
  }
  const float scale =
      camera.orthographic ? glm::length(sensor.transform("to_world").vector({0, 0, 1})) : 1.0f;
  camera.near_clip = scale * near;
  camera.far_clip = camera.near_clip + (far - near);
}

void read_lens(Context& context, const Object& sensor, CameraParameters& camera) {
  camera.aperture = 2.0f * std::abs(sensor.number("aperture_radius", 0.0f));
  const float focus = sensor.number("focus_distance", camera.focus_distance);
  if (focus > 0.0f) {
    camera.focus_distance = focus;
  } else if (camera.aperture > 0.0f) {
    camera.aperture = 0.0f;
    context.warn_once(
        "focus", sensor.element(),
        fmt::format("focus_distance {}; expected one above 0: a pinhole is used", focus));
  }
}

}  // namespace

void read_fov(const Object& sensor, CameraParameters& camera) {
  camera.fov_axis = fov_axis_of(sensor);
  if (const std::optional<double> fov = sensor.number("fov")) {
    if (!(*fov > 0 && *fov < 180)) {
      fail(*sensor.find("fov"),
           fmt::format("fov {}; expected degrees between 0 and 180, both excluded", *fov));
    }
    camera.fov_degrees = static_cast<float>(*fov);
    return;
  }
  const double tangent = 0.5 * std::hypot(36.0, 24.0) / focal_length_mm(sensor);
  camera.fov_degrees = static_cast<float>(2.0 * std::atan(tangent) * 180.0 / std::acos(-1.0));
  camera.fov_axis = FovAxis::diagonal;
}

void read_sensor(Context& context, const Object& sensor) {
  const std::string type = sensor.type();
  SceneDefaults& defaults = context.scene.defaults;
  defaults.width = 768;
  defaults.height = 576;
  defaults.filter = default_filter(FilterKind::gaussian);
  if (const Object* film = sensor.child("film")) read_film(context, *film);
  if (const Object* sampler = sensor.child("sampler")) read_sampler(context, *sampler);
  const bool orthographic = type == "orthographic";
  if (type != "perspective" && type != "thinlens" && !orthographic) {
    context.warn_once("sensor " + type, sensor.element(),
                      fmt::format("sensor '{}' is not supported: perspective is used", type));
  }
  CameraParameters& camera = context.scene.camera;
  camera = {};
  place_camera(context, sensor, orthographic);
  if (orthographic) {
    read_orthographic(context, sensor);
  } else {
    read_fov(sensor, camera);
    camera.principal_point = {sensor.number("principal_point_offset_x", 0.0f),
                              sensor.number("principal_point_offset_y", 0.0f)};
  }
  read_clips(sensor, camera);
  sensor.ignore({"shutter_open", "shutter_close"});
  if (const Object* medium = sensor.child("medium")) {
    context.scene.camera_medium = read_medium(context, *medium).value_or(no_medium);
  }
  if (type == "thinlens") {
    read_lens(context, sensor, camera);
  } else {
    sensor.ignore({"focus_distance"});
  }
}

}  // namespace pt::mitsuba
