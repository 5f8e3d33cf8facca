// Spheres, disks and cylinders, whole and cut (pbrt-v4, sections 6.2 to 6.4), as triangles.
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/scene/load/files/importer.h"
#include "common/scene/load/pbrt/scene_parts.h"

namespace pt::pbrt {
namespace {

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
  const Vec3 across = glm::cross(q - p, r - p);
  const float longest = std::max({glm::length(q - p), glm::length(r - p), glm::length(r - q)});
  // Twice the area; rounding leaves a little of none.
  if (!(glm::length(across) > 1e-6f * longest * longest)) return;
  const Vec3 normals = mesh.normals[a] + mesh.normals[b] + mesh.normals[c];
  if (glm::dot(across, normals) < 0.0f) std::swap(b, c);
  mesh.triangles.push_back({{a, b, c}});
}

}  // namespace

void tessellate(Mesh& mesh, int columns, int rows,
                const std::function<SurfacePoint(float u, float v)>& surface) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(columns);
      const float v = static_cast<float>(j) / static_cast<float>(rows);
      const SurfacePoint point = surface(u, v);
      mesh.positions.push_back(point.position);
      mesh.normals.push_back(point.normal);
      mesh.uvs.emplace_back(u, v);
    }
  }
  const auto at = [&](int i, int j) {
    return first + static_cast<std::uint32_t>(j * (columns + 1) + i);
  };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      add_triangle(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add_triangle(mesh, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
}

namespace {

float read_radius(const Parameters& parameters) {
  const float radius = parameters.number("radius", 1.0f);
  if (radius > 0.0f) return radius;
  fail(parameters.place(), "{}: radius {}; expected a length above 0", parameters.what(), radius);
}

/// The angle that u covers, radians.
float read_phi_max(const Parameters& parameters) {
  return glm::clamp(parameters.number("phimax", 360.0f), 0.0f, 360.0f) * pi / 180.0f;
}

/// cos and sin of u * phi_max; the circle closes exactly.
Vec2 around(float u, float phi_max) {
  const bool closes = u >= 1.0f && phi_max >= 2.0f * pi;
  const double angle = closes ? 0.0 : double{u} * double{phi_max};
  return {std::cos(angle), std::sin(angle)};
}

int columns_for(float phi_max) {
  return std::max(3, static_cast<int>(std::ceil(circle_segments * phi_max / (2.0f * pi))));
}

struct SphereCut {
  float radius, z_min, z_max, phi_max;
};

SphereCut read_cut(const Parameters& parameters) {
  const float r = read_radius(parameters);
  const float a = glm::clamp(parameters.number("zmin", -r), -r, r);
  const float b = glm::clamp(parameters.number("zmax", r), -r, r);
  return {r, std::min(a, b), std::max(a, b), read_phi_max(parameters)};
}

}  // namespace

std::optional<float> whole_sphere(const Entity& entity) {
  const SphereCut cut = read_cut(entity.parameters);
  const bool whole =
      cut.z_min <= -cut.radius && cut.z_max >= cut.radius && cut.phi_max >= 2.0f * pi;
  return whole ? std::optional(cut.radius) : std::nullopt;
}

/// v grows from the lowest z to the highest, with the angle.
Mesh read_sphere(Context&, const Entity& entity, const ShapeMaterial&) {
  const SphereCut cut = read_cut(entity.parameters);
  const double low = std::acos(cut.z_min / cut.radius), high = std::acos(cut.z_max / cut.radius);
  Mesh mesh;
  const auto surface = [&](float u, float v) {
    const double theta = low + double{v} * (high - low);
    const bool is_pole =
        (v <= 0.0f && cut.z_min <= -cut.radius) || (v >= 1.0f && cut.z_max >= cut.radius);
    const float s = is_pole ? 0.0f : static_cast<float>(std::sin(theta));
    const Vec2 p = around(u, cut.phi_max);
    const Vec3 normal(s * p.x, s * p.y, static_cast<float>(std::cos(theta)));
    return SurfacePoint{cut.radius * normal, normal};
  };
  tessellate(mesh, columns_for(cut.phi_max), meridian_segments, surface);
  return mesh;
}

/// v grows from the rim inwards.
Mesh read_disk(Context&, const Entity& entity, const ShapeMaterial& material) {
  const Parameters& parameters = entity.parameters;
  const float radius = read_radius(parameters), phi_max = read_phi_max(parameters);
  const float height = parameters.number("height", 0.0f);
  const float inner = glm::clamp(parameters.number("innerradius", 0.0f), 0.0f, radius);
  Mesh mesh;
  const auto surface = [&](float u, float v) {
    const float r = v >= 1.0f ? inner : radius + v * (inner - radius);
    const Vec2 p = around(u, phi_max);
    return SurfacePoint{{r * p.x, r * p.y, height}, {0, 0, 1}};
  };
  tessellate(mesh, columns_for(phi_max), material.textured ? disk_rings : 1, surface);
  return mesh;
}

Mesh read_cylinder(Context&, const Entity& entity, const ShapeMaterial&) {
  const Parameters& parameters = entity.parameters;
  const float radius = read_radius(parameters), phi_max = read_phi_max(parameters);
  const float a = parameters.number("zmin", -1.0f), b = parameters.number("zmax", 1.0f);
  const float low = std::min(a, b), high = std::max(a, b);
  Mesh mesh;
  const auto surface = [&](float u, float v) {
    const Vec2 p = around(u, phi_max);
    return SurfacePoint{{radius * p.x, radius * p.y, low + v * (high - low)}, {p.x, p.y, 0}};
  };
  tessellate(mesh, columns_for(phi_max), 1, surface);
  return mesh;
}

}  // namespace pt::pbrt
