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
  std::vector<std::vector<double>> weights;  ///< at the times of keys; one: they stay
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
    Shape shape{
        source.mesh, {weights_of(source.weights, mesh.weights)}, source.skin >= 0 ? node.node : -1};
    for (const MovingNodes::Then& then : moving.later) {
      const auto own = then.weights.find(node.node);
      shape.weights.push_back(weights_of(
          own == then.weights.end() ? std::vector<double>() : own->second, mesh.weights));
    }
    if (std::ranges::count(shape.weights, shape.weights[0]) == std::ssize(shape.weights))
      shape.weights.resize(1);
    uses[shape].push_back(&node);
  }
  return uses;
}

/// Whether each `stride`-th set of vertices has the others between them, to within 1/1000 of the
/// mesh's size.
bool is_enough(const Mesh& mesh, std::size_t stride) {
  Bounds bounds;
  for (std::size_t set = 0; set < mesh.vertex_sets(); ++set)
    for (const Vec3& p : mesh.positions_of(set)) bounds.grow(p);
  const float tolerance = 1e-3f * glm::length(bounds.max - bounds.min);
  for (std::size_t set = 0; set < mesh.vertex_sets(); ++set) {
    const std::size_t begin = set / stride * stride;
    if (set == begin) continue;
    const float part = static_cast<float>(set - begin) / static_cast<float>(stride);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3 &from = mesh.positions_of(begin)[v], &to = mesh.positions_of(begin + stride)[v];
      if (!(glm::length(from + part * (to - from) - mesh.positions_of(set)[v]) <= tolerance))
        return false;
    }
  }
  return true;
}

/// Leaves what deforms the fewest sets of vertices that are enough for each mesh, as many for all:
/// each one, or one of 2, 4, 8 or 16. Meshes of which all sets are equal stand still.
void thin_vertex_sets(std::vector<Mesh>& meshes) {
  std::size_t stride = shutter_steps;
  for (Mesh& mesh : meshes) {
    const auto lacks = [&](const auto& normals) { return normals.size() != mesh.normals.size(); };
    if (mesh.normals.empty() || std::ranges::any_of(mesh.later_normals, lacks))
      mesh.later_normals.clear();  // some have no direction at times
    const auto stays = [](const auto& later, const std::vector<Vec3>& first) {
      return std::ranges::count(later, first) == std::ssize(later);
    };
    if (stays(mesh.later_positions, mesh.positions) && stays(mesh.later_normals, mesh.normals))
      mesh.stop_deforming();
    while (mesh.vertex_sets() > 1 && stride > 1 && !is_enough(mesh, stride)) stride /= 2;
  }
  for (Mesh& mesh : meshes) {
    for (auto* later : {&mesh.later_positions, &mesh.later_normals}) {
      std::vector<std::vector<Vec3>> kept;
      for (std::size_t i = stride; i <= later->size(); i += stride)
        kept.push_back(std::move((*later)[i - 1]));
      *later = std::move(kept);
    }
  }
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
        later_(moving.later) {
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
        mesh.stop_deforming();
        bake(file_, user->to_world, node_place(user->node), mesh);
        for (std::size_t set = 1; set < part.mesh.vertex_sets(); ++set) {
          Mesh then = mesh_at(part.mesh, set);
          bake(file_, user->to_world, node_place(user->node), then);
          if (!add_set(mesh, std::move(then))) break;
        }
        push(std::move(mesh), part);
      }
    }
    if (!instances.empty()) add_group(parts, instances);
  }

  void finish() {
    thin_vertex_sets(scene_.meshes);
    colors_.finish();
  }

 private:
  struct Part {
    Mesh mesh;
    bool shines_back = false;  ///< on its back, too
    std::string name = {};
  };

  /// Takes a set of vertices from the same mesh as it is later. False: it is another one, and the
  /// mesh stays as it is at first.
  static bool add_set(Mesh& mesh, Mesh&& then) {
    const auto same = [](const TriangleIndices& a, const TriangleIndices& b) {
      return std::ranges::equal(a.v, b.v);
    };
    if (mesh.positions.size() != then.positions.size() ||
        !std::ranges::equal(mesh.triangles, then.triangles, same)) {
      mesh.stop_deforming();
      return false;
    }
    mesh.later_positions.push_back(std::move(then.positions));
    mesh.later_normals.push_back(std::move(then.normals));
    return true;
  }

  /// With what skins and morph targets make of them until the shutter closes.
  std::vector<Part> read_moving_parts(const Shape& shape, const PlacedNode& user, bool& in_world) {
    std::vector<Part> parts = read_parts(shape, 0, user, in_world);
    if (shape.skinned_by < 0 && shape.weights.size() == 1) return parts;
    for (std::size_t key = 1; key <= later_.size(); ++key) {
      bool then_in_world = false;
      std::vector<Part> then = read_parts(shape, key, user, then_in_world);
      bool is_same = parts.size() == then.size() && in_world == then_in_world;
      for (std::size_t i = 0; is_same && i < parts.size(); ++i)
        is_same = add_set(parts[i].mesh, std::move(then[i].mesh));
      if (is_same) continue;
      for (Part& part : parts) part.mesh.stop_deforming();
      file_.report(fmt::format("meshes[{}]", shape.mesh),
                   "--shutter: other triangles while the shutter is open: the mesh stays as it is "
                   "when it opens");
      break;
    }
    return parts;
  }

  /// At the time of a key. `in_world`: a skin has put them into world space.
  std::vector<Part> read_parts(const Shape& shape, std::size_t key, const PlacedNode& user,
                               bool& in_world) {
    const auto& places = key == 0 ? places_ : later_[key - 1].places;
    const Affine& to_world =
        user.keys.empty() ? user.to_world : user.keys[std::min(key, user.keys.size() - 1)].to_world;
    const std::vector<double>& weights = shape.weights[shape.weights.size() == 1 ? 0 : key];
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
        bake(file_, to_world, place, primitive.mesh);
      }
      const int material = primitive.material;
      for (UvPart& uv : split_by_uv_sets(file_, std::move(primitive),
                                         sets_of_textures(file_, material), place)) {
        if (key > 0) {  // its vertices alone are wanted
          parts.push_back({std::move(uv.mesh)});
          continue;
        }
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
  const std::vector<MovingNodes::Then>& later_;
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
