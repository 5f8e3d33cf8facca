// What holds of every light of the list, a new one included.
#include "common/light/light_tree.h"
#include "common/transport/sample_light.h"
#include "statistics.h"

namespace pt {
namespace {

/// Calls test(kind) for every light that a DeltaLight describes.
template <class Test>
void for_each_delta_kind(const Test& test) {
  int count = 0;
  for_each_type(Lights{}, [&]<class Type>(std::type_identity<Type>) {
    if constexpr (requires(const DeltaLight& light) { Type::make(light); }) {
      SCOPED_TRACE(testing::Message() << "kind " << static_cast<int>(Type::type));
      ++count, test(Type::type);
    }
  });
  EXPECT_GE(count, 4);
}

DeltaLight lamp_of(LightKind kind) {
  DeltaLight lamp;
  lamp.kind = kind;
  lamp.position = {1, 2, 3};
  lamp.direction = {0, 0.6f, -0.8f};
  lamp.right = {1, 0, 0};
  lamp.intensity = {2, 1, 3};
  lamp.cos_inner = 0.9f, lamp.cos_outer = 0.5f;
  return lamp;
}

// No ray can meet it: light sampling alone knows its light, always, and ends in front of it.
TEST(Lights, ThoseWithoutExtentAreSampledAlone) {
  for_each_delta_kind([](LightKind kind) {
    const Light light = make_light(lamp_of(kind), 7);
    EXPECT_EQ(light.kind, kind);
    EXPECT_GT(light.weight, 0.0f);
    TestRandom random(3);
    int lit = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 from = lamp_of(kind).position + Vec3(5.0 * random.direction());
      const IncidentLight s =
          sample_other_light(light, from, random.unit(), random.unit()).incident;
      ASSERT_EQ(s.pdf, 1.0f);
      ASSERT_TRUE(s.is_delta);
      ASSERT_NEAR(glm::length(s.wi), 1, 1e-6);
      if (has_position(kind)) {
        ASSERT_LT(glm::length(s.end), glm::length(lamp_of(kind).position - from));
      } else {
        ASSERT_GE(glm::length(s.end), 0.99f * beyond_scene);
      }
      lit += !is_black(s.radiance);
    }
    EXPECT_GT(lit, 20) << "dark";
  });
}

// The tree of lights never leaves out a light that would give something.
TEST(Lights, ShineWithinTheirBounds) {
  for_each_delta_kind([](LightKind kind) {
    const Light light = make_light(lamp_of(kind), 7);
    const std::optional<LightBounds> bounds = bounds_of(light);
    ASSERT_EQ(bounds.has_value(), has_position(kind));
    if (!bounds) return;
    EXPECT_EQ(bounds->box.min, lamp_of(kind).position);
    EXPECT_EQ(bounds->box.max, lamp_of(kind).position);
    const double widest = double{bounds->cone} + bounds->emission + 1e-5;
    TestRandom random(4);
    for (int i = 0; i < 20'000; ++i) {
      const Vec3 from = lamp_of(kind).position + Vec3(random.uniform(0.1, 9) * random.direction());
      const IncidentLight s =
          sample_other_light(light, from, random.unit(), random.unit()).incident;
      if (is_black(s.radiance)) continue;
      ASSERT_LE(std::acos(std::clamp(glm::dot(-s.wi, bounds->axis), -1.0f, 1.0f)), widest);
    }
    Light dark = light;
    dark.radiance = Color(0.0f);
    EXPECT_FALSE(bounds_of(dark).has_value());
  });
}

}  // namespace
}  // namespace pt
