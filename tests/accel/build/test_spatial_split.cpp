// What spatial splits leave of a triangle, cut again and again: around each of its points one part
// has room for the error of a hit there, also where a plane has gone through just beside it.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "accel/triangle_rays.h"
#include "common/accel/build/binary/split.h"

namespace pt {
namespace {

/// A triangle's parts after some splits, and the planes of these.
struct CutTriangle {
  Triangle triangle;
  std::vector<BuildReference> parts;
  struct Plane {
    int axis;
    float at;
  };
  std::vector<Plane> planes;

  explicit CutTriangle(const Mesh& mesh, std::size_t i) {
    const TriangleIndices& t = mesh.triangles[i];
    triangle.v0 = mesh.positions[t.v[0]], triangle.v1 = mesh.positions[t.v[1]];
    triangle.v2 = mesh.positions[t.v[2]];
    parts = {make_reference(hit_bounds(triangle.v0, triangle.v1, triangle.v2), 0)};
  }

  /// Through a part; cutting costs nothing.
  void split(TestRandom& random) {
    const auto count = static_cast<std::uint32_t>(parts.size());
    const BuildReference& part = parts[random.below(count)];
    SpatialSplit split;
    split.cost = 0;
    split.axis = static_cast<int>(random.below(3));
    const float low = part.low[split.axis], high = part.high[split.axis];
    split.plane = low + random.unit() * (high - low);
    split.left_count = split.right_count = count;
    ReferenceRange range{0, count, {}, {}};
    for (const BuildReference& r : parts) {
      range.grow(r), split.left_bounds.grow(r), split.right_bounds.grow(r);
    }
    parts.resize(2 * std::size_t{count});
    const RangeHalves halves =
        split_spatially(parts, range, split, [this](std::uint32_t) { return triangle; });
    parts.resize(halves.right.end);
    planes.push_back({split.axis, split.plane});
  }

  glm::dvec3 at(double b1, double b2) const {
    return (1 - b1 - b2) * glm::dvec3(triangle.v0) + b1 * glm::dvec3(triangle.v1) +
           b2 * glm::dvec3(triangle.v2);
  }

  /// Within a margin or two of a plane, where that goes through the triangle.
  glm::dvec3 point_at_plane(const glm::dvec3& margin, TestRandom& random) const {
    const Plane& plane = planes[random.below(static_cast<std::uint32_t>(planes.size()))];
    const glm::dvec3 a = at(0, random.uniform(0, 1)), b = at(1, 0);
    const double goal = plane.at + 2 * random.uniform(-1, 1) * margin[plane.axis];
    const double s = (goal - a[plane.axis]) / (b[plane.axis] - a[plane.axis]);
    return s >= 0 && s <= 1 ? a + s * (b - a) : a;
  }

  bool has_room(const glm::dvec3& p, const glm::dvec3& margin) const {
    return std::any_of(parts.begin(), parts.end(), [&](const BuildReference& part) {
      for (int i = 0; i < 3; ++i) {
        if (p[i] - margin[i] < part.low[i] || p[i] + margin[i] > part.high[i]) return false;
      }
      return true;
    });
  }
};

TEST(SpatialSplit, APartHasRoomForTheErrorOfEveryHit) {
  TestRandom random(91);
  const Mesh mesh = make_soup(300, 8);
  std::size_t parts = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    CutTriangle cut(mesh, i);
    for (int k = 0; k < 6; ++k) cut.split(random);
    parts += cut.parts.size();
    const Triangle& t = cut.triangle;
    // Less by what rounds in double precision.
    const glm::dvec3 margin = 0.999999 * glm::dvec3(hit_margin(triangle_bounds(t.v0, t.v1, t.v2)));
    for (int k = 0; k < 300; ++k) {
      const glm::dvec3 p = cut.point_at_plane(margin, random);
      ASSERT_TRUE(cut.has_room(p, margin)) << "triangle " << i << ", " << cut.parts.size();
    }
  }
  EXPECT_GT(parts, 4 * mesh.triangles.size());
}

}  // namespace
}  // namespace pt
