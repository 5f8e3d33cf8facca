#include <cmath>

#include "common/scene/load/files/importer.h"
#include "common/scene/load/load_scene.h"
#include "common/scene/load/mitsuba/scene_parts.h"

namespace pt {
namespace {

using mitsuba::Context;
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

}  // namespace

SceneData load_mitsuba_scene(const mitsuba::Element& root, const std::string& name,
                             const LoadOptions& options) {
  const mitsuba::ObjectGraph graph(root, options);
  SceneData scene;
  scene.name = name;
  Context context(scene, options, graph);
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

}  // namespace pt
