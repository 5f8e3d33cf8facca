#include "common/scene/data/scene_facts.h"

#include <fmt/format.h>

#include <algorithm>
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
  return sum + bytes(scene.corners);
}

std::string size_text(std::uint64_t size_bytes) {
  return size_bytes < 10'000'000 ? fmt::format("{:.1f} KB", 1e-3 * static_cast<double>(size_bytes))
                                 : fmt::format("{:.1f} MB", 1e-6 * static_cast<double>(size_bytes));
}

void append_count(std::string& text, std::uint64_t count, const char* what) {
  if (count == 0) return;
  text += fmt::format("{}{} {}{}", text.empty() ? "" : ", ", count, what, count == 1 ? "" : "s");
}

/// The expected cost of a ray: visits of nodes and tests of triangles, weighted as by the builders.
constexpr double triangle_cost = 1.0;

}  // namespace

TreeFacts tree_facts(const TreeSummary& tree, std::uint64_t triangles) {
  TreeFacts facts;
  if (tree.quality.nodes == 0) return facts;
  facts.builder = tree.builder;
  facts.nodes = tree.quality.nodes;
  facts.references = tree.quality.slots;
  facts.depth = tree.quality.depth;
  facts.sah_cost = tree.quality.sah_cost(triangle_cost);
  facts.bytes_per_triangle = static_cast<double>(tree.size_bytes) /
                             static_cast<double>(std::max<std::uint64_t>(triangles, 1));
  facts.build_ms = tree.build_ms;
  return facts;
}

void describe_scene(const SceneData& scene, SceneFacts& facts, bool has_new_tree) {
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
      {"lights", bytes(scene.light_list.lights) + bytes(scene.light_list.selection) +
                     bytes(scene.light_list.tree.pairs) + bytes(scene.light_list.tree.trail)}};
  std::erase_if(facts.memory, [](const BufferSize& buffer) { return buffer.size_bytes == 0; });
  if (has_new_tree) facts.tree = tree_facts(summarize(scene.tree), facts.triangles);
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
  return text + tree_text(facts.tree);
}

std::string tree_text(const TreeFacts& tree) {
  if (tree.nodes == 0) return "";
  return fmt::format(
      "tree: {}, {} nodes, depth {}, SAH cost {:.1f}, {:.1f} bytes per triangle, built in {:.{}f} "
      "ms\n",
      tree.builder, tree.nodes, tree.depth, tree.sah_cost, tree.bytes_per_triangle, tree.build_ms,
      tree.build_ms < 10 ? 1 : 0);
}

}  // namespace pt
