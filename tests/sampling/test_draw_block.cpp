// Numbers drawn for many paths at once are those that each draws alone.
#include <gtest/gtest.h>

#include "common/sampling/draw_block.h"

namespace pt {
namespace {

constexpr std::uint64_t seed = 0x123456789abcdef0;

DrawNames some_names() {
  DrawNames names;
  for (std::uint32_t i = 0; i < DrawNames::size_max; ++i) {
    const Uint4 bits = philox4x32_10({i, 0, 0, 0}, 1, 2);
    names.pixel[i] = bits.x, names.sample[i] = bits.y, names.block[i] = i % 2 == 0 ? i : bits.z;
  }
  return names;
}

Vec4 draw_alone(const DrawNames& names, std::uint32_t i) {
  return PhiloxSource{seed}.open({names.pixel[i], names.sample[i], 0}).draw(names.block[i]);
}

TEST(DrawBlock, IsWhatEachDrawsAlone) {
  const DrawNames names = some_names();
  for (std::uint32_t count = 0; count <= DrawNames::size_max; ++count) {
    DrawnBlock drawn{};
    draw_block(seed, names, count, drawn);
    for (std::uint32_t i = 0; i < count; ++i) EXPECT_EQ(drawn.at(i), draw_alone(names, i)) << i;
  }
}

TEST(DrawBlock, SourceGivesEachPathItsNumbers) {
  DrawnBlock scatter{}, light{};
  for (std::uint32_t i = 0; i < DrawNames::size_max; ++i) {
    scatter.set(i, Vec4(static_cast<float>(i)));
    light.set(i, Vec4(static_cast<float>(i) + 0.5f));
  }
  DrawnSource source{&scatter, &light};
  for (std::uint32_t i = 0; i < DrawNames::size_max; ++i) {
    source.index = i;
    const auto stream = source.open({});
    EXPECT_EQ(stream.draw(scatter_block(i)), scatter.at(i));
    EXPECT_EQ(stream.draw(light_block(i)), light.at(i));
  }
}

TEST(DrawBlock, KnowsWhoseNumbersArePhiloxs) {
  EXPECT_TRUE(is_philox(PhiloxSource{seed}));
  EXPECT_TRUE(is_philox(SamplerSource{seed, make_sampler(SamplerKind::independent, 4)}));
  EXPECT_FALSE(is_philox(SamplerSource{seed, make_sampler(SamplerKind::sobol, 4)}));
  EXPECT_FALSE(is_philox(SamplerSource{seed, make_sampler(SamplerKind::stratified, 4)}));
  const Chains chains{};
  EXPECT_FALSE(is_philox(SamplerSource{seed, make_sampler(SamplerKind::independent, 4), &chains}));
}

}  // namespace
}  // namespace pt
