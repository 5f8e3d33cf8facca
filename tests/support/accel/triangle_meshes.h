// Meshes that are hard on an acceleration structure, each kind in its own way.
#pragma once

#include <functional>
#include <ostream>

#include "common/geometry/mesh.h"
#include "statistics.h"

namespace pt {

inline Vec3 point_in_cube(TestRandom& random, double half_size) {
  const auto coordinate = [&] { return static_cast<float>(random.uniform(-half_size, half_size)); };
  const float x = coordinate(), y = coordinate();
  return {x, y, coordinate()};
}

inline void add_triangle(Mesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c});
  mesh.triangles.push_back({{first, first + 1, first + 2}});
}

/// Triangles of about `size` all over a cube of 20 units.
inline Mesh make_soup(int count, double size, const Vec3& at = Vec3(0.0f), std::uint64_t seed = 1) {
  TestRandom random(seed);
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3 p = at + point_in_cube(random, 10);
    const double s = size * random.log_uniform(0.1, 1);
    const Vec3 q = p + point_in_cube(random, s);
    add_triangle(mesh, p, q, p + point_in_cube(random, s));
  }
  return mesh;
}

/// A closed sphere of radius 5 with `n` strips from pole to pole, every vertex shared.
inline Mesh make_closed_sphere(int n) {
  Mesh mesh;
  const auto un = static_cast<std::uint32_t>(n);
  mesh.positions.push_back({0, 0, 5});
  for (int i = 1; i < n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      const double theta = pi_double * i / n, phi = pi_double * j / n;
      mesh.positions.emplace_back(5 * std::sin(theta) * std::cos(phi),
                                  5 * std::sin(theta) * std::sin(phi), 5 * std::cos(theta));
    }
  }
  mesh.positions.push_back({0, 0, -5});
  const auto vertex = [&](std::uint32_t i, std::uint32_t j) {
    if (i == 0) return 0u;
    if (i == un) return static_cast<std::uint32_t>(mesh.positions.size() - 1);
    return 1 + (i - 1) * 2 * un + j % (2 * un);
  };
  for (std::uint32_t i = 0; i < un; ++i) {
    for (std::uint32_t j = 0; j < 2 * un; ++j) {
      if (i + 1 < un) {
        mesh.triangles.push_back({{vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)}});
      }
      if (i > 0) mesh.triangles.push_back({{vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)}});
    }
  }
  return mesh;
}

/// n x n squares of two triangles in the plane z = 1, on whole numbers.
inline Mesh make_flat_grid(int n) {
  Mesh mesh;
  const auto un = static_cast<std::uint32_t>(n);
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) mesh.positions.emplace_back(x, y, 1);
  }
  for (std::uint32_t y = 0; y < un; ++y) {
    for (std::uint32_t x = 0; x < un; ++x) {
      const std::uint32_t a = y * (un + 1) + x, b = a + un + 1;
      mesh.triangles.push_back({{a, a + 1, b + 1}});
      mesh.triangles.push_back({{a, b + 1, b}});
    }
  }
  return mesh;
}

/// Needles of up to 20 units length in all directions.
inline Mesh make_needles(int count) {
  TestRandom random(4);
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3 a = point_in_cube(random, 10), b = point_in_cube(random, 10);
    add_triangle(mesh, a, b, 0.5f * (a + b) + point_in_cube(random, 0.02));
  }
  return mesh;
}

/// Needles side by side along a diagonal: boxes of whole ones overlap, those of their parts do not.
inline Mesh make_slanted(int count) {
  TestRandom random(5);
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3 a = point_in_cube(random, 2) - Vec3(10.0f), b = a + Vec3(20.0f);
    add_triangle(mesh, a, b, 0.5f * (a + b) + point_in_cube(random, 0.02));
  }
  return mesh;
}

/// Every triangle several times.
inline Mesh make_coincident(int count) {
  Mesh mesh = make_soup((count + 4) / 5, 3);
  const std::vector<TriangleIndices> once = mesh.triangles;
  while (static_cast<int>(mesh.triangles.size()) < count) {
    mesh.triangles.push_back(once[mesh.triangles.size() % once.size()]);
  }
  return mesh;
}

/// Among others, triangles that are points or lines.
inline Mesh make_degenerate(int count) {
  TestRandom random(6);
  Mesh mesh = make_soup(count, 2);
  for (TriangleIndices& t : mesh.triangles) {
    if (random.bits() % 2) t.v[1] = t.v[0];
    if (random.bits() % 4 == 0) t.v[2] = t.v[0];
    if (random.bits() % 4 == 0) {
      mesh.positions[t.v[2]] = 0.5f * (mesh.positions[t.v[0]] + mesh.positions[t.v[1]]);
    }
  }
  return mesh;
}

/// Each triangle smaller and nearer to the origin than the one before: a tree that splits where it
/// is cheapest is nearly a list.
inline Mesh make_geometric_series(int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const float s = std::ldexp(1.0f, 38 - i);
    add_triangle(mesh, {s, s, s}, {1.5f * s, s, s}, {s, 1.5f * s, 1.2f * s});
  }
  return mesh;
}

/// Scales and then moves a mesh.
inline Mesh moved(Mesh mesh, float scale, const Vec3& by) {
  for (Vec3& p : mesh.positions) p = scale * p + by;
  return mesh;
}

struct MeshKind {
  const char* name;
  std::function<Mesh(int count)> make;
};
inline void PrintTo(const MeshKind& kind, std::ostream* out) { *out << kind.name; }

inline int strips(int count) { return std::max(2, static_cast<int>(std::sqrt(count / 4.0))); }

inline const MeshKind mesh_kinds[] = {
    {"soup", [](int n) { return make_soup(n, 3); }},
    {"tiny_soup", [](int n) { return moved(make_soup(n, 3), 1e-4f, Vec3(0.0f)); }},
    {"soup_far_away",
     [](int n) {
       return make_soup(n, 3, {1e5f, -1e5f, 1e5f});
     }},
    {"closed_sphere", [](int n) { return make_closed_sphere(strips(n)); }},
    {"flat_grid", [](int n) { return make_flat_grid(strips(2 * n)); }},
    {"needles", [](int n) { return make_needles(n); }},
    {"slanted", [](int n) { return make_slanted(n); }},
    {"coincident", [](int n) { return make_coincident(n); }},
    {"degenerate", [](int n) { return make_degenerate(n); }},
};

}  // namespace pt
