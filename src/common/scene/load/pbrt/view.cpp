// Camera, film, filter, sampler and integrator.
#include <algorithm>
#include <cmath>
#include <set>

#include "common/scene/load/files/importer.h"
#include "common/scene/load/pbrt/scene_parts.h"
#include "common/scene/prepare/prepare_filter.h"

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
  look_along_z(map, camera);
  camera.mirrored = map.determinant() > 0.0f;
  if (const auto& look = context.description.camera_look_at) take_written_view(*look, camera);
  if (entity.end_to_world) {
    const Description& d = context.description;
    const Affine left = scale({camera.mirrored ? 1.0f : -1.0f, 1, 1});
    context.scene.motion.camera = {{d.begin_s, map * left},
                                   {d.end_s, inverse(*entity.end_to_world) * left}};
  }
}

void read_perspective(Context& context, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  const ScreenWindow window = read_window(context, parameters);
  const float fov = parameters.number("fov", 90.0f);
  if (!(fov > 0.0f && fov < 180.0f)) {
    fail(parameters.place(), "fov {}; expected degrees between 0 and 180", fov);
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

/// The camera, into the scene; its shutter's time, which exposes the film.
void read_camera(Context& context, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  context.scene.camera = {};
  context.scene.motion.camera.clear();
  place_camera(context, entity);
  if (entity.type == "orthographic") {
    read_orthographic(context, entity);
  } else {
    if (entity.type != "perspective") {
      context.reporter.warn_once(
          "camera " + entity.type, parameters.place(),
          "camera '{}' is not supported: perspective is used; expected perspective or orthographic",
          entity.type);
      parameters.ignore({"lensfile", "aperturediameter", "focusdistance", "mapping", "aperture"});
    }
    read_perspective(context, entity);
  }
  Shutter& shutter = context.scene.motion.shutter;
  shutter = {parameters.number("shutteropen", 0.0f), parameters.number("shutterclose", 1.0f)};
  const float exposure = shutter.close - shutter.open;
  if (!(exposure > 0.0f)) fail(parameters.place(), "expected shutterclose after shutteropen");
  if (!context.description.is_earlier) context.imaging_ratio *= exposure;
  parameters.report_unused(context.reporter);
}

// Filter, sampler and integrator.

constexpr int most_rays = 65535;

/// Ways to compute the light of all paths, which is what we compute: how is not the scene's affair.
const std::set<std::string_view> light_transport = {"bdpt",          "lightpath",  "mlt",
                                                    "path",          "randomwalk", "simplepath",
                                                    "simplevolpath", "sppm",       "volpath"};

/// Ours have the radius that their other parameters give them.
void read_filter(Context& context, const Entity& filter) {
  const Parameters& p = filter.parameters;
  const std::map<std::string_view, FilterKind> kinds = {{"box", FilterKind::box},
                                                        {"triangle", FilterKind::tent},
                                                        {"gaussian", FilterKind::gaussian},
                                                        {"mitchell", FilterKind::mitchell},
                                                        {"sinc", FilterKind::lanczos}};
  const auto kind = kinds.find(filter.type);
  if (kind == kinds.end()) {
    p.ignore_all();
    return context.reporter.warn_once(
        "filter " + filter.type, p.place(),
        "filter '{}' is not known: box is used; expected box, triangle, gaussian, mitchell or sinc",
        filter.type);
  }
  FilterChoice choice = default_filter(kind->second);
  // pbrt-v3 calls them widths.
  const auto along = [&](const char* name, const char* earlier, float fallback) {
    return p.number(name, p.number(earlier, fallback));
  };
  const auto x_radius = [&](float fallback) { return along("xradius", "xwidth", fallback); };
  float radius = 2.0f;
  switch (choice.kind) {
    case FilterKind::box:
      choice.a = radius = x_radius(0.5f);
      break;
    case FilterKind::tent:
      choice.a = radius = x_radius(2.0f);
      break;
    case FilterKind::gaussian:
      // pbrt-v3's alpha is that of exp(-alpha x^2), 2 by default, which is the same.
      choice.a = p.number("sigma", std::sqrt(0.5f / p.number("alpha", 2.0f)));
      radius = x_radius(1.5f);
      break;
    case FilterKind::mitchell:
      choice.a = p.number("B", 1.0f / 3.0f), choice.b = p.number("C", 1.0f / 3.0f);
      radius = x_radius(2.0f);
      break;
    case FilterKind::lanczos:
      choice.a = p.number("tau", 3.0f);
      radius = x_radius(4.0f);
      break;
  }
  if (!(radius > 0.0f) || (choice.kind != FilterKind::mitchell && !(choice.a > 0.0f))) {
    fail(p.place(), "{}: expected sizes above 0", p.what());
  }
  const bool other_shape = choice.kind == FilterKind::mitchell && radius != 2.0f;
  const bool differs = along("yradius", "ywidth", radius) != radius;
  if (other_shape || differs) {
    context.reporter.warn_once("filter radius", p.place(),
                               "{}: a radius of our own is used, the same along x and y", p.what());
  }
  context.scene.defaults.filter = choice;
  p.report_unused(context.reporter);
}

void read_sampler(Context& context, const Entity& sampler) {
  const Parameters& p = sampler.parameters;
  int count = p.integer("pixelsamples", 16);
  if (sampler.type == "stratified") {
    const std::int64_t product = std::int64_t{p.integer("xsamples", 4)} * p.integer("ysamples", 4);
    count = static_cast<int>(std::clamp<std::int64_t>(product, -1, 1 << 30));
  }
  p.ignore({"seed", "randomization", "jitter", "dimensions"});
  if (count < 1) fail(p.place(), "{} samples a pixel; expected 1 or more", count);
  context.scene.defaults.spp = count;
  p.report_unused(context.reporter);
}

/// pbrt counts where paths are scattered; we count rays, the camera's included.
void read_integrator(Context& context, const Entity& integrator) {
  const Parameters& p = integrator.parameters;
  if (!light_transport.contains(integrator.type) && integrator.type != "directlighting") {
    context.reporter.warn_once(
        "integrator " + integrator.type, p.place(),
        "integrator '{}' is not supported: the scene is rendered by path tracing", integrator.type);
  }
  // pbrt-v3's is path tracing of one bounce.
  const int depth = integrator.type == "directlighting" ? 1 : p.integer("maxdepth", 5);
  if (depth < 0) fail(p.place(), "maxdepth {}; expected 0 or more", depth);
  context.scene.defaults.max_depth = std::min(depth, most_rays - 1) + 1;
  p.ignore_all();  // the rest is about the method
}

// The film, and all of the view.

constexpr int most_pixels = 65535;  // a side

int read_side(const Parameters& parameters, const char* name, int fallback) {
  const int side = parameters.integer(name, fallback);
  if (side >= 1 && side <= most_pixels) return side;
  fail(parameters.place(), "{} {}; expected 1 to {} pixels", name, side, most_pixels);
}

/// Both windows are x0 x1 y0 y1, the one in pixels, the other in parts of the image.
void read_crop(const Parameters& parameters, SceneDefaults& defaults) {
  const int width = *defaults.width, height = *defaults.height;
  const std::vector<int> pixels = parameters.integers("pixelbounds");
  std::vector<float> parts = parameters.numbers("cropwindow");
  if ((!pixels.empty() && pixels.size() != 4) || (!parts.empty() && parts.size() != 4)) {
    fail(parameters.place(), "cropwindow, pixelbounds: expected four numbers, x0 x1 y0 y1");
  }
  CropWindow crop{0, 0, width, height};
  if (!parts.empty()) {
    for (float& part : parts) part = glm::clamp(part, 0.0f, 1.0f);
    const auto edge = [](int side, float part) {
      return static_cast<int>(std::ceil(static_cast<float>(side) * part));
    };
    crop = {edge(width, std::min(parts[0], parts[1])), edge(height, std::min(parts[2], parts[3])),
            edge(width, std::max(parts[0], parts[1])), edge(height, std::max(parts[2], parts[3]))};
  } else if (!pixels.empty()) {
    crop = {std::max(0, pixels[0]), std::max(0, pixels[2]), std::min(width, pixels[1]),
            std::min(height, pixels[3])};
  }
  defaults.crop.reset();
  if (crop.x0 >= crop.x1 || crop.y0 >= crop.y1) {
    fail(parameters.place(), "cropwindow or pixelbounds leave nothing of the image");
  }
  if (!(crop == CropWindow{0, 0, width, height})) defaults.crop = crop;
}

/// What cameras take for white, if nothing is said, is near ours.
void read_white(Context& context, const Parameters& parameters, float fallback) {
  const float kelvins = parameters.number("whitebalance", 0.0f);
  if (kelvins != 0.0f && !(kelvins >= 1000.0f && kelvins <= 25000.0f)) {
    fail(parameters.place(), "whitebalance {}; expected 0, or kelvins from 1000 to 25000", kelvins);
  }
  context.white_kelvins = kelvins != 0.0f ? kelvins : fallback;
  if (kelvins == 0.0f) return;
  context.reporter.warn_once("white balance", parameters.find("whitebalance")->place,
                             "whitebalance {} changes the colours of lights, not of pixels: the "
                             "same where surfaces are grey",
                             kelvins);
}

/// pbrt's sensor multiplies by the time of exposure and ISO / 100.
void read_film(Context& context, const Entity& film) {
  const Parameters& parameters = film.parameters;
  SceneDefaults& defaults = context.scene.defaults;
  if (film.type != "rgb" && film.type != "image") {
    parameters.ignore({"nbuckets", "lambdamin", "lambdamax", "coordinatesystem"});
    context.reporter.warn_once("film " + film.type, parameters.place(),
                               "film '{}' is not supported: rgb is used", film.type);
  }
  defaults.width = read_side(parameters, "xresolution", 1280);
  defaults.height = read_side(parameters, "yresolution", 720);
  read_crop(parameters, defaults);
  // 'scale' is that of pbrt-v3.
  context.imaging_ratio *=
      parameters.number("iso", 100.0f * parameters.number("scale", 1.0f)) / 100.0f;
  if (!(context.imaging_ratio > 0.0f) || !std::isfinite(context.imaging_ratio)) {
    fail(parameters.place(), "Film: expected an iso above 0");
  }
  const std::string sensor = parameters.text("sensor", "cie1931");
  if (sensor != "cie1931") {
    context.reporter.warn_once("sensor", parameters.find("sensor")->place,
                               "sensor '{}' is not supported: the observer of 1931 is used, with "
                               "the sensor's whitebalance",
                               sensor);
  }
  read_white(context, parameters, sensor == "cie1931" ? 0.0f : 6500.0f);
  // About the file that pbrt would write, and what it does about fireflies.
  parameters.ignore(
      {"filename", "savefp16", "diagonal", "maxcomponentvalue", "maxsampleluminance"});
  parameters.report_unused(context.reporter);
}

}  // namespace

void read_view(Context& context) {
  const Description& d = context.description;
  const auto read = [&](const char* what, const char* type, const EntityPointer& entity,
                        void (*reader)(Context&, const Entity&)) {
    const Entity plain{entity ? entity->type : type, Parameters(d.place, what, {}),
                       entity ? entity->to_world : Affine(), ColorSpace::srgb,
                       entity ? entity->end_to_world : std::nullopt};
    const float ratio = context.imaging_ratio;
    const bool is_read = context.reporter.attempt(
        what, "is as if it had no parameters", [&] { reader(context, entity ? *entity : plain); });
    if (is_read) return;
    context.imaging_ratio = ratio;
    reader(context, plain);
  };
  read("Film", "rgb", d.film, read_film);
  read("PixelFilter", d.is_earlier ? "box" : "gaussian", d.filter, read_filter);
  read("Sampler", "zsobol", d.sampler, read_sampler);
  read("Integrator", "volpath", d.integrator, read_integrator);
  if (d.camera) read("Camera", "perspective", d.camera, read_camera);
}

}  // namespace pt::pbrt
