// Plastics against Mitsuba 3.9.1 (scalar_rgb): its values of eval() and pdf().
#include <gtest/gtest.h>

#include "common/scene/data/plastic_material.h"
#include "statistics.h"

namespace pt {
namespace {

struct Golden {
  float cos_o, phi_o, cos_i, phi_i;
  Color f;  ///< times |cos|
  float pdf;
};

Vec3 direction(float cosine, float phi) {
  const float sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}

void expect_golden(const MaterialDescription& material, const std::vector<Golden>& table,
                   double tolerance) {
  for (const Golden& golden : table) {
    SCOPED_TRACE(testing::Message() << golden.cos_o << " " << golden.cos_i);
    const Vec3 wo = direction(golden.cos_o, golden.phi_o),
               wi = direction(golden.cos_i, golden.phi_i);
    visit(material.kind, material, [&](const auto& bsdf) {
      const BsdfValue value = bsdf.evaluate(wo, wi);
      EXPECT_NEAR(value.pdf / golden.pdf, 1, 3 * tolerance);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(value.f[c] / golden.f[c], 1, tolerance);
    });
  }
}

const Color body(0.25f, 0.5f, 0.75f), coat(0.9f, 0.5f, 0.7f);

// Mitsuba has a fit for the internal reflectance, 0.12 % off in what leaves.
constexpr double smooth_tolerance = 1.5e-3;

TEST(Plastic, IsMitsubas) {
  expect_golden(make_plastic(body, coat, {1.5f}),
                {
                    {0.90f, 0.30f, 0.80f, 3.00f, {0.0643587f, 0.128717f, 0.193076f}, 0.240339f},
                    {0.50f, 0.00f, 0.50f, pi, {0.0363855f, 0.0727709f, 0.109156f}, 0.139967f},
                    {0.50f, 0.00f, 0.60f, 2.80f, {0.0448448f, 0.0896896f, 0.134534f}, 0.167961f},
                    {0.30f, 1.00f, 0.90f, 5.00f, {0.0599947f, 0.119989f, 0.179984f}, 0.209547f},
                    {0.10f, 0.00f, 0.20f, 3.30f, {0.00496886f, 0.00993772f, 0.0149066f}, 0.022198f},
                },
                smooth_tolerance);
}

TEST(Plastic, NonlinearIsMitsubas) {
  expect_golden(make_plastic(body, coat, {1.5f, true}),
                {
                    {0.90f, 0.30f, 0.80f, 3.00f, {0.0304993f, 0.0739707f, 0.140926f}, 0.240339f},
                    {0.50f, 0.00f, 0.50f, pi, {0.0172429f, 0.0418196f, 0.0796729f}, 0.139967f},
                    {0.50f, 0.00f, 0.60f, 2.80f, {0.0212517f, 0.0515424f, 0.0981962f}, 0.167961f},
                    {0.30f, 1.00f, 0.90f, 5.00f, {0.0284312f, 0.068955f, 0.13137f}, 0.209547f},
                    {0.10f, 0.00f, 0.20f, 3.30f, {0.00235472f, 0.00571096f, 0.0108803f}, 0.022198f},
                },
                smooth_tolerance);
}

TEST(Plastic, CoatIsMitsubas) {
  const MaterialDescription plastic = make_plastic(body, coat, {1.5f});
  struct Sample {
    float cosine, probability;
    Color weight;
  };
  for (const Sample& golden : {Sample{0.9f, 0.0561918f, {0.653347f, 0.36297f, 0.508158f}},
                               Sample{0.3f, 0.2685423f, {0.69628f, 0.386822f, 0.541551f}}}) {
    const Vec3 wo = direction(golden.cosine, 1);
    for (const float step : {-1e-5f, 1e-5f}) {
      const BsdfSample s =
          make_bsdf<Plastic>(plastic).sample(wo, {0.3f, 0.4f, golden.probability + step});
      EXPECT_EQ(s.is_delta(), step < 0);
      if (!s.is_delta()) continue;
      EXPECT_EQ(s.wi, mirrored(wo));
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(s.weight[c], golden.weight[c], 1e-5);
    }
  }
}

// 1 - R(1 / eta) = (1 - R(eta)) / eta^2, since light in balance crosses both ways alike; the value
// is that of Duderstadt's integral for glass, 0.0918 (Egan and Hilgeman 1979).
TEST(Plastic, DiffuseReflectanceOfBothSides) {
  for (const double eta : {1.1, 1.5, 2.4}) {
    const double outside = diffuse_reflectance(eta);
    EXPECT_NEAR(1 - diffuse_reflectance(1 / eta), (1 - outside) / (eta * eta), 2e-5);
  }
  EXPECT_NEAR(diffuse_reflectance(1.5), 0.0918, 5e-5);
}

// Mitsuba interpolates its table of transmittances linearly.
constexpr double rough_tolerance = 5e-3;

TEST(RoughPlastic, GgxIsMitsubas) {
  expect_golden(make_rough_plastic(body, coat, {1.5f, true}, 0.3f, false),
                {
                    {0.90f, 0.30f, 0.80f, 3.00f, {0.0507934f, 0.0761676f, 0.127346f}, 0.280278f},
                    {0.50f, 0.00f, 0.50f, pi, {0.141011f, 0.104791f, 0.158134f}, 0.387816f},
                    {0.50f, 0.00f, 0.60f, 2.80f, {0.0561125f, 0.0637479f, 0.103317f}, 0.253771f},
                    {0.30f, 1.00f, 0.90f, 5.00f, {0.0351705f, 0.0665028f, 0.11339f}, 0.258717f},
                    {0.10f, 0.00f, 0.20f, 3.30f, {0.113125f, 0.0702657f, 0.101576f}, 0.192725f},
                },
                rough_tolerance);
}

TEST(RoughPlastic, SharpGgxIsMitsubas) {
  expect_golden(make_rough_plastic(body, coat, {1.9f}, 0.1f, false),
                {
                    {0.90f, 0.30f, 0.80f, 3.00f, {0.11215f, 0.135927f, 0.200492f}, 0.312797f},
                    {0.50f, 0.00f, 0.50f, pi, {2.12123f, 1.21947f, 1.71293f}, 3.28208f},
                    {0.50f, 0.00f, 0.60f, 2.80f, {0.0680813f, 0.0884383f, 0.130822f}, 0.209587f},
                    {0.30f, 1.00f, 0.90f, 5.00f, {0.0512662f, 0.098081f, 0.14695f}, 0.20645f},
                    {0.10f, 0.00f, 0.20f, 3.30f, {0.0549951f, 0.0393492f, 0.0563068f}, 0.0988966f},
                },
                rough_tolerance);
}

TEST(RoughPlastic, BeckmannIsMitsubas) {
  expect_golden(make_rough_plastic(body, coat, {1.5f}, 0.3f, true),
                {
                    {0.90f, 0.30f, 0.80f, 3.00f, {0.0837249f, 0.125766f, 0.187045f}, 0.284859f},
                    {0.50f, 0.00f, 0.50f, pi, {0.172511f, 0.139991f, 0.202101f}, 0.372961f},
                    {0.50f, 0.00f, 0.60f, 2.80f, {0.0970176f, 0.10831f, 0.159168f}, 0.289461f},
                    {0.30f, 1.00f, 0.90f, 5.00f, {0.0571676f, 0.109369f, 0.163863f}, 0.239224f},
                    {0.10f, 0.00f, 0.20f, 3.30f, {0.163947f, 0.103526f, 0.14666f}, 0.203906f},
                },
                rough_tolerance);
}

TEST(RoughPlastic, SharpBeckmannIsMitsubas) {
  expect_golden(make_rough_plastic(body, coat, {1.3f, true}, 0.15f, true),
                {
                    {0.90f, 0.30f, 0.80f, 3.00f, {0.0610677f, 0.103265f, 0.174963f}, 0.279606f},
                    {0.50f, 0.00f, 0.50f, pi, {0.363339f, 0.241877f, 0.356169f}, 0.700964f},
                    {0.50f, 0.00f, 0.60f, 2.80f, {0.0414303f, 0.0720892f, 0.122434f}, 0.204574f},
                    {0.30f, 1.00f, 0.90f, 5.00f, {0.0393034f, 0.0890923f, 0.154209f}, 0.227865f},
                    {0.10f, 0.00f, 0.20f, 3.30f, {0.00515114f, 0.0115329f, 0.0199468f}, 0.0356861f},
                },
                rough_tolerance);
}

TEST(RoughPlastic, VerySharpGgxIsMitsubas) {
  expect_golden(make_rough_plastic(body, coat, {1.49f}, 0.05f, false),
                {
                    {0.90f, 0.30f, 0.80f, 3.00f, {0.0712024f, 0.128059f, 0.191537f}, 0.255687f},
                    {0.50f, 0.00f, 0.50f, pi, {5.03048f, 2.84468f, 3.98947f}, 7.78871f},
                    {0.50f, 0.00f, 0.60f, 2.80f, {0.0480428f, 0.0882677f, 0.132101f}, 0.178472f},
                    {0.30f, 1.00f, 0.90f, 5.00f, {0.0578797f, 0.115227f, 0.17282f}, 0.213807f},
                    {0.10f, 0.00f, 0.20f, 3.30f, {0.0198259f, 0.0194475f, 0.0283941f}, 0.0501204f},
                },
                rough_tolerance);
}

}  // namespace
}  // namespace pt
