#include "common/light/light_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace pt {
namespace {

constexpr int bin_count = 12;

float angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));  // precise for small ones
}

/// The smallest cone around two (Conty Estevez and Kulla 2018, algorithm 1).
void join_cones(const LightBounds& first, const LightBounds& second, LightBounds& result) {
  const bool swap = second.cone > first.cone;
  const LightBounds& a = swap ? second : first;
  const LightBounds& b = swap ? first : second;
  const float between = angle_between(a.axis, b.axis);
  result.emission = std::max(a.emission, b.emission);
  if (std::min(between + b.cone, half_turn) <= a.cone) {
    result.axis = a.axis, result.cone = a.cone;
    return;
  }
  result.cone = 0.5f * (a.cone + between + b.cone);
  const Vec3 across = b.axis - glm::dot(a.axis, b.axis) * a.axis;
  if (result.cone >= half_turn || !(glm::length(across) > 1e-6f)) {
    result.axis = a.axis, result.cone = half_turn;
    return;
  }
  const float turn = result.cone - a.cone;
  result.axis = glm::normalize(std::cos(turn) * a.axis + std::sin(turn) * glm::normalize(across));
}

LightBounds joined(const LightBounds& a, const LightBounds& b) {
  if (a.box.is_empty()) return b;
  if (b.box.is_empty()) return a;
  LightBounds result = a;
  result.box.grow(b.box);
  result.intensity = a.intensity + b.intensity;
  join_cones(a, b, result);
  return result;
}

/// Solid angle of the directions that get light, weighed by the cosine beyond the cone.
float orientation_measure(const LightBounds& b) {
  const float o = b.cone, w = std::min(o + b.emission, half_turn);
  return 2 * pi * (1 - std::cos(o)) +
         0.5f * pi *
             (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o));
}

float cost(const LightBounds& b) {
  if (b.box.is_empty()) return 0.0f;
  // A row or a point of lights has no area.
  const Vec3 size = b.box.max - b.box.min;
  const float longest = max_abs(size), area = b.box.half_area() + 1e-3f * longest * longest;
  return b.intensity * orientation_measure(b) * area;
}

LightNode pack(const LightBounds& b, std::uint32_t child) {
  LightNode node;
  node.center = b.box.center();
  // What is rounded: the centre, and where sampled points lie.
  const float size = 0.5f * glm::length(b.box.max - b.box.min);
  node.radius = size > 0 ? size * 1.0001f + 4 * half_ulp * max_abs(node.center) : 0.0f;
  node.intensity = b.intensity;
  node.axis = pack_direction(b.axis);
  // 2e-4 rad: the axis has been packed.
  node.cos_cone = pack_cosine(std::cos(std::min(b.cone + 2e-4f, half_turn)));
  node.cos_emission = pack_cosine(std::cos(std::min(b.emission, half_turn)));
  node.child = child;
  return node;
}

/// A light in the tree.
struct Item {
  LightBounds bounds;
  Vec3 center;
  std::uint32_t light;
};

class Builder {
 public:
  explicit Builder(LightTreeData& data) : data_(data) {}

  LightNode build(std::span<Item> items, int depth, std::uint32_t trail) {
    if (items.size() == 1) {
      data_.trail[items[0].light] = trail;
      return pack(items[0].bounds, LightNode::leaf | items[0].light);
    }
    const std::size_t middle = split(items, depth);
    const auto pair = static_cast<std::uint32_t>(data_.pairs.size());
    data_.pairs.emplace_back();
    const LightNode first = build(items.first(middle), depth + 1, trail);
    const LightNode second = build(items.subspan(middle), depth + 1, trail | 1u << depth);
    data_.pairs[pair] = {{first, second}};
    LightBounds all;
    for (const Item& item : items) all = joined(all, item.bounds);
    return pack(all, pair);
  }

 private:
  struct Split {
    float cost = HUGE_VALF;
    int axis = 0, bin = 0;
  };

  static int bin_of(const Item& item, const Bounds& centers, int axis) {
    const float size = centers.max[axis] - centers.min[axis];
    const float at = (item.center[axis] - centers.min[axis]) / size;
    return std::clamp(static_cast<int>(at * bin_count), 0, bin_count - 1);
  }

  static Split best_split(std::span<const Item> items, const Bounds& centers) {
    Split best;
    const Vec3 size = centers.max - centers.min;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(size[axis] > 0.0f)) continue;
      std::array<LightBounds, bin_count> bins;
      for (const Item& item : items) {
        LightBounds& bin = bins[static_cast<std::size_t>(bin_of(item, centers, axis))];
        bin = joined(bin, item.bounds);
      }
      std::array<float, bin_count> above{};  // cost of all bins from here on
      LightBounds sum;
      for (int i = bin_count - 1; i > 0; --i) {
        sum = joined(sum, bins[static_cast<std::size_t>(i)]);
        above[static_cast<std::size_t>(i)] = cost(sum);
      }
      sum = {};
      const float thin = max_abs(size) / size[axis];  // against slabs
      for (int i = 0; i + 1 < bin_count; ++i) {
        sum = joined(sum, bins[static_cast<std::size_t>(i)]);
        const float total = thin * (cost(sum) + above[static_cast<std::size_t>(i) + 1]);
        if (total < best.cost) best = {total, axis, i};
      }
    }
    return best;
  }

  /// How many items go to the first child, which comes first then.
  static std::size_t split(std::span<Item> items, int depth) {
    Bounds centers;
    for (const Item& item : items) centers.grow(item.center);
    const Split best = best_split(items, centers);
    std::size_t middle = 0;
    // So deep that halves must do from here on: a trail has few bits.
    const int halvings = std::bit_width(items.size() - 1);
    if (best.cost < HUGE_VALF && depth + halvings + 1 < LightTree::depth_max) {
      const auto end = std::partition(items.begin(), items.end(), [&](const Item& item) {
        return bin_of(item, centers, best.axis) <= best.bin;
      });
      middle = static_cast<std::size_t>(end - items.begin());
    }
    if (middle > 0 && middle < items.size()) return middle;
    middle = items.size() / 2;
    std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle),
                     items.end(), [&](const Item& a, const Item& b) {
                       const float x = a.center[best.axis], y = b.center[best.axis];
                       return x < y || (x == y && a.light < b.light);
                     });
    return middle;
  }

  LightTreeData& data_;
};

}  // namespace

LightTreeData build_light_tree(std::span<const std::optional<LightBounds>> lights) {
  LightTreeData data;
  data.trail.assign(lights.size(), LightTree::outside);
  std::vector<Item> items;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (lights[i])
      items.push_back({*lights[i], lights[i]->box.center(), static_cast<std::uint32_t>(i)});
  }
  if (items.empty()) return data;
  data.pairs.reserve(items.size());
  data.root = Builder(data).build(items, 0, 0).child;
  if (data.pairs.empty()) data.pairs.emplace_back();
  return data;
}

}  // namespace pt
