#include "common/scene/scene_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "common/error.h"
#include "common/render/option_names.h"
#include "common/scene/prepare_materials.h"

namespace pt {
namespace {

/// The option's value, if it is one that not every scene takes; else empty.
using Limited = std::string (*)(const Options&);

using Suits = bool (*)(const SceneData&, const Options&);

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

bool has_triangles(const SceneData& scene, const Options& o) {
  return !has_specialized_kernels(scene, o);
}

bool has_triangles_alone(const SceneData& scene, const Options& o) {
  return !has_specialized_kernels(scene, o) && scene.spheres.empty() && scene.instances.empty() &&
         !is_limited(scene.camera);
}

bool has_plain_triangles_alone(const SceneData& scene, const Options& o) {
  return has_triangles_alone(scene, o) &&
         std::ranges::all_of(scene.materials,
                             [](const MaterialDescription& m) { return m.opacity.is_opaque(); });
}

bool has_rough_conductors(const SceneData& scene, const Options&) {
  return std::ranges::any_of(scene.materials, is_rough_conductor);
}

constexpr const char* paper =
    "is for scenes of spheres and quads alone, with --sampling bsdf, --mis power, --sampler "
    "independent, --integrator path and not --shade material; expected such a scene instead of "
    "'{}', or other options";

/// The whole policy. What stands in no rule is for every scene.
constexpr SceneRule rules[] = {
    {"accel",
     [](const Options& o) {
       return unless(o.accel, AccelKind::automatic, AccelKind::brute, AccelKind::bvh2);
     },
     has_triangles,
     "holds triangles; scene '{}' has spheres and quads only, expected brute or bvh2"},
    {"builder", [](const Options& o) { return unless(o.builder, TreeBuilder::automatic); },
     has_triangles, "builds trees over triangles; scene '{}' has none"},
    {"kernel",
     [](const Options& o) {
       return unless(o.kernel, MegakernelKind::automatic, MegakernelKind::loop,
                     MegakernelKind::sort);
     },
     has_plain_triangles_alone,
     "traces triangles alone; scene '{}' has spheres, instances, masks, clip planes, hidden "
     "emitters or no triangles, expected auto or loop"},
    {"kernel",
     [](const Options& o) {
       return unless(o.kernel, MegakernelKind::automatic, MegakernelKind::loop,
                     MegakernelKind::vote);
     },
     has_triangles_alone,
     "traces triangles alone; scene '{}' has spheres, instances, clip planes, hidden emitters or "
     "no triangles, expected auto or loop"},
    {"light-selection",
     [](const Options& o) {
       return unless(o.light_selection, LightSelection::automatic, LightSelection::uniform);
     },
     has_triangles,
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
    {"multiple-scattering",
     [](const Options& o) { return std::string(o.multiple_scattering ? "on" : ""); },
     has_rough_conductors, "makes up for what rough conductors lose; scene '{}' has none"},
};

/// Kernels without triangles know the paper's materials alone, which have no back.
bool needs_triangles(const MaterialDescription& material) {
  const bool has_black_back = material.one_sided && !is_black(material.parameters[0].value);
  return has_black_back || material.node != MaterialNode::none || !material.opacity.is_opaque() ||
         static_cast<int>(material.kind) >= PaperBsdfs::size;
}

}  // namespace

bool has_specialized_kernels(const SceneData& scene, const Options& o) {
  return has_primitives_only(scene) && o.sampling == DirectionSampling::bsdf &&
         o.mis == MisHeuristic::power && o.sampler == SamplerKind::independent &&
         o.shade != Shade::material && o.integrator != IntegratorKind::mlt;
}

bool has_primitives_only(const SceneData& scene) {
  return !is_limited(scene.camera) && scene.meshes.empty() && scene.delta_lights.empty() &&
         scene.environment.width == 0 && scene.sun.one_minus_cos == 0.0f &&
         scene.textures.empty() && scene.sphere_frames.empty() &&
         std::ranges::none_of(scene.materials, needs_triangles);
}

MegakernelKind automatic_kernel(const SceneData& scene, const Options& options) {
  if (may_sort(options)) return MegakernelKind::sort;
  const bool is_simple = std::has_single_bit(kinds_of(scene)) && scene.opacities.empty();
  return is_simple && may_vote(options) ? MegakernelKind::vote : MegakernelKind::loop;
}

void check_scene_options(const Options& options, const SceneData& scene) {
  for (const SceneRule& rule : rules) {
    const std::string value = rule.limited(options);
    if (value.empty() || rule.suits(scene, options)) continue;
    throw Error(fmt::format("--{} {}: {}", rule.option, value,
                            fmt::format(fmt::runtime(rule.problem), scene.name)));
  }
}

}  // namespace pt
