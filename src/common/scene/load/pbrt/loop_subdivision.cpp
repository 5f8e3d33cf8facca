#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "common/error/error.h"
#include "common/scene/load/pbrt/scene_parts.h"

namespace pt::pbrt {
namespace {

using Index = std::uint32_t;

constexpr Index none = 0xffffffffu;

/// What lies around a vertex, counterclockwise; from border to border where it is open.
struct Ring {
  std::vector<Index> vertices;
  bool open = false;
};

std::uint64_t key(Index from, Index to) { return std::uint64_t{from} << 32 | to; }

/// The vertex across from each edge, which has the direction of its triangle.
using Edges = std::unordered_map<std::uint64_t, Index>;

Edges edges_of(const Mesh& mesh) {
  Edges edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const TriangleIndices& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const Index from = t.v[i], to = t.v[(i + 1) % 3];
      if (from == to || !edges.emplace(key(from, to), t.v[(i + 2) % 3]).second) {
        throw Error(
            "expected triangles of three vertices, alike wound, no more than two at an edge");
      }
    }
  }
  return edges;
}

Index across(const Edges& edges, Index from, Index to) {
  const auto found = edges.find(key(from, to));
  return found == edges.end() ? none : found->second;
}

/// Rings around all vertices; that of one without triangles is empty. Of several fans that meet in
/// a vertex one counts.
std::vector<Ring> rings_of(const Mesh& mesh, const Edges& edges) {
  std::vector<Ring> rings(mesh.positions.size());
  for (const TriangleIndices& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const Index center = t.v[i];
      Ring& ring = rings[center];
      if (!ring.vertices.empty()) continue;
      // Clockwise to the border, or around.
      Index start = t.v[(i + 1) % 3];
      for (Index next = across(edges, start, center); next != none && next != t.v[(i + 1) % 3];
           next = across(edges, start, center)) {
        start = next;
      }
      ring.open = across(edges, start, center) == none;
      ring.vertices.push_back(start);
      for (Index next = across(edges, center, start); next != none && next != ring.vertices[0];
           next = across(edges, center, ring.vertices.back())) {
        ring.vertices.push_back(next);
      }
    }
  }
  return rings;
}

Vec3 sum_of(const Mesh& mesh, const std::vector<Index>& vertices) {
  Vec3 sum(0.0f);
  for (const Index v : vertices) sum += mesh.positions[v];
  return sum;
}

/// The vertex and its neighbours, of which each weighs as much as its kind of vertex says.
Vec3 weighted(const Mesh& mesh, Index center, const Ring& ring, float inner, float border) {
  const Vec3& p = mesh.positions[center];
  if (ring.vertices.empty()) return p;
  if (ring.open) {
    const Vec3 ends = mesh.positions[ring.vertices.front()] + mesh.positions[ring.vertices.back()];
    return (1.0f - 2.0f * border) * p + border * ends;
  }
  const auto valence = static_cast<float>(ring.vertices.size());
  return (1.0f - valence * inner) * p + inner * sum_of(mesh, ring.vertices);
}

/// Warren's weights (1995).
float beta(std::size_t valence) {
  return valence == 3 ? 3.0f / 16.0f : 3.0f / (8.0f * static_cast<float>(valence));
}

Mesh divide(const Mesh& mesh, const Edges& edges, const std::vector<Ring>& rings) {
  Mesh fine;
  fine.positions.reserve(4 * mesh.positions.size());
  for (Index v = 0; v < mesh.positions.size(); ++v) {
    const std::size_t valence = std::max<std::size_t>(rings[v].vertices.size(), 1);
    fine.positions.push_back(weighted(mesh, v, rings[v], beta(valence), 1.0f / 8.0f));
  }
  std::unordered_map<std::uint64_t, Index> middles;
  const auto middle = [&](Index a, Index b) {
    const auto [entry, is_new] = middles.try_emplace(key(std::min(a, b), std::max(a, b)),
                                                     static_cast<Index>(fine.positions.size()));
    if (!is_new) return entry->second;
    const Index c = across(edges, a, b), d = across(edges, b, a);
    const Vec3 ends = mesh.positions[a] + mesh.positions[b];
    fine.positions.push_back(
        c == none || d == none ? 0.5f * ends
                               : 0.375f * ends + 0.125f * (mesh.positions[c] + mesh.positions[d]));
    return entry->second;
  };
  fine.triangles.reserve(4 * mesh.triangles.size());
  for (const TriangleIndices& t : mesh.triangles) {
    const auto& [a, b, c] = t.v;
    const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.triangles.insert(fine.triangles.end(),
                          {{{a, ab, ca}}, {{ab, b, bc}}, {{ca, bc, c}}, {{ab, bc, ca}}});
  }
  return fine;
}

/// A sum of what is around a vertex that is a tangent of the limit surface; at the border the one
/// across it (Hoppe et al. 1994, 'Piecewise Smooth Surface Reconstruction', appendix A).
Vec3 border_tangent(const Mesh& mesh, Index center, const std::vector<Index>& ring) {
  const auto at = [&](std::size_t i) { return mesh.positions[ring[i]]; };
  const Vec3& p = mesh.positions[center];
  const std::size_t n = ring.size();
  if (n == 2) return at(0) + at(1) - 2.0f * p;
  if (n == 3) return at(1) - p;
  if (n == 4) return 2.0f * (at(1) + at(2)) - at(0) - at(3) - 2.0f * p;
  const double angle = double{pi} / static_cast<double>(n - 1);
  Vec3 sum = -static_cast<float>(std::sin(angle)) * (at(0) + at(n - 1));
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const double weight = (2 - 2 * std::cos(angle)) * std::sin(static_cast<double>(k) * angle);
    sum += static_cast<float>(weight) * at(k);
  }
  return sum;
}

Vec3 normal_at(const Mesh& mesh, Index center, const Ring& ring) {
  const std::size_t n = ring.vertices.size();
  Vec3 s(0.0f), t(0.0f);
  if (ring.open && n >= 2) {
    s = mesh.positions[ring.vertices.front()] - mesh.positions[ring.vertices.back()];
    t = border_tangent(mesh, center, ring.vertices);
  } else {
    for (std::size_t i = 0; i < n; ++i) {
      const double angle = 2 * double{pi} * static_cast<double>(i) / static_cast<double>(n);
      s += static_cast<float>(std::cos(angle)) * mesh.positions[ring.vertices[i]];
      t += static_cast<float>(std::sin(angle)) * mesh.positions[ring.vertices[i]];
    }
  }
  const Vec3 across = glm::cross(t, s);
  const float length = glm::length(across);
  return length > 0.0f && std::isfinite(length) ? across / length : Vec3(0, 0, 1);
}

}  // namespace

Mesh subdivide_loop(const Mesh& cage, int levels) {
  Mesh mesh;
  mesh.positions = cage.positions;
  mesh.triangles = cage.triangles;
  for (int level = 0; level < levels; ++level) {
    const Edges edges = edges_of(mesh);
    mesh = divide(mesh, edges, rings_of(mesh, edges));
  }
  const Edges edges = edges_of(mesh);
  const std::vector<Ring> rings = rings_of(mesh, edges);
  Mesh limit;
  limit.triangles = mesh.triangles;
  for (Index v = 0; v < mesh.positions.size(); ++v) {
    const std::size_t n = std::max<std::size_t>(rings[v].vertices.size(), 1);
    const float inner = 1.0f / (static_cast<float>(n) + 3.0f / (8.0f * beta(n)));
    limit.positions.push_back(weighted(mesh, v, rings[v], inner, 1.0f / 6.0f));
  }
  for (Index v = 0; v < mesh.positions.size(); ++v) {
    limit.normals.push_back(normal_at(mesh, v, rings[v]));
  }
  return limit;
}

}  // namespace pt::pbrt
