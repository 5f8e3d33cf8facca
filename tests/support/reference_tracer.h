// A second path tracer, for comparison: double precision, textbook formulas, no light sampling.
#pragma once

#include "common/scene/prepare/prepare_scene.h"
#include "statistics.h"

namespace pt {

class ReferenceTracer {
 public:
  using Vec3d = glm::dvec3;

  /// Traces diffuse and metal surfaces; `scene` is prepared, with a pinhole camera.
  ReferenceTracer(const SceneData& scene, int max_depth) : scene_(scene), max_depth_(max_depth) {}

  /// A sample of the radiance that arrives through the film point (s, t), each in [-1, 1], to the
  /// right and up.
  Vec3d sample(double aspect, double s, double t, TestRandom& random) const {
    const CameraParameters& c = scene_.camera;
    const Vec3d forward = glm::normalize(Vec3d(c.look_at) - Vec3d(c.look_from));
    const Vec3d right = glm::normalize(glm::cross(forward, Vec3d(c.up)));
    const double half = std::tan(c.fov_degrees * pi_double / 360);
    const Vec3d direction =
        forward + s * aspect * half * right + t * half * glm::cross(right, forward);
    return trace(Vec3d(c.look_from), glm::normalize(direction), random);
  }

 private:
  struct Found {
    double t = 1e30;
    Vec3d normal{0};
    const MaterialDescription* material = nullptr;
  };

  void intersect_sphere(std::size_t i, const Vec3d& o, const Vec3d& d, Found& found) const {
    const Vec3d center(scene_.spheres[i].center);
    const double r2 = scene_.spheres[i].radius_squared, b = glm::dot(o - center, d);
    const double discriminant = b * b - glm::dot(o - center, o - center) + r2;
    if (discriminant < 0) return;
    for (const double t : {-b - std::sqrt(discriminant), -b + std::sqrt(discriminant)}) {
      if (t > epsilon && t < found.t) {
        found = {t, (o + t * d - center) / std::sqrt(r2), material(i)};
      }
    }
  }

  void intersect_quad(std::size_t i, const Vec3d& o, const Vec3d& d, Found& found) const {
    // Solves o + t d = corner + a edge_a + b edge_b by Cramer's rule.
    const Quad& quad = scene_.quads[i];
    const Vec3d ea(quad.edge_a), eb(quad.edge_b), n = glm::cross(ea, eb);
    const double det = glm::dot(n, d);
    const Vec3d from = o - Vec3d(quad.corner);
    const double t = -glm::dot(n, from) / det;
    const double a = -glm::dot(glm::cross(eb, from), d) / det;
    const double b = glm::dot(glm::cross(ea, from), d) / det;
    if (t > epsilon && t < found.t && a >= 0 && a <= 1 && b >= 0 && b <= 1) {
      found = {t, glm::normalize(n), material(scene_.spheres.size() + i)};
    }
  }

  const MaterialDescription* material(std::size_t primitive) const {
    return &scene_.materials[scene_.material_of[primitive]];
  }

  static Vec3d point_in_ball(TestRandom& random) {
    for (;;) {
      const Vec3d p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      if (glm::dot(p, p) < 1) return p;
    }
  }

  Vec3d trace(Vec3d o, Vec3d d, TestRandom& random) const {
    Vec3d radiance(0), beta(1);
    for (int ray = 1;; ++ray) {
      Found found;
      for (std::size_t i = 0; i < scene_.spheres.size(); ++i) intersect_sphere(i, o, d, found);
      for (std::size_t i = 0; i < scene_.quads.size(); ++i) intersect_quad(i, o, d, found);
      if (!found.material) {
        const double height = 0.5 * (d.y + 1);
        return radiance +
               beta * ((1 - height) * Vec3d(scene_.sky.nadir) + height * Vec3d(scene_.sky.zenith));
      }
      const MaterialDescription& m = *found.material;
      const double cosine = -glm::dot(d, found.normal);
      if (cosine > 0) radiance += beta * Vec3d(m.emission.radiance);
      if (ray == max_depth_) return radiance;
      const Vec3d n = cosine > 0 ? found.normal : -found.normal;
      Vec3d next;
      if (m.kind == kind_of<Metal>) {
        next =
            d - 2 * glm::dot(d, n) * n + static_cast<double>(m.scalar(1)) * point_in_ball(random);
        if (glm::dot(next, n) <= 0) return radiance;
      } else {
        next = n + random.direction();
      }
      beta *= Vec3d(m.color(0));
      o += found.t * d;
      d = glm::normalize(next);
    }
  }

  static constexpr double epsilon = 1e-7;
  const SceneData& scene_;
  int max_depth_;
};

}  // namespace pt
