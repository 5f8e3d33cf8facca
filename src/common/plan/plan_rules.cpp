#include <fmt/format.h>

#include "common/accel/build/build_triangle_tree.h"
#include "common/error/error.h"
#include "common/options/option_names.h"
#include "common/plan/kernels.h"
#include "common/plan/plan_steps.h"

namespace pt {
namespace {

/// The option's value, if it is one that not every scene takes; else empty.
using Limited = std::string (*)(const Options&);

using Suits = bool (*)(const SceneProperties&, const Options&);

struct SceneRule {
  const char* option;
  Limited limited;
  Suits suits;          ///< which scenes it is for
  const char* problem;  ///< elsewhere; {}: the scene's name
};

template <class E, class... Usual>
std::string unless(E value, Usual... usual) {
  return ((value == usual) || ...) ? "" : to_string(value);
}

bool has_specialized_kernels(const SceneProperties& scene, const Options& o) {
  return why_general(o, scene).empty();
}

bool is_general(const SceneProperties& scene, const Options& o) {
  return !has_specialized_kernels(scene, o);
}

bool has_rough_conductors(const SceneProperties& scene, const Options&) {
  return scene.has_rough_conductors;
}

bool has_media(const SceneProperties& scene, const Options&) { return scene.has_media; }

/// What stands in no rule is for every scene.
constexpr SceneRule rules[] = {
    {"builder", [](const Options& o) { return unless(o.builder, TreeBuilder::automatic); },
     is_general, "builds trees over triangles; scene '{}' has none"},
    {"light-selection",
     [](const Options& o) {
       return unless(o.light_selection, LightSelection::automatic, LightSelection::uniform);
     },
     is_general,
     "needs triangles, textures, an environment or lights without extent; scene '{}' has spheres "
     "and quads only, expected uniform"},
    {"wave-collisions",
     [](const Options& o) {
       return o.wave_collisions == 0 ? std::string() : std::to_string(o.wave_collisions);
     },
     has_media, "counts what free flights in media meet; scene '{}' has no media, expected 0"},
    {"multiple-scattering",
     [](const Options& o) { return std::string(o.multiple_scattering ? "on" : ""); },
     has_rough_conductors, "makes up for what rough conductors lose; scene '{}' has none"},
};

EnumSet<Content> contents_of(const SceneProperties& scene) {
  EnumSet<Content> contents;
  if (scene.spheres > 0) contents = contents | Content::spheres;
  if (scene.instances > 0) contents = contents | Content::instances;
  if (scene.has_open_boundaries) contents = contents | Content::open_boundaries;
  if (scene.deforms) contents = contents | Content::deforming;
  return contents;
}

KernelBody body_of(const ExecutionPlan& plan, bool on_cuda) {
  using enum KernelBody;
  switch (plan.mode) {
    case Mode::serial:
      return serial;
    case Mode::megakernel:
      if (plan.traces_by_optix) return optix;
      return !on_cuda || plan.megakernel == MegakernelKind::loop ? loop
             : plan.megakernel == MegakernelKind::vote           ? vote
                                                                 : blocks;
    default:
      if (plan.traces_by_optix) return queues;
      return plan.fused ? fused : plan.persistent_warps ? warps : stages;
  }
}

EnumSet<KernelChoice> asked_choices(const Options& o) {
  EnumSet<KernelChoice> asked{KernelChoice::branching, KernelChoice::rng, KernelChoice::path_bytes};
  if (o.accel != AccelKind::automatic) asked = asked | KernelChoice::accel;
  if (o.scene_memory != SceneMemory::automatic) asked = asked | KernelChoice::memory;
  if (o.kernel != MegakernelKind::automatic || o.stages != Stages::automatic)
    asked = asked | KernelChoice::body;
  return asked;
}

/// "triangles, masks": what decides which kernels a scene has, besides what is refused.
std::string scene_text(const KernelNeed& need, const Options& o, const SceneProperties& scene,
                       const std::string& refused) {
  const bool is_specialized = need.scene.geometry == Geometry::spheres_and_quads;
  if (!is_specialized && scene.is_primitive_only)
    return "spheres and quads by general kernels, because of " + why_general(o, scene);
  std::string text = is_specialized ? "spheres and quads" : "triangles";
  const std::pair<bool, std::string> more[] = {
      {is_specialized && scene.has_emitters, "emitters"},
      {!is_specialized && scene.spheres > 0, "spheres"},
      {scene.instances > 0, "instances"},
      {scene.has_motion, "motion"},
      {scene.deforms, "deforming meshes"},
      {scene.has_masks, "masks, a far plane or hidden emitters"},
      {scene.has_media, "media"},
      {need.on_cuda && scene.has_sparse, "sparse grids"},
      {scene.has_open_boundaries, "boundaries without a BSDF"},
      {o.branching == Branching::reduced, "--branching reduced"},
      {o.rng == RngKind::xorwow, "--rng xorwow"}};
  for (const auto& [has, name] : more)
    if (has && refused.find(name) == std::string::npos) text += ", " + name;
  return text;
}

/// Everything that is to run has a row in the table of kernels.
void check_kernels(const ExecutionPlan& plan, const Options& o, const SceneProperties& scene,
                   bool on_cuda) {
  std::vector<KernelNeed> needs{need_of(plan, o, scene, on_cuda)};
  if (plan.mode == Mode::wavefront && plan.finish_paths > 0 &&
      o.integrator == IntegratorKind::path) {
    KernelNeed& last = needs.emplace_back(needs.front());
    last.bodies = plan.finishes_in_blocks ? KernelBody::blocks : KernelBody::fused;
    last.branching = Branching::divergent, last.memory = SceneMemory::global;
  }
  for (const KernelNeed& need : needs) {
    if (has_kernel(need)) continue;
    const auto [refused, expected] = nearest_kernel(need, asked_choices(o));
    throw Error(fmt::format("{}: no kernel on {} renders scene '{}' ({}) so; expected {}", refused,
                            on_cuda ? "CUDA" : "the CPU", scene.name,
                            scene_text(need, o, scene, refused), expected));
  }
}

/// Paths that carry more on CUDA have kernels of their own.
void check_path_bytes(const ExecutionPlan& plan) {
  if (plan.path_bytes == 0) return;
  const auto refuse = [&](const char* why) {
    throw Error(fmt::format("--path-bytes {}: {}", plan.path_bytes, why));
  };
  if (!has_carrying_kernels)
    refuse(
        "this build has no kernels on CUDA for it; expected 0, or a build with "
        "-DPTEXP_PATH_STATE=ON");
  if (plan.kernel_set == KernelSet::specialized)
    refuse(
        "on CUDA the lean kernels of spheres and quads know none; expected --kernel-set general");
}

void check_scene_memory(const ExecutionPlan& plan, const SceneProperties& scene,
                        const DeviceProperties& device) {
  if (plan.scene_memory == SceneMemory::global) return;
  if (plan.scene_memory == SceneMemory::constant && scene.spheres > constant_spheres_max)
    throw Error(
        fmt::format("--scene-memory constant: the scene has {} spheres; a kernel's "
                    "parameters hold at most {}",
                    scene.spheres, constant_spheres_max));
  constexpr std::size_t own_shared_bytes = 2048;  // what a kernel needs besides, at most
  if (plan.scene_memory == SceneMemory::shared &&
      scene.scan_bytes + own_shared_bytes > device.block_shared_bytes)
    throw Error(
        fmt::format("--scene-memory shared: the scene's {} spheres take {} bytes; a block "
                    "of this device has at most {}",
                    scene.spheres, scene.scan_bytes, device.block_shared_bytes));
}

void check_megakernel(const ExecutionPlan& plan, const Options& o, const DeviceProperties& device) {
  const std::int64_t threads = o.block.threads();
  if (threads > device.block_threads_max)
    throw Error(fmt::format("--block {}x{}: {} threads; a block has at most {}", o.block.x,
                            o.block.y, threads, device.block_threads_max));
  const bool persists = plan.accel == Accel::cwbvh && o.work == Work::persistent;
  if (plan.megakernel == MegakernelKind::vote &&
      !(persists && threads % 32 == 0 && threads <= phase_voting_threads_max))
    throw Error(
        fmt::format("--kernel vote: expected --accel cwbvh, --work persistent and a --block of 32 "
                    "to {} threads, a multiple of 32; {}x{} has {}",
                    phase_voting_threads_max, o.block.x, o.block.y, threads));
  const std::size_t voting_bytes = phase_voting_bytes(threads, plan.path_bytes);
  if (plan.megakernel == MegakernelKind::vote && voting_bytes > device.block_shared_bytes)
    throw Error(fmt::format(
        "--kernel vote: a block of {} threads, with --path-bytes {}, needs {} KiB of shared "
        "memory; "
        "one of this device has at most {}",
        threads, plan.path_bytes, voting_bytes / 1024, device.block_shared_bytes / 1024));
  if (plan.megakernel == MegakernelKind::sort &&
      !(persists && device.block_shared_bytes >= sorting_bytes_min))
    throw Error(
        fmt::format("--kernel sort: expected --accel cwbvh, --work persistent and a device whose "
                    "blocks may have {} KiB of shared memory",
                    sorting_bytes_min / 1024));
}

}  // namespace

KernelNeed need_of(const ExecutionPlan& plan, const Options& o, const SceneProperties& scene,
                   bool on_cuda) {
  KernelNeed need;
  need.on_cuda = on_cuda;
  need.bodies = body_of(plan, on_cuda);
  need.contents = contents_of(scene);
  need.branching = o.branching;
  need.extra = ExtraRecords{o.path_bytes / path_bytes_step};
  if (plan.kernel_set == KernelSet::specialized) {
    need.scene = {plan.traversal, Geometry::spheres_and_quads,
                  scene.has_emitters ? Lighting::emitters : Lighting::sky};
    need.sources = o.rng == RngKind::philox ? NumberSource::philox : NumberSource::xorwow;
    if (on_cuda) need.memory = plan.scene_memory;
  } else {
    need.scene = general_traits(plan.traversal, need.contents, scene.has_masks, scene.has_media,
                                on_cuda && looks_up_sparse_grids(scene), scene.has_motion);
    need.sources = o.rng == RngKind::philox ? NumberSource::sampler : NumberSource::xorwow;
    if (o.scene_memory != SceneMemory::automatic) need.memory = o.scene_memory;
  }
  return need;
}

DeviceProperties limit_device(DeviceProperties device, const DeviceLimits& limits) {
  if (!device.is_cuda) return device;
  if (limits.sms > device.multiprocessors)
    throw Error(fmt::format("--sms {}: the GPU has {} multiprocessors; expected at most as many",
                            limits.sms, device.multiprocessors));
  const std::size_t shared_kib = device.block_shared_bytes / 1024;
  const auto shared_max = static_cast<std::size_t>(limits.shared_memory_max);
  if (shared_max > shared_kib)
    throw Error(fmt::format("--shared-memory-max {}: a block of this GPU has at most {} KiB",
                            shared_max, shared_kib));
  if (limits.sms > 0) device.multiprocessors = limits.sms;
  if (shared_max > 0) device.block_shared_bytes = shared_max * 1024;
  return device;
}

void check_options_for_scene(const Options& options, const SceneProperties& scene) {
  const std::string why = why_general(options, scene);
  if (options.kernel_set == KernelSet::specialized && !why.empty())
    throw Error(fmt::format("--kernel-set lean: not here, {}; expected auto or general", why));
  if (options.counters && options.integrator == IntegratorKind::mlt)
    throw Error(
        "--counters with --integrator mlt: they are read of a path tracer's batch; expected path");
  if (options.path_bytes > 0 && options.integrator == IntegratorKind::mlt)
    throw Error(
        fmt::format("--path-bytes {}: paths of --integrator mlt carry no more state; expected path",
                    options.path_bytes));
  for (const SceneRule& rule : rules) {
    const std::string value = rule.limited(options);
    if (value.empty() || rule.suits(scene, options)) continue;
    throw Error(fmt::format("--{} {}: {}", rule.option, value,
                            fmt::format(fmt::runtime(rule.problem), scene.name)));
  }
}

std::string motion_obstacle(const Options& o, const SceneProperties& scene, bool on_cuda) {
  if (!scene.has_motion) return "";
  if (on_cuda && scene.has_moving_surfaces && is_device_builder(o.builder))
    return fmt::format(
        "--builder {} fits no tree to a motion; expected auto, sah, sah-reinsert, sbvh or best",
        to_string(o.builder));
  if (o.integrator == IntegratorKind::mlt)
    return "--integrator mlt knows no motion blur; expected --integrator path";
  if (scene.has_moving_grids)
    return "a grid of a medium does not move with the medium's boundary; expected a homogeneous "
           "medium, or a boundary that stands";
  return "";
}

void check_motion(const Options& o, const SceneProperties& scene, const DeviceProperties& device) {
  const std::string why = motion_obstacle(o, scene, device.is_cuda);
  if (!why.empty())
    throw Error(fmt::format("scene '{}' moves while the shutter is open: {}", scene.name, why));
}

void check_optix(const Options& o, const SceneProperties& scene, const DeviceProperties& device,
                 const ExecutionPlan& plan) {
  const auto refuse = [](const std::string& option, const std::string& why) {
    throw Error(fmt::format("--accel optix: {}; {}", why, option));
  };
  if (!device.is_cuda) refuse("expected --device cuda", "OptiX runs on NVIDIA's GPUs");
  if (scene.has_motion)
    refuse(fmt::format("scene '{}' moves", scene.name), "OptiX traces what stands still");
  if (o.optix_hits == OptixHits::built_in && scene.has_masks)
    refuse("expected --optix-hits custom or any-hit", "only our programs judge masks");
  if (o.counters) refuse("expected no --counters", "OptiX's kernels are not counted");
  if (plan.mode == Mode::megakernel) {
    if (scene.has_media)
      refuse(fmt::format("scene '{}' has some, expected --mode wavefront", scene.name),
             "its megakernel knows no media");
    if (plan.megakernel != MegakernelKind::loop)
      refuse("expected --kernel loop, not " + to_string(plan.megakernel),
             "its threads follow their paths");
    if (!(o.block == BlockSize{})) refuse("expected no --block", "OptiX chooses its blocks");
    return;
  }
  if (o.stages == Stages::fused) refuse("expected --stages split", "fused stages have no queue");
  if (!o.persistent) refuse("expected --persistent on", "whole queues are traced");
  if (o.schedule == Schedule::graph)
    refuse("expected --schedule host", "a launch of OptiX is not recorded in a graph");
  if (o.finish_paths.value_or(0) > 0)
    refuse("expected --finish-paths 0", "only waves have their rays traced by OptiX");
}

void check_plan(const ExecutionPlan& plan, const Options& options, const SceneProperties& scene,
                const DeviceProperties& device) {
  check_builder(options.builder, accel_kind_of(plan.accel), device.is_cuda);
  if (device.is_cuda) check_path_bytes(plan);
  check_kernels(plan, options, scene, device.is_cuda);
  if (!device.is_cuda) return;
  check_scene_memory(plan, scene, device);
  if (plan.mode == Mode::megakernel) check_megakernel(plan, options, device);
}

}  // namespace pt
