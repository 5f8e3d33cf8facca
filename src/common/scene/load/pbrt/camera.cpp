// Cameras.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/scene/load/pbrt/view.h"

namespace pt::pbrt {
namespace {

/// What the image shows, on a plane across the axis: x to the right, y up.
struct ScreenWindow {
  float x0, x1, y0, y1;
  bool given = false;
};

ScreenWindow read_window(Context& context, const Parameters& parameters) {
  const SceneDefaults& defaults = context.scene.defaults;
  const float aspect = static_cast<float>(*defaults.width) / static_cast<float>(*defaults.height);
  const float frame = parameters.number("frameaspectratio", aspect);
  if (!(frame > 0.0f)) fail(parameters.place(), "frameaspectratio: expected a number above 0");
  ScreenWindow window{-std::max(frame, 1.0f), std::max(frame, 1.0f), -std::max(1.0f / frame, 1.0f),
                      std::max(1.0f / frame, 1.0f), frame != aspect};
  const std::vector<float> v = parameters.numbers("screenwindow");
  if (!v.empty()) {
    if (v.size() != 4 || !(v[1] > v[0]) || !(v[3] > v[2])) {
      fail(parameters.place(), "screenwindow: expected four numbers, x0 < x1 and y0 < y1");
    }
    window = {v[0], v[1], v[2], v[3], true};
  }
  const float shape = (window.x1 - window.x0) / (window.y1 - window.y0);
  if (std::abs(shape - aspect) > 1e-3f * aspect) {
    context.reporter.warn_once("pixel aspect", parameters.place(),
                               "screenwindow or frameaspectratio and the film's resolution make "
                               "pixels that are no squares: squares are used, as high as they are");
  }
  return window;
}

/// pbrt's camera looks along its z, with y up and x to the right: a space that is left-handed,
/// where ours has x to the left of such an axis.
void place_camera(Context& context, const Entity& entity) {
  const Affine map = inverse(entity.to_world);
  CameraParameters& camera = context.scene.camera;
  camera.look_from = map.translation();
  const Vec3 forward = map.vector({0, 0, 1});
  // Far enough that rounding does not turn the view.
  const float distance = std::max(1.0f, max_abs(camera.look_from));
  camera.look_at = camera.look_from + distance * glm::normalize(forward);
  camera.up = map.vector({0, 1, 0});
  camera.mirrored = map.determinant() > 0.0f;
}

void read_perspective(Context& context, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  const ScreenWindow window = read_window(context, parameters);
  const float fov = parameters.number("fov", 90.0f);
  if (!(fov > 0.0f && fov < 180.0f)) {
    fail(parameters.place(), fmt::format("fov {}; expected degrees between 0 and 180", fov));
  }
  CameraParameters& camera = context.scene.camera;
  camera.fov_degrees = fov;
  camera.fov_axis = FovAxis::smaller;
  if (window.given) {
    const float height = window.y1 - window.y0, width = window.x1 - window.x0;
    const double tangent = std::tan(0.5 * double{fov} * double{pi} / 180) * 0.5 * double{height};
    camera.fov_axis = FovAxis::vertical;
    camera.fov_degrees = static_cast<float>(2 * std::atan(tangent) * 180 / double{pi});
    camera.principal_point = {0.5f * (window.x0 + window.x1) / width,
                              -0.5f * (window.y0 + window.y1) / height};
  }
  camera.aperture = 2.0f * parameters.number("lensradius", 0.0f);
  camera.focus_distance = parameters.number("focaldistance", 1e6f);
  if (!(camera.aperture >= 0.0f && camera.focus_distance > 0.0f)) {
    fail(parameters.place(), "expected a lensradius not below 0 and a focaldistance above 0");
  }
  if (camera.aperture == 0.0f) camera.focus_distance = 1.0f;  // of no effect
}

void read_orthographic(Context& context, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  const ScreenWindow window = read_window(context, parameters);
  const Affine map = inverse(entity.to_world);
  const Vec3 right = map.vector({1, 0, 0}), up = map.vector({0, 1, 0});
  const SceneDefaults& defaults = context.scene.defaults;
  const float aspect = static_cast<float>(*defaults.width) / static_cast<float>(*defaults.height);
  CameraParameters& camera = context.scene.camera;
  camera.orthographic = true;
  camera.orthographic_size = {0.5f * (window.x1 - window.x0) * glm::length(right),
                              0.5f * (window.y1 - window.y0) * aspect * glm::length(up)};
  const Vec3 shift = 0.5f * (window.x0 + window.x1) * right + 0.5f * (window.y0 + window.y1) * up;
  camera.look_from += shift, camera.look_at += shift;
  if (parameters.number("lensradius", 0.0f) > 0.0f) {
    context.reporter.warn_once("orthographic lens", parameters.place(),
                               "the lens of an orthographic camera is not supported: all is sharp");
  }
  parameters.ignore({"focaldistance"});
}

}  // namespace

void read_camera(Context& context, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  context.scene.camera = {};
  place_camera(context, entity);
  if (entity.type == "orthographic") {
    read_orthographic(context, entity);
  } else {
    if (entity.type != "perspective") {
      context.reporter.warn_once("camera " + entity.type, parameters.place(),
                                 fmt::format("camera '{}' is not supported: perspective is used; "
                                             "expected perspective or orthographic",
                                             entity.type));
      parameters.ignore({"lensfile", "aperturediameter", "focusdistance", "mapping", "aperture"});
    }
    read_perspective(context, entity);
  }
  const float exposure =
      parameters.number("shutterclose", 1.0f) - parameters.number("shutteropen", 0.0f);
  if (!(exposure > 0.0f)) fail(parameters.place(), "expected shutterclose after shutteropen");
  if (!context.description.is_earlier) context.imaging_ratio *= exposure;
  parameters.report_unused(context.reporter);
}

}  // namespace pt::pbrt
