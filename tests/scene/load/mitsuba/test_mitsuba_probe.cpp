// What the loader of Mitsuba's XML made of a scene, seen along rays: the C++ half of the comparison
// with Mitsuba 3 in test_mitsuba_reference.py. Everything is tested against everything, in double
// precision and without the project's intersection code.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>

#include "common/scene/data/camera.h"
#include "common/scene/load/load_scene.h"
#include "common/texture/sample_texture.h"

namespace pt {
namespace {

using DVec3 = glm::dvec3;

struct Probe {
  double t = 1e30;
  DVec3 side{0.0};     ///< the geometric normal: where the surface emits
  DVec3 shading{0.0};  ///< the normal by vertex, or the same
  std::optional<Vec2> uv;
  std::uint32_t material = 0;
};

/// Distance and barycentric coordinates (Moeller and Trumbore 1997).
std::optional<DVec3> hit_triangle(const DVec3& o, const DVec3& d, const DVec3& a, const DVec3& b,
                                  const DVec3& c, bool parallelogram) {
  const DVec3 e1 = b - a, e2 = c - a, p = glm::cross(d, e2), s = o - a, q = glm::cross(s, e1);
  const double determinant = glm::dot(e1, p);
  if (determinant == 0) return std::nullopt;
  const double u = glm::dot(s, p) / determinant, v = glm::dot(d, q) / determinant;
  const double t = glm::dot(e2, q) / determinant;
  const bool inside = u >= 0 && v >= 0 && (parallelogram ? u <= 1 && v <= 1 : u + v <= 1);
  return inside && t > 1e-6 ? std::optional(DVec3(t, u, v)) : std::nullopt;
}

/// Within a hundredth of the mesh's size.
bool passes_by(const Mesh& mesh, const DVec3& o, const DVec3& d) {
  Vec3 low(1e30f), high(-1e30f);
  for (const Vec3& p : mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
  const DVec3 center = 0.5f * (low + high);
  const double radius = 0.51 * glm::length(high - low);
  return glm::length(glm::cross(center - o, d)) > radius * glm::length(d);
}

void probe_mesh(const Mesh& mesh, const DVec3& o, const DVec3& d, Probe& nearest) {
  if (passes_by(mesh, o, d)) return;
  for (const TriangleIndices& triangle : mesh.triangles) {
    const auto& [i, j, k] = triangle.v;
    const DVec3 a = mesh.positions[i], b = mesh.positions[j], c = mesh.positions[k];
    const auto hit = hit_triangle(o, d, a, b, c, false);
    if (!hit || hit->x >= nearest.t) continue;
    nearest.t = hit->x;
    nearest.side = glm::normalize(glm::cross(b - a, c - a));
    nearest.shading = nearest.side;
    nearest.material = mesh.material;
    const auto u = static_cast<float>(hit->y), v = static_cast<float>(hit->z), w = 1.0f - u - v;
    nearest.uv.reset();
    if (!mesh.normals.empty()) {
      nearest.shading =
          glm::normalize(w * mesh.normals[i] + u * mesh.normals[j] + v * mesh.normals[k]);
    }
    if (!mesh.uvs.empty()) nearest.uv = w * mesh.uvs[i] + u * mesh.uvs[j] + v * mesh.uvs[k];
  }
}

void probe_instances(const SceneData& scene, const DVec3& o, const DVec3& d, Probe& nearest) {
  for (const Instance& instance : scene.instances) {
    const Affine back = inverse(instance.to_world);
    Probe inside = nearest;
    for (const Mesh& mesh : scene.meshes) {
      if (mesh.group != instance.group) continue;
      probe_mesh(mesh, back.point(o), back.vector(d), inside);
    }
    if (inside.t >= nearest.t) continue;
    nearest = inside;
    nearest.side = glm::normalize(DVec3(back.transposed(inside.side)));
    nearest.shading = glm::normalize(DVec3(back.transposed(inside.shading)));
  }
}

void probe_quads(const SceneData& scene, const DVec3& o, const DVec3& d, Probe& nearest) {
  for (std::size_t i = 0; i < scene.quads.size(); ++i) {
    const Quad& quad = scene.quads[i];
    const DVec3 a = quad.corner, b = quad.edge_a, c = quad.edge_b;
    const auto hit = hit_triangle(o, d, a, a + b, a + c, true);
    if (!hit || hit->x >= nearest.t) continue;
    nearest = {hit->x, quad.normal, quad.normal, std::nullopt, scene.quad_material[i]};
  }
}

void probe_spheres(const SceneData& scene, const DVec3& o, const DVec3& d, Probe& nearest) {
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    const DVec3 to_center = DVec3(scene.spheres[i].center) - o;
    const double b = glm::dot(to_center, d);
    const double rest =
        b * b - glm::dot(to_center, to_center) + double{scene.spheres[i].radius_squared};
    if (rest < 0) continue;
    const double t = b - std::sqrt(rest) > 1e-6 ? b - std::sqrt(rest) : b + std::sqrt(rest);
    if (t <= 1e-6 || t >= nearest.t) continue;
    const DVec3 normal = glm::normalize(t * d - to_center);
    nearest = {t, normal, normal, std::nullopt, scene.sphere_material[i]};
    if (scene.sphere_frames.empty()) continue;
    const SphereFrame& frame = scene.sphere_frames[i];
    nearest.uv = sphere_uv(frame.local(normal));
    nearest.side *= frame.side, nearest.shading *= frame.side;
  }
}

Color environment_radiance(const EnvironmentData& environment, const DVec3& d) {
  if (environment.width == 0) return Color(0.0f);
  const Vec3 local = inverse(environment.to_world).vector(d);
  const double u = 0.5 + std::atan2(local.x, -local.z) / (2 * std::acos(-1.0));
  const double v = std::acos(std::min(1.0f, std::max(-1.0f, local.y))) / std::acos(-1.0);
  const int w = environment.width, h = environment.height;
  const auto texel = [&](int x, int y) {
    const int row = std::min(std::max(y, 0), h - 1), column = (x + w) % w;
    return environment.pixels[static_cast<std::size_t>(row) * w + column];
  };
  const double x = u * w - 0.5, y = v * h - 0.5;
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  const auto s = static_cast<float>(x - i), t = static_cast<float>(y - j);
  return (1 - t) * ((1 - s) * texel(i, j) + s * texel(i + 1, j)) +
         t * ((1 - s) * texel(i, j + 1) + s * texel(i + 1, j + 1));
}

void print(std::ostream& out, const Vec3& v) { out << v.x << ' ' << v.y << ' ' << v.z << ' '; }

/// One line: o, d, and after "hit" t, side, shading, kind, albedo, emission and uv as Mitsuba's; or
/// after "miss" the radiance of the sky.
void print_probe(std::ostream& out, const SceneData& scene, const Vec3& o, const Vec3& d) {
  Probe nearest;
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.group == 0) probe_mesh(mesh, o, d, nearest);
  }
  probe_instances(scene, o, d, nearest);
  probe_quads(scene, o, d, nearest);
  probe_spheres(scene, o, d, nearest);
  print(out, o), print(out, d);
  if (nearest.t >= 1e30) {
    out << "miss ";
    print(out, environment_radiance(scene.environment, d) + sky_radiance(scene.sky, d));
    out << '\n';
    return;
  }
  const MaterialDescription& material = scene.materials[nearest.material];
  const std::uint32_t albedo_map = material.parameters[0].texture;
  const std::uint32_t emission_map = material.emission.texture;
  Color albedo = material.color(0), emission = material.emission.radiance;
  const auto look_up = [&](std::uint32_t texture) {
    return sample_texture(scene.textures[texture], scene.texels.data(), *nearest.uv);
  };
  if (nearest.uv && albedo_map != no_texture) albedo *= look_up(albedo_map);
  if (nearest.uv && emission_map != no_texture) emission *= look_up(emission_map);
  out << "hit " << nearest.t << ' ';
  print(out, nearest.side), print(out, nearest.shading);
  out << static_cast<int>(material.kind) << ' ';
  print(out, albedo), print(out, emission);
  if (nearest.uv) out << nearest.uv->x << ' ' << 1.0f - nearest.uv->y;
  out << '\n';
}

// Environment: PTEXP_PROBE_SCENE, a scene; PTEXP_PROBE_RAYS, a file of lines "film X Y" (in [0, 1],
// from the upper left) and "ray OX OY OZ DX DY DZ"; PTEXP_PROBE_OUT, where the probes go.
TEST(MitsubaProbe, printsWhatRaysMeet) {
  const char* path = std::getenv("PTEXP_PROBE_SCENE");
  if (!path) GTEST_SKIP() << "run by test_mitsuba_reference.py";
  const SceneData scene = load_mitsuba_xml(path);
  const Camera camera = make_camera(scene.camera, *scene.defaults.width, *scene.defaults.height);
  std::ifstream rays(std::getenv("PTEXP_PROBE_RAYS"));
  std::ofstream out(std::getenv("PTEXP_PROBE_OUT"));
  out.precision(9);
  std::string kind;
  while (rays >> kind) {
    Vec3 o, d;
    if (kind == "film") {
      float x = 0, y = 0;
      rays >> x >> y;
      const Ray ray = camera_ray(camera, x * static_cast<float>(*scene.defaults.width),
                                 y * static_cast<float>(*scene.defaults.height), 0.5f, 0.5f);
      o = ray.origin, d = ray.direction;
    } else {
      rays >> o.x >> o.y >> o.z >> d.x >> d.y >> d.z;
    }
    print_probe(out, scene, o, d);
  }
  EXPECT_TRUE(out.good());
}

}  // namespace
}  // namespace pt
