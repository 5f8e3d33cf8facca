#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/error/error.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/default_lighting.h"
#include "common/scene/load/files/images/image_files.h"
#include "common/scene/load/files/importer.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/read_ahead.h"
#include "common/scene/load/load_scene.h"
#include "common/scene/load/pbrt/scene_parts.h"
#include "common/scene/load/pbrt/syntax/description.h"
#include "common/scene/load/pbrt/syntax/parameters.h"

namespace pt::pbrt {
namespace {

using DVec3 = glm::dvec3;
using DMat3 = glm::dmat3;

/// CIE 15:2004, 3.1: the D illuminants, XYZ with Y = 1.
DVec3 daylight(double kelvins) {
  const double t = kelvins * 1.4388 / 1.4380;  // c2 was another then
  if (t < 4000) {
    const DVec3 xyz = xyz_from_srgb() * DVec3(blackbody_to_rgb(t));
    return xyz / xyz.y;
  }
  const double x = t <= 7000
                       ? 0.244063 + 0.09911e3 / t + 2.9678e6 / (t * t) - 4.6070e9 / (t * t * t)
                       : 0.237040 + 0.24748e3 / t + 1.9018e6 / (t * t) - 2.0064e9 / (t * t * t);
  const double y = -3.0 * x * x + 2.87 * x - 0.275;
  return {x / y, 1.0, (1.0 - x - y) / y};
}

/// Lam 1985, by columns.
const DMat3 cones_of_xyz(0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367, 1.0296);

/// A grid of colours has them all: its medium multiplies it by grey.
template <class Balance>
void balance_media(SceneData& scene, const Balance& balance) {
  std::set<std::uint32_t> begins;  // of colours, which grids may share
  for (Medium& medium : scene.media) {
    if (medium.emission_grid == no_grid || scene.grids[medium.emission_grid].channels == 1) {
      balance(medium.emission);
    } else {
      begins.insert(scene.grids[medium.emission_grid].first);
    }
  }
  for (const std::uint32_t begin : begins) {
    std::size_t end = scene.grid_values.size();
    for (const VolumeGrid& grid : scene.grids)
      if (grid.first > begin) end = std::min<std::size_t>(end, grid.first);
    for (std::size_t first = begin; first < end; first += 3) {
      float* const values = &scene.grid_values[first];
      Color color(values[0], values[1], values[2]);
      balance(color);
      for (int c = 0; c < 3; ++c) values[c] = color[c];
    }
  }
}

/// Linear sRGB to the same, of which daylight of this colour temperature (below 4000 K a blackbody)
/// becomes white: pbrt's, after von Kries, by the cones of Bradford.
glm::mat3 white_balance(double kelvins) {
  const DVec3 from = cones_of_xyz * daylight(kelvins);
  const DVec3 to = cones_of_xyz * (xyz_from_srgb() * DVec3(1.0));
  DMat3 scale(0.0);
  for (int i = 0; i < 3; ++i) scale[i][i] = to[i] / from[i];
  const DMat3 balance = glm::inverse(cones_of_xyz) * scale * cones_of_xyz;
  return glm::mat3(glm::inverse(xyz_from_srgb()) * balance * xyz_from_srgb());
}

/// Changes all lights as the film would change its pixels: the same where surfaces are grey, near
/// it else, for colours multiply light component by component.
void balance_lights(SceneData& scene, double kelvins) {
  const glm::mat3 map = white_balance(kelvins);
  const auto balance = [&](Color& color) { color = glm::max(map * color, Color(0.0f)); };
  for (DeltaLight& light : scene.delta_lights) balance(light.intensity);
  for (MaterialDescription& material : scene.materials) balance(material.emission.radiance);
  for (Color& pixel : scene.environment.pixels) balance(pixel);
  balance(scene.sky.nadir), balance(scene.sky.zenith);
  balance_media(scene, balance);
}

}  // namespace

}  // namespace pt::pbrt

namespace pt {
namespace {

using pbrt::Context;
using pbrt::Description;
using pbrt::Reporter;

/// Announces the file of an entity of this type that has one.
void read_file_ahead(const Context& context, const pbrt::Entity& entity, std::string_view type) {
  if (entity.type != type) return;
  try {
    const pbrt::Parameters parameters = entity.parameters;  // to ask for one is not to use it
    if (!parameters.find("filename", {"string"})) return;
    const auto path = context.find(parameters.text("filename", ""));
    if (type == "plymesh") read_mesh_ahead({MeshFile::Format::ply, path});
    if (type == "infinite") read_radiance_ahead(path);
    if (type == "imagemap") read_texture_ahead(path, pbrt::encoding_of(parameters, path));
  } catch (const Error&) {  // said where it is read
  }
}

void read_files_ahead(const Context& context) {
  const Description& description = context.description;
  for (const auto& light : description.lights) read_file_ahead(context, *light, "infinite");
  for (const auto* textures : {&description.spectrum_textures, &description.float_textures}) {
    for (const auto& [name, texture] : *textures) read_file_ahead(context, *texture, "imagemap");
  }
  for (const auto& shape : description.shapes) read_file_ahead(context, shape.shape, "plymesh");
}

/// What a viewer needs and the file does not bring.
void complete(Context& context, const LoadOptions& options) {
  SceneData& scene = context.scene;
  const Description& description = context.description;
  if (!description.camera) {
    frame_finite_scene(scene);
    context.reporter.note(description.place, "no Camera: one that frames the scene is used");
  }
  if (context.lit || options.default_lighting == DefaultLighting::off) return;
  add_default_lighting(scene);
  const std::string text =
      fmt::format("no light that is supported: {} is used", default_lighting_text);
  if (description.lights.empty()) return context.reporter.note(description.place, text);
  context.reporter.warn_once("dark", description.place, text);
}

}  // namespace

SceneData load_pbrt(const std::filesystem::path& path, const LoadOptions& options) {
  Reporter reporter(options);
  const Description description = pbrt::read_description(path, reporter);
  SceneData scene;
  scene.name = path.stem().string();
  Context context(scene, description, reporter);
  context.volume_storage = options.volume;
  const ReadAhead ahead;
  read_files_ahead(context);
  pbrt::read_view(context);
  if (description.camera) {
    scene.camera_medium = pbrt::medium_named(context, description.camera_medium,
                                             description.camera->parameters.place());
  }
  pbrt::add_lights(context);
  pbrt::add_shapes(context);
  if (context.white_kelvins > 0.0f) pbrt::balance_lights(scene, double{context.white_kelvins});
  complete(context, options);
  return scene;
}

}  // namespace pt
