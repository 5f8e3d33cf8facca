// Where shading a surface gets its random numbers and where it leaves its results. On a GPU
// registers limit it: results are streamed to memory as soon as they are known, and numbers are
// drawn when they are needed, so that live ranges are short.
#pragma once

#include "common/sampling/random.h"
#include "common/transport/intersect.h"

namespace pt {

/// Eager shading: the numbers are drawn before it, and all results are returned in the Scattering.
struct EagerShading {
  Vec4 scatter_numbers, light_numbers;

  /// The blocks of random numbers of the ray that hit (random.h); may be called repeatedly.
  PT_HD Vec4 scatter() const { return scatter_numbers; }
  PT_HD Vec4 light() const { return light_numbers; }
  /// Takes what the surface emits, or returns it for Scattering::emitted.
  PT_HD Color emit(const Color& emitted) const { return emitted; }
  /// Whether aim() is to be called before the BSDF is evaluated, with the shadow ray's direction.
  /// Scattering::shadow then has only its radiance.
  static constexpr bool aims = false;
  PT_HD void aim(const ShadowRay&) const {}
};

/// Streaming shading: passes results to a sink (path_step.h), to shorten live ranges. It has
/// besides
///   void aim(const PathState&, const ShadowRay&)  the way of a shadow ray that may be cast
/// Source: one whose streams have no state. `samples` gives a path's id.
template <class Source, class Samples, class Sink>
struct StreamingShading {
  const Source& source;
  const Samples& samples;
  const PathState& path;
  Sink& sink;

  PT_HD Vec4 scatter() const { return draw(scatter_block(path.rays)); }
  PT_HD Vec4 light() const { return draw(light_block(path.rays)); }
  PT_HD Color emit(const Color& emitted) const {
    sink.emit(path, emitted);
    return Color(0.0f);
  }
  static constexpr bool aims = true;
  PT_HD void aim(const ShadowRay& shadow) const { sink.aim(path, shadow); }

 private:
  /// An optimisation barrier hides the block's index from the compiler, which would otherwise keep
  /// the numbers of an equal block in registers.
  PT_HD Vec4 draw(std::uint32_t block) const {
    auto stream = source.open(samples.id_of(path.index));
    return stream.draw(float_to_bits(optimization_barrier(bits_to_float(block))));
  }
};
template <class Source, class Samples, class Sink>
StreamingShading(const Source&, const Samples&, const PathState&, Sink&)
    -> StreamingShading<Source, Samples, Sink>;

}  // namespace pt
