// Faces of more than three corners are covered once, whatever their shape and first corner.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "common/scene/load/files/meshes/mesh_files.h"
#include "load/mesh_bytes.h"

namespace pt {
namespace {

using Ring = std::vector<Vec3>;

Ring flat(const std::vector<Vec2>& points) {
  Ring ring;
  for (const Vec2& p : points) ring.emplace_back(p.x, p.y, 0.0f);
  return ring;
}

const Ring l_shape = flat({{-2, -2}, {2, -2}, {2, -1}, {-1, -1}, {-1, 2}, {-2, 2}});

std::string obj_of(const Ring& ring) {
  std::string text, face = "f";
  for (std::size_t i = 0; i < ring.size(); ++i) {
    text += fmt::format("v {} {} {}\n", ring[i].x, ring[i].y, ring[i].z);
    face += fmt::format(" {}", i + 1);
  }
  return text + face + "\n";
}

/// A face of the ring, and before it one of three corners if not all are to be alike.
std::string ply_of(const Ring& ring, bool binary, bool equal) {
  std::string text = fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nelement face {}\nproperty list ushort uint vertex_indices\nend_header\n",
      binary ? "binary_little_endian" : "ascii", ring.size(), equal ? 1 : 2);
  MeshBytes body;
  std::string words;
  for (const Vec3& p : ring) {
    body.put(p.x).put(p.y).put(p.z);
    words += fmt::format("{} {} {}\n", p.x, p.y, p.z);
  }
  if (!equal) {
    body.put<std::uint16_t>(3).put(0u).put(0u).put(0u);
    words += "3 0 0 0\n";
  }
  body.put(static_cast<std::uint16_t>(ring.size()));
  words += fmt::format("{}", ring.size());
  for (std::uint32_t i = 0; i < ring.size(); ++i) {
    body.put(i);
    words += fmt::format(" {}", i);
  }
  return text + (binary ? body.text : words + "\n");
}

std::vector<Mesh> meshes_of(const Ring& ring) {
  std::vector<Mesh> meshes = {decode_obj(obj_of(ring), "a.obj")};
  for (int kind = 0; kind < 4; ++kind) {
    meshes.push_back(decode_ply(ply_of(ring, kind & 1, kind & 2), "a.ply"));
  }
  return meshes;
}

glm::dvec3 doubled_area(const Mesh& mesh, const TriangleIndices& t) {
  const glm::dvec3 a(mesh.positions[t.v[0]]), b(mesh.positions[t.v[1]]), c(mesh.positions[t.v[2]]);
  return glm::cross(b - a, c - a);
}

/// Areas add up to `area`, with and without their signs as seen along `normal`: so the triangles
/// cover the face once, since those of any triangulation add up with their signs.
void expect_covered_once(const Ring& ring, double area, const glm::dvec3& normal = {0, 0, 1},
                         double tolerance = 1e-5) {
  for (const Mesh& mesh : meshes_of(ring)) {
    double sum = 0, all = 0;
    for (const TriangleIndices& t : mesh.triangles) {
      const double part = 0.5 * glm::dot(doubled_area(mesh, t), normal);
      sum += part, all += std::abs(part);
    }
    EXPECT_GE(mesh.triangles.size(), ring.size() - 2);
    EXPECT_NEAR(sum, area, tolerance * std::abs(area));
    EXPECT_NEAR(all, std::abs(area), tolerance * std::abs(area));
  }
}

void expect_covered_from_all_corners(Ring ring, double area, const glm::dvec3& normal = {0, 0, 1}) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "first corner " << i);
    expect_covered_once(ring, area, normal);
    expect_covered_once(Ring(ring.rbegin(), ring.rend()), -area, normal);  // seen from behind
    std::rotate(ring.begin(), ring.begin() + 1, ring.end());
  }
}

TEST(Polygons, AreCoveredOnceFromAnyCorner) {
  struct Case {
    const char* what;
    std::vector<Vec2> points;
    double area;
  };
  const Case cases[] = {
      {"arrow", {{0, 0}, {2, 2}, {0, 1}, {-2, 2}}, 2},
      {"L", {{-2, -2}, {2, -2}, {2, -1}, {-1, -1}, {-1, 2}, {-2, 2}}, 7},
      {"U", {{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}, 7},
      {"U with corners on its edges",
       {{0, 0},
        {1, 0},
        {2, 0},
        {3, 0},
        {3, 1},
        {3, 3},
        {2, 3},
        {2, 2},
        {2, 1},
        {1, 1},
        {1, 3},
        {0, 3},
        {0, 2}},
       7},
      {"plus",
       {{1, 0},
        {2, 0},
        {2, 1},
        {3, 1},
        {3, 2},
        {2, 2},
        {2, 3},
        {1, 3},
        {1, 2},
        {0, 2},
        {0, 1},
        {1, 1}},
       5},
      {"L with corners twice",
       {{-2, -2}, {2, -2}, {2, -2}, {2, -1}, {-1, -1}, {-1, -1}, {-1, 2}, {-2, 2}},
       7},
      {"L with a spike",
       {{-2, -2}, {2, -2}, {2, -1}, {-1, -1}, {3, 5}, {-1, -1}, {-1, 2}, {-2, 2}},
       7},
      {"two squares that touch",
       {{0, 0}, {1, 0}, {1, 1}, {2, 1}, {2, 2}, {1, 2}, {1, 1}, {0, 1}},
       2},
      {"square with a square hole and a bridge",
       {{0, 0}, {3, 0}, {3, 3}, {0, 3}, {0, 0}, {1, 1}, {1, 2}, {2, 2}, {2, 1}, {1, 1}},
       8},
      {"two holes in a row, bridged along one line",
       {{0, 0}, {7, 0}, {7, 4}, {0, 4}, {0, 2}, {1, 2}, {1, 3}, {3, 3}, {3, 2}, {4, 2},
        {4, 3}, {6, 3}, {6, 1}, {4, 1}, {4, 2}, {3, 2}, {3, 1}, {1, 1}, {1, 2}, {0, 2}},
       20},
      {"spiral",
       {{0, 0},
        {6, 0},
        {6, 6},
        {1, 6},
        {1, 2},
        {4, 2},
        {4, 4},
        {3, 4},
        {3, 3},
        {2, 3},
        {2, 5},
        {5, 5},
        {5, 1},
        {0, 1}},
       21}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    expect_covered_from_all_corners(flat(c.points), c.area);
  }
}

TEST(Polygons, AreCoveredOnceInAnyPlaneAndPlace) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> number(-1.0f, 1.0f);
  for (int i = 0; i < 40; ++i) {
    const Vec3 z = glm::normalize(Vec3(number(random), number(random), number(random)));
    const Vec3 x = glm::normalize(glm::cross(z, Vec3(0.3f, 0.5f, -0.8f))), y = glm::cross(z, x);
    const Vec3 place = i % 2 == 0 ? Vec3(0.0f) : Vec3(300.0f, -200.0f, 100.0f);
    Ring ring;
    for (const Vec3& p : l_shape) ring.push_back(place + p.x * x + p.y * y);
    expect_covered_once(ring, 7.0, glm::dvec3(z), 1e-4);
  }
}

/// What assimp's concave_polygon.obj is: a disk of many corners with a hole, joined by a bridge.
Ring keyhole(std::mt19937& random, int corners, double* area) {
  std::uniform_real_distribution<double> wobble(0.4, 1.0);
  std::vector<Vec2> outer, inner;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / corners;
    const Vec2 direction(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
    outer.push_back(static_cast<float>(2.0 * wobble(random)) * direction);
    inner.push_back(static_cast<float>(0.7 * wobble(random)) * direction);
  }
  const auto area_of = [](const std::vector<Vec2>& p) {
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Vec2 a = p[i], b = p[(i + 1) % p.size()];
      sum += 0.5 * (static_cast<double>(a.x) * b.y - static_cast<double>(a.y) * b.x);
    }
    return sum;
  };
  *area = area_of(outer) - area_of(inner);
  std::vector<Vec2> points = outer;
  points.push_back(outer[0]), points.push_back(inner[0]);
  points.insert(points.end(), inner.rbegin(), inner.rend());
  return flat(points);
}

TEST(Polygons, RingsWithABridgeAreCoveredOnce) {
  std::mt19937 random(11);
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    double area = 0;
    Ring ring = keyhole(random, 3 + i, &area);
    std::rotate(ring.begin(), ring.begin() + static_cast<int>(random() % ring.size()), ring.end());
    expect_covered_once(ring, area);
  }
}

TEST(Polygons, ThatBendAreCoveredOnceAsSeenAlongTheirNormal) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> lift(-0.2f, 0.2f);
  for (int i = 0; i < 20; ++i) {
    double area = 0;
    Ring ring = keyhole(random, 12, &area);
    for (std::size_t k = 0; k < 12; ++k) ring[k].z = lift(random);  // its area stays, seen from +z
    ring[12].z = ring[0].z;
    Ring l = l_shape;
    for (Vec3& p : l) p.z = 0.1f * p.x;  // planar still: sheared
    expect_covered_once(l, 7.0);
    // Newell's normal leans a little; none of this is so thin that it would turn over.
    expect_covered_once(ring, area, {0, 0, 1}, 0.02);
  }
}

TEST(Polygons, ThatTheirFirstCornerSeesWholeStayFans) {
  const Ring rings[] = {flat({{0, 0}, {1, 0}, {1, 1}, {0, 1}}),
                        flat({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {0, 1}}),  // one lies on an edge
                        flat({{0, 1}, {-2, 2}, {0, 0}, {2, 2}}),         // an arrow from within
                        {{0, 0, 0}, {1, 0, 0.4f}, {1, 1, 0}, {0, 1, 0.4f}},
                        flat({{0, 0}, {1, 1}, {0, 1}, {1, 0}}),  // crosses itself: has no area
                        flat({{0, 0}, {1, 0}, {2, 0}, {3, 0}})};
  for (const Ring& ring : rings) {
    for (const Mesh& mesh : meshes_of(ring)) {
      const std::size_t first = mesh.triangles.size() - (ring.size() - 2);
      for (std::uint32_t k = 2; k < ring.size(); ++k) {
        const TriangleIndices& t = mesh.triangles[first + k - 2];
        EXPECT_EQ(t.v[0], mesh.triangles[first].v[0]);
        EXPECT_EQ(mesh.positions[t.v[1]], ring[k - 1]);
        EXPECT_EQ(mesh.positions[t.v[2]], ring[k]);
      }
    }
  }
}

TEST(Polygons, ColoursAndNormalsStayWithTheirCorners) {
  std::string text = obj_of({l_shape.begin(), l_shape.end()});
  std::string face = "f", more;
  for (int i = 1; i <= 6; ++i) {
    more += fmt::format("vt {} 0\nvn 0 {} 1\n", i, i);
    face += fmt::format(" {0}/{0}/{0}", 1 + (i + 4) % 6);  // the first is one that sees little
  }
  text = text.substr(0, text.find('f')) + more + face + "\n";
  const Mesh mesh = decode_obj(text, "a.obj");
  ASSERT_EQ(mesh.triangles.size(), 4u);
  for (std::size_t v = 0; v < 6; ++v) {
    const auto corner = std::ranges::find(l_shape, mesh.positions[v]) - l_shape.begin();
    EXPECT_EQ(mesh.uvs[v].x, static_cast<float>(corner + 1));
    EXPECT_NEAR(mesh.normals[v].y / mesh.normals[v].z, static_cast<float>(corner + 1), 1e-4f);
  }
}

double area_of_all(const Ring& ring) {
  const Mesh mesh = decode_obj(obj_of(ring), "a.obj");
  double all = 0;
  for (const TriangleIndices& t : mesh.triangles) all += 0.5 * std::abs(doubled_area(mesh, t).z);
  return all;
}

TEST(Polygons, OfManyCornersTakeNoTime) {
  std::mt19937 random(3);
  double area = 0;
  const Ring ring = keyhole(random, 2000, &area);
  EXPECT_NEAR(area_of_all(ring), area, 1e-4 * area);
  // Teeth whose feet lie on one line, clockwise.
  constexpr int teeth = 2000;
  std::vector<Vec2> comb;
  for (int i = 0; i < teeth; ++i) {
    const auto x = static_cast<float>(i);
    comb.emplace_back(x, 11.0f), comb.emplace_back(x + 0.5f, 1.0f);
  }
  comb.emplace_back(teeth, 11.0f), comb.emplace_back(teeth, 0.0f), comb.emplace_back(0.0f, 0.0f);
  EXPECT_NEAR(area_of_all(flat(comb)), 6.0 * teeth, 1e-5 * teeth);
}

// Where each triangle must be compared with most corners, the time is bounded.
TEST(Polygons, ThatAreTooIntricateKeepTheirFan) {
  constexpr int teeth = 30'000;
  std::vector<Vec2> comb;
  for (int i = 0; i < teeth; ++i) {
    const auto x = static_cast<float>(i);
    comb.emplace_back(x, 11.0f), comb.emplace_back(x + 0.5f, 1.0f);
  }
  comb.emplace_back(teeth, 11.0f), comb.emplace_back(teeth, 0.0f), comb.emplace_back(0.0f, 0.0f);
  std::vector<std::string> warnings;
  MeshFileOptions options;
  options.warnings = &warnings;
  EXPECT_EQ(decode_ply(ply_of(flat(comb), true, true), "a.ply", options).triangles.size(),
            comb.size() - 2);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].find("1 concave faces with up to 60003 corners are too intricate"), 0u);
}

/// Twice the area along Newell's normal, summed over the sides.
glm::dvec3 newell(const Ring& ring) {
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < ring.size(); ++i) {
    sum += glm::cross(glm::dvec3(ring[i]), glm::dvec3(ring[(i + 1) % ring.size()]));
  }
  return sum;
}

// Stars that bend as far as they are wide, in any direction. Their heights are such that Newell's
// normal stays that of the flat star, as seen along which they are simple.
TEST(Polygons, ThatBendFarAreCoveredOnceAsSeenAlongTheirNormal) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int n = 0; n < 40; ++n) {
    std::vector<glm::dvec3> star;
    for (int i = 0; i < 11; ++i) {
      const double angle = 2 * std::numbers::pi * i / 11, radius = i % 2 ? 1 : 0.35;
      star.emplace_back(radius * std::cos(angle), radius * std::sin(angle), uniform(random));
    }
    // The normal's x and y are sums of heights by weights: what of the heights adds to them goes.
    std::vector<double> of_x, of_y;
    for (std::size_t i = 0; i < 11; ++i) {
      const glm::dvec3 across = star[(i + 1) % 11] - star[(i + 10) % 11];
      of_x.push_back(across.y), of_y.push_back(across.x);
    }
    const auto dot = [](const auto& a, const auto& b) {
      return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
    };
    const double skew = dot(of_x, of_y) / dot(of_x, of_x);
    for (std::size_t i = 0; i < 11; ++i) of_y[i] -= skew * of_x[i];
    for (const auto& weights : {of_x, of_y}) {
      double part = 0;
      for (std::size_t i = 0; i < 11; ++i) part += star[i].z * weights[i];
      for (std::size_t i = 0; i < 11; ++i) star[i].z -= part / dot(weights, weights) * weights[i];
    }
    const glm::dvec3 up =
        glm::normalize(glm::dvec3(uniform(random), uniform(random), uniform(random)));
    const glm::dvec3 right = glm::normalize(glm::cross(up, glm::dvec3(0.3, 0.5, -0.8)));
    Ring ring;
    for (const glm::dvec3& p : star) {
      ring.emplace_back(p.x * right + p.y * glm::cross(up, right) + p.z * up);
    }
    const glm::dvec3 normal = newell(ring);
    ASSERT_NEAR(glm::dot(glm::normalize(normal), up), 1, 1e-9);
    expect_covered_from_all_corners(ring, 0.5 * glm::length(normal), up);
  }
}

}  // namespace
}  // namespace pt
