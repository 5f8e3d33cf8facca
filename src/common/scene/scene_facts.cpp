#include "common/scene/scene_facts.h"

#include <fmt/format.h>

#include <utility>

namespace pt {
namespace {

template <class T>
std::uint64_t bytes(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

std::uint64_t mesh_bytes(const SceneData& scene) {
  std::uint64_t sum = 0;
  for (const Mesh& mesh : scene.meshes) {
    sum += bytes(mesh.positions) + bytes(mesh.triangles) + bytes(mesh.normals) + bytes(mesh.uvs);
  }
  return sum + bytes(scene.attributes.triangles) + bytes(scene.attributes.normals) +
         bytes(scene.attributes.uvs);
}

std::string size_text(std::uint64_t size_bytes) {
  return size_bytes < 10'000'000 ? fmt::format("{:.1f} KB", 1e-3 * static_cast<double>(size_bytes))
                                 : fmt::format("{:.1f} MB", 1e-6 * static_cast<double>(size_bytes));
}

void append_count(std::string& text, std::uint64_t count, const char* what) {
  if (count == 0) return;
  text += fmt::format("{}{} {}{}", text.empty() ? "" : ", ", count, what, count == 1 ? "" : "s");
}

/// Of all nodes' visits and triangles' tests, as the builders weigh them.
constexpr double triangle_cost = 1.0;

void describe_tree(const TriangleTreeData& tree, SceneFacts& facts) {
  if (tree.bvh2.empty() && tree.cwbvh.empty()) return;
  const TreeQuality quality =
      tree.bvh2.empty() ? measure_tree(tree.cwbvh, tree.root) : measure_tree(tree.bvh2, tree.root);
  facts.tree.nodes = tree.bvh2.size() + tree.cwbvh.size();
  facts.tree.references = tree.triangles.size();
  facts.tree.depth = quality.depth;
  facts.tree.sah_cost = quality.sah_cost(triangle_cost);
  facts.tree.bytes_per_triangle = static_cast<double>(tree.size_bytes()) /
                                  static_cast<double>(std::max<std::uint64_t>(facts.triangles, 1));
  facts.tree.builder = tree.builder;
  facts.tree.build_ms = tree.build_ms;
}

std::string tree_text(const SceneFacts& facts) {
  return fmt::format(
      "tree: {}, {} nodes, depth {}, SAH cost {:.1f}, {:.1f} bytes per triangle, built in {:.0f} "
      "ms\n",
      facts.tree.builder, facts.tree.nodes, facts.tree.depth, facts.tree.sah_cost,
      facts.tree.bytes_per_triangle, facts.tree.build_ms);
}

}  // namespace

void describe_scene(const SceneData& scene, SceneFacts& facts) {
  facts.triangles = scene.triangle_count();
  facts.meshes = scene.meshes.size();
  facts.instances = scene.instances.size();
  facts.spheres = scene.spheres.size();
  facts.quads = scene.quads.size();
  facts.materials = scene.materials.size();
  facts.textures = scene.textures.size();
  const bool has_environment = scene.environment_map.width > 0;
  facts.lights = scene.lights.size() + scene.light_list.lights.size() + (has_environment ? 1 : 0);
  facts.memory = {
      {"meshes", mesh_bytes(scene)},
      {"acceleration structure", scene.tree.size_bytes() + bytes(scene.bvh_nodes)},
      {"textures", bytes(scene.texels)},
      {"environment", bytes(scene.environment_map.texels) + bytes(scene.environment_map.alias)},
      {"lights", bytes(scene.light_list.lights) + bytes(scene.light_list.selection)}};
  std::erase_if(facts.memory, [](const BufferSize& buffer) { return buffer.size_bytes == 0; });
  describe_tree(scene.tree, facts);
}

std::string scene_text(const SceneFacts& facts) {
  if (facts.triangles == 0) return "";
  std::string counts;
  append_count(counts, facts.triangles, "triangle");
  append_count(counts, facts.instances, "instance");
  append_count(counts, facts.spheres, "sphere");
  append_count(counts, facts.materials, "material");
  append_count(counts, facts.lights, "light");
  append_count(counts, facts.textures, "texture");
  std::string memory;
  for (const BufferSize& buffer : facts.memory) {
    memory += fmt::format("{}{} {}", memory.empty() ? "" : ", ", buffer.name,
                          size_text(buffer.size_bytes));
  }
  std::string text = fmt::format("scene: {}\n", counts);
  if (!memory.empty()) text += fmt::format("memory: {}\n", memory);
  if (facts.tree.nodes > 0) text += tree_text(facts);
  return text;
}

}  // namespace pt
