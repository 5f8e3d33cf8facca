#include <cmath>
#include <unordered_set>

#include "common/error/error.h"
#include "common/scene/load/files/images/image_files.h"
#include "common/scene/load/files/importer.h"
#include "common/scene/load/files/read_ahead.h"
#include "common/scene/load/files/text.h"
#include "common/scene/load/load_scene.h"
#include "common/scene/load/mitsuba/scene_parts.h"
#include "common/scene/load/mitsuba/surfaces/surfaces.h"

namespace pt {
namespace {

using mitsuba::Context;
using mitsuba::Element;
using mitsuba::Object;

/// The sensor, in the name of 0.x's first versions or of today. After the shapes, for it may have
/// to frame them.
void load_sensor(Context& context, const Object& root) {
  std::vector<const Object*> sensors = root.children("sensor");
  for (const Object* camera : root.children("camera")) sensors.push_back(camera);
  if (sensors.empty()) {
    context.note(root.element(), "no sensor: a camera that frames the scene is used");
    return frame_finite_scene(context.scene);
  }
  if (sensors.size() > 1) {
    context.warn_once("sensors", sensors[1]->element(), "more than one sensor: the first is used");
  }
  read_sensor(context, *sensors.front());
}

/// Announces the file of an object that has one.
void read_file_ahead(const Context& context, const Object& object) {
  const Element* filename = object.find("filename");
  if (!filename) return;
  const auto path = [&] { return context.find(*filename, filename->required("value")); };
  if (object.tag() == "emitter" && object.type() == "envmap") read_radiance_ahead(path());
  if (object.tag() == "texture" && mitsuba::is_bitmap(object))
    read_texture_ahead(path(), mitsuba::integers_of_bitmap(object));
  if (object.tag() == "shape") read_mesh_ahead(context, object);
}

std::vector<const Object*> objects_in_use(const Object& root) {
  std::unordered_set<const Object*> known{&root};
  std::vector<const Object*> in_use{&root};
  for (std::size_t i = 0; i < in_use.size(); ++i) {
    for (const Object::Nested& nested : in_use[i]->nested()) {
      if (nested.object && known.insert(nested.object).second) in_use.push_back(nested.object);
    }
  }
  return in_use;
}

/// Announces all files in use, those first that take longest to decode.
void read_files_ahead(const Context& context, const Object& root) {
  const std::vector<const Object*> in_use = objects_in_use(root);
  for (const std::string_view tag : {"emitter", "texture", "shape"}) {
    for (const Object* object : in_use) {
      if (object->tag() != tag) continue;
      try {
        const Object copy = *object;  // to ask it for a property is not to use that
        read_file_ahead(context, copy);
      } catch (const Error&) {  // said where it is read
      }
    }
  }
}

void load_objects(Context& context, const Object& root) {
  for (const Object* shape : root.children("shape")) add_shape(context, *shape, 0);
  context.expect_some_shape();
  load_sensor(context, root);
  add_grids(context);
  // What the camera sees is up to it.
  if (const Object* integrator = root.child("integrator")) read_integrator(context, *integrator);
  for (const Object* emitter : root.children("emitter")) add_emitter(context, *emitter);
  for (const Object* emitter : root.children("luminaire")) add_emitter(context, *emitter);
}

std::vector<std::string> with(std::vector<std::string> read, std::string_view others) {
  for (std::string_view word; !(word = next_word(others)).empty();) read.emplace_back(word);
  return read;
}

}  // namespace

std::vector<std::pair<std::string, std::vector<std::string>>> mitsuba::plugin_types() {
  return {
      {"integrator", with(integrator_types(), "aov depth moment stokes")},
      {"sensor", with({},
                      "perspective thinlens orthographic radiancemeter irradiancemeter distant "
                      "batch")},
      {"film", with({}, "hdrfilm ldrfilm mfilm specfilm")},
      {"sampler", with({}, "independent stratified multijitter orthogonal ldsampler")},
      {"rfilter", with({}, "box tent gaussian mitchell catmullrom lanczos")},
      {"texture", with({}, "bitmap checkerboard mesh_attribute scale volume")},
      {"spectrum", spectrum_types()},
      {"emitter", with(emitter_types(), "directionalarea timed_sunsky")},
      {"medium", with({}, "homogeneous heterogeneous")},
      {"volume", with({}, "constvolume gridvolume")},
      {"phase", with({}, "isotropic hg rayleigh blendphase sggx tabphase")},
      {"shape", with(shape_types(),
                     "blender bsplinecurve linearcurve ellipsoids ellipsoidsmesh "
                     "sdfgrid")},
      {"bsdf", with(surface_types(),
                    "circular hair measured measured_polarized polarizer pplastic "
                    "retarder")},
  };
}

SceneData load_mitsuba_scene(const mitsuba::Element& root, const std::string& name,
                             const LoadOptions& options) {
  const mitsuba::ObjectGraph graph(root, options);
  SceneData scene;
  scene.name = name;
  Context context(scene, options, graph);
  const ReadAhead ahead;
  read_files_ahead(context, graph.scene());
  load_objects(context, graph.scene());
  context.colors.finish();
  context.add_default_lighting_if_dark();
  context.report_unused();
  return scene;
}

SceneData load_mitsuba_xml(const std::filesystem::path& path, const LoadOptions& options) {
  const mitsuba::Element root = mitsuba::read_document(path, options);
  // Many scenes are FOLDER/scene.xml.
  const std::string stem = path.stem().string();
  const bool is_in_folder = stem == "scene" && path.has_parent_path();
  return load_mitsuba_scene(root, is_in_folder ? path.parent_path().filename().string() : stem,
                            options);
}

SceneData load_mitsuba_text(std::string_view text, const LoadOptions& options) {
  return load_mitsuba_scene(mitsuba::read_document("<string>", options, &text), "string", options);
}

}  // namespace pt
