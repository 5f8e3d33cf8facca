// The trees of the forest, which its instances repeat.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <array>

#include "common/error/error.h"
#include "common/math/transform.h"
#include "common/scene/builtin/generated_scenes.h"
#include "common/scene/builtin/noise.h"
#include "common/scene/builtin/shapes.h"
#include "common/scene/builtin/sphere_world.h"

namespace pt {
namespace {

/// `count` leaves of two triangles each, turned at random, in an ellipsoid.
void add_leaves(Mesh& mesh, const Vec3& center, const Vec3& radii, int count, float size,
                std::uint32_t seed) {
  WorldRandom random(seed);
  for (int i = 0; i < count; ++i) {
    const float u0 = random.next(), u1 = random.next(), u2 = random.next();
    // Denser near the surface, where a crown has its leaves.
    const Vec3 place = center + radii * sample_unit_ball(u0, u1, 0.4f + 0.6f * u2);
    const float v0 = random.next(), v1 = random.next();
    const Vec3 facing = sample_unit_sphere(v0, v1);
    const Frame frame = make_frame(facing);
    const float half = 0.5f * size * random.next(0.7f, 1.3f);
    add_rectangle(mesh, place - half * (frame.tangent + frame.bitangent),
                  2.0f * half * frame.tangent, 2.0f * half * frame.bitangent);
  }
}

void add_trunk(Mesh& mesh, float height, float radius) {
  const ProfilePoint profile[] = {{1.4f * radius, -0.05f * height}, {radius, 0.06f * height},
                                  {0.8f * radius, 0.4f * height},   {0.5f * radius, 0.7f * height},
                                  {0.2f * radius, 0.95f * height},  {0.0f, height}};
  add_revolution(mesh, Vec3(0.0f), profile, 16);
}

struct Tree {
  Mesh trunk, leaves;
};

/// Twelve skirts of branches, one above the other, with needles in the lowest.
Tree conifer() {
  Tree tree;
  add_trunk(tree.trunk, 1.0f, 0.03f);
  for (int i = 0; i < 12; ++i) {
    const float height = 0.14f + 0.07f * static_cast<float>(i);
    const float radius = 0.24f * (1.05f - height);
    const ProfilePoint skirt[] = {{0.3f * radius, 0.015f},
                                  {radius, 0.0f},
                                  {0.7f * radius, 0.035f},
                                  {0.35f * radius, 0.075f},
                                  {0.0f, 0.11f}};
    add_revolution(tree.leaves, {0, height, 0}, skirt, 40);
    add_leaves(tree.leaves, {0, height + 0.01f, 0}, {radius, 0.02f, radius}, 80, 0.02f,
               static_cast<std::uint32_t>(100 + i));
  }
  return tree;
}

Tree broad_tree() {
  Tree tree;
  add_trunk(tree.trunk, 0.75f, 0.045f);
  const Vec3 crowns[] = {{0, 0.72f, 0},         {0.2f, 0.6f, 0.05f},    {-0.17f, 0.58f, 0.12f},
                         {0.02f, 0.62f, -0.2f}, {-0.12f, 0.8f, -0.06f}, {0.1f, 0.82f, 0.1f}};
  std::uint32_t seed = 200;
  for (const Vec3& crown : crowns)
    add_leaves(tree.leaves, crown, {0.19f, 0.15f, 0.19f}, 1500, 0.022f, seed++);
  return tree;
}

Tree bush() {
  Tree tree;
  add_trunk(tree.trunk, 0.3f, 0.02f);
  add_leaves(tree.leaves, {0, 0.22f, 0}, {0.25f, 0.2f, 0.25f}, 1800, 0.025f, 300);
  return tree;
}

Tree poplar() {
  Tree tree;
  add_trunk(tree.trunk, 0.9f, 0.03f);
  add_leaves(tree.leaves, {0, 0.58f, 0}, {0.12f, 0.45f, 0.12f}, 5500, 0.018f, 400);
  return tree;
}

}  // namespace

std::vector<Mesh> generate_trees() {
  std::vector<Mesh> meshes;
  std::uint32_t group = 0;
  for (Tree& tree : std::array{conifer(), broad_tree(), bush(), poplar()}) {
    ++group;
    for (Mesh* mesh : {&tree.trunk, &tree.leaves}) {
      mesh->group = group;
      meshes.push_back(std::move(*mesh));
    }
  }
  return meshes;
}

namespace {

constexpr double spacing = 3.5;  ///< of trees; they are about 4 units tall
constexpr std::uint32_t ground_seed = 3;
constexpr std::uint32_t instance_seed = 1000, sway_seed = 1u << 31;

/// Ground over a square around the origin: waves that grow with it.
class Ground {
 public:
  explicit Ground(std::uint64_t trees)
      : side_(spacing * std::sqrt(static_cast<double>(trees)) + 2 * spacing),
        cells_(std::clamp(static_cast<int>(side_ / spacing), 32, 1024)) {}

  double side() const { return side_; }

  /// The height of the smooth ground; its mesh differs by a small part of a unit.
  double height(double x, double z) const {
    const double size = side_ / 5;
    return 0.09 * size * gradient_noise<2>({x / size, z / size}, ground_seed);
  }

  /// A little wider than where trees stand, facing up.
  Mesh mesh() const {
    const int n = cells_ + 1;
    Mesh mesh;
    mesh.positions.resize(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
    tbb::parallel_for(0, n, [&](int row) {
      for (int i = 0; i < n; ++i) {
        const double x = coordinate(i), z = coordinate(row);
        mesh.positions[static_cast<std::size_t>(row * n + i)] =
            Vec3(glm::dvec3(x, height(x, z), z));
      }
    });
    for (int row = 0; row + 1 < n; ++row) {
      for (int i = 0; i + 1 < n; ++i) {
        const auto far = static_cast<std::uint32_t>(row * n + i);
        const auto near = far + static_cast<std::uint32_t>(n);
        mesh.triangles.push_back({{far, near, far + 1}});
        mesh.triangles.push_back({{far + 1, near, near + 1}});
      }
    }
    return mesh;
  }

 private:
  double coordinate(int i) const { return 1.1 * side_ * (static_cast<double>(i) / cells_ - 0.5); }

  double side_;
  int cells_;
};

/// Tree `index`: what it is and how it stands.
Instance plant_tree(const Ground& ground, std::uint32_t index) {
  WorldRandom random(instance_seed + index);
  const auto side = static_cast<float>(ground.side());
  const std::uint32_t middle = 1u << 31;  // where tree 0 stands
  const float x = side * (to_unit_float(middle + 3242174889u * index) - 0.5f);
  const float z = side * (to_unit_float(middle + 2447445414u * index) - 0.5f);
  const auto y = static_cast<float>(ground.height(double{x}, double{z})) - 0.05f;
  const auto group = 1 + static_cast<std::uint32_t>(4 * random.next());
  const float size = random.next(3.0f, 5.0f), wide_x = random.next(0.8f, 1.25f);
  const float wide_z = random.next(0.8f, 1.25f), turn = random.next(0, 360);
  Affine bend;
  bend.row[0].y = random.next(-0.15f, 0.15f);
  bend.row[2].y = random.next(-0.15f, 0.15f);
  return {group, translate({x, y, z}) * bend * rotate({0, 1, 0}, turn) *
                     scale({size * wide_x, size, size * wide_z})};
}

/// How far the wind tilts a tree about its foot while the shutter is open.
TransformKey tilted(const Affine& to_world, std::uint32_t index) {
  WorldRandom random(sway_seed + index);
  const Vec3 foot = to_world.translation();
  const Affine tilt = rotate({0, 0, 1}, random.next(-12.0f, -2.0f));  // towards x
  return {Shutter().close, translate(foot) * tilt * translate(-foot) * to_world};
}

void let_sway(SceneData& scene, float percent) {
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    if (100.0f * to_unit_float(2654435769u * i) >= percent) continue;
    const Affine& to_world = scene.instances[i].to_world;
    scene.motion.instances.push_back({i, {{Shutter().open, to_world}, tilted(to_world, i)}});
  }
}

}  // namespace

ForestSettings parse_forest(const SceneName& scene) {
  ForestSettings settings;
  std::string_view rest = scene.parameter;
  const bool has_percent = rest.find(':') != std::string_view::npos;
  const std::string count(next_part(rest));
  settings.trees =
      parse_count({scene.full, scene.name, count}, settings.trees, forest_least, forest_most);
  if (has_percent && !read_part(rest, 0.0f, 100.0f, settings.percent))
    refuse_part(scene, 'P', rest, "0 to 100 percent of the trees", "instances:N:P");
  return settings;
}

SceneData make_forest_scene(std::uint64_t count, float percent) {
  if (count < forest_least || count > forest_most) {
    throw Error(fmt::format("forest of {} instances: expected from {} to {}", count, forest_least,
                            forest_most));
  }
  SceneData scene;
  const Ground ground(count);
  scene.meshes.push_back(ground.mesh());
  scene.meshes.back().material = scene.add_material(make_diffuse({0.24f, 0.2f, 0.12f}));
  const std::uint32_t bark = scene.add_material(make_diffuse({0.2f, 0.13f, 0.08f}));
  const std::array<Color, 4> greens = {Color(0.08f, 0.2f, 0.1f), Color(0.2f, 0.38f, 0.08f),
                                       Color(0.3f, 0.36f, 0.1f), Color(0.14f, 0.34f, 0.12f)};
  for (Mesh& mesh : generate_trees()) {
    const bool leaves = scene.meshes.back().group == mesh.group;
    mesh.material = leaves ? scene.add_material(make_diffuse(greens[mesh.group - 1])) : bark;
    scene.meshes.push_back(std::move(mesh));
  }
  scene.instances.resize(count);
  tbb::parallel_for(std::uint32_t{0}, static_cast<std::uint32_t>(count),
                    [&](std::uint32_t i) { scene.instances[i] = plant_tree(ground, i); });
  let_sway(scene, percent);
  const auto side = static_cast<float>(ground.side());
  scene.sky = {{0.05f, 0.08f, 0.12f}, {1.25f, 1.4f, 1.6f}};  // overcast: brightest above
  scene.camera = {{0, 0.1f * side + 4, 0.55f * side + 4},
                  {0, 0.02f * side + 2, 0.1f * side},
                  {0, 1, 0},
                  38.0f,
                  0.0f,
                  0.5f * side};
  return scene;
}

}  // namespace pt
