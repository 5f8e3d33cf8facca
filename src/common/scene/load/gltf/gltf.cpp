#include "common/scene/load/gltf/gltf.h"

#include <algorithm>
#include <map>

#include "common/scene/data/frame_scene.h"
#include "common/scene/load/files/meshes/vertex_colors.h"
#include "common/scene/load/files/studio.h"
#include "common/scene/load/gltf/bake.h"
#include "common/scene/load/gltf/cameras.h"
#include "common/scene/load/gltf/document/read_model.h"
#include "common/scene/load/gltf/lights.h"
#include "common/scene/load/gltf/materials.h"
#include "common/scene/load/gltf/meshes.h"
#include "common/scene/load/gltf/nodes.h"

namespace pt {

namespace {

using namespace gltf;

void check_extensions(File& file) {
  const auto is_known = [](const std::string& name) {
    return std::ranges::find(known_extensions, name) != known_extensions.end();
  };
  for (const std::string& name : file.model.extensionsRequired) {
    if (!is_known(name) && std::ranges::find(image_extensions, name) == image_extensions.end()) {
      file.fail("extensionsRequired", fmt::format("{:.80} is not supported", name));
    }
  }
  for (const std::string& name : file.model.extensionsUsed) {
    if (!is_known(name)) {
      file.report("extensionsUsed", fmt::format("{:.80} is ignored", name));
    }
  }
}

void report_ignored(File& file) {
  if (!file.model.animations.empty()) file.report("animations", "animations are ignored");
  if (!file.model.skins.empty()) file.report("skins", "skins are ignored");
}

/// Meshes by the nodes that use them.
using Uses = std::map<int, std::vector<const PlacedNode*>>;

Uses uses_of_meshes(const File& file, const std::vector<PlacedNode>& nodes) {
  Uses uses;
  for (const PlacedNode& node : nodes) {
    const int mesh = file.model.nodes[static_cast<std::size_t>(node.node)].mesh;
    if (mesh < 0) continue;
    file.at(file.model.meshes, mesh, "meshes", node_place(node.node) + ".mesh");
    uses[mesh].push_back(&node);
  }
  return uses;
}

void add_group(const std::vector<Mesh>& meshes, const std::vector<const PlacedNode*>& nodes,
               std::uint32_t group, SceneData& scene) {
  for (const Mesh& mesh : meshes) {
    scene.meshes.push_back(mesh);
    scene.meshes.back().group = group;
  }
  for (const PlacedNode* node : nodes) scene.instances.push_back({group, node->to_world});
}

void add_meshes(File& file, const std::vector<PlacedNode>& nodes, const LoadOptions& options,
                SceneData& scene) {
  Materials materials(file, scene);
  VertexColors colors(scene, options);
  std::uint32_t groups = 0;
  for (const auto& [index, users] : uses_of_meshes(file, nodes)) {
    std::vector<Mesh> meshes;
    for (PrimitiveMesh& primitive : read_primitives(file, index)) {
      const std::string place = fmt::format("meshes[{}]", index);
      primitive.mesh.material = materials.material_index(primitive.material, place);
      colors.tint(primitive.mesh, materials.is_unlit(primitive.material), file.describe(place));
      meshes.push_back(std::move(primitive.mesh));
    }
    if (meshes.empty()) continue;
    // Instances need a map that can be inverted.
    std::vector<const PlacedNode*> instances, baked;
    for (const PlacedNode* user : users) {
      const bool is_instance = users.size() > 1 && user->to_world.determinant() != 0.0f;
      (is_instance ? instances : baked).push_back(user);
    }
    for (const PlacedNode* user : baked) {
      for (const Mesh& mesh : meshes) {
        scene.meshes.push_back(mesh);
        bake(file, user->to_world, node_place(user->node), scene.meshes.back());
      }
    }
    if (!instances.empty()) add_group(meshes, instances, ++groups, scene);
  }
  colors.finish();
}

}  // namespace

SceneData load_gltf(const std::filesystem::path& path, const LoadOptions& options) {
  ReadModel read = read_model(path);
  File file(path.string(), std::move(read.model), options);
  for (const std::string& warning : read.warnings) file.report("", warning);
  check_extensions(file);
  report_ignored(file);
  SceneData scene;
  scene.name = path.filename().string();
  const std::vector<PlacedNode> nodes = place_nodes(file);
  add_meshes(file, nodes, options, scene);
  if (scene.meshes.empty()) file.fail("", "no triangles in the scene: expected at least one");
  add_lights(file, nodes, scene);
  const Bounds bounds = scene_bounds(scene);
  if (!std::isfinite(glm::length(bounds.max - bounds.min))) {
    file.fail("", "the scene is too large for numbers of 32 bits");
  }
  const bool is_framed = !set_camera(file, nodes, bounds, scene);
  if (is_framed) {
    file.note("no camera: one that frames the scene is used");
    scene.camera = frame_scene(scene);
  }
  if (const std::string light = light_model(options, is_framed, scene); !light.empty())
    file.note(light);
  return scene;
}

}  // namespace pt
