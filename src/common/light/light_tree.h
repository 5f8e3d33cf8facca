// Choosing among many lights by their estimated contribution at the shading point: a stochastic
// descent through a tree of lights (Conty Estevez and Kulla 2018, 'Importance Sampling of Many
// Lights with Adaptive Tree Splitting'; bounds of the cosines as in pbrt-v4, section 12.6.3).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/light/light.h"
#include "common/light/receiver.h"

namespace pt {

/// A cluster of lights, or one light. 32 bytes: two loads. All bounds are rounded outwards, so
/// that only lights without any contribution have importance 0.
struct alignas(16) LightNode {
  Vec3 center;             ///< of their bounding sphere
  float radius;            ///< 0: a point
  float intensity;         ///< luminance, W / sr, of all together in the direction that gets most
  std::uint32_t axis;      ///< packed: normals lie in a cone around it,
  std::uint16_t cos_cone;  ///< of this half angle, and light goes where the angle
  std::uint16_t cos_emission;  ///< to a normal is below this one; see pack_cosine
  std::uint32_t child;         ///< its pair of children, or leaf | index of the light

  static constexpr std::uint32_t leaf = 0x80000000u;
};
static_assert(sizeof(LightNode) == 32);

/// Siblings are always weighed together.
struct alignas(16) LightPair {
  LightNode node[2];
};

/// In steps of 2^-15, rounded down: the angle only grows.
inline std::uint16_t pack_cosine(float cosine) {
  const float steps = std::floor((cosine + 1.0f) * 32768.0f) - 1.0f;
  return static_cast<std::uint16_t>(std::fmin(std::fmax(steps, 0.0f), 65535.0f));
}
PT_HD float unpack_cosine(std::uint16_t packed) {
  return fused_multiply_add(static_cast<float>(packed), 1.0f / 32768.0f, -1.0f);
}

PT_HD float sine_of(float cosine) { return fast_sqrt(fused_multiply_add(-cosine, cosine, 1.0f)); }

/// cos(max(0, a - b)) of two angles between 0 and pi.
PT_HD float cos_difference(float cos_a, float sin_a, float cos_b, float sin_b) {
  return cos_a > cos_b ? 1.0f : fused_multiply_add(sin_a, sin_b, cos_a * cos_b);
}

/// The shading point and its normal, for which lights are weighted.
struct LightReceiver {
  Vec3 point;
  Vec3 normal;
  bool has_normal, both_sides;

  PT_HD LightReceiver(const Vec3& p, Receiver receiver)
      : point(p),
        normal(receiver_normal(receiver)),
        has_normal(receiver.bits != 0),
        both_sides((receiver.bits & Receiver::both_sides) != 0) {}
};

/// Two of them can be added.
inline constexpr float importance_max = 1e37f;

/// The cosines at the lights of a node are bounded by the best point of the bounding sphere and
/// estimated at its centre. The bound alone makes large lights near by too important (measured: 1.3
/// times the variance in rooms), the estimate alone is 0 for some that contribute.
PT_HD float blend_cosine(float bound, float middle) {
  return fused_multiply_add(0.25f, bound, 0.75f * fmaxf(middle, 0.0f));
}

/// The importance of a node: an estimate of the irradiance by its lights without occlusion, >= 0
/// (pbrt-v4, section 12.6.3). No branches: the two nodes of a pair are computed side by side.
PT_HD float light_importance(const LightNode& node, const LightReceiver& receiver) {
  const Vec3 way = node.center - receiver.point;
  const float distance2 = dot(way, way), radius2 = node.radius * node.radius;
  const bool inside = !(distance2 > radius2);
  const float inverse = inverse_sqrt_of_normal(fmaxf(distance2, 1e-30f));
  const float sin_ball = fminf(node.radius * inverse, 1.0f), cos_ball = sine_of(sin_ball);
  // The angle at the light, less the cone of its normals, and less the ball's angle as well: both
  // together may be more than half a turn.
  const float cos_light = -dot(unpack_direction(node.axis), way) * inverse;
  const float sin_light = sine_of(cos_light);
  const float cos_cone = unpack_cosine(node.cos_cone), sin_cone = sine_of(cos_cone);
  const float cos_slack = fused_multiply_add(cos_cone, cos_ball, -(sin_cone * sin_ball));
  const float sin_slack = fused_multiply_add(sin_cone, cos_ball, cos_cone * sin_ball);
  const float bound = inside || sin_slack <= 0.0f
                          ? 1.0f
                          : cos_difference(cos_light, sin_light, cos_slack, sin_slack);
  const bool dark = bound <= unpack_cosine(node.cos_emission);
  const float emitted =
      blend_cosine(bound, cos_difference(cos_light, sin_light, cos_cone, sin_cone));
  const float irradiance = divide(node.intensity * emitted, fmaxf(distance2, radius2));
  const float cosine = dot(receiver.normal, way) * inverse;
  const float middle = receiver.both_sides ? fabsf(cosine) : cosine;
  const float beside = cos_difference(middle, sine_of(middle), cos_ball, sin_ball);
  const float received =
      blend_cosine(select(inside, 1.0f, beside), middle) + 1e-4f;  // the normal has been packed
  const float importance = irradiance * select(receiver.has_normal, received, 1.0f);
  return dark ? 0.0f : fminf(fmaxf(importance, 0.0f), importance_max);
}

/// The share of a pair's first node; one half where the importance of both is next to 0.
PT_HD float first_share(const LightPair& pair, const LightReceiver& receiver) {
  const float first = light_importance(pair.node[0], receiver);
  const float sum = first + light_importance(pair.node[1], receiver);
  return sum > 1e-30f ? divide(first, sum) : 0.5f;
}

/// A view. LightTreeData owns the memory.
struct LightTree {
  const LightPair* pairs = nullptr;      ///< null: there is none
  const std::uint32_t* trail = nullptr;  ///< [light]: bit i is the child to take at depth i;
                                         ///< `outside`: the light is not in the tree
  std::uint32_t root = 0;                ///< as LightNode::child

  static constexpr std::uint32_t outside = 0xffffffffu;
  static constexpr int depth_max = 31;
};

/// A part of [0, 2^64) and a position in it, relative to where it begins. Each choice narrows it,
/// and nothing is rescaled: after a choice of probability p, 64 - log2(1 / p) bits are left.
struct Interval {
  std::uint64_t width = ~std::uint64_t{0};
  std::uint64_t position;

  /// From the 48 random bits of two floats that are multiples of 2^-24 in [0, 1).
  PT_HD Interval(float u0, float u1)
      : position(static_cast<std::uint64_t>(u0 * 16777216.0f) << 40 |
                 static_cast<std::uint64_t>(u1 * 16777216.0f) << 16) {}

  /// The position, uniform in [0, 1): for a last choice.
  PT_HD float unit() const {
    return fminf(static_cast<float>(position) / static_cast<float>(width), one_minus_ulp);
  }

  /// True with this probability.
  PT_HD bool choose(float probability) {
    // 32 bits, so that each product is one instruction.
    const auto share =
        static_cast<std::uint32_t>(fminf(probability * 4294967296.0f, 4294967040.0f));
    const auto high = static_cast<std::uint32_t>(width >> 32);
    const auto low = static_cast<std::uint32_t>(width);
    const std::uint64_t part =
        probability >= 1.0f ? width
                            : std::uint64_t{high} * share + (std::uint64_t{low} * share >> 32);
    const bool chosen = position < part;
    if (!chosen) position -= part;
    width = chosen ? part : width - part;
    return chosen;
  }
};

/// Names a light of the tree, which must not be empty, and multiplies `pmf` by the probability.
PT_HD std::uint32_t sample_light_tree(const LightTree& tree, const LightReceiver& receiver,
                                      Interval random, float& pmf) {
  std::uint32_t child = tree.root;
  while ((child & LightNode::leaf) == 0) {
    const LightPair pair = load_wide(&tree.pairs[child]);
    const float share = first_share(pair, receiver);
    const bool first = random.choose(share);
    pmf *= first ? share : 1.0f - share;
    child = first ? pair.node[0].child : pair.node[1].child;
  }
  return child & ~LightNode::leaf;
}

/// The probability with which sample_light_tree names a light of this trail.
PT_HD float light_tree_pmf(const LightTree& tree, const LightReceiver& receiver,
                           std::uint32_t trail) {
  float pmf = 1.0f;
  for (std::uint32_t child = tree.root; (child & LightNode::leaf) == 0; trail >>= 1) {
    const LightPair pair = load_wide(&tree.pairs[child]);
    const float share = first_share(pair, receiver);
    const bool first = (trail & 1u) == 0;
    pmf *= first ? share : 1.0f - share;
    child = first ? pair.node[0].child : pair.node[1].child;
  }
  return pmf;
}

/// The memory behind a LightTree.
struct LightTreeData {
  std::vector<LightPair> pairs;
  std::vector<std::uint32_t> trail;
  std::uint32_t root = 0;
};

/// Builds the tree over all lights that have bounds, which are given light by light, split by the
/// surface area orientation heuristic. Without such lights there are no pairs; a single light gets
/// a pair that is never visited.
LightTreeData build_light_tree(std::span<const std::optional<LightBounds>> lights);

}  // namespace pt
