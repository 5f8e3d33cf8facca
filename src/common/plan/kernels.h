// The table of kernels: which code follows paths on which device, and in which scenes. Templates
// are instantiated from it (render/dispatch.h), a plan that has no row in it is refused, and `ptexp
// --list-kernels` prints it. A combination that no row names has no kernel, because no measurement
// needs it or because another one was faster everywhere (results/log/).
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>

#include "common/choices/choices.h"
#include "common/options/options.h"

namespace pt {

/// The code that takes paths from ray to ray.
enum class KernelBody {
  serial,  ///< one thread follows one path after the other
  loop,    ///< megakernel: each thread follows its paths
  vote,    ///< megakernel: each warp votes on what it does next
  blocks,  ///< megakernel: a wavefront in each block (--kernel sort), which ends the waves' last
           ///< paths
  stages,  ///< wavefront: a kernel for each stage; a thread traces a ray
  warps,   ///< wavefront: the same, but persistent warps trace the queues of rays
  fused,   ///< wavefront: one stage traces and shades
  optix,   ///< megakernel: the loop in OptiX's ray generation program
  queues,  ///< wavefront: OptiX traces the queues of rays; the stages are those of warps
};

/// Where a kernel's random numbers come from: Philox or XORWOW, inlined, or any sampler.
enum class NumberSource { philox, xorwow, sampler };

/// A set of enumerators.
template <class E>
class EnumSet {
 public:
  using value_type = E;
  constexpr EnumSet() = default;
  constexpr EnumSet(E value) : bits_(bit(value)) {}
  constexpr EnumSet(std::initializer_list<E> values) {
    for (const E value : values) bits_ |= bit(value);
  }
  constexpr EnumSet operator|(EnumSet other) const {
    EnumSet both;
    both.bits_ = bits_ | other.bits_;
    return both;
  }
  constexpr bool operator==(const EnumSet&) const = default;
  constexpr bool contains(E value) const { return (bits_ & bit(value)) != 0; }
  constexpr bool intersects(EnumSet other) const { return (bits_ & other.bits_) != 0; }

 private:
  static constexpr std::uint32_t bit(E value) { return 1u << static_cast<int>(value); }
  std::uint32_t bits_ = 0;
};

/// Records of 16 bytes that a path carries besides its own state (--path-bytes).
enum class ExtraRecords : int { none = 0, most = path_bytes_max / path_bytes_step };
inline constexpr EnumSet<ExtraRecords> some_records = [] {
  EnumSet<ExtraRecords> set;
  for (int i = 1; i <= static_cast<int>(ExtraRecords::most); ++i) set = set | ExtraRecords{i};
  return set;
}();

/// Whether CUDA has kernels whose paths carry some: a choice of the build, since they take long to
/// compile.
inline constexpr bool has_carrying_kernels = PTEXP_PATH_STATE != 0;
constexpr EnumSet<ExtraRecords> if_built(EnumSet<ExtraRecords> records) {
  return has_carrying_kernels ? records : EnumSet<ExtraRecords>();
}

/// What a kernel knows of a scene besides its geometry; the first four have all of those before,
/// and so have the last three, which know masks with media. A CPU's kernels with media know sparse
/// grids, too, and CUDA's where something moves.
enum class Extras {
  plain,
  with_masks,
  with_media,
  with_sparse,
  with_motion,
  with_moving_media,
  with_moving_sparse
};
inline constexpr int extras_count = 7;

constexpr SceneTraits traits_of(Extras extras) {
  using enum Extras;
  SceneTraits traits;
  traits.has_motion = extras >= with_motion;
  traits.has_masks = extras >= with_masks && extras != with_motion;
  traits.has_media = extras >= with_media && extras != with_motion;
  traits.has_sparse = extras == with_sparse || extras == with_moving_sparse;
  return traits;
}

/// What some kernels cannot have in a scene although its SceneTraits allow it.
enum class Content { spheres, instances, open_boundaries, deforming };

struct KernelRow {
  bool on_cuda;
  EnumSet<KernelBody> bodies;
  EnumSet<Accel> accels;
  Geometry geometry;
  EnumSet<Lighting> lighting;
  Extras extras;
  EnumSet<NumberSource> sources;
  EnumSet<Content> without = {};
  EnumSet<SceneMemory> memories = SceneMemory::global;
  EnumSet<Branching> branchings = Branching::divergent;
  EnumSet<ExtraRecords> extra = ExtraRecords::none;  ///< on a CPU every kernel carries any number
};

namespace kernel_rows {
using enum KernelBody;
using enum Accel;
using enum Geometry;
using enum Lighting;
using enum Extras;
using enum NumberSource;
using enum SceneMemory;
using enum Branching;
using enum Content;
inline constexpr bool cpu = false, cuda = true;
inline constexpr EnumSet<Accel> trees = tree_accels;
// In registers, and so by a kernel for each number; in memory.
inline constexpr auto in_registers =
    if_built({ExtraRecords{2}, ExtraRecords{4}, ExtraRecords{8}, ExtraRecords{16}});
inline constexpr auto in_memory = if_built(some_records);

// clang-format off
inline constexpr KernelRow table[] = {
    // The paper's scenes, with its random numbers.
    {cpu,  {serial, loop, stages, fused}, {brute, bvh2}, spheres_and_quads, {sky, emitters}, plain, {philox, xorwow}},
    {cpu,  {loop, stages}, {brute, bvh2}, spheres_and_quads, {sky, emitters}, plain, {philox, xorwow}, {}, global, reduced},
    {cuda, {loop, fused}, brute, spheres_and_quads, sky, plain, philox, {}, {global, shared, constant}},
    {cuda, {loop, fused}, brute, spheres_and_quads, emitters, plain, philox, {}, {global, constant}},
    {cuda, stages, brute, spheres_and_quads, {sky, emitters}, plain, philox},
    {cuda, {loop, stages, fused}, bvh2, spheres_and_quads, {sky, emitters}, plain, philox},
    {cuda, {loop, stages}, brute, spheres_and_quads, sky, plain, philox, {}, global, reduced},
    {cuda, {loop, stages, fused}, brute, spheres_and_quads, sky, plain, xorwow},
    // All other scenes.
    {cpu,  {serial, loop, stages, fused}, trees | cwbvh_avx2, triangles, full, plain, sampler},
    {cpu,  {serial, loop, stages, fused}, trees | EnumSet{cwbvh_avx2, brute, embree}, mixed, full, plain, sampler},
    {cpu,  {serial, loop, stages, fused}, trees | brute, mixed, full, with_masks, sampler},
    {cpu,  {serial, loop, stages, fused}, {bvh2, cwbvh, brute}, mixed, full, with_media, sampler},
    {cpu,  {serial, loop, stages, fused}, {bvh2, brute}, mixed, full, with_motion, sampler},
    {cpu,  {serial, loop, stages, fused}, {cwbvh, cwbvh_avx2}, mixed, full, with_motion, sampler, deforming},
    {cpu,  {serial, loop, stages, fused}, {bvh2, brute}, mixed, full, with_moving_media, sampler},
    {cpu,  {serial, loop, stages, fused}, cwbvh, mixed, full, with_moving_media, sampler, deforming},
    {cuda, {loop, stages, fused}, trees, triangles, full, plain, sampler},
    {cuda, {loop, stages}, bvh2, mixed, full, plain, sampler},
    {cuda, {loop, stages}, bvh2, mixed, full, with_masks, sampler},
    {cuda, {loop, stages, fused}, bvh2, mixed, full, with_media, sampler},
    {cuda, {loop, stages, fused}, bvh2, mixed, full, with_sparse, sampler},
    {cuda, {loop, stages, fused}, bvh2, mixed, full, with_motion, sampler},
    {cuda, {loop, stages, fused}, bvh2, mixed, full, with_moving_sparse, sampler},
    {cuda, fused, cwbvh, mixed, full, with_motion, sampler, deforming},
    {cuda, fused, trees, mixed, full, plain, sampler},
    {cuda, fused, trees, mixed, full, with_masks, sampler},
    {cuda, {vote, blocks, warps}, cwbvh, triangles, full, plain, sampler},
    {cuda, {blocks, warps}, cwbvh, mixed, full, plain, sampler, spheres},
    {cuda, {blocks, warps}, cwbvh, mixed, full, with_motion, sampler, {spheres, deforming}},
    {cuda, {blocks, warps}, cwbvh, mixed, full, with_masks, sampler, {spheres, instances}},
    {cuda, {blocks, warps}, cwbvh, mixed, full, with_media, sampler, {spheres, instances, open_boundaries}},
    // Rays that OptiX traces.
    {cuda, {optix, queues}, cwbvh, triangles, full, plain, sampler},
    {cuda, {optix, queues}, cwbvh, mixed, full, plain, sampler},
    {cuda, {optix, queues}, cwbvh, mixed, full, with_masks, sampler},
    {cuda, queues, cwbvh, mixed, full, with_media, sampler, open_boundaries},
    // With --path-bytes.
    {cuda, loop, bvh2, triangles, full, plain, sampler, {}, global, divergent, in_registers},
    {cuda, {vote, blocks, warps}, cwbvh, triangles, full, plain, sampler, {}, global, divergent, in_memory},
};
// clang-format on
}  // namespace kernel_rows
inline constexpr auto& kernel_table = kernel_rows::table;

/// What a kernel is asked for.
struct KernelNeed {
  bool on_cuda = false;
  EnumSet<KernelBody> bodies;  ///< one of them
  SceneTraits scene;
  EnumSet<NumberSource> sources;  ///< one of them
  SceneMemory memory = SceneMemory::global;
  Branching branching = Branching::divergent;
  EnumSet<Content> contents = {};
  EnumSet<ExtraRecords> extra = ExtraRecords::none;  ///< one of them
};

constexpr bool is_of_scene(const KernelRow& row, const SceneTraits& scene) {
  SceneTraits traits = traits_of(row.extras);
  traits.accel = scene.accel, traits.geometry = row.geometry, traits.lighting = scene.lighting;
  return traits == scene && row.lighting.contains(scene.lighting);
}

constexpr bool serves(const KernelRow& row, const KernelNeed& need) {
  return row.on_cuda == need.on_cuda && row.bodies.intersects(need.bodies) &&
         row.accels.contains(need.scene.accel) && is_of_scene(row, need.scene) &&
         row.sources.intersects(need.sources) && row.memories.contains(need.memory) &&
         row.branchings.contains(need.branching) && !row.without.intersects(need.contents) &&
         (!row.on_cuda || row.extra.intersects(need.extra));
}

constexpr bool has_kernel(const KernelNeed& need) {
  for (const KernelRow& row : kernel_table)
    if (serves(row, need)) return true;
  return false;
}

/// Whether stages trace rays, one by each thread, in such scenes; `scene` says nothing of lights
/// and sparse grids.
constexpr bool traces_rays(SceneTraits scene, SceneMemory memory) {
  using enum NumberSource;
  for (const Lighting lighting : {Lighting::sky, Lighting::emitters, Lighting::full}) {
    for (const bool has_sparse : {false, true}) {
      scene.lighting = lighting, scene.has_sparse = has_sparse;
      if (has_kernel({true, KernelBody::stages, scene, {philox, xorwow, sampler}, memory}))
        return true;
    }
  }
  return false;
}

/// The traits of a scene whose kernels are not the paper's, in this structure.
constexpr SceneTraits general_traits(Accel accel, EnumSet<Content> contents, bool has_masks,
                                     bool has_media, bool has_sparse = false,
                                     bool has_motion = false) {
  const bool mixed = has_masks || has_media || has_motion || accel == Accel::brute ||
                     accel == Accel::embree ||
                     contents.intersects({Content::spheres, Content::instances});
  return {accel,
          mixed ? Geometry::mixed : Geometry::triangles,
          Lighting::full,
          has_masks || has_media,
          has_media || (has_masks && has_motion),
          has_sparse,
          has_motion};
}

/// Which parts of a need the user asked for; the plan chose the others.
enum class KernelChoice { accel, memory, body, branching, rng, path_bytes };

/// For a need that no kernel serves: the options that the user gave and that stand in the way,
/// "--accel cwbvh", and those of a kernel for the same scene, "--accel bvh2". The nearest row
/// changes the fewest of them: first the structure or the scene's memory, then the body, last the
/// paper's toggles.
struct NearestKernel {
  std::string refused, expected;
};
NearestKernel nearest_kernel(const KernelNeed& need, EnumSet<KernelChoice> asked);

/// The table as text, with a line for each row.
std::string kernel_list();

}  // namespace pt
