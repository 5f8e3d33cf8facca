// What shading a surface asks for and tells on its way. Registers are what limits it on a GPU: a
// caller that has a place for a thing is told of it as soon as it is known, and numbers are drawn
// when they are needed, so that nobody keeps them meanwhile.
#pragma once

#include "common/sampling/random.h"
#include "common/transport/intersect.h"

namespace pt {

/// The plain form: the numbers are drawn already, and all that is found lies in the Scattering.
struct DrawnSteps {
  Vec4 scatter_numbers, light_numbers;

  /// The blocks of random numbers of the ray that hit (random.h), as often as they are asked for.
  PT_HD Vec4 scatter() const { return scatter_numbers; }
  PT_HD Vec4 light() const { return light_numbers; }
  /// Takes what the surface emits, or returns it for Scattering::emitted.
  PT_HD Color emit(const Color& emitted) const { return emitted; }
  /// Whether aim() wants to know, before the BSDF does, which way a shadow ray would go. Of
  /// Scattering::shadow only the radiance is then set.
  static constexpr bool aims = false;
  PT_HD void aim(const ShadowRay&) const {}
};

/// What steps return that keep no numbers. Anew each time: the compiler would keep a block that it
/// recognises. Source: one whose streams have no state.
template <class Source>
PT_HD Vec4 draw_late(const Source& source, const PathId& id, std::uint32_t block) {
  auto stream = source.open(id);
  return stream.draw(float_to_bits(anew(bits_to_float(block))));
}

}  // namespace pt
