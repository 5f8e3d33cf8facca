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
  std::vector<double> weights, end_weights;  ///< the latter as the shutter closes
  int skinned_by = -1;                       ///< the node with the skin, -1: none

  auto operator<=>(const Shape&) const = default;
};
using Uses = std::map<Shape, std::vector<const PlacedNode*>>;

/// Those of a node, else of its mesh; what is no number is 0.
std::vector<double> weights_of(const std::vector<double>& own, const std::vector<double>& of_mesh) {
  std::vector<double> weights = own.empty() ? of_mesh : own;
  for (double& weight : weights) {
    if (!std::isfinite(static_cast<float>(weight))) weight = 0.0;
  }
  return weights;
}

Uses uses_of_meshes(File& file, const MovingNodes& moving) {
  Uses uses;
  for (const PlacedNode& node : moving.nodes) {
    const auto& source = file.model.nodes[static_cast<std::size_t>(node.node)];
    if (source.mesh < 0 || !file.has(file.model.meshes, source.mesh, "meshes",
                                     node_place(node.node) + ".mesh", "the node has no mesh")) {
      continue;
    }
    const auto& mesh = file.model.meshes[static_cast<std::size_t>(source.mesh)];
    Shape shape{source.mesh,
                weights_of(source.weights, mesh.weights),
                {},
                source.skin >= 0 ? node.node : -1};
    shape.end_weights =
        moving.end_weights.empty()
            ? shape.weights
            : weights_of(moving.end_weights[static_cast<std::size_t>(node.node)], mesh.weights);
    uses[shape].push_back(&node);
  }
  return uses;
}

bool has_inverses(const PlacedNode& node) {
  return is_invertible(node.to_world) &&
         std::ranges::all_of(node.keys, is_invertible, &TransformKey::to_world);
}

/// Adds the meshes of the file to the scene.
class MeshAdder {
 public:
  MeshAdder(File& file, const MovingNodes& moving, const LoadOptions& options, SceneData& scene)
      : file_(file),
        scene_(scene),
        materials_(file, scene),
        colors_(scene, options),
        end_places_(moving.end_places) {
    for (const PlacedNode& node : moving.nodes) places_[node.node] = node.to_world;
    materials_.read_ahead();
  }

  void add(const Shape& shape, const std::vector<const PlacedNode*>& users) {
    bool in_world = false;
    const std::vector<Part> parts = read_moving_parts(shape, *users.front(), in_world);
    if (parts.empty()) return;
    if (in_world) {
      for (const Part& part : parts) push(part.mesh, part);
      return;
    }
    // Instances need a map that can be inverted.
    std::vector<const PlacedNode*> instances;
    for (const PlacedNode* user : users) {
      const bool repeats = users.size() > 1 || !user->keys.empty();
      if (repeats && has_inverses(*user)) {
        instances.push_back(user);
        continue;
      }
      for (const Part& part : parts) {
        Mesh mesh = part.mesh;
        bake(file_, user->to_world, node_place(user->node), mesh);
        if (!mesh.end_positions.empty()) {
          Mesh end = at_end(part.mesh);
          bake(file_, user->to_world, node_place(user->node), end);
          set_end(mesh, std::move(end));
        }
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

  /// As it is when the shutter closes.
  static Mesh at_end(const Mesh& mesh) {
    Mesh end = mesh;
    end.positions = end.end_positions;
    if (!end.end_normals.empty()) end.normals = end.end_normals;
    return end;
  }

  /// Takes the end of a deformation from the same mesh as it is then. False: it is another one.
  static bool set_end(Mesh& mesh, Mesh&& end) {
    mesh.end_positions.clear(), mesh.end_normals.clear();
    const auto same = [](const TriangleIndices& a, const TriangleIndices& b) {
      return std::ranges::equal(a.v, b.v);
    };
    if (mesh.positions.size() != end.positions.size() ||
        !std::ranges::equal(mesh.triangles, end.triangles, same))
      return false;
    if (mesh.positions != end.positions || mesh.normals != end.normals) {
      mesh.end_positions = std::move(end.positions);
      if (mesh.normals.size() == end.normals.size()) mesh.end_normals = std::move(end.normals);
    }
    return true;
  }

  /// With what skins and morph targets make of them until the shutter closes.
  std::vector<Part> read_moving_parts(const Shape& shape, const PlacedNode& user, bool& in_world) {
    std::vector<Part> parts = read_parts(shape, shape.weights, places_, user, in_world);
    if (end_places_.empty() || (shape.skinned_by < 0 && shape.end_weights == shape.weights))
      return parts;
    bool end_in_world = false;
    PlacedNode end_user = user;
    if (!user.keys.empty()) end_user.to_world = user.keys.back().to_world;
    std::vector<Part> end =
        read_parts(shape, shape.end_weights, end_places_, end_user, end_in_world);
    bool is_same = parts.size() == end.size() && in_world == end_in_world;
    for (std::size_t i = 0; is_same && i < parts.size(); ++i)
      is_same = set_end(parts[i].mesh, std::move(end[i].mesh));
    if (!is_same) {
      for (Part& part : parts) part.mesh.end_positions.clear(), part.mesh.end_normals.clear();
      file_.report(fmt::format("meshes[{}]", shape.mesh),
                   "--shutter: other triangles when the shutter closes: the mesh stays as it is "
                   "when it opens");
    }
    return parts;
  }

  /// `in_world`: a skin has put them into world space.
  std::vector<Part> read_parts(const Shape& shape, const std::vector<double>& weights,
                               const std::unordered_map<int, Affine>& places,
                               const PlacedNode& user, bool& in_world) {
    std::vector<Affine> joints;
    if (shape.skinned_by >= 0) {
      const int skin = file_.model.nodes[static_cast<std::size_t>(shape.skinned_by)].skin;
      joints = joint_matrices(file_, skin, places, node_place(shape.skinned_by));
    }
    in_world = !joints.empty();
    const std::string place = fmt::format("meshes[{}]", shape.mesh);
    const std::string& name = file_.model.meshes[static_cast<std::size_t>(shape.mesh)].name;
    std::vector<Part> parts;
    for (PrimitiveMesh& primitive : read_primitives(file_, shape.mesh, weights)) {
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
    for (const PlacedNode* node : nodes) {
      if (!node->keys.empty())
        scene_.motion.instances.push_back(
            {static_cast<std::uint32_t>(scene_.instances.size()), node->keys});
      scene_.instances.push_back({groups_, node->to_world});
    }
  }

  File& file_;
  SceneData& scene_;
  Materials materials_;
  VertexColors colors_;
  const ReadAhead ahead_;
  std::unordered_map<int, Affine> places_;  ///< by node
  const std::unordered_map<int, Affine>& end_places_;
  std::uint32_t groups_ = 0;
};

}  // namespace

SceneData load_gltf(const std::filesystem::path& path, const LoadOptions& options) {
  ReadModel read = read_model(path);
  File file(path.string(), std::move(read.model), options);
  for (const std::string& warning : read.warnings) file.report("", warning);
  report_ignored(file);
  SceneData scene;
  scene.name = path.filename().string();
  const MovingNodes moving = place_moving_nodes(file, options);
  const std::vector<PlacedNode>& nodes = moving.nodes;
  if (options.shutter) scene.motion.shutter = {0.0f, *options.shutter};
  MeshAdder meshes(file, moving, options, scene);
  for (const auto& [shape, users] : uses_of_meshes(file, moving)) meshes.add(shape, users);
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
