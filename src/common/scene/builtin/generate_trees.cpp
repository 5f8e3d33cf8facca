// The trees of the forest, which its instances repeat.
#include <array>

#include "common/math/frame.h"
#include "common/scene/builtin/generate_forest.h"
#include "common/scene/builtin/shapes.h"
#include "common/scene/builtin/sphere_world.h"

namespace pt {
namespace {

/// `count` leaves of two triangles each, turned at random, in an ellipsoid.
void add_leaves(Mesh& mesh, const Vec3& center, const Vec3& radii, int count, float size,
                std::uint32_t seed) {
  WorldRandom random(seed);
  for (int i = 0; i < count; ++i) {
    const float u0 = random.next(), u1 = random.next(), u2 = random.next();
    // Denser near the surface, where a crown has its leaves.
    const Vec3 place = center + radii * sample_unit_ball(u0, u1, 0.4f + 0.6f * u2);
    const float v0 = random.next(), v1 = random.next();
    const Vec3 facing = sample_unit_sphere(v0, v1);
    const Frame frame = make_frame(facing);
    const float half = 0.5f * size * random.next(0.7f, 1.3f);
    add_rectangle(mesh, place - half * (frame.tangent + frame.bitangent),
                  2.0f * half * frame.tangent, 2.0f * half * frame.bitangent);
  }
}

void add_trunk(Mesh& mesh, float height, float radius) {
  const ProfilePoint profile[] = {{1.4f * radius, -0.05f * height}, {radius, 0.06f * height},
                                  {0.8f * radius, 0.4f * height},   {0.5f * radius, 0.7f * height},
                                  {0.2f * radius, 0.95f * height},  {0.0f, height}};
  add_revolution(mesh, Vec3(0.0f), profile, 16);
}

struct Tree {
  Mesh trunk, leaves;
};

/// Twelve skirts of branches, one above the other, with needles in the lowest.
Tree conifer() {
  Tree tree;
  add_trunk(tree.trunk, 1.0f, 0.03f);
  for (int i = 0; i < 12; ++i) {
    const float height = 0.14f + 0.07f * static_cast<float>(i);
    const float radius = 0.24f * (1.05f - height);
    const ProfilePoint skirt[] = {{0.3f * radius, 0.015f},
                                  {radius, 0.0f},
                                  {0.7f * radius, 0.035f},
                                  {0.35f * radius, 0.075f},
                                  {0.0f, 0.11f}};
    add_revolution(tree.leaves, {0, height, 0}, skirt, 40);
    add_leaves(tree.leaves, {0, height + 0.01f, 0}, {radius, 0.02f, radius}, 80, 0.02f,
               static_cast<std::uint32_t>(100 + i));
  }
  return tree;
}

Tree broad_tree() {
  Tree tree;
  add_trunk(tree.trunk, 0.75f, 0.045f);
  const Vec3 crowns[] = {{0, 0.72f, 0},         {0.2f, 0.6f, 0.05f},    {-0.17f, 0.58f, 0.12f},
                         {0.02f, 0.62f, -0.2f}, {-0.12f, 0.8f, -0.06f}, {0.1f, 0.82f, 0.1f}};
  std::uint32_t seed = 200;
  for (const Vec3& crown : crowns)
    add_leaves(tree.leaves, crown, {0.19f, 0.15f, 0.19f}, 1500, 0.022f, seed++);
  return tree;
}

Tree bush() {
  Tree tree;
  add_trunk(tree.trunk, 0.3f, 0.02f);
  add_leaves(tree.leaves, {0, 0.22f, 0}, {0.25f, 0.2f, 0.25f}, 1800, 0.025f, 300);
  return tree;
}

Tree poplar() {
  Tree tree;
  add_trunk(tree.trunk, 0.9f, 0.03f);
  add_leaves(tree.leaves, {0, 0.58f, 0}, {0.12f, 0.45f, 0.12f}, 5500, 0.018f, 400);
  return tree;
}

}  // namespace

std::vector<Mesh> generate_trees() {
  std::vector<Mesh> meshes;
  std::uint32_t group = 0;
  for (Tree& tree : std::array{conifer(), broad_tree(), bush(), poplar()}) {
    ++group;
    for (Mesh* mesh : {&tree.trunk, &tree.leaves}) {
      mesh->group = group;
      meshes.push_back(std::move(*mesh));
    }
  }
  return meshes;
}

}  // namespace pt
