// The orientation of the surface for which a light is chosen, in 4 bytes. A path carries it to the
// emitter that it hits, where the probability of the same choice is computed.
#pragma once

#include "common/math/vec.h"

namespace pt {

/// A unit vector in an octahedron (Cigolla et al. 2014): two numbers of 16 bits. Within 1e-4 rad.
PT_HD std::uint32_t pack_direction(const Vec3& v) {
  const float scale = divide(1.0f, fabsf(v.x) + fabsf(v.y) + fabsf(v.z));
  float x = v.x * scale, y = v.y * scale;
  if (v.z < 0.0f) {
    const float folded = copysignf(1.0f - fabsf(y), x);
    y = copysignf(1.0f - fabsf(x), y), x = folded;
  }
  const auto unit = [](float t) {
    return static_cast<std::uint32_t>(fused_multiply_add(t, 32767.0f, 32768.0f));
  };
  return unit(x) | unit(y) << 16;
}

PT_HD Vec3 unpack_direction(std::uint32_t packed) {
  const auto signed_unit = [](std::uint32_t bits) {
    return fused_multiply_add(static_cast<float>(bits), 1.0f / 32767.0f, -32767.5f / 32767.0f);
  };
  const float x = signed_unit(packed & 0xffffu), y = signed_unit(packed >> 16);
  const float z = 1.0f - fabsf(x) - fabsf(y), below = fmaxf(-z, 0.0f);
  const Vec3 v(x - copysignf(below, x), y - copysignf(below, y), z);
  return v * Vec3(inverse_sqrt_of_normal(dot(v, v)));
}

/// The packed normal on the side from which the path came, the last bit being `both_sides`.
struct Receiver {
  std::uint32_t bits = 0;  ///< 0: nothing is known of it (a packed direction is never 0)

  static constexpr std::uint32_t both_sides = 0x80000000u;  ///< light from behind counts as well
};

/// `normal` has unit length. Two bits of precision make room for the flag.
PT_HD Receiver make_receiver(const Vec3& normal, bool both_sides) {
  const std::uint32_t packed = pack_direction(normal);
  return {((packed & 0xffffu) | (packed >> 17) << 16) | (both_sides ? Receiver::both_sides : 0u)};
}

PT_HD Vec3 receiver_normal(Receiver receiver) {
  const std::uint32_t bits = receiver.bits & ~Receiver::both_sides;
  return unpack_direction((bits & 0xffffu) | (bits >> 16) << 17 | 0x10000u);
}

}  // namespace pt
