// A scene as the kernels see it: a plain view, passed by value. scene_data.h owns the memory.
#pragma once

#include "common/accel/bvh2.h"
#include "common/geometry/primitives.h"
#include "common/light/sky.h"
#include "common/material/material.h"
#include "common/scene/camera.h"

namespace pt {

struct Scene {
  Camera camera;
  Sky sky;
  Primitives primitives;
  const Bvh2Node* bvh_nodes = nullptr;
  const Material* materials = nullptr;
  const std::uint32_t* material_of = nullptr;  ///< [primitive]
  const std::uint32_t* lights = nullptr;       ///< primitives that emit
  std::uint32_t light_count = 0;

  PT_HD Material material(std::uint32_t primitive) const {
    return load_wide(&materials[material_of[primitive]]);
  }
};

enum class Accel { brute, bvh2 };

/// What is known of a scene before its kernels are chosen: each combination is a kernel of its own.
struct SceneTraits {
  Accel accel = Accel::brute;
  bool has_lights = false;
};

/// The same as a type. (A value as template argument, new in C++20, is refused by nvcc's host
/// pass.)
template <Accel accel_value, bool has_lights_value>
struct Traits {
  static constexpr Accel accel = accel_value;
  static constexpr bool has_lights = has_lights_value;
};

}  // namespace pt
