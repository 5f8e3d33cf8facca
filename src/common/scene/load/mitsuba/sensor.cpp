// <sensor>, with its film and sampler, and <integrator>: camera and defaults of a scene.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/scene/load/files/importer.h"
#include "common/scene/load/mitsuba/scene_parts.h"
#include "common/scene/load/mitsuba/xml/elements.h"
#include "common/scene/prepare/prepare_filter.h"

namespace pt::mitsuba {
namespace {

// <film> and <sampler>: the defaults of the image.

constexpr int max_image_side = 65535;

int image_side(const Object& film, std::string_view name, int fallback) {
  const int side = film.integer(name).value_or(fallback);
  if (side < 1 || side > max_image_side) {
    fail(film.element(), "{} of the film is {}; expected 1 to {} pixels", name, side,
         max_image_side);
  }
  return side;
}

/// The crop window, in pixels of the film.
void read_crop(Context& context, const Object& film) {
  SceneDefaults& defaults = context.scene.defaults;
  const CropWindow whole{0, 0, *defaults.width, *defaults.height};
  CropWindow crop;
  crop.x0 = film.integer("crop_offset_x").value_or(0);
  crop.y0 = film.integer("crop_offset_y").value_or(0);
  const int width = film.integer("crop_width").value_or(whole.x1);
  const int height = film.integer("crop_height").value_or(whole.y1);
  if (crop.x0 < 0 || crop.y0 < 0 || width < 1 || height < 1 || width > whole.x1 - crop.x0 ||
      height > whole.y1 - crop.y0) {
    fail(film.element(), "a crop of {}x{} pixels at {},{}; expected a part of the film of {}x{}",
         width, height, crop.x0, crop.y0, whole.x1, whole.y1);
  }
  crop.x1 = crop.x0 + width, crop.y1 = crop.y0 + height;
  if (!(crop == whole)) defaults.crop = crop;
}

/// Names as in Mitsuba; its `catmullrom` is a Mitchell filter.
void read_filter(Context& context, const Object& filter) {
  const std::string type = filter.type();
  FilterChoice choice;
  if (type == "box") {
    choice.a = filter.number("radius", choice.a);
  } else if (type == "tent") {
    choice = default_filter(FilterKind::tent);
    choice.a = filter.number("radius", choice.a);
  } else if (type == "gaussian") {
    choice = default_filter(FilterKind::gaussian);
    choice.a = filter.number("stddev", choice.a);
  } else if (type == "mitchell") {
    choice = default_filter(FilterKind::mitchell);
    choice.a = filter.number("b", choice.a);  // B and C in the file: names are in snake_case here
    choice.b = filter.number("c", choice.b);
  } else if (type == "catmullrom") {
    choice = {FilterKind::mitchell, 0.0f, 0.5f};
  } else if (type == "lanczos") {
    choice = default_filter(FilterKind::lanczos);
    choice.a = static_cast<float>(filter.integer("lobes").value_or(3));
  } else {
    context.warn_once("rfilter", filter.element(),
                      "reconstruction filter '{}' is not supported: box is used", type);
  }
  if (choice.kind != FilterKind::mitchell && !(choice.a > 0.0f)) {
    context.warn_once("filter size", filter.element(),
                      "filter '{}' of size {}; expected one above 0: its default is used", type,
                      choice.a);
    choice = default_filter(choice.kind);
  }
  context.scene.defaults.filter = choice;
}

void read_film(Context& context, const Object& film) {
  context.scene.defaults.width = image_side(film, "width", 768);
  context.scene.defaults.height = image_side(film, "height", 576);
  read_crop(context, film);
  // About the file that Mitsuba would write.
  film.ignore({"file_format", "pixel_format", "component_format", "gamma", "banner", "exposure",
               "tonemap_method", "high_quality_edges", "attach_log", "compensate", "sample_border",
               "variable", "digits", "key", "burn"});
  if (const Object* filter = film.child("rfilter")) read_filter(context, *filter);
}

void read_sampler(Context& context, const Object& sampler) {
  const std::optional<int> count = sampler.integer("sample_count");
  sampler.ignore({"seed", "scramble", "jitter", "dimension"});
  if (!count) return;
  if (*count < 1) {
    return context.warn_once("sample_count", sampler.element(),
                             "sample_count {}; expected 1 or more: it is ignored", *count);
  }
  context.scene.defaults.spp = count;
}

FovAxis fov_axis_of(const Object& sensor) {
  static const std::map<std::string_view, FovAxis> axes = {{"x", FovAxis::horizontal},
                                                           {"y", FovAxis::vertical},
                                                           {"diagonal", FovAxis::diagonal},
                                                           {"smaller", FovAxis::smaller},
                                                           {"larger", FovAxis::larger}};
  const std::string name = sensor.text("fov_axis", "x");
  const auto axis = axes.find(name);
  if (axis != axes.end()) return axis->second;
  fail(*sensor.find("fov_axis"), "fov_axis '{}'; expected x, y, diagonal, smaller or larger", name);
}

/// Millimetres, of film 36 mm x 24 mm: "50mm".
double focal_length_mm(const Object& sensor) {
  const std::string given = sensor.text("focal_length", "50mm");
  std::string text = given;
  if (text.size() > 2 && text.ends_with("mm")) text.resize(text.size() - 2);
  const std::optional<double> length = parse_number(text);
  if (!length || !(*length > 0)) {
    fail(sensor.element(), "focal_length '{}'; expected a length above 0, such as 50mm", given);
  }
  return *length;
}

/// Mitsuba's camera looks along its z, with y up and x to the left of the image.
void place_camera(Context& context, const Object& sensor, bool may_scale) {
  const Affine map = sensor.transform("to_world");
  const Vec3 left = map.vector({1, 0, 0}), up = map.vector({0, 1, 0});
  const Vec3 forward = map.vector({0, 0, 1});
  CameraParameters& camera = context.scene.camera;
  look_along_z(map, camera);
  camera.mirrored = map.determinant() < 0.0f;
  if (const Element* const transform = sensor.find_transform("to_world")) {
    if (const auto look = read_look_at(*transform)) take_written_view(*look, camera);
  }
  const float size = glm::length(forward);
  const auto differs = [&](float a, float b) { return std::abs(a - b) > 1e-3f * size; };
  const bool scales =
      differs(size, 1.0f) || differs(glm::length(left), size) || differs(glm::length(up), size);
  const auto leans = [&](const Vec3& a, const Vec3& b) {
    return std::abs(glm::dot(a, b)) > 1e-3f * glm::length(a) * glm::length(b);
  };
  if ((scales && !may_scale) || leans(left, forward) || leans(up, forward) || leans(left, up)) {
    context.warn_once(
        "camera scale", sensor.element(),
        "to_world of the sensor scales or shears: its view and up direction are used without that");
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
    fail(sensor.element(), "near_clip {}, far_clip {}; expected 0 < near_clip < far_clip", near,
         far);
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
    context.warn_once("focus", sensor.element(),
                      "focus_distance {}; expected one above 0: a pinhole is used", focus);
  }
}

}  // namespace

void read_fov(const Object& sensor, CameraParameters& camera) {
  camera.fov_axis = fov_axis_of(sensor);
  if (const std::optional<double> fov = sensor.number("fov")) {
    if (!(*fov > 0 && *fov < 180)) {
      fail(*sensor.find("fov"), "fov {}; expected degrees between 0 and 180, both excluded", *fov);
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
                      "sensor '{}' is not supported: perspective is used", type);
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

namespace {

// <integrator>: how long paths are.

// For -1, a path of any length. Without Russian roulette a path must end somewhere: what is left
// after 64 rays is less than a part in 1000 unless surfaces reflect more than 90 %.
constexpr int unlimited_depth = 64;
constexpr int max_depth_limit = 65535;

/// Ways to compute the light of all paths, which is what we compute: how is not the scene's affair.
const std::set<std::string_view> light_transport = {
    "bdpt",   "erpt",      "mlt",       "path",    "photonmapper",   "ppm",
    "pssmlt", "ptracer",   "sppm",      "volpath", "volpath_simple", "volpathmis",
    "prb",    "prb_basic", "prbvolpath"};

/// Ways to run the integrator inside of one.
const std::set<std::string_view> ways_to_run = {"adaptive", "irrcache"};

}  // namespace

std::vector<std::string> integrator_types() {
  std::vector<std::string> types = {"direct"};
  types.insert(types.end(), light_transport.begin(), light_transport.end());
  types.insert(types.end(), ways_to_run.begin(), ways_to_run.end());
  return types;
}

namespace {

void read_max_depth(Context& context, const Object& integrator, int depth) {
  if (depth < -1) {
    fail(integrator.element(), "max_depth {}; expected -1 (any) or more", depth);
  }
  if (depth == 0 || depth > max_depth_limit) {
    const int used = depth == 0 ? 1 : max_depth_limit;
    context.warn_once("max_depth", integrator.element(), "max_depth {}: {} is used", depth, used);
    depth = used;
  }
  // Mitsuba counts the edges of a path, the last one to the emitter included; ours counts its rays,
  // the camera's included. That is the same.
  context.scene.defaults.max_depth = depth == -1 ? unlimited_depth : depth;
}

/// In its integrators for media thin glass lets shadow rays through, and what passes it costs no
/// depth.
void let_panes_pass(SceneData& scene) {
  for (MaterialDescription& m : scene.materials) {
    const bool is_pane = m.node == MaterialNode::none && m.kind == kind_of<ThinDielectric>;
    if (is_pane && is_black(m.emission.radiance)) m.passes = true;
  }
}

void read_around(Context& context, const Object& integrator, const Object& nested) {
  if (!ways_to_run.contains(integrator.type())) {
    context.warn_once("integrator " + integrator.type(), integrator.element(),
                      "integrator '{}' is not supported: the one inside is used",
                      integrator.type());
  }
  integrator.ignore_all();
  read_integrator(context, nested);
}

}  // namespace

void read_integrator(Context& context, const Object& integrator) {
  const std::string type = integrator.type();
  if (const Object* nested = integrator.child("integrator")) {
    return read_around(context, integrator, *nested);
  }
  const bool direct = type == "direct";
  if (!direct && !light_transport.contains(type)) {
    context.warn_once("integrator " + type, integrator.element(),
                      "integrator '{}' is not supported: the scene is rendered by path tracing",
                      type);
  }
  context.scene.camera.hides_emitters = integrator.boolean("hide_emitters", false);
  read_max_depth(context, integrator, integrator.integer("max_depth").value_or(-1));
  if (direct) context.scene.defaults.max_depth = 2;
  context.scene.defaults.rr_depth = integrator.integer("rr_depth");
  if (type.find("volpath") != std::string::npos) let_panes_pass(context.scene);
  // The rest is about the method.
  if (!direct && type != "path" && type != "volpath") return integrator.ignore_all();
  integrator.ignore({"strict_normals", "emitter_samples", "bsdf_samples", "shading_samples",
                     "samples_per_pass", "block_size", "timeout"});
}

}  // namespace pt::mitsuba
