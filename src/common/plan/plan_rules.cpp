#include "common/plan/plan_rules.h"

#include <fmt/format.h>

#include "common/accel/build/check_builder.h"
#include "common/error/error.h"
#include "common/options/option_names.h"

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

bool has_triangles_alone(const SceneProperties& scene, const Options& o) {
  return is_general(scene, o) && scene.spheres == 0 && scene.has_plain_instances() &&
         !scene.has_open_boundaries;
}

bool has_plain_triangles_alone(const SceneProperties& scene, const Options& o) {
  return has_triangles_alone(scene, o) && scene.instances == 0 && !scene.has_masks &&
         !scene.has_media;
}

bool has_rough_conductors(const SceneProperties& scene, const Options&) {
  return scene.has_rough_conductors;
}

bool has_media(const SceneProperties& scene, const Options&) { return scene.has_media; }

constexpr const char* paper =
    "is for scenes of spheres and quads alone, with --sampling bsdf, --mis power, --sampler "
    "independent, --integrator path and not --kernel-set general; expected such a scene instead of "
    "'{}', or other options";

/// What stands in no rule is for every scene.
constexpr SceneRule rules[] = {
    {"accel",
     [](const Options& o) {
       return unless(o.accel, AccelKind::automatic, AccelKind::brute, AccelKind::bvh2);
     },
     is_general, "holds triangles; scene '{}' has spheres and quads only, expected brute or bvh2"},
    {"builder", [](const Options& o) { return unless(o.builder, TreeBuilder::automatic); },
     is_general, "builds trees over triangles; scene '{}' has none"},
    {"kernel",
     [](const Options& o) {
       return unless(o.kernel, MegakernelKind::automatic, MegakernelKind::loop,
                     MegakernelKind::sort);
     },
     has_plain_triangles_alone,
     "traces triangles alone; scene '{}' has spheres, instances, masks, media, a far plane, hidden "
     "emitters or no triangles, expected auto or loop"},
    {"kernel",
     [](const Options& o) {
       return unless(o.kernel, MegakernelKind::automatic, MegakernelKind::loop,
                     MegakernelKind::vote);
     },
     has_triangles_alone,
     "traces triangles and their instances alone; scene '{}' has spheres, masks or media among "
     "instances, boundaries without a BSDF or no triangles, expected auto or loop"},
    {"light-selection",
     [](const Options& o) {
       return unless(o.light_selection, LightSelection::automatic, LightSelection::uniform);
     },
     is_general,
     "needs triangles, textures, an environment or lights without extent; scene '{}' has spheres "
     "and quads only, expected uniform"},
    {"scene-memory",
     [](const Options& o) {
       return unless(o.scene_memory, SceneMemory::automatic, SceneMemory::global);
     },
     has_specialized_kernels,
     "holds the spheres of scenes without triangles; expected global or auto"},
    {"branching", [](const Options& o) { return unless(o.branching, Branching::divergent); },
     has_specialized_kernels, paper},
    {"rng", [](const Options& o) { return unless(o.rng, RngKind::philox); },
     has_specialized_kernels, paper},
    {"wave-collisions",
     [](const Options& o) {
       return o.wave_collisions == 0 ? std::string() : std::to_string(o.wave_collisions);
     },
     has_media, "counts what free flights in media meet; scene '{}' has no media, expected 0"},
    {"multiple-scattering",
     [](const Options& o) { return std::string(o.multiple_scattering ? "on" : ""); },
     has_rough_conductors, "makes up for what rough conductors lose; scene '{}' has none"},
};

/// On CUDA the paper's toggles each have kernels alone, and for its scene, spheres that are scanned
/// under the sky: no experiment combines them, and together they would be as many kernels as all
/// others.
void check_toggles(const ExecutionPlan& plan, const Options& o, const SceneProperties& scene) {
  if (!is_toggled(o)) return;
  const std::string toggle = o.rng != RngKind::philox ? "--rng " + to_string(o.rng)
                                                      : "--branching " + to_string(o.branching);
  const auto refuse = [&](const std::string& other, const char* expected) {
    throw Error(fmt::format("{}: on CUDA not with {}; expected {}", toggle, other, expected));
  };
  if (plan.accel != Accel::brute) refuse("--accel bvh2", "brute or auto");
  if (scene.has_emitters)
    refuse("surfaces that shine, as scene '" + scene.name + "' has", "a scene without");
  if (o.rng != RngKind::philox && o.branching != Branching::divergent)
    refuse("--branching reduced", "divergent");
  if (plan.scene_memory != SceneMemory::global)
    refuse("--scene-memory " + to_string(plan.scene_memory), "global or auto");
}

void check_scene_memory(const ExecutionPlan& plan, const SceneProperties& scene,
                        const DeviceProperties& device) {
  if (plan.scene_memory == SceneMemory::global) return;
  const std::string memory = to_string(plan.scene_memory);
  if (plan.accel != Accel::brute || (plan.mode == Mode::wavefront && !plan.fused))
    throw Error(
        fmt::format("--scene-memory {}: for kernels that scan the spheres and shade; expected "
                    "--accel brute, and --stages fused in waves, or global memory",
                    memory));
  if (plan.scene_memory == SceneMemory::shared && scene.has_emitters)
    throw Error(
        fmt::format("--scene-memory shared: has kernels for spheres under the sky alone; scene "
                    "'{}' has surfaces that shine, expected constant or global",
                    scene.name));
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

/// What has no kernel because it would win nowhere.
void check_structure(const ExecutionPlan& plan, const SceneProperties& scene) {
  if (plan.kernel_set != KernelSet::general) return;
  if (plan.accel == Accel::brute)
    throw Error(
        "--accel brute: on CUDA by lean kernels alone (--kernel-set); expected bvh2 or "
        "cwbvh");
  const bool is_plain = scene.has_only_triangles() && !scene.has_masked_kernels();
  if (plan.accel != Accel::cwbvh || is_plain) return;
  const bool in_blocks = plan.megakernel == MegakernelKind::sort || plan.persistent_warps;
  if (scene.has_media && (scene.has_open_boundaries || !scene.has_only_triangles() || !in_blocks))
    throw Error(
        fmt::format("--accel cwbvh: with media for triangles alone whose boundaries have BSDFs, by "
                    "--kernel sort or persistent warps without --wave-collisions, on CUDA; not for "
                    "scene '{}', expected bvh2 "
                    "or auto",
                    scene.name));
  if (plan.mode == Mode::megakernel && plan.megakernel == MegakernelKind::loop)
    throw Error(
        fmt::format("--accel cwbvh: the megakernel's loop traces triangles alone in it on CUDA; "
                    "scene '{}' has more, expected bvh2 or auto",
                    scene.name));
  if (plan.mode == Mode::wavefront && !plan.persistent_warps && !plan.fused)
    throw Error(
        fmt::format("--accel cwbvh: threads trace triangles alone in it on CUDA; scene '{}' has "
                    "more, expected bvh2 or auto, or persistent warps",
                    scene.name));
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
  if (plan.megakernel == MegakernelKind::sort &&
      !(persists && device.block_shared_bytes >= sorting_bytes_min))
    throw Error(
        fmt::format("--kernel sort: expected --accel cwbvh, --work persistent and a device whose "
                    "blocks may have {} KiB of shared memory",
                    sorting_bytes_min / 1024));
}

}  // namespace

void check_options_for_scene(const Options& options, const SceneProperties& scene) {
  const std::string why = why_general(options, scene);
  if (options.kernel_set == KernelSet::specialized && !why.empty())
    throw Error(fmt::format("--kernel-set lean: not here, {}; expected auto or general", why));
  for (const SceneRule& rule : rules) {
    const std::string value = rule.limited(options);
    if (value.empty() || rule.suits(scene, options)) continue;
    throw Error(fmt::format("--{} {}: {}", rule.option, value,
                            fmt::format(fmt::runtime(rule.problem), scene.name)));
  }
}

void check_plan(const ExecutionPlan& plan, const Options& options, const SceneProperties& scene,
                const DeviceProperties& device) {
  if (plan.accel == Accel::embree && scene.has_masked_kernels())
    throw Error(
        fmt::format("--accel embree: scene '{}' has masks, media, a far plane or hidden emitters; "
                    "expected brute, bvh2 or cwbvh",
                    scene.name));
  check_builder(options.builder, accel_kind_of(plan.accel), device.is_cuda);
  if (!device.is_cuda) return;
  check_toggles(plan, options, scene);
  check_structure(plan, scene);
  check_scene_memory(plan, scene, device);
  if (plan.mode == Mode::megakernel) check_megakernel(plan, options, device);
}

}  // namespace pt
