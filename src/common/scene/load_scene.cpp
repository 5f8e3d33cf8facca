#include "common/scene/load_scene.h"
#include "common/files/mesh_files.h"

namespace pt {
bool is_scene_file(const std::string& name) { return name.ends_with(".ply"); }
SceneData load_scene_file(const std::filesystem::path& path, const LoadOptions&) {
  SceneData scene;
  scene.meshes.push_back(read_ply(path));
  scene.add_material({});
  return scene;
}
}  // namespace pt
