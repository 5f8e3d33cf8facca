// Surfaces over blocks of slots: the numbers of a block's paths are drawn together and what they
// read is prefetched, then the stage shades each slot as it does alone.
#pragma once

#include "common/accel/traverse_triangles.h"
#include "common/sampling/draw_block.h"
#include "wavefront/prefetch_cpu.h"
#include "wavefront/run_stage_cpu.h"

namespace pt {

/// Sources whose streams have no state: numbers can be drawn in advance.
template <class Source>
concept StatelessSource = !requires(const Source& source) {
  source.states;
};

/// Whether the stage runs so.
template <class Stage>
inline constexpr bool shades_in_blocks = false;
template <class Traits, Branching branching, StatelessSource Source>
inline constexpr bool shades_in_blocks<ShadeSurface<Traits, branching, Source>> = true;

/// Draws the numbers with which `count` paths leave the surfaces that they have hit.
template <bool has_lights, class Source, class Slots>
void draw_for_surfaces(const StageContext<Source>& context, const Slots& slots, std::uint32_t count,
                       DrawnBlock& scatter, DrawnBlock& light) {
  const bool together = is_philox(context.source);
  DrawNames names{};
  for (std::uint32_t i = 0; i < count; ++i) {
    const PathState path = context.pool.load_path_id(slots[i]);
    const PathId id = context.samples.id_of(path.index);
    const std::uint32_t rays = path.rays + 1u;  // with the one that has hit the surface
    names.pixel[i] = id.pixel, names.sample[i] = id.sample, names.block[i] = scatter_block(rays);
    if (together) continue;
    auto stream = context.source.open(id);
    scatter.set(i, stream.draw(scatter_block(rays)));
    if (has_lights) light.set(i, stream.draw(light_block(rays)));
  }
  if (!together) return;
  draw_block(context.source.seed, names, count, scatter);
  for (std::uint32_t i = 0; i < count; ++i) names.block[i] |= 1u;  // light_block
  if (has_lights) draw_block(context.source.seed, names, count, light);
}

#ifdef __SANITIZE_ADDRESS__  // which makes one function of all that take minutes to compile
#define PT_FLATTEN
#else
#define PT_FLATTEN [[gnu::flatten]]
#endif
#ifdef __x86_64__
#define PT_SHADE PT_FLATTEN [[gnu::target("avx2,bmi,bmi2,popcnt")]]
#else
#define PT_SHADE PT_FLATTEN
#endif

/// All that shading calls, but for what is never inlined, becomes one function, in which a path's
/// values stay in registers. (Across calls they would go through memory: stored by parts and loaded
/// as a whole, for which a processor waits.) Compiled for AVX2, so only where that is there;
/// products and sums are not contracted, so the bits are the same.
template <class Stage>
PT_SHADE Next shade_slot(const Stage& stage, const Scene& scene, std::uint32_t slot) {
  return stage(scene, slot, 0);
}
#undef PT_SHADE
#undef PT_FLATTEN

/// As run_stage_cpu.
template <class Traits, Branching branching, class Source>
void shade_blocks_cpu(const ShadeSurface<Traits, branching, Source>& stage, const Scene& scene,
                      const StageQueues& queues) {
  using Stage = ShadeSurface<Traits, branching, DrawnSource>;
  constexpr bool prefetches = Traits::lighting == Lighting::full;  // its scenes may be large
  constexpr bool is_one_function = !Traits::has_motion;            // of which rays take longest
  constexpr std::uint32_t attributes_ahead = 6, texels_ahead = 3;  // slots
  const StageContext<Source>& c = stage.context;
  using SharedStage = ShadeSurface<SharedShadingTraits<Traits>, branching, DrawnSource>;
  static const bool fast = is_one_function && has_avx2();
  for_each_range<Stage>(queues, [&](std::uint32_t begin, std::uint32_t end, auto&& send) {
    DrawnBlock scatter{}, light{};
    Stage drawn{
        {c.pool, c.samples, {&scatter, &light}, c.counters, c.ray_queue, c.settings, c.supply}};
    for_each_block<Stage, DrawNames::size_max>(
        queues, begin, end, [&](const auto& slots, std::uint32_t count) {
          draw_for_surfaces<Traits::has_lights>(c, slots, count, scatter, light);
          const auto ask_for_attributes = [&](std::uint32_t i) {
            if (prefetches && i < count) {
              prefetch_attributes(scene, c.pool.load_hit(slots[i]), light.at(i));
            }
          };
          for (std::uint32_t i = 0; prefetches && i < count; ++i) {
            prefetch_records(scene, c.pool.load_hit(slots[i]), light.at(i));
          }
          const auto ask_for_texels = [&](std::uint32_t i) {
            if (prefetches && i < count && scene.triangles.instance_count == 0) {
              prefetch_texels(scene, c.pool.load_ray(slots[i]), c.pool.load_hit(slots[i]));
            }
          };
          const auto shade = [&](std::uint32_t slot) {
            if constexpr (is_one_function) {
              if (fast) return shade_slot(drawn, scene, slot);
            }
            return SharedStage{drawn.context}(scene, slot, 0);
          };
          for (std::uint32_t i = 0; i < attributes_ahead; ++i) ask_for_attributes(i);
          for (std::uint32_t i = 0; i < texels_ahead; ++i) ask_for_texels(i);
          for (std::uint32_t i = 0; i < count; ++i) {
            ask_for_attributes(i + attributes_ahead);
            ask_for_texels(i + texels_ahead);
            drawn.context.source.index = i;
            send(slots[i], shade(slots[i]));
          }
        });
  });
}

}  // namespace pt
