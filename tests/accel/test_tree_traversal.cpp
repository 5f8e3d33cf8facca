// Whatever the structure and the builder: rays meet what testing every triangle meets, and what
// Embree says.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <tuple>

#include "accel/tree_kinds.h"
#include "accel/triangle_rays.h"
#include "common/accel/build/build_triangle_tree.h"
#include "common/accel/build/tree_statistics.h"
#include "common/accel/embree/embree_tree.h"
#include "temp_folder.h"

namespace pt {
namespace {

/// What a hit means, whichever tree it is of.
struct Met {
  float t;
  std::uint32_t id = no_primitive, instance = 0;

  Met(const TriangleTreeData& tree, const Hit& hit) : t(hit.t) {
    if (hit.is_miss()) return;
    id = tree.triangles.at(hit.primitive).id;
    if (!tree.instances.empty()) instance = tree.instances.at(hit.instance).index;
  }
  bool operator==(const Met& other) const = default;
};
void PrintTo(const Met& met, std::ostream* out) {
  *out << "t " << met.t << ", triangle " << met.id << ", instance " << met.instance;
}

class TreeTraversal : public testing::TestWithParam<TreeKind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, TreeTraversal, testing::ValuesIn(tree_kinds),
                         [](const auto& kind) { return std::string(kind.param.name); });

int expect_brute(const TriangleTreeData& tree, const TriangleTreeData& brute, const Ray& ray) {
  const Hit hit = closest_hit(brute, ray);
  EXPECT_EQ(Met(tree, closest_hit(tree, ray)), Met(brute, hit));
  EXPECT_EQ(any_hit(tree, ray), !hit.is_miss());
  if (hit.is_miss()) return 0;
  EXPECT_EQ(any_hit(tree, ray, 0.0f, hit.t), any_hit(brute, ray, 0.0f, hit.t));
  const float t_min = hit.t, t_max = 2.0f * hit.t;  // the next one, perhaps
  EXPECT_EQ(Met(tree, closest_hit(tree, ray, t_min, t_max)),
            Met(brute, closest_hit(brute, ray, t_min, t_max)));
  return 1;
}

TEST_P(TreeTraversal, MeetsWhatTestingEveryTriangleMeets) {
  for (const MeshKind& mesh_kind : mesh_kinds) {
    for (const int count : {1, 4, 60, 900}) {
      const Mesh mesh = mesh_kind.make(count);
      const TriangleTreeData tree = GetParam().build({mesh}), brute = brute_kind.build({mesh});
      const Target target(mesh);
      TestRandom random(21);
      int hits = 0;
      for (const RayKind& ray_kind : ray_kinds) {
        SCOPED_TRACE(testing::Message() << mesh_kind.name << ' ' << count << ' ' << ray_kind.name);
        for (int i = 0; i < 100; ++i)
          hits += expect_brute(tree, brute, ray_kind.make(target, random));
        if (HasFailure()) return;
      }
      EXPECT_GE(hits, count < 60 ? 0 : 100) << mesh_kind.name << ' ' << count;
    }
  }
}

std::vector<Instance> random_instances(TestRandom& random, int count) {
  std::vector<Instance> instances;
  for (int i = 0; i < count; ++i) {
    const Affine shear = {{{1, random.unit(), 0, 0}, {0, 1, random.unit(), 0}, {0, 0, 1, 0}}};
    const Vec3 stretch(random.bits() % 2 ? 1 : -1, 0.1f + random.unit(), 0.5f);
    instances.push_back({1 + random.below(3), translate(point_in_cube(random, 40)) *
                                                  rotate(point_in_cube(random, 1), 77) * shear *
                                                  scale(stretch)});
  }
  instances.push_back(instances.front());  // ties
  return instances;
}

std::vector<Mesh> world_and_groups() {
  std::vector<Mesh> meshes = {make_flat_grid(8), make_soup(70, 5), make_closed_sphere(6),
                              make_soup(1, 9)};
  for (std::uint32_t i = 1; i < 4; ++i) meshes[i].group = i;
  return meshes;
}

Mesh flattened(const std::vector<Mesh>& meshes, const std::vector<Instance>& instances) {
  Mesh all = meshes[0];
  for (const Instance& instance : instances) {
    const Mesh& mesh = meshes[instance.group];
    for (const TriangleIndices& t : mesh.triangles) {
      Vec3 p[3];
      for (int i = 0; i < 3; ++i) p[i] = instance.to_world.point(mesh.positions[t.v[i]]);
      add_triangle(all, p[0], p[1], p[2]);
    }
  }
  return all;
}

TEST_P(TreeTraversal, MeetsInstancesAsTestingEachOfThem) {
  const std::vector<Mesh> meshes = world_and_groups();
  for (const int count : {1, 3, 40}) {
    TestRandom random(31);
    const std::vector<Instance> instances = random_instances(random, count);
    const TriangleTreeData tree = GetParam().build(meshes, instances);
    const TriangleTreeData brute = brute_kind.build(meshes, instances);
    const Mesh all = flattened(meshes, instances);
    const Target target(all);
    int hits = 0;
    for (const RayKind& kind : ray_kinds) {
      SCOPED_TRACE(testing::Message() << count << ' ' << kind.name);
      for (int i = 0; i < 100; ++i) {
        hits += expect_brute(tree, brute, kind.make(target, random));
      }
      if (HasFailure()) return;
    }
    EXPECT_GT(hits, 200);
  }
}

TEST_P(TreeTraversal, MeetsInstancesAsTheirCopiesInTheWorld) {
  const std::vector<Mesh> meshes = world_and_groups();
  TestRandom random(32);
  const std::vector<Instance> instances = random_instances(random, 20);
  const TriangleTreeData tree = GetParam().build(meshes, instances);
  const Mesh all = flattened(meshes, instances);
  const TriangleTreeData copies = GetParam().build({all});
  const Target target(all);
  int different = 0;
  for (int i = 0; i < 1000; ++i) {
    const Ray ray = ray_to(target.anywhere(random), target.on_surface(random));
    different += std::abs(closest_hit(tree, ray).t - closest_hit(copies, ray).t) > 1e-3f;
  }
  EXPECT_LE(different, 2) << "at borders of triangles rounding decides";
}

TEST_P(TreeTraversal, ClosedMeshesDoNotLeak) {
  const Mesh mesh = make_closed_sphere(24);
  Mesh grouped = mesh;
  grouped.group = 1;
  const Instance placed{1, rotate({1, 2, 3}, 50)};
  const TriangleTreeData tree = GetParam().build({mesh}),
                         two = GetParam().build({grouped}, {placed});
  const Affine to_world = placed.to_world;
  const Target target(mesh);
  TestRandom random(41);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 from = point_in_cube(random, 2);
    const Vec3 to = i % 2 ? target.vertex(random) : target.on_edge(random);
    ASSERT_FALSE(closest_hit(tree, ray_to(from, to)).is_miss()) << i;
    ASSERT_TRUE(any_hit(tree, ray_to(from, to))) << i;
    ASSERT_FALSE(closest_hit(two, ray_to(from, to_world.point(to))).is_miss()) << i;
  }
}

/// A triangle and a ray in double precision.
struct ExactPass {
  double t;             // where the ray meets the triangle's plane
  double border;        // the least of the edge functions
  double sum;           // of the edge functions: twice the area that the ray sees
  double longest, far;  // an edge, a vertex from the origin

  ExactPass(const Triangle& triangle, const Ray& ray) {
    const glm::dvec3 d(ray.direction), o(ray.origin);
    const glm::dvec3 a = glm::dvec3(triangle.v0) - o, b = glm::dvec3(triangle.v1) - o,
                     c = glm::dvec3(triangle.v2) - o;
    const double u = glm::dot(d, glm::cross(c, b)), v = glm::dot(d, glm::cross(a, c)),
                 w = glm::dot(d, glm::cross(b, a));
    sum = u + v + w;
    border = std::min({std::abs(u), std::abs(v), std::abs(w)});
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    t = glm::dot(normal, a) / glm::dot(normal, d);
    longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
    far = std::max({glm::length(a), glm::length(b), glm::length(c)});
  }
  /// What the rounding of the edge functions does to t: much where a triangle is long and thin.
  double t_error() const { return 2.0 * half_ulp * 4.0 * far * longest * longest / std::abs(sum); }
  /// So near the border, or at such an angle, that rounding decides.
  bool is_close_call() const {
    return border <= 1e-5 * far * longest || std::abs(sum) <= 1e-4 * longest * longest;
  }
};

struct EmbreeCount {
  int hits = 0, close_calls = 0;
};

void expect_embree(const TriangleTreeData& tree, const TriangleTreeData& plain,
                   const EmbreeTree& embree, const Ray& ray, float t_min, EmbreeCount& count) {
  const Hit own = closest_hit(tree, ray, t_min),
            other = closest_triangle_embree(embree, ray, t_min, infinite_distance);
  const float tolerance = 1e-5f * std::max(own.t, max_abs(ray.origin));
  if (own.is_miss() == other.is_miss() &&
      (own.is_miss() || std::abs(own.t - other.t) <= tolerance)) {
    count.hits += own.is_miss() ? 0 : 1;
    return;
  }
  if (!own.is_miss() && Met(tree, own).id == Met(plain, other).id) {
    const ExactPass exact(tree.triangles.at(own.primitive), ray);
    EXPECT_TRUE(std::abs(own.t - exact.t) <= tolerance + exact.t_error() || exact.is_close_call())
        << exact.t;
    return;
  }
  ++count.close_calls;
  const auto is_explained = [&](const TriangleTreeData& of, const Hit& hit) {
    return !hit.is_miss() && ExactPass(of.triangles.at(hit.primitive), ray).is_close_call();
  };
  const auto t_error = [&](const TriangleTreeData& of, const Hit& hit) {
    return hit.is_miss() ? 0.0 : ExactPass(of.triangles.at(hit.primitive), ray).t_error();
  };
  EXPECT_TRUE(is_explained(tree, own) || is_explained(plain, other) ||
              std::abs(own.t - other.t) <= tolerance + t_error(tree, own) + t_error(plain, other))
      << "t " << own.t << ", Embree " << other.t;
}

TEST_P(TreeTraversal, AgreesWithEmbree) {
  if (embree_version().empty()) GTEST_SKIP() << "built without Embree";
  EmbreeCount count;
  for (const MeshKind& mesh_kind : mesh_kinds) {
    const Mesh mesh = mesh_kind.make(3000);
    const TriangleTreeData tree = GetParam().build({mesh}), plain = brute_kind.build({mesh});
    const EmbreeTree embree(plain);
    const Target target(mesh);
    TestRandom random(51);
    for (const RayKind& ray_kind : ray_kinds) {
      SCOPED_TRACE(testing::Message() << mesh_kind.name << ' ' << ray_kind.name);
      for (int i = 0; i < 200; ++i) {
        const Ray ray = ray_kind.make(target, random);
        expect_embree(tree, plain, embree, ray, 1e-3f * target.size(), count);
      }
      if (HasFailure()) return;
    }
  }
  EXPECT_GT(count.hits, 5000);
  EXPECT_LT(count.close_calls, count.hits / 5);
}

TEST_P(TreeTraversal, AgreesWithEmbreeOnInstances) {
  if (embree_version().empty()) GTEST_SKIP() << "built without Embree";
  const std::vector<Mesh> meshes = world_and_groups();
  TestRandom random(61);
  const std::vector<Instance> instances = random_instances(random, 30);
  const TriangleTreeData tree = GetParam().build(meshes, instances);
  const TriangleTreeData plain = brute_kind.build(meshes, instances);
  const EmbreeTree embree(plain);
  const Mesh all = flattened(meshes, instances);
  const Target target(all);
  int hits = 0, different = 0;
  for (int i = 0; i < 2000; ++i) {
    const Ray ray = ray_to(target.anywhere(random), target.on_surface(random));
    const Met own(tree, closest_hit(tree, ray)),
        other(plain, closest_triangle_embree(embree, ray, 0, infinite_distance));
    hits += own.id != no_primitive;
    different += std::abs(own.t - other.t) > 1e-4f * own.t || own.id != other.id;
    EXPECT_EQ(any_hit(tree, ray, 0, 1e3f), own.t < 1e3f);
  }
  EXPECT_GT(hits, 1500);
  EXPECT_LT(different, 10);
}

// Embree's own t, of which some processors lose the last bit.
TEST(Embree, IntervalsAreOpenAtBothEnds) {
  if (embree_version().empty()) GTEST_SKIP() << "built without Embree";
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, mesh.triangles = {{{0, 1, 2}}};
  const EmbreeTree tree(brute_kind.build({mesh}, {}));
  const Ray ray{{0, 0, 2}, {0, 0, -1}};
  const float t = closest_triangle_embree(tree, ray, 0, infinite_distance).t;
  EXPECT_FLOAT_EQ(t, 2.0f);
  const auto next = [t](float to) { return std::nextafter(t, to); };
  for (const auto& [t_min, t_max, meets] :
       {std::tuple{0.0f, t, false}, {t, 3.0f, false}, {next(0), next(3), true}}) {
    EXPECT_EQ(any_triangle_embree(tree, ray, t_min, t_max), meets) << t_min << " to " << t_max;
    EXPECT_EQ(!closest_triangle_embree(tree, ray, t_min, t_max).is_miss(), meets) << t_min;
  }
}

TEST_P(TreeTraversal, RefittedTreesMeetWhatHasMoved) {
  std::vector<Mesh> meshes = world_and_groups();
  TestRandom random(71);
  std::vector<Instance> instances = random_instances(random, 12);
  TriangleTreeData tree = GetParam().build(meshes, instances);
  TriangleTreeData single = GetParam().build({meshes[1]});
  for (Mesh& mesh : meshes) {
    for (Vec3& p : mesh.positions) p = 1.3f * p + point_in_cube(random, 0.5);
  }
  for (Instance& instance : instances) {
    instance.to_world = translate(point_in_cube(random, 30)) * instance.to_world;
  }
  refit_triangle_tree(tree, meshes, instances);
  refit_triangle_tree(single, {&meshes[1], 1}, {});
  const TriangleTreeData brute = brute_kind.build(meshes, instances);
  const TriangleTreeData single_brute = brute_kind.build({meshes[1]});
  const Mesh all = flattened(meshes, instances);
  const Target target(all), single_target(meshes[1]);
  int hits = 0;
  for (const RayKind& kind : ray_kinds) {
    SCOPED_TRACE(kind.name);
    for (int i = 0; i < 100; ++i) {
      hits += expect_brute(tree, brute, kind.make(target, random));
      hits += expect_brute(single, single_brute, kind.make(single_target, random));
    }
  }
  EXPECT_GT(hits, 500);
}

TEST_P(TreeTraversal, RefittingNeedsAllTriangles) {
  Mesh mesh = make_closed_sphere(20);
  const auto count = mesh.triangles.size();
  TriangleTreeData tree = GetParam().build({mesh});
  mesh.triangles.pop_back();  // the last one is in the tree
  expect_error(
      [&] {
        refit_triangle_tree(tree, {&mesh, 1}, {});
      },
      fmt::format("refit: meshes of {} triangles, expected at least {}", count - 1, count));
}

TEST_P(TreeTraversal, RefittingToTheSamePlaceChangesNoHit) {
  const Mesh mesh = make_closed_sphere(20);
  const TriangleTreeData built = GetParam().build({mesh});
  TriangleTreeData refitted = built;
  refit_triangle_tree(refitted, {&mesh, 1}, {});
  const Target target(mesh);
  TestRandom random(81);
  for (int i = 0; i < 500; ++i) {
    const Ray ray = ray_kinds[1].make(target, random);
    EXPECT_EQ(Met(built, closest_hit(built, ray)), Met(refitted, closest_hit(refitted, ray)));
  }
  const auto cost = [](const TriangleTreeData& tree) {
    return (tree.bvh2.empty() ? measure_tree(tree.cwbvh, tree.root)
                              : measure_tree(tree.bvh2, tree.root))
        .sah_cost(0.5);
  };
  // Split triangles get the boxes of whole ones.
  const double tolerance = GetParam().builder == TreeBuilder::sbvh ? 0.1 : 0.001;
  EXPECT_NEAR(cost(refitted), cost(built), tolerance * cost(built));
}

void test_large(const TreeKind& kind, int strips) {
  const Mesh mesh = moved(make_closed_sphere(strips), 1.0f, Vec3(3, 4, 5));
  const TriangleTreeData tree = kind.build({mesh}), plain = brute_kind.build({mesh});
  const EmbreeTree embree(plain);
  const Target target(mesh);
  TestRandom random(91);
  EmbreeCount count;
  for (const RayKind& ray_kind : ray_kinds) {
    SCOPED_TRACE(ray_kind.name);
    for (int i = 0; i < 2000; ++i) {
      expect_embree(tree, plain, embree, ray_kind.make(target, random), 0.01f, count);
    }
  }
  EXPECT_GT(count.hits, 10'000);
}

TEST(LargeTrees, OfAMillionTrianglesAgreeWithEmbree) {
  if (embree_version().empty()) GTEST_SKIP() << "built without Embree";
  test_large(tree_kinds[2], 500);
}

TEST(LargeTrees, OfTenMillionTrianglesAgreeWithEmbree) {
  if (embree_version().empty()) GTEST_SKIP() << "built without Embree";
  if (std::getenv("PTEXP_LARGE_TESTS") == nullptr) GTEST_SKIP() << "set PTEXP_LARGE_TESTS to run";
  for (const TreeKind& kind : tree_kinds) {
    if (kind.builder == TreeBuilder::sah) test_large(kind, 1600);
  }
}

/// The rays and hits of an independent tracer (shared/trace).
class BunnyRoom {
 public:
  static std::filesystem::path folder() {
    const char* shared = std::getenv("PTEXP_SHARED");
    const auto source = std::filesystem::path(__FILE__).parent_path().parent_path();
    return (shared != nullptr ? std::filesystem::path(shared) : source / "../shared") / "trace";
  }
  static std::ifstream open(const std::string& ending, int header) {
    std::ifstream file(folder() / ("bunny_room." + ending), std::ios::binary);
    file.ignore(header);
    return file;
  }
  static Mesh mesh() {
    std::ifstream file = open("mesh", 8);
    std::uint32_t count[2] = {};
    read(file, count, 2);
    Mesh mesh;
    mesh.positions.resize(count[0]), mesh.triangles.resize(count[1]);
    read(file, mesh.positions.data(), count[0]);
    read(file, mesh.triangles.data(), count[1]);
    return mesh;
  }
  template <class T>
  static bool read(std::ifstream& file, T* values, std::size_t count) {
    return static_cast<bool>(file.read(reinterpret_cast<char*>(values),
                                       static_cast<std::streamsize>(count * sizeof(T))));
  }
};

TEST_P(TreeTraversal, FindsTheHitsOfAnIndependentTracerInTheBunnyRoom) {
  if (!std::filesystem::exists(BunnyRoom::folder() / "bunny_room.mesh")) {
    GTEST_SKIP() << "no test data in " << BunnyRoom::folder();
  }
  const TriangleTreeData tree = GetParam().build({BunnyRoom::mesh()});
  for (const std::string set : {"primary", "diffuse"}) {
    SCOPED_TRACE(set);
    std::ifstream rays = BunnyRoom::open(set + ".rays", 32),
                  hits = BunnyRoom::open(set + ".hits", 32);
    struct {
      Vec3 origin;
      float t_min;
      Vec3 direction;
      float t_max;
    } ray;
    struct {
      float t;
      std::uint32_t id;
    } hit;
    int count = 0;
    for (; BunnyRoom::read(rays, &ray, 1) && BunnyRoom::read(hits, &hit, 1); ++count) {
      const float t_max = std::min(ray.t_max, infinite_distance);
      const Met met(tree, closest_hit(tree, {ray.origin, ray.direction}, ray.t_min, t_max));
      EXPECT_EQ(met.id, hit.id) << "ray " << count;
      if (hit.id == no_primitive) continue;
      EXPECT_NEAR(met.t, hit.t, 1e-5f * hit.t + 1e-4f);
    }
    EXPECT_EQ(count, 4096);
  }
}

}  // namespace
}  // namespace pt
