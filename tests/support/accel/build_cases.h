// Meshes for the tests of the device builders.
#pragma once

#include <functional>
#include <string>

#include "accel/triangle_meshes.h"
#include "common/geometry/triangle.h"

namespace pt {

inline std::vector<Triangle> numbered(std::vector<Triangle> triangles) {
  for (std::uint32_t i = 0; i < triangles.size(); ++i) triangles[i].id = i;
  return triangles;
}

inline Triangle triangle_at(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {a, 0, b, 0, c, 0};
}

/// A grid over [0, 1]^2 with hills of eight sizes; about `count` triangles, at least as many.
inline Mesh make_hills(std::uint32_t count) {
  const auto side = static_cast<std::uint32_t>(std::ceil(std::sqrt(count / 2.0)));
  constexpr int octaves = 8;
  struct Waves {
    float at[octaves];
  };
  std::vector<Waves> along_x(side + 1), along_y(side + 1);
  for (std::uint32_t i = 0; i <= side; ++i) {
    float size = 0.1f, frequency = 7;
    for (int octave = 0; octave < octaves; ++octave, size *= 0.5f, frequency *= 2.3f) {
      const float phase = frequency * static_cast<float>(i) / static_cast<float>(side);
      along_x[i].at[octave] = size * std::sin(phase + static_cast<float>(octave));
      along_y[i].at[octave] = std::cos(phase);
    }
  }
  Mesh mesh;
  mesh.positions.reserve(std::size_t{side + 1} * (side + 1));
  mesh.triangles.reserve(std::size_t{side} * side * 2);
  for (std::uint32_t j = 0; j <= side; ++j) {
    for (std::uint32_t i = 0; i <= side; ++i) {
      float height = 0;
      for (int octave = 0; octave < octaves; ++octave)
        height += along_x[i].at[octave] * along_y[j].at[octave];
      mesh.positions.push_back({static_cast<float>(i) / static_cast<float>(side),
                                static_cast<float>(j) / static_cast<float>(side), height});
    }
  }
  for (std::uint32_t j = 0; j < side; ++j) {
    for (std::uint32_t i = 0; i < side; ++i) {
      const std::uint32_t v = j * (side + 1) + i, w = v + side + 1;
      mesh.triangles.push_back({{v, v + 1, w}});
      mesh.triangles.push_back({{v + 1, w + 1, w}});
    }
  }
  return mesh;
}

inline std::vector<Triangle> triangles_of(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for (const TriangleIndices& t : mesh.triangles) {
    triangles.push_back(
        triangle_at(mesh.positions[t.v[0]], mesh.positions[t.v[1]], mesh.positions[t.v[2]]));
  }
  return numbered(std::move(triangles));
}

inline std::vector<Triangle> make_soup(std::uint32_t count, double extent, double size) {
  TestRandom random(count);
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 p = point_in_cube(random, extent);
    triangles.push_back(
        triangle_at(p, p + point_in_cube(random, size), p + point_in_cube(random, size)));
  }
  return numbered(std::move(triangles));
}

struct BuildCase {
  const char* name;
  std::function<std::vector<Triangle>(std::uint32_t)> make;
};

inline void PrintTo(const BuildCase& c, std::ostream* out) { *out << c.name; }

inline const BuildCase build_cases[] = {
    {"soup", [](std::uint32_t n) { return make_soup(n, 10, 1); }},
    {"hills",
     [](std::uint32_t n) {
       std::vector<Triangle> triangles = triangles_of(make_hills(n));
       triangles.resize(n);
       return triangles;
     }},
    {"copies_of_one",
     [](std::uint32_t n) {
       return numbered(std::vector<Triangle>(n, triangle_at({0, 0, 0}, {1, 0, 0}, {0, 1, 1})));
     }},
    {"one_center",
     [](std::uint32_t n) {
       std::vector<Triangle> triangles;
       for (std::uint32_t i = 0; i < n; ++i) {
         const float r = 1.0f + static_cast<float>(i);
         triangles.push_back(triangle_at({-r, -r, 0}, {r, -r, 0}, {0, r, 0}));
       }
       return numbered(std::move(triangles));
     }},
    {"points",
     [](std::uint32_t n) {
       std::vector<Triangle> triangles = make_soup(n, 1, 0);
       for (std::uint32_t i = 0; i < n; i += 2) triangles[i].v1 = triangles[i].v2 = triangles[0].v0;
       return triangles;
     }},
    {"all_scales",  // each a little larger and further away than the last
     [](std::uint32_t n) {
       std::vector<Triangle> triangles;
       for (std::uint32_t i = 0; i < n; ++i) {
         const float s = std::exp2(static_cast<float>(i % 80) - 42.0f);
         triangles.push_back(triangle_at({s, 0, 0}, {2 * s, 0, 0}, {s, s, s}));
       }
       return numbered(std::move(triangles));
     }},
    {"huge", [](std::uint32_t n) { return make_soup(n, 9e11, 9e10); }},
    {"tiny", [](std::uint32_t n) { return make_soup(n, 1e-36, 1e-37); }},
    {"far_away",
     [](std::uint32_t n) {
       std::vector<Triangle> triangles = make_soup(n, 20, 5);
       for (Triangle& t : triangles)
         for (Vec3* v : {&t.v0, &t.v1, &t.v2}) *v += Vec3(3e6f, -2e6f, 1e6f);
       return triangles;
     }},
};

}  // namespace pt
