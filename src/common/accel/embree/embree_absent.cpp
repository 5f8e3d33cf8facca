// Built instead of embree_tree.cpp where CMake finds no Embree.
#include "common/accel/embree/embree_tree.h"
#include "common/accel/traverse_triangles.h"
#include "common/error/error.h"

namespace pt {

struct EmbreeTree::Scenes {};

std::string embree_version() { return {}; }

EmbreeTree::EmbreeTree(const TriangleTreeData&) {
  throw Error("--accel embree: ptexp was built without Embree; expected cwbvh, bvh2 or brute");
}
EmbreeTree::~EmbreeTree() = default;
EmbreeTree::EmbreeTree(EmbreeTree&&) noexcept = default;
EmbreeTree& EmbreeTree::operator=(EmbreeTree&&) noexcept = default;

Hit closest_triangle_embree(const EmbreeTree&, const Ray&, float, float) { return {}; }
bool any_triangle_embree(const EmbreeTree&, const Ray&, float, float) { return false; }

}  // namespace pt
