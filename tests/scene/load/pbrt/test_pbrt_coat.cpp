// How far coateddiffuse, a rough plastic here, is from pbrt's: a random walk between a boundary of
// facets and a diffuse body, written anew.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/scene/prepare/prepare_scene.h"
#include "load/pbrt_scene.h"
#include "render_serial.h"

namespace pt {
namespace {

using DVec3 = glm::dvec3;

struct Walk {
  double eta = 1.5, alpha = 0, body = 0.5, thickness = 0.01;
  int most = 1 << 20;  ///< encounters; 12: pbrt's maxdepth of 10
  std::mt19937_64 random{7};

  double uniform() { return std::uniform_real_distribution<double>()(random); }

  /// Trowbridge and Reitz, in proportion to D cos.
  DVec3 facet() {
    if (alpha == 0) return {0, 0, 1};
    const double u = uniform(), phi = 2 * double{pi} * uniform();
    const double tan2 = alpha * alpha * u / (1 - u), cosine = 1 / std::sqrt(1 + tan2);
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    return {sine * std::cos(phi), sine * std::sin(phi), cosine};
  }
  double lambda(const DVec3& w) const {
    const double tan2 = (1 - w.z * w.z) / (w.z * w.z);
    return 0.5 * (std::sqrt(1 + alpha * alpha * tan2) - 1);
  }

  /// w points away from the boundary, z to its outside; becomes the direction that light goes on
  /// to, `weight` what is left of it, 0 where facets hide it.
  void cross(DVec3& w, double& weight) {
    DVec3 m = facet();
    const bool outside = w.z > 0;
    if (!outside) m = -m;
    const double c = glm::dot(w, m);
    if (c <= 0) return void(weight = 0);
    const double n = outside ? 1 / eta : eta;  // of the side of w over the other one
    const double k = 1 - n * n * (1 - c * c);
    const double t = k > 0 ? std::sqrt(k) : 0;
    const double rs = (n * c - t) / (n * c + t), rp = (c - n * t) / (c + n * t);
    const bool reflects = k <= 0 || uniform() < 0.5 * (rs * rs + rp * rp);
    const DVec3 out = reflects ? 2 * c * m - w : (n * c - t) * m - n * w;
    if (out.z == 0 || (out.z > 0) != (outside == reflects)) return void(weight = 0);
    if (alpha > 0) weight *= c / (std::abs(w.z) * std::abs(m.z) * (1 + lambda(w) + lambda(out)));
    w = out;
  }

  /// The share of light from a direction that leaves the surface.
  double once(double cosine) {
    DVec3 w(std::sqrt(1 - cosine * cosine), 0, cosine);
    double weight = 1;
    for (int i = 0; i < most && weight > 0; i += 2) {
      cross(w, weight);
      if (w.z > 0) return weight;
      const double u = uniform(), phi = 2 * double{pi} * uniform();
      weight *= body * std::exp(-thickness / std::abs(w.z) - thickness / std::sqrt(1 - u));
      // Away from the boundary, to the body, from which it comes.
      w = -DVec3(std::sqrt(u) * std::cos(phi), std::sqrt(u) * std::sin(phi), std::sqrt(1 - u));
      if (weight < 1e-4) return 0;
    }
    return 0;
  }
  double albedo(double cosine) {
    constexpr int count = 100000;
    double sum = 0;
    for (int i = 0; i < count; ++i) sum += once(cosine);
    return sum / count;
  }
};

/// Ours: what a plane of the material shows of a white world.
double albedo_here(double cosine, double alpha, double body) {
  const double sine = std::sqrt(1 - cosine * cosine);
  const std::string text = fmt::format(
      "LookAt {} 0 {}  0 0 0  0 1 0\nFilm \"rgb\" \"integer xresolution\" 16 "
      "\"integer yresolution\" 16 PixelFilter \"box\"\n"
      "Camera \"orthographic\" \"float screenwindow\" [-.01 .01 -.01 .01]\nWorldBegin\n"
      "LightSource \"infinite\"\nMaterial \"coateddiffuse\" \"bool remaproughness\" false "
      "\"float roughness\" {} \"rgb reflectance\" [{} {} {}]\n"
      "Shape \"bilinearmesh\" \"point3 P\" [ -3 -3 0  3 -3 0  -3 3 0  3 3 0 ]\n",
      2 * sine, 2 * cosine, alpha, body, body, body);
  SceneData scene = load_pbrt_silently(text);
  Options options = image_options(16, 16, 256, 2);
  options.filter = FilterChoice();
  prepare_scene(scene, options);
  double sum = 0;
  for (const float value : render(scene, options).image.rgb) sum += double{value};
  return sum / 768;
}

struct CoatCase {
  double alpha, off_walk, off_pbrt;  ///< albedos may differ by
};

TEST(PbrtCoat, ReflectsAsMuchAsARandomWalkInIt) {
  // Rough plastic counts nothing that facets do to light within the coat. pbrt's own walk ends
  // after a number of encounters, which bright bodies feel.
  for (const CoatCase& c : {CoatCase{0.0, 0.006, 0.018}, CoatCase{0.1, 0.004, 0.010},
                            CoatCase{0.3, 0.012, 0.012}, CoatCase{0.6, 0.039, 0.046}}) {
    for (const double body : {0.2, 0.8}) {
      for (const double cosine : {0.95, 0.25}) {
        Walk walk;
        walk.alpha = c.alpha, walk.body = body;
        const double here = albedo_here(cosine, c.alpha, body);
        const std::string what =
            fmt::format("alpha {}, reflectance {}, cosine {}", c.alpha, body, cosine);
        EXPECT_NEAR(here, walk.albedo(cosine), c.off_walk) << what;
        walk.most = 12;
        EXPECT_NEAR(here, walk.albedo(cosine), c.off_pbrt) << what << ", pbrt's maxdepth";
      }
    }
  }
}

}  // namespace
}  // namespace pt
