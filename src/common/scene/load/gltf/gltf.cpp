#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/default_lighting.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/meshes/vertex_colors.h"
#include "common/scene/load/files/read_ahead.h"
#include "common/scene/load/gltf/materials.h"
#include "common/scene/load/gltf/meshes.h"
#include "common/scene/load/gltf/nodes.h"
#include "common/scene/load/gltf/read_model.h"
#include "common/scene/load/load_scene.h"

namespace pt {
namespace {

using namespace gltf;

void report_ignored(File& file) {
  for (const std::string& name : file.model.extensionsUsed) {
    if (std::ranges::find(known_extensions, name) == known_extensions.end()) {
      file.report("extensionsUsed", "{:.80} is ignored", name);
    }
  }
}

/// A mesh in a shape of its own: with the weights of its morph targets, which a node may set, and
/// moved by a skin, which no two nodes share here.
struct Shape {
  int mesh = -1;
  std::vector<double> weights;
  int skinned_by = -1;  ///< the node with the skin, -1: none

  auto operator<=>(const Shape&) const = default;
};
using Uses = std::map<Shape, std::vector<const PlacedNode*>>;

Uses uses_of_meshes(File& file, const std::vector<PlacedNode>& nodes) {
  Uses uses;
  for (const PlacedNode& node : nodes) {
    const auto& source = file.model.nodes[static_cast<std::size_t>(node.node)];
    if (source.mesh < 0 || !file.has(file.model.meshes, source.mesh, "meshes",
                                     node_place(node.node) + ".mesh", "the node has no mesh")) {
      continue;
    }
    const auto& mesh = file.model.meshes[static_cast<std::size_t>(source.mesh)];
    Shape shape{source.mesh, source.weights.empty() ? mesh.weights : source.weights,
                source.skin >= 0 ? node.node : -1};
    for (double& weight : shape.weights) {
      if (!std::isfinite(static_cast<float>(weight))) weight = 0.0;
    }
    uses[shape].push_back(&node);
  }
  return uses;
}

/// Adds the meshes of the file to the scene.
class MeshAdder {
 public:
  MeshAdder(File& file, const std::vector<PlacedNode>& nodes, const LoadOptions& options,
            SceneData& scene)
      : file_(file), scene_(scene), materials_(file, scene), colors_(scene, options) {
    for (const PlacedNode& node : nodes) places_[node.node] = node.to_world;
    materials_.read_ahead();
  }

  void add(const Shape& shape, const std::vector<const PlacedNode*>& users) {
    bool in_world = false;
    const std::vector<Part> parts = read_parts(shape, *users.front(), in_world);
    if (parts.empty()) return;
    if (in_world) {
      for (const Part& part : parts) push(part.mesh, part);
      return;
    }
    // Instances need a map that can be inverted.
    std::vector<const PlacedNode*> instances;
    for (const PlacedNode* user : users) {
      if (users.size() > 1 && user->to_world.determinant() != 0.0f) {
        instances.push_back(user);
        continue;
      }
      for (const Part& part : parts) {
        Mesh mesh = part.mesh;
        bake(file_, user->to_world, node_place(user->node), mesh);
        push(std::move(mesh), part);
      }
    }
    if (!instances.empty()) add_group(parts, instances);
  }

  void finish() { colors_.finish(); }

 private:
  struct Part {
    Mesh mesh;
    bool shines_back = false;  ///< on its back, too
    std::string name = {};
  };

  /// `in_world`: a skin has put them into world space.
  std::vector<Part> read_parts(const Shape& shape, const PlacedNode& user, bool& in_world) {
    std::vector<Affine> joints;
    if (shape.skinned_by >= 0) {
      const int skin = file_.model.nodes[static_cast<std::size_t>(shape.skinned_by)].skin;
      joints = joint_matrices(file_, skin, places_, node_place(shape.skinned_by));
    }
    in_world = !joints.empty();
    const std::string place = fmt::format("meshes[{}]", shape.mesh);
    const std::string& name = file_.model.meshes[static_cast<std::size_t>(shape.mesh)].name;
    std::vector<Part> parts;
    for (PrimitiveMesh& primitive : read_primitives(file_, shape.mesh, shape.weights)) {
      if (in_world && primitive.influences.per_vertex > 0) {
        apply_skin(file_, joints, primitive.influences, place, primitive.mesh);
      } else if (in_world) {
        file_.report(place,
                     "a primitive of a skinned mesh without JOINTS_0 and WEIGHTS_0: it is placed "
                     "by its node");
        bake(file_, user.to_world, place, primitive.mesh);
      }
      const int material = primitive.material;
      for (UvPart& uv : split_by_uv_sets(file_, std::move(primitive),
                                         sets_of_textures(file_, material), place)) {
        uv.mesh.material = materials_.material_index(material, uv.maps);
        const bool shines_back = materials_.shines_on_both_sides(uv.mesh.material);
        colors_.tint(uv.mesh, materials_.is_unlit(material), file_.describe(place));
        parts.push_back({std::move(uv.mesh), shines_back, name});
      }
    }
    return parts;
  }

  /// `mesh`: that of the part, somewhere.
  void push(Mesh mesh, const Part& part) {
    if (mesh.triangles.empty()) return;
    if (part.shines_back) scene_.meshes.push_back(back_of(mesh));
    if (!part.name.empty())
      scene_.names.meshes[static_cast<std::uint32_t>(scene_.meshes.size())] = part.name;
    scene_.meshes.push_back(std::move(mesh));
  }

  void add_group(const std::vector<Part>& parts, const std::vector<const PlacedNode*>& nodes) {
    ++groups_;
    for (const Part& part : parts) {
      Mesh mesh = part.mesh;
      mesh.group = groups_;
      push(std::move(mesh), part);
    }
    for (const PlacedNode* node : nodes) scene_.instances.push_back({groups_, node->to_world});
  }

  File& file_;
  SceneData& scene_;
  Materials materials_;
  VertexColors colors_;
  const ReadAhead ahead_;
  std::unordered_map<int, Affine> places_;  ///< by node
  std::uint32_t groups_ = 0;
};

}  // namespace

SceneData load_gltf(const std::filesystem::path& path, const LoadOptions& options) {
  ReadModel read = read_model(path);
  File file(path.string(), std::move(read.model), options);
  for (const std::string& warning : read.warnings) file.report("", warning);
  report_ignored(file);
  pose_nodes(file, options);
  SceneData scene;
  scene.name = path.filename().string();
  const std::vector<PlacedNode> nodes = place_nodes(file);
  MeshAdder meshes(file, nodes, options, scene);
  for (const auto& [shape, users] : uses_of_meshes(file, nodes)) meshes.add(shape, users);
  meshes.finish();
  if (scene.meshes.empty()) {
    const std::string& last = file.last_report();
    file.fail("", "no triangles in the scene: expected at least one" +
                      (last.empty() ? "" : fmt::format(" (warned: {})", last)));
  }
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
