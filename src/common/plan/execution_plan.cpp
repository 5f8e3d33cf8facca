#include "common/plan/execution_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "common/accel/build/build_nodes.h"
#include "common/accel/build/build_triangle_tree.h"
#include "common/accel/trace_cpu/ray_block.h"
#include "common/accel/traverse_triangles.h"
#include "common/error/error.h"
#include "common/material/material.h"
#include "common/options/option_names.h"
#include "common/plan/plan_steps.h"
#include "common/plan/render_properties.h"

namespace pt {
namespace {

constexpr const char* asked = "asked for";

/// What has been decided so far, and what the decisions depend on.
class Planner {
 public:
  Planner(const Options& options, const SceneProperties& scene, const DeviceProperties& device)
      : o_(options), scene_(scene), device_(limit_device(device, options.limits)) {
    static_cast<ImageSettings&>(plan_) = options;
    static_cast<ExecutionSettings&>(plan_) = options;
    if (!device.is_cuda) plan_.threads = device.threads;
    if (device.is_cuda) note_limits(device);
    plan_.calibration = device.constants.calibration;
  }

  ExecutionPlan plan() {
    check_options_for_scene(o_, scene_);
    check_motion(o_, scene_, device_);
    choose_kernels();
    choose_mode();
    if (is_on_gpu(Mode::megakernel)) choose_megakernel();
    choose_structure();
    if (traces_by_optix()) choose_optix();
    if (has_nodes(accel_kind_of(plan_.accel)) && !is_specialized()) choose_builder();
    if (plan_.mode == Mode::wavefront) choose_stages();
    if (device_.is_cuda && is_specialized()) choose_scene_memory();
    if (plan_.mode == Mode::wavefront) choose_waves();
    if (!is_specialized()) choose_lights();
    if (plan_.path_bytes > 0) decide("path-bytes", std::to_string(plan_.path_bytes), state_place());
    check_plan(plan_, o_, scene_, device_);
    return std::move(plan_);
  }

 private:
  using C = PlanConstants;

  bool is_specialized() const { return plan_.kernel_set == KernelSet::specialized; }

  /// Where a path keeps --path-bytes.
  std::string state_place() const {
    const bool in_blocks = is_on_gpu(Mode::wavefront) && plan_.finishes_in_blocks;
    if (plan_.mode == Mode::wavefront)
      return in_blocks ? "in the pool, then in the blocks' slots" : "in the pool";
    if (!is_on_gpu(Mode::megakernel)) return "beside the thread's path";
    return plan_.megakernel == MegakernelKind::loop   ? "in registers"
           : plan_.megakernel == MegakernelKind::vote ? "in shared memory"
                                                      : "in the blocks' slots";
  }

  bool is_on_gpu(Mode mode) const { return device_.is_cuda && plan_.mode == mode; }

  /// Whether a block-local wavefront fits into a block's shared memory.
  bool blocks_have_room() const { return device_.block_shared_bytes >= sorting_bytes_min; }

  void decide(const char* option, std::string value, std::string reason) {
    plan_.decisions.push_back({option, std::move(value), std::move(reason)});
  }

  void note_limits(const DeviceProperties& whole) {
    const DeviceLimits& limits = o_.limits;
    if (limits.sms > 0)
      decide("sms", std::to_string(limits.sms),
             fmt::format("asked for, of {} multiprocessors", whole.multiprocessors));
    if (limits.shared_memory_max > 0)
      decide("shared-memory-max", std::to_string(limits.shared_memory_max),
             fmt::format("asked for, of {} KiB", whole.block_shared_bytes / 1024));
  }

  /// The reason, with where the constants come from that it rests on.
  std::string by(std::initializer_list<PlanConstant> used, const std::string& reason) const {
    return reason + " (" + origin_of(c_, used) + ")";
  }

  void choose_mode() {
    std::string reason = asked;
    plan_.mode = o_.mode;
    if (o_.mode == Mode::automatic) std::tie(plan_.mode, reason) = faster_mode();
    decide("mode", to_string(plan_.mode), reason);
  }

  /// Fitted to sizes.csv: results/log/2026-11-sizes.md.
  std::pair<Mode, std::string> faster_mode() const {
    using enum Mode;
    if (o_.integrator == IntegratorKind::mlt) return {wavefront, "its slots follow chains"};
    if (traces_by_optix()) return {wavefront, "OptiX traces its queues"};
    if (!device_.is_cuda) {
      return by_ratio({&C::megakernel_cpu}, "threads that follow paths alone were faster",
                      "the CPU takes rays and surfaces in blocks");
    }
    if (is_specialized()) return faster_lean_mode();
    const bool sorts = automatic_megakernel().first == MegakernelKind::sort &&
                       scene_.instances == 0 && orders_pay();
    if (sorts && o_.max_depth > c_.short_depth_sorting) {
      return by_ratio({&C::megakernel_sorting, &C::short_depth_sorting},
                      "many kinds of BSDFs on long paths: blocks that sort were faster",
                      "many kinds of BSDFs on long paths: waves were faster");
    }
    const char *alone = "a megakernel was faster",
               *waves = "persistent warps or queues of rays were faster";
    return sorts ? by_ratio({&C::megakernel_mesh, &C::short_depth_sorting}, alone, waves)
                 : by_ratio({&C::megakernel_mesh}, alone, waves);
  }

  std::pair<Mode, std::string> faster_lean_mode() const {
    using enum Mode;
    if (scene_.quads == 0) {
      return by_ratio({&C::megakernel_spheres}, "spheres: a path is cheap to follow alone",
                      "spheres: waves were faster");
    }
    if (o_.max_depth <= c_.short_depth)
      return {wavefront, by({&C::short_depth}, "quads and short paths")};
    const double paths = double(o_.width) * o_.height * o_.spp;
    const auto reason = [&](const char* text) {
      return by({&C::short_depth, &C::few_paths_multiprocessor}, text);
    };
    const double few = c_.few_paths_multiprocessor * device_.multiprocessors;
    if (paths <= few) return {wavefront, reason("quads and few paths")};
    return {megakernel, reason("quads and many long paths")};
  }

  /// By the megakernel's time over the wavefront's, the first of the constants.
  std::pair<Mode, std::string> by_ratio(std::initializer_list<PlanConstant> used,
                                        const char* why_megakernel,
                                        const char* why_wavefront) const {
    const bool is_megakernel = c_.**used.begin() < 1;
    return {is_megakernel ? Mode::megakernel : Mode::wavefront,
            by(used, is_megakernel ? why_megakernel : why_wavefront)};
  }

  bool orders_pay() const { return order_pays_for(scene_.bsdf_kinds, c_.order_kinds); }

  void choose_kernels() {
    const std::string why = why_general(o_, scene_);
    plan_.kernel_set = why.empty() ? KernelSet::specialized : KernelSet::general;
    const bool is_given = o_.kernel_set != KernelSet::automatic;
    decide("kernel-set", to_string(plan_.kernel_set),
           is_given      ? asked
           : why.empty() ? "the paper's spheres, quads and materials, sampled as it does"
                         : why);
  }

  /// What is built, or will be whatever is chosen.
  std::optional<Accel> known_structure() const {
    if (scene_.structure) return scene_.structure;
    if (o_.accel == AccelKind::automatic) return std::nullopt;
    return accel_of(o_.accel);
  }

  void choose_megakernel() {
    MegakernelKind kind = o_.kernel;
    std::string reason = asked;
    if (kind == MegakernelKind::automatic) std::tie(kind, reason) = automatic_megakernel();
    plan_.megakernel = kind;
    decide("kernel", to_string(kind), reason);
  }

  std::pair<MegakernelKind, std::string> automatic_megakernel() const {
    using enum MegakernelKind;
    if (traces_by_optix()) return {loop, "in OptiX's ray generation program"};
    if (is_specialized()) return {loop, "spheres and quads alone: the paper's loop"};
    if (scene_.spheres > 0) return {loop, "the others trace triangles alone"};
    if (!knows_motion_in_wide_trees()) return {loop, motion_alone};
    if (!scene_.has_plain_instances()) return {loop, "the others know no masks among instances"};
    if (has_open_media()) return {loop, "the others know no boundaries without a BSDF"};
    if (o_.work != Work::persistent) return {loop, "--work " + to_string(o_.work)};
    if (known_structure().value_or(Accel::cwbvh) != Accel::cwbvh)
      return {loop, "the others trace wide trees"};
    if (o_.block == BlockSize{} && blocks_have_room())
      return {sort, "triangles: a wavefront in each block was the fastest"};
    if (scene_.instances > 0) return {loop, "phase voting knows no instances"};
    const std::int64_t threads = o_.block.threads();
    const bool may_vote = !scene_.has_masks && !scene_.has_media && !scene_.has_motion &&
                          threads % 32 == 0 && threads <= phase_voting_threads_max &&
                          phase_voting_bytes(threads, o_.path_bytes) <= device_.block_shared_bytes;
    const bool is_simple = std::has_single_bit(scene_.bsdf_kinds) || known_structure();
    if (may_vote && is_simple) return {vote, "triangles of few kinds of BSDFs, blocks of warps"};
    return {loop, "blocks or materials suit no other"};
  }

  void choose_structure() {
    if (scene_.structure) {
      plan_.accel = *scene_.structure, plan_.why_accel = scene_.why_structure;
    } else if (o_.accel != AccelKind::automatic) {
      plan_.accel = *known_structure(), plan_.why_accel = asked;
    } else {
      std::tie(plan_.accel, plan_.why_accel) =
          is_specialized() ? automatic_scan() : automatic_tree();
    }
    decide("accel", traces_by_optix() ? "optix" : accel_name(plan_.accel), plan_.why_accel);
    // Masks have no code by vectors.
    const bool by_vectors = !device_.is_cuda && device_.has_avx2 && !scene_.has_masked_kernels();
    plan_.traversal = plan_.accel == Accel::cwbvh && by_vectors ? Accel::cwbvh_avx2 : plan_.accel;
  }

  bool traces_by_optix() const { return o_.accel == AccelKind::optix; }

  /// Its structure is built beside our tree, which the features of first hits still walk.
  void choose_optix() {
    check_optix(o_, scene_, device_, plan_);
    const bool is_megakernel = plan_.mode == Mode::megakernel;
    const bool has_queues = compaction_info(o_.compaction).appends && !has_unbounded_media();
    if (!(is_megakernel || has_queues) || plan_.accel != Accel::cwbvh)
      throw Error(fmt::format(
          "--accel optix: scene '{}' has no kernel for it; OptiX traces appended queues "
          "(--compaction atomic), media without sparse grids whose boundaries have a "
          "BSDF, and wide trees",
          scene_.name));
    plan_.traces_by_optix = true;
    decide("optix-hits", to_string(plan_.optix_hits),
           plan_.optix_hits == OptixHits::built_in
               ? "OptiX decides: hits may differ from our trees'"
               : "our test decides: hits are our trees'");
    if (!is_megakernel) return;
    decide(
        "reorder", o_.reorder ? "on" : "off",
        std::string(o_.reorder ? asked : "not asked for") +
            (device_.can_reorder ? "" : "; this GPU reorders nothing: RTX GPUs do, from Ada on"));
  }

  /// The builder with which building and rendering end first. A tree is worth the more time the
  /// more rays are traced in it.
  void choose_builder() {
    if (scene_.builder) {
      plan_.builder = *scene_.builder;
      return decide("builder", to_string(plan_.builder), "as the scene is built");
    }
    if (o_.builder != TreeBuilder::automatic)
      return decide("builder", to_string(plan_.builder), asked);
    const TreeWork work{double(scene_.triangles + 2 * scene_.quads), double(scene_.tree_groups),
                        expected_rays(rendered_pixels(), o_, c_)};
    std::vector<TreeTimes> all = expected_tree_times(work, device_, double(o_.time_limit));
    if (scene_.has_moving_surfaces)
      std::erase_if(all, [](const TreeTimes& t) { return is_device_builder(t.builder); });
    const TreeTimes& first = *std::ranges::min_element(all, {}, &TreeTimes::total_s);
    plan_.builder = first.builder;
    std::string reason = fmt::format("expected {} to build, {} to render", seconds(first.build_s),
                                     seconds(first.trace_s));
    for (const TreeTimes& other : all) {
      if (other.builder != first.builder)
        reason += fmt::format("; {} {} + {}", to_string(other.builder), seconds(other.build_s),
                              seconds(other.trace_s));
    }
    decide("builder", to_string(first.builder),
           device_.is_cuda ? by({&C::ray_s_multiprocessor, &C::hploc_triangle_s, &C::sah_s}, reason)
                           : by({&C::ray_s_thread, &C::sah_s, &C::reinsert_s}, reason));
  }

  double rendered_pixels() const {
    const double image = double(o_.width) * o_.height;
    const double window =
        o_.crop ? double(o_.crop->x1 - o_.crop->x0) * (o_.crop->y1 - o_.crop->y0) : image;
    return window / o_.part.count;
  }

  static std::string seconds(double s) { return fmt::format("{:.{}f} s", s, s < 1 ? 3 : 1); }

  /// Whether testing every primitive is faster than walking a tree.
  std::pair<Accel, std::string> automatic_scan() const {
    if (device_.is_cuda && is_toggled(o_))
      return {Accel::brute, "--rng and --branching have kernels for it alone on CUDA"};
    const bool halves = device_.is_cuda && scene_.quads == 0;
    const PlanConstant most = !halves                         ? &C::scan_primitives
                              : plan_.mode == Mode::wavefront ? &C::scan_spheres_wavefront
                                                              : &C::scan_spheres_megakernel;
    const auto count = double(scene_.spheres + scene_.quads);
    return {count <= c_.*most ? Accel::brute : Accel::bvh2,
            by({most}, fmt::format("{:.0f} primitives: up to {:.0f} are scanned faster than a tree "
                                   "is walked",
                                   count, c_.*most))};
  }

  /// Persistent warps and AVX2 make the most of wide trees, with masks where rays are traced in
  /// blocks; for threads that follow rays alone binary ones are faster.
  std::pair<Accel, std::string> automatic_tree() const {
    const char* const alone = "rays are traced one by one, for which binary trees are faster";
    if (scene_.deforms) return {Accel::bvh2, "only binary trees know meshes that deform"};
    if (device_.is_cuda && !knows_motion_in_wide_trees()) return {Accel::bvh2, motion_alone};
    if (has_open_media()) return {Accel::bvh2, alone};
    if (is_on_gpu(Mode::megakernel)) {
      if (plan_.megakernel == MegakernelKind::loop) return {Accel::bvh2, alone};
      return {Accel::cwbvh, "what --kernel " + to_string(plan_.megakernel) + " traces"};
    }
    if (device_.is_cuda) {
      if (takes_wide_tree()) return {Accel::cwbvh, "persistent warps make the most of it"};
      return {Accel::bvh2, alone};
    }
    if (scene_.has_motion && scene_.has_masked_kernels()) return {Accel::bvh2, alone};
    const bool masks_in_blocks = plan_.mode == Mode::wavefront && scene_.instances == 0;
    const bool is_plain = !scene_.has_masks && !scene_.has_media;
    if (device_.has_avx2 && (is_plain || masks_in_blocks))
      return {Accel::cwbvh, "AVX2 tests eight children at once"};
    return {Accel::bvh2, alone};
  }

  static constexpr const char* motion_alone =
      "where meshes deform, or masks or media move, rays are traced one by one";

  /// Whether a GPU's kernels for wide trees know the scene's motion, if it has one.
  bool knows_motion_in_wide_trees() const {
    return !scene_.has_motion || (!scene_.deforms && !scene_.has_masked_kernels());
  }

  /// Whether warps could trace the wavefront's queues in a wide tree. Where they do not, threads
  /// walk it over triangles alone: over instances a binary one is twice as fast
  /// (results/log/2026-11-motion.md).
  bool takes_wide_tree() const {
    const bool is_plain =
        scene_.has_only_triangles() && !scene_.has_masks && !scene_.has_media && !scene_.has_motion;
    const bool by_warps = o_.persistent && o_.stages != Stages::fused;
    return warps_can_persist() && (by_warps || is_plain);
  }

  /// Media through which rays are traced one by one: a shadow ray goes on behind the first surface.
  /// Blocks on CUDA, which take the last paths, know no flights that pause and no sparse grids.
  bool has_open_media() const {
    const bool is_closed = scene_.has_only_triangles() && o_.stages != Stages::fused &&
                           (!device_.is_cuda || blocks_have_room());
    return has_unbounded_media() || (scene_.has_media && !is_closed);
  }

  /// Media whose rays nobody traces as a queue.
  bool has_unbounded_media() const {
    const bool is_bounded = !scene_.has_open_boundaries && o_.wave_collisions == 0 &&
                            !(device_.is_cuda && scene_.has_sparse);
    return scene_.has_media && !is_bounded;
  }

  bool warps_can_persist() const {
    return is_on_gpu(Mode::wavefront) && !is_specialized() &&
           compaction_info(o_.compaction).appends && scene_.spheres == 0 && !has_open_media() &&
           knows_motion_in_wide_trees() && scene_.has_plain_instances();
  }

  void choose_scene_memory() {
    plan_.scene_memory = o_.scene_memory;
    std::string reason = asked;
    if (plan_.scene_memory == SceneMemory::automatic) {
      const double most = c_.constant_spheres;
      const bool fits = double(scene_.spheres) <= most;
      const bool is_scan = plan_.accel == Accel::brute && scans_in_one_kernel();
      const bool is_constant = fits && !is_toggled(o_) && is_scan;
      plan_.scene_memory = is_constant ? SceneMemory::constant : SceneMemory::global;
      const auto fitted = [&](const std::string& text) { return by({&C::constant_spheres}, text); };
      reason = is_constant
                   ? fitted(fmt::format("{} spheres, up to {:.0f} are scanned fastest there",
                                        scene_.spheres, most))
               : fits ? "constant memory is for plain scans"
                      : fitted(fmt::format("more than {:.0f} spheres", most));
    }
    decide("scene-memory", to_string(plan_.scene_memory), reason);
  }

  /// Rays that are traced by stages of their own find the spheres in global memory.
  bool scans_in_one_kernel() const { return plan_.mode == Mode::megakernel || plan_.fused; }

  void choose_waves() {
    if (device_.is_cuda) choose_persistence();
    choose_surface_order();
    choose_finish();
    choose_pool();
    if (!device_.is_cuda) return;
    plan_.uses_graph = o_.schedule != Schedule::host && !plan_.traces_by_optix;
    decide("schedule", plan_.uses_graph ? "graph" : "host",
           o_.schedule != Schedule::automatic ? asked
           : plan_.traces_by_optix            ? "a launch of OptiX is not recorded in a graph"
                                              : "no round trip to the host between waves");
  }

  void choose_stages() {
    const bool is_possible =
        o_.branching == Branching::divergent && o_.order_surfaces != SurfaceOrdering::on;
    const bool is_cheap = is_specialized() && plan_.accel == Accel::brute;
    std::string reason = asked;
    plan_.fused = o_.stages == Stages::fused;
    if (o_.stages == Stages::automatic) {
      plan_.fused = is_possible && is_cheap && !device_.has_ray_blocks;
      reason = plan_.fused       ? "one scan a ray and few BSDFs: saves the hits' bytes"
               : !is_possible    ? "--branching and --order-surfaces apply to split stages"
               : device_.is_cuda ? "threads of one kernel would wait for each other"
               : is_cheap        ? "stages take blocks of rays, which save more"
                                 : "tracing and shading are expensive: stages take blocks of paths";
    }
    decide("stages", plan_.fused ? "fused" : "split", reason);
  }

  void choose_persistence() {
    const bool can = (plan_.traces_by_optix || warps_can_persist()) &&
                     plan_.accel == Accel::cwbvh && !plan_.fused;
    plan_.persistent_warps = o_.persistent && can;
    decide("persistent", plan_.persistent_warps ? "on" : "off",
           plan_.traces_by_optix    ? "whole queues of rays, by OptiX"
           : plan_.persistent_warps ? "triangles in a wide tree, appended queues"
           : can                    ? asked
                                    : "for wide trees of triangles and appended queues alone");
  }

  void choose_surface_order() {
    if (plan_.fused) return;
    const bool has_queues = compaction_info(o_.compaction).has_queues;
    const bool pays = device_.is_cuda && !is_specialized() && orders_pay();
    const bool is_free = o_.order_surfaces == SurfaceOrdering::automatic;
    const bool wanted = is_free ? pays : o_.order_surfaces == SurfaceOrdering::on;
    plan_.orders_surfaces = has_queues && wanted;
    const int kinds = std::popcount(scene_.bsdf_kinds);
    decide("order-surfaces", plan_.orders_surfaces ? "on" : "off",
           !is_free           ? asked
           : !has_queues      ? "there is no queue"
           : !device_.is_cuda ? "threads of a CPU do not run in warps"
                              : by({&C::order_kinds}, fmt::format("{} kind{} of BSDFs", kinds,
                                                                  kinds == 1 ? "" : "s")));
  }

  /// A wave costs some 0.1 ms however few rays it has. A thread that follows a path waits for the
  /// slowest of its warp, in each ray and in shading of several kinds: so the more the rays of a
  /// scene and its kinds of BSDFs differ, the fewer paths are finished that way. Blocks sort
  /// theirs, and are faster than waves as long as they have room for all.
  void choose_finish() {
    if (plan_.traces_by_optix)
      return decide("finish-paths", "0", "only waves have their rays traced by OptiX");
    plan_.finishes_in_blocks = can_finish_in_blocks();
    if (o_.finish_paths) {
      plan_.finish_paths = *o_.finish_paths;
      return decide("finish-paths", std::to_string(plan_.finish_paths), asked);
    }
    const bool is_expensive = scene_.instances > 0 || orders_pay();
    const auto [paths, reason] =
        is_specialized() ? std::pair(&C::finish_lean, "a path is cheap to follow alone")
        : plan_.finishes_in_blocks
            ? std::pair(&C::finish_blocks, "block-local wavefronts follow them")
        : is_expensive ? std::pair(&C::finish_expensive,
                                   "instances or many kinds of BSDFs: a path alone is expensive")
                       : std::pair(&C::finish_plain, "triangles");
    plan_.finish_paths = static_cast<std::uint32_t>(c_.*paths);
    decide("finish-paths", std::to_string(plan_.finish_paths), by({paths}, reason));
  }

  /// Where the kernel of --kernel sort knows all that the scene has.
  bool can_finish_in_blocks() const {
    return plan_.persistent_warps && o_.integrator == IntegratorKind::path && blocks_have_room();
  }

  void choose_pool() {
    const bool appends = compaction_info(o_.compaction).appends;
    const double fitting = !device_.is_cuda ? c_.pool_thread * device_.threads
                           : appends        ? 0
                                            : c_.pool_passes;
    plan_.pool_paths_max = o_.pool_size > 0 ? o_.pool_size : static_cast<std::uint64_t>(fitting);
    decide("pool-size",
           plan_.pool_paths_max == 0 ? "the whole batch" : std::to_string(plan_.pool_paths_max),
           o_.pool_size > 0   ? asked
           : !device_.is_cuda ? by({&C::pool_thread}, "fits the caches of each thread")
           : appends          ? "no slot is used twice, so neighbours stay neighbouring pixels"
                              : by({&C::pool_passes}, "a pass over all tags fits the L2 cache"));
  }

  void choose_lights() {
    using enum LightSelection;
    const bool is_given = o_.light_selection != automatic;
    const auto emitters = static_cast<double>(scene_.emitters);
    plan_.light_selection = is_given                     ? o_.light_selection
                            : emitters > c_.few_emitters ? tree
                                                         : power;
    if (!o_.nee) return;
    decide("light-selection", to_string(plan_.light_selection),
           is_given ? asked
                    : by({&C::few_emitters},
                         fmt::format("{:.0f} light{}; a light tree pays off from {:.0f} lights on",
                                     emitters, emitters == 1 ? "" : "s", c_.few_emitters + 1)));
  }

  const Options& o_;
  const SceneProperties& scene_;
  const DeviceProperties device_;  ///< within the limits
  const PlanConstants& c_ = device_.constants;
  ExecutionPlan plan_;
};

}  // namespace

bool order_pays_for(std::uint32_t bsdf_kinds, double few) {
  constexpr std::uint32_t one = 1, long_ones = one << static_cast<int>(kind_of<Principled>) |
                                               one << static_cast<int>(kind_of<PrincipledThin>);
  return std::popcount(bsdf_kinds) > ((bsdf_kinds & long_ones) != 0 ? std::min(few, 1.0) : few);
}

std::string why_general(const Options& o, const SceneProperties& scene) {
  if (!scene.is_primitive_only) return "the scene has more than the paper's spheres and quads";
  if (o.kernel_set == KernelSet::general) return "--kernel-set general";
  if (o.sampling != DirectionSampling::bsdf) return "--sampling " + to_string(o.sampling);
  if (o.mis != MisHeuristic::power) return "--mis " + to_string(o.mis);
  if (o.sampler != SamplerKind::independent) return "--sampler " + to_string(o.sampler);
  if (o.integrator == IntegratorKind::mlt) return "--integrator mlt";
  if (o.accel == AccelKind::optix) return "--accel optix";
  return "";
}

ExecutionPlan plan_execution(const Options& options, const SceneProperties& scene,
                             const DeviceProperties& device) {
  return Planner(options, scene, device).plan();
}

std::string plan_text(const std::vector<Decision>& decisions) {
  std::size_t option_width = 0, value_width = 0;
  for (const Decision& d : decisions) {
    option_width = std::max(option_width, d.option.size());
    value_width = std::max(value_width, d.value.size());
  }
  std::string text;
  for (const Decision& d : decisions) {
    text += fmt::format("--{:<{}}  {:<{}}  {}\n", d.option, option_width, d.value, value_width,
                        d.reason);
  }
  return text;
}

DeviceProperties cpu_properties(int threads) {
  DeviceProperties cpu;
  cpu.has_avx2 = has_avx2();
  cpu.has_ray_blocks = brute_block() != nullptr;
  cpu.threads = cpu.host_threads = threads;
  return cpu;
}

}  // namespace pt
