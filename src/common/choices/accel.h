// The list of acceleration structures.
#pragma once

#include <initializer_list>

namespace pt {

// By their names on the command line. traverse_triangles.h traverses them; triangle_tree.h and
// build/build_nodes.h have the nodes of those that are built of a binary tree.
#define PT_ACCELS(ACCEL) \
  ACCEL(brute)           \
  ACCEL(bvh2)            \
  ACCEL(cwbvh)           \
  ACCEL(embree)

#define PT_ACCEL_ENUMERATOR(name) name,
/// The values of --accel. With `optix`, OptiX's structure stands beside a wide tree.
enum class AccelKind { automatic, PT_ACCELS(PT_ACCEL_ENUMERATOR) optix };

/// The acceleration structure that is traversed. Embree's is for the CPU; cwbvh_avx2 is the wide
/// tree for processors with AVX2. A CPU's kernels may be compiled for `any`: the one that
/// TriangleTree::accel names.
enum class Accel { PT_ACCELS(PT_ACCEL_ENUMERATOR) cwbvh_avx2, any };
#undef PT_ACCEL_ENUMERATOR
inline constexpr int accel_count = static_cast<int>(Accel::any) + 1;

/// The trees over triangles for which all devices have kernels.
inline constexpr std::initializer_list<Accel> tree_accels = {Accel::bvh2, Accel::cwbvh};

/// `kind` must not be AccelKind::automatic.
constexpr Accel accel_of(AccelKind kind) {
  if (kind == AccelKind::optix) return Accel::cwbvh;
  return static_cast<Accel>(static_cast<int>(kind) - static_cast<int>(AccelKind::brute));
}
constexpr AccelKind accel_kind_of(Accel accel) {
  if (accel == Accel::cwbvh_avx2) return AccelKind::cwbvh;
  return static_cast<AccelKind>(static_cast<int>(accel) + static_cast<int>(AccelKind::brute));
}
static_assert(accel_of(AccelKind::embree) == Accel::embree);

#define PT_ACCEL_NAME(name) #name,
/// As on the command line.
inline const char* accel_name(Accel accel) {
  constexpr const char* names[] = {PT_ACCELS(PT_ACCEL_NAME) "cwbvh", "any"};
  return names[static_cast<int>(accel)];
}
#undef PT_ACCEL_NAME

}  // namespace pt
