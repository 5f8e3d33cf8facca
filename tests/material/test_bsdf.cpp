// The list of BSDFs, and single ones against what is known of them.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "material/bsdf_cases.h"
#include "statistics.h"

namespace pt {
namespace {

TEST(Diffuse, ReflectsTheSameInAllDirectionsOfOneSide) {
  const Diffuse bsdf{{0.25f, 0.5f, 1}};
  for (const float side : {1.0f, -1.0f}) {
    const Vec3 wo(0.6f, 0, side * 0.8f);
    EXPECT_NEAR(bsdf.evaluate(wo, {0, 0.8f, side * 0.6f}).f.y, 0.5 * 0.6 / pi_double, 1e-7);
    EXPECT_TRUE(is_black(bsdf.evaluate(wo, {0, 0.8f, side * -0.6f}).f));
  }
}

// The order of the list is the number that materials store; names tell the BSDFs apart.
TEST(Bsdfs, AreNumberedByTheirPlaceInTheList) {
  std::set<std::string> names;
  int index = 0;
  for_each_type(Bsdfs{}, [&](auto type) {
    using Bsdf = typename decltype(type)::type;
    EXPECT_EQ(static_cast<int>(kind_of<Bsdf>), index++);
    EXPECT_LE(parameter_count<Bsdf>, parameters_max);
    EXPECT_TRUE(names.insert(Bsdf::name).second);
    visit(kind_of<Bsdf>, MaterialDescription(), [](const auto& bsdf) {
      EXPECT_TRUE((std::is_same_v<std::remove_cvref_t<decltype(bsdf)>, Bsdf>));
    });
  });
}

/// Parameters that differ, within the ranges of all BSDFs.
struct Numbered {
  Color color(int i) const { return Color(scalar(i)); }
  float scalar(int i) const { return static_cast<float>(i + 1) / 64; }
};

// A member that is missing in the list would be 0; one in another place would get another number.
TEST(Bsdfs, ListAllTheirMembersInTheOrderOfTheMaterials) {
  for_each_type(Bsdfs{}, []<class Bsdf>(std::type_identity<Bsdf>) {
    SCOPED_TRACE(Bsdf::name);
    const auto bsdf = make_bsdf<Bsdf>(Numbered{});
    std::size_t bytes = 0;
    for (int i = 0; i < parameter_count<Bsdf>; ++i) {
      const auto& field = Bsdf::fields[i];
      const float number = Numbered{}.scalar(i);
      const auto expect = [&](auto member, auto expected) {
        EXPECT_EQ(bsdf.*member, expected) << field.name;
        EXPECT_EQ(index_of(member), i) << field.name;
        bytes += sizeof(expected);
      };
      if (field.color != nullptr) expect(field.color, Color(number));
      if (field.number != nullptr) expect(field.number, number);
      if (field.flag != nullptr) expect(field.flag, true);
    }
    EXPECT_EQ((bytes + 3) / 4 * 4, sizeof(Bsdf));
  });
}

}  // namespace
}  // namespace pt
