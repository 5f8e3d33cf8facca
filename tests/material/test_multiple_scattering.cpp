// What facets of conductors send on to each other: the fit of what single scattering loses, the
// albedo with and without compensation, and a random walk on a microsurface.
#include <gtest/gtest.h>

#include "common/scene/load/mitsuba/surfaces/surfaces.h"
#include "common/scene/prepare/prepare_steps.h"
#include "material/bsdf_integral.h"
#include "material/microsurface_walk.h"

namespace pt {
namespace {

constexpr double cosines[] = {1e-4, 0.003, 0.01, 0.03, 0.08, 0.15, 0.3, 0.5, 0.75, 0.95, 1};
constexpr double roughnesses[] = {0.001, 0.004, 0.015, 0.03, 0.06, 0.12, 0.25, 0.43, 0.68, 0.87, 1};

/// A facets' distribution in double precision.
struct Facets {
  double alpha_x, alpha_y;
  bool is_beckmann;

  double distribution(const Vec3d& m) const {
    const double slopes =
        (m.x * m.x / (alpha_x * alpha_x) + m.y * m.y / (alpha_y * alpha_y)) / (m.z * m.z);
    const double scale = 1 / (pi_double * alpha_x * alpha_y * std::pow(m.z, 4));
    return scale * (is_beckmann ? std::exp(-slopes) : std::pow(1 + slopes, -2));
  }
  double lambda(const Vec3d& w) const {
    const double root = std::hypot(alpha_x * w.x, alpha_y * w.y), a = w.z / std::max(root, 1e-30);
    if (is_beckmann)
      return 0.5 * (std::erf(a) - 1) + std::exp(-a * a) / (2 * a * std::sqrt(pi_double));
    return 0.5 * (std::sqrt(1 + 1 / (a * a)) - 1);
  }
};

/// The albedo of one facet by quadrature over normals whose slopes are evenly spread; `correlated`:
/// by the height-correlated masking and shadowing (Heitz 2014, equation 99), else the product.
template <class Reflectance>
Vec3d single_albedo(const Facets& facets, const Vec3d& wo, bool correlated,
                    const Reflectance& reflectance, int steps = 300) {
  Vec3d sum(0.0);
  for (int i = 0; i < steps; ++i) {
    const double s = (i + 0.5) / steps;  // the part s^2 of the facets is steeper than the slope
    const double slope =
        facets.is_beckmann ? std::sqrt(-2 * std::log(s)) : std::sqrt(1 - s * s) / s;
    for (int k = 0; k < steps; ++k) {
      const double phi = (k + 0.5) / steps * 2 * pi_double;
      const Vec3d m = glm::normalize(Vec3d(facets.alpha_x * slope * std::cos(phi),
                                           facets.alpha_y * slope * std::sin(phi), 1.0));
      const double cosine = glm::dot(wo, m);
      const Vec3d wi = 2 * cosine * m - wo;
      if (cosine <= 0 || wi.z <= 0) continue;
      const double lo = facets.lambda(wo), li = facets.lambda(wi);
      const double seen = correlated ? 1 / (1 + lo + li) : 1 / ((1 + lo) * (1 + li));
      sum += s * cosine / (m.z * wo.z) * seen * reflectance(cosine);
    }
  }
  return sum * (2.0 / (steps * steps));
}

Vec3d white(double) { return Vec3d(1.0); }

Vec3d tilted(double cosine, double phi = 0.7) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}

TEST(MicrofacetLoss, IsThatOfQuadrature) {
  for (const bool is_beckmann : {false, true}) {
    for (const double alpha : roughnesses) {
      const auto loss = MicrofacetLoss::make(static_cast<float>(alpha), is_beckmann);
      for (const double cosine : cosines) {
        const double albedo =
            single_albedo({alpha, alpha, is_beckmann}, tilted(cosine), false, white).x;
        EXPECT_NEAR(static_cast<double>(loss.at(static_cast<float>(cosine))), 1 - albedo,
                    is_beckmann ? 1e-3 : 5e-4)
            << "alpha " << alpha << ", cosine " << cosine << ", Beckmann " << is_beckmann;
      }
    }
  }
}

/// f(cosine) cosine d cosine from 0 to 1, times 2: in steps that are fine near 0.
template <class F>
double mean_over_directions(const F& f) {
  constexpr int steps = 4000;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double x = (i + 0.5) / steps, cosine = x * x * x;
    sum += 2 * cosine * f(cosine) * 3 * x * x / steps;
  }
  return sum;
}

// An error of the average is one of the albedo, times what is lost.
TEST(MicrofacetLoss, AverageIsItsIntegral) {
  for (const bool is_beckmann : {false, true}) {
    for (const double alpha : roughnesses) {
      const auto loss = MicrofacetLoss::make(static_cast<float>(alpha), is_beckmann);
      double most = 0;
      const double mean = mean_over_directions([&](double cosine) {
        const double lost = static_cast<double>(loss.at(static_cast<float>(cosine)));
        most = std::max(most, lost);
        return lost;
      });
      EXPECT_NEAR(mean / static_cast<double>(loss.average()) * most, most,
                  is_beckmann ? 1.1e-3 : 3e-4)
          << "alpha " << alpha << ", Beckmann " << is_beckmann;
    }
  }
}

TEST(AverageFresnel, IsThatOfQuadratureForEveryNamedMetal) {
  for (const mitsuba::ConductorIndex& metal : mitsuba::conductors) {
    const Color mean = average_fresnel_conductor(metal.eta, metal.k);
    for (int c = 0; c < 3; ++c) {
      const double expected = mean_over_directions([&](double cosine) {
        return static_cast<double>(
            fresnel_conductor(static_cast<float>(cosine), metal.eta[c], metal.k[c]));
      });
      EXPECT_NEAR(static_cast<double>(mean[c]), expected, 8e-3) << metal.name;
    }
  }
}

CompensatedConductor compensated(const Color& eta, const Color& k, float alpha_x, float alpha_y,
                                 bool is_beckmann) {
  return {{Color(1.0f), eta, k, alpha_x, alpha_y, is_beckmann}};
}
CompensatedConductor compensated_white(double alpha_x, double alpha_y, bool is_beckmann) {
  return compensated(Color(0.0f), Color(1.0f), static_cast<float>(alpha_x),
                     static_cast<float>(alpha_y), is_beckmann);
}

/// By sample().
template <class Bsdf>
Vec3d albedo_of(const Bsdf& bsdf, const Vec3d& wo) {
  constexpr int count = 1 << 14;
  Vec3d sum(0.0);
  for (int i = 0; i < count; ++i) sum += Vec3d(bsdf.sample(Vec3(wo), even_numbers(i)).weight);
  return sum / static_cast<double>(count);
}

/// The albedo of the second lobe alone, which does not depend on the azimuth: asked across wo,
/// where the first one is weak.
double second_albedo(const CompensatedConductor& bsdf, const Vec3d& wo) {
  const double across = std::atan2(wo.y, wo.x) + pi_double / 2;
  return pi_double * mean_over_directions([&](double cosine) {
           const Vec3 o(wo), i(tilted(cosine, across));
           const BsdfValue both = bsdf.evaluate(o, i), first = bsdf.Conductor::evaluate(o, i);
           return (static_cast<double>(both.f.x) - static_cast<double>(first.f.x)) / cosine;
         });
}

// The white furnace, which the facets alone do not pass.
TEST(CompensatedConductor, LosesNothingWithoutAbsorption) {
  double lost = 0;
  for (const bool is_beckmann : {false, true}) {
    for (const double alpha : roughnesses) {
      const CompensatedConductor bsdf = compensated_white(alpha, alpha, is_beckmann);
      for (const double cosine : cosines) {
        const Vec3d wo = tilted(cosine);
        const double first = single_albedo({alpha, alpha, is_beckmann}, wo, false, white).x;
        lost = std::max(lost, 1 - first);
        EXPECT_NEAR(first + second_albedo(bsdf, wo), 1, is_beckmann ? 2e-3 : 1e-3)
            << "alpha " << alpha << ", cosine " << cosine << ", Beckmann " << is_beckmann;
      }
    }
  }
  EXPECT_NEAR(lost, 0.693, 1e-3);  // GGX 1
}

// Equal roughness along x and y is assumed: with a ratio of up to 4, light is made or lost.
TEST(CompensatedConductor, AnisotropyIsApproximate) {
  double least = 1, most = 0;
  for (const bool is_beckmann : {false, true}) {
    for (const auto& [x, y] : {std::pair{0.3, 0.15}, {0.1, 0.4}, {0.8, 0.2}}) {
      const CompensatedConductor bsdf = compensated_white(x, y, is_beckmann);
      for (const double cosine : cosines) {
        for (const double phi : {0.0, 0.8, pi_double / 2}) {
          const Vec3d wo = tilted(cosine, phi);
          const double first = single_albedo({x, y, is_beckmann}, wo, false, white, 200).x;
          const double both = first + second_albedo(bsdf, wo);
          least = std::min(least, both), most = std::max(most, both);
        }
      }
    }
  }
  EXPECT_NEAR(least, 0.81, 0.01);
  EXPECT_NEAR(most, 1.04, 0.01);
}

// Also within other materials; what has no roughness or is no conductor stays as it is.
TEST(CompensatedConductor, IsWhatTheOptionMakesOfRoughConductors) {
  const auto kinds = [](bool option) {
    SceneData scene;
    MaterialDescription rough = make_material<Conductor>(1, 0, 1, 0.3f, 0.2f, 0), textured = rough;
    textured.parameters[3].texture = 0;
    scene.materials = {rough, textured, make_material<Conductor>(1, 0, 1, 0, 0, 0),
                       make_material<RoughDielectric>(1, 1, 1.5f, 0.3f, 0.3f, 0),
                       make_two_sided(0, 1)};
    prepare_materials(scene, option);
    std::vector<MaterialKind> result;
    for (const Material& m : scene.material_records) result.push_back(m.kind);
    return result;
  };
  constexpr MaterialKind lossy = kind_of<Conductor>, whole = kind_of<CompensatedConductor>,
                         glass = kind_of<RoughDielectric>;
  EXPECT_EQ(kinds(false), (std::vector{lossy, lossy, lossy, glass, lossy}));
  EXPECT_EQ(kinds(true), (std::vector{whole, whole, lossy, glass, whole}));
}

TEST(MicrosurfaceWalk, MeetsOneFacetAsTheIntegralSays) {
  for (const double alpha : {0.3, 1.0}) {
    MicrosurfaceWalk walk(alpha);
    for (const double cosine : {0.15, 0.5, 0.95}) {
      const auto found = walk.albedo(tilted(cosine), white, 400'000);
      EXPECT_NEAR(found.once.x, single_albedo({alpha, alpha, false}, tilted(cosine), true, white).x,
                  3e-3);
      EXPECT_NEAR(found.all.x, 1, 1e-9);  // nothing is lost
    }
  }
}

// Real metals: facets with masking and shadowing of their own heights, where the BSDF takes them
// for independent and what is lost for diffuse.
TEST(CompensatedConductor, ReflectsAboutWhatAMicrosurfaceDoes) {
  for (const char* name : {"Cu", "Al", "Cr", "W"}) {
    const auto metal =
        std::ranges::find(mitsuba::conductors, std::string(name), &mitsuba::ConductorIndex::name);
    const auto reflectance = [&](double cosine) {
      return Vec3d(fresnel_conductor(static_cast<float>(cosine), metal->eta, metal->k));
    };
    for (const double alpha : {0.2, 0.5, 1.0}) {
      const auto a = static_cast<float>(alpha);
      const CompensatedConductor bsdf = compensated(metal->eta, metal->k, a, a, false);
      MicrosurfaceWalk walk(alpha);
      for (const double cosine : {0.15, 0.5, 0.95}) {
        SCOPED_TRACE(testing::Message() << name << ", alpha " << alpha << ", cosine " << cosine);
        const Vec3d expected = walk.albedo(tilted(cosine), reflectance, 50'000).all;
        const Vec3d found = albedo_of(bsdf, tilted(cosine));
        const Vec3d single = albedo_of<Conductor>(bsdf, tilted(cosine));
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(found[c], expected[c], alpha < 1 ? 0.045 : 0.12);
          EXPECT_LT(std::abs(found[c] - expected[c]),
                    0.6 * std::abs(single[c] - expected[c]) + 0.005);
        }
      }
    }
  }
}

}  // namespace
}  // namespace pt
