// Vectors and colours that are equal but for rounding.
#pragma once

#include <gtest/gtest.h>

#include "common/math/vec.h"

namespace pt {

inline void expect_near(const Vec3& actual, const Vec3& expected, float tolerance = 1e-5f) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(actual[i], expected[i], tolerance) << "component " << i;
}

}  // namespace pt
