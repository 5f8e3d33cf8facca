#include "common/scene/prepare/list_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "common/accel/build/instance_tree.h"
#include "common/error/error.h"
#include "common/light/lights.h"

namespace pt {

namespace {

Affine without_translation(Affine map) {
  for (Vec4& row : map.row) row.w = 0.0f;
  return map;
}

/// On slivers Embree's distances are uncertain by the longest edge over the height, but no more
/// than this. (Our own test's are not: see hit_error_distance.)
constexpr float aspect_max = 1024.0f;

}  // namespace

PlacementErrors::PlacementErrors(const Affine* to_world) : placed_(to_world != nullptr) {
  if (!placed_) return;
  to_world_ = *to_world;
  to_object_ = inverse(*to_world);
  linear_ = without_translation(to_world_);
  condition_ = max_abs(linear_.absolute(without_translation(to_object_).absolute(Vec3(1.0f))));
}

LightError PlacementErrors::of_triangle(const Vec3 vertices[3]) const {
  const Vec3 edge1 = edge(vertices, 1), edge2 = edge(vertices, 2);
  const Vec3 normal = glm::cross(edge1, edge2);
  const float area = glm::length(normal);  // twice
  const float longest =
      std::max({glm::length(edge1), glm::length(edge2), glm::length(edge2 - edge1)});
  if (!(area > 0.0f)) return {};
  const float aspect = std::clamp(longest * longest / area, 1.0f, aspect_max);
  LightError error{light_rounding * longest * aspect, light_rounding * condition_};
  if (placed_) {
    // A map of a point rounds up to 4 times, its own numbers have been rounded once, and the
    // shadow ray is another one: half an ulp each of the terms' sizes.
    Vec3 size(0.0f);
    for (int i = 0; i < 3; ++i) size = glm::max(size, glm::abs(vertices[i]));
    const Vec3 in_world = to_world_.absolute(size);
    const Vec3 terms = in_world + linear_.absolute(to_object_.absolute(in_world));
    error.absolute += 8.0f * half_ulp * glm::dot(glm::abs(normal) / area, terms);
  }
  return error;
}
namespace {

constexpr std::size_t lights_max = std::size_t{1} << 24;

class Lister {
 public:
  Lister(const SceneData& scene, const Bounds& bounds, LightSelection selection)
      : scene_(scene), selection_(selection) {
    radius_ = bounds.is_empty() ? 1.0f : 0.5f * glm::length(bounds.max - bounds.min);
  }

  LightListData list() {
    list_area_lights();
    for (std::uint32_t i = 0; i < scene_.instances.size(); ++i)
      add_group(scene_.instances[i].group, i, &scene_.instances[i].to_world);
    add_group(0, MovingLight::none, nullptr);
    for (std::size_t i = 0; i < scene_.spheres.size(); ++i) add_sphere(i);
    for (const DeltaLight& light : scene_.delta_lights) {
      if (has_position(light.kind)) add_delta(light);
    }
    const std::size_t first_distant = data_.lights.size();
    for (const DeltaLight& light : scene_.delta_lights) {
      if (!has_position(light.kind)) add_delta(light);
    }
    if (scene_.sun.one_minus_cos > 0.0f) add_sun();
    if (selection_ == LightSelection::tree) data_.tree = build_light_tree(bounds_of_lights());
    if (data_.tree.pairs.empty()) {
      make_table(0);
      share_with_environment(data_.selection.empty() ? 0 : emitter_count_);
    } else {
      make_table(first_distant);
      share_with_tree();
    }
    return std::move(data_);
  }

 private:
  /// Of lights that move, with all of their way and turned in any way. One may begin as a point.
  std::vector<std::optional<LightBounds>> bounds_of_lights() {
    for (std::size_t i = 0; i < scene_.motion.spheres.size(); ++i) {
      const std::uint32_t sphere = scene_.motion.spheres[i].sphere;
      if (shines(scene_.sphere_material[sphere]))
        ways_[data_.spheres[sphere]] = moving_sphere_bounds(scene_, i);
    }
    std::vector<std::optional<LightBounds>> result;
    for (const Light& light : data_.lights) {
      result.push_back(bounds_of(light));
      const auto way = ways_.find(static_cast<std::uint32_t>(result.size() - 1));
      if (way == ways_.end() || !(light.weight > 0.0f)) continue;
      if (!result.back()) result.back() = {{}, {0, 0, 1}, half_turn, quarter_turn, light.weight};
      result.back()->box = way->second, result.back()->cone = half_turn;
    }
    return result;
  }

  /// The table of the lights from `first` on.
  void make_table(std::size_t first) {
    std::vector<float> weights;
    double total = 0;
    for (std::size_t i = first; i < data_.lights.size(); ++i) {
      weights.push_back(data_.lights[i].weight);
      total += data_.lights[i].weight;
    }
    data_.table_first = static_cast<std::uint32_t>(first);
    data_.total_weight = total > 0 ? static_cast<float>(total) : 1.0f;  // a divisor
    // Lights of no weight are never sampled, but a ray may hit them and need their probability.
    if (total > 0) data_.selection = build_alias_table(weights);
  }

  void share_with_environment(std::size_t emitters) {
    if (scene_.environment.width == 0) return;
    const bool uniform = selection_ == LightSelection::uniform;
    data_.environment_probability = emitters == 0 ? 1.0f
                                    : uniform     ? 1.0f / static_cast<float>(emitters + 1)
                                                  : 0.5f;
  }

  /// The environment, lights without position, and the tree: equally likely.
  void share_with_tree() {
    const bool has_table = !data_.selection.empty(), has_map = scene_.environment.width > 0;
    data_.table_probability = has_table ? 0.5f : 0.0f;
    data_.environment_probability = !has_map ? 0.0f : has_table ? 1.0f / 3.0f : 0.5f;
  }

  /// The lights from `first` on are one emitter.
  void finish_emitter(std::size_t first) {
    double total = 0;
    for (std::size_t i = first; i < data_.lights.size(); ++i) total += data_.lights[i].weight;
    if (!(total > 0)) return;
    ++emitter_count_;
    if (selection_ != LightSelection::uniform) return;
    for (std::size_t i = first; i < data_.lights.size(); ++i) {
      data_.lights[i].weight = static_cast<float>(data_.lights[i].weight / total);
    }
  }

  bool shines(std::uint32_t material) const {
    return !is_black(scene_.materials[material].emission.radiance);
  }

  /// A mesh that emits.
  struct EmissiveMesh {
    const Mesh* mesh;
    std::uint32_t first_triangle;  ///< counted through all meshes
  };

  /// Emissive triangles are numbered through the meshes of a group.
  void list_area_lights() {
    std::map<std::uint32_t, std::uint32_t> ranks;  // by group
    std::uint32_t first_triangle = 0;
    for (const Mesh& mesh : scene_.meshes) {
      const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
      if (shines(mesh.material)) {
        emissive_meshes_[mesh.group].push_back({&mesh, first_triangle});
        data_.rank.resize(first_triangle + count);
        std::uint32_t& next = ranks[mesh.group];
        std::iota(data_.rank.end() - count, data_.rank.end(), next);
        next += count;
      }
      first_triangle += count;
    }
  }

  /// `instance`: its number, or MovingLight::none for what lies in the world.
  void add_group(std::uint32_t group, std::uint32_t instance, const Affine* to_world) {
    data_.first.push_back(static_cast<std::uint32_t>(data_.lights.size()));
    if (!emissive_meshes_.contains(group)) return;
    std::vector<PlacementErrors> poses;  // at all keys, the first one first
    if (const MotionTracks& tracks = scene_.motion.tracks(); tracks.moves(instance)) {
      const MotionTrack& track = tracks.instances[instance];
      for (std::uint32_t i = track.first; i < track.first + track.count; ++i) {
        for (const float end : {0.0f, 1.0f}) {
          const Affine pose = pose_in(tracks.segments[i], end);
          poses.emplace_back(&pose);
        }
      }
    } else {
      poses.emplace_back(to_world);
    }
    for (const EmissiveMesh& emissive : emissive_meshes_.at(group))
      add_placed(*emissive.mesh, emissive.first_triangle, instance, to_world, poses);
  }

  void add_placed(const Mesh& mesh, std::uint32_t first_triangle, std::uint32_t instance,
                  const Affine* to_world, const std::vector<PlacementErrors>& poses) {
    const Emission& emission = scene_.materials[mesh.material].emission;
    const bool moves = poses.size() > 1 || mesh.vertex_sets() > 1;
    if (data_.lights.size() + mesh.triangles.size() > lights_max) {
      throw Error(fmt::format("scene '{}' has more than {} triangles that emit light", scene_.name,
                              lights_max));
    }
    const PlacementErrors first(to_world);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const std::uint32_t id = first_triangle + static_cast<std::uint32_t>(i);
      Vec3 v[3];
      LightError error;
      float area = 0.0f;  // of all sets of vertices, of which the first comes last
      for (std::size_t set = mesh.vertex_sets(); set-- > 0;) {
        for (int k = 0; k < 3; ++k) v[k] = mesh.positions_of(set)[mesh.triangles[i].v[k]];
        area += 0.5f * glm::length(glm::cross(first.edge(v, 1), first.edge(v, 2)));
        for (const PlacementErrors& pose : poses) error.grow(pose.of_triangle(v));
      }
      TriangleLight light;
      light.vertex = to_world != nullptr ? to_world->point(v[0]) : v[0];
      const bool turned = to_world != nullptr && to_world->determinant() < 0.0f;
      light.kind = turned ? LightKind::flipped_triangle : LightKind::triangle;
      light.edge1 = first.edge(v, turned ? 2 : 1), light.edge2 = first.edge(v, turned ? 1 : 2);
      const float more = moves ? 2.0f : 1.0f;  // for what lies between keys and sets
      const PackedLightError packed =
          pack_light_error({more * error.absolute, more * error.relative});
      light.relative_error = packed.relative, light.absolute_error = packed.absolute;
      light.weight = emitter_weight(
          emission.radiance, area / static_cast<float>(mesh.vertex_sets()), emission.texture_mean);
      // Emission is scaled by opacity: such emitters are hit by BSDF sampling alone.
      if (!scene_.materials[mesh.material].opacity.is_opaque()) light.weight = 0.0f;
      light.triangle = mesh.uvs.empty() ? no_texture : id;
      light.radiance = emission.radiance;
      light.emission_texture = emission.texture;
      data_.lights.push_back(Light::of(light));
      if (!moves) continue;
      if (selection_ == LightSelection::tree)
        ways_[static_cast<std::uint32_t>(data_.lights.size() - 1)] =
            way_of(mesh, mesh.triangles[i], instance, to_world);
      data_.moving.resize(data_.lights.size());
      data_.moving.back() = {id, instance};
    }
    finish_emitter(data_.lights.size() - mesh.triangles.size());
  }

  /// The world's box of a triangle of a mesh, of all sets of vertices, that moves with an instance.
  Bounds way_of(const Mesh& mesh, const TriangleIndices& triangle, std::uint32_t instance,
                const Affine* to_world) const {
    const MotionTracks& tracks = scene_.motion.tracks();
    const bool moves = tracks.moves(instance);
    Bounds box;
    for (std::size_t set = 0; set < mesh.vertex_sets(); ++set)
      for (const std::uint32_t k : triangle.v) {
        const Vec3& own = mesh.positions_of(set)[k];
        box.grow(moves || to_world == nullptr ? own : to_world->point(own));
      }
    return moves ? moving_bounds(box, tracks, tracks.instances[instance]) : box;
  }

  void add_sphere(std::size_t i) {
    data_.spheres.push_back(static_cast<std::uint32_t>(data_.lights.size()));
    if (!shines(scene_.sphere_material[i])) return;
    const Color& radiance = scene_.materials[scene_.sphere_material[i]].emission.radiance;
    const Sphere& sphere = scene_.spheres[i];
    SphereLight light;
    light.center = sphere.center;
    light.radius_squared = sphere.radius_squared;
    light.weight = emitter_weight(radiance, sphere_area(sphere));
    light.radiance = radiance;
    data_.lights.push_back(Light::of(light));
    finish_emitter(data_.lights.size() - 1);
  }

  void add_delta(const DeltaLight& delta) {
    data_.lights.push_back(make_light(delta, radius_));
    finish_emitter(data_.lights.size() - 1);
  }

  void add_sun() {
    data_.sun = static_cast<std::uint32_t>(data_.lights.size());
    const Sun& sun = scene_.sun;
    SunLight light;
    light.direction = sun.direction;
    light.one_minus_cos = sun.one_minus_cos;
    light.radiance = sun.radiance;
    // As a directional light of its irradiance.
    light.weight = 2 * pi * sun.one_minus_cos * radius_ * radius_ * luminance(sun.radiance);
    data_.lights.push_back(Light::of(light));
    finish_emitter(data_.lights.size() - 1);
  }

  const SceneData& scene_;
  LightSelection selection_;
  float radius_;
  std::size_t emitter_count_ = 0;                                       ///< that give any light
  std::map<std::uint32_t, std::vector<EmissiveMesh>> emissive_meshes_;  ///< by group
  std::map<std::uint32_t, Bounds> ways_;  ///< of lights that move, for a tree
  LightListData data_;
};

}  // namespace

LightListData list_lights(const SceneData& scene, const Bounds& bounds, LightSelection selection) {
  return Lister(scene, bounds, selection).list();
}

std::size_t emitter_count(const SceneData& scene) {
  const auto emits = [&](std::uint32_t material, float area) {
    const MaterialDescription& m = scene.materials[material];
    return m.opacity.is_opaque() &&
           emitter_weight(m.emission.radiance, area, m.emission.texture_mean) > 0;
  };
  std::map<std::uint32_t, std::size_t> meshes;  // that emit, by group
  for (const Mesh& mesh : scene.meshes) {
    if (!emits(mesh.material, 1)) continue;
    const auto emits_in = [&](std::size_t set) {
      const std::vector<Vec3>& p = mesh.positions_of(set);
      return std::ranges::any_of(mesh.triangles, [&](const TriangleIndices& t) {
        const Vec3 normal = glm::cross(p[t.v[1]] - p[t.v[0]], p[t.v[2]] - p[t.v[0]]);
        return emits(mesh.material, 0.5f * glm::length(normal));
      });
    };
    bool has_any = false;
    for (std::size_t set = 0; set < mesh.vertex_sets(); ++set) has_any = has_any || emits_in(set);
    meshes[mesh.group] += has_any;
  }
  std::size_t count = meshes[0];
  for (const Instance& instance : scene.instances) count += meshes[instance.group];
  std::set<std::uint32_t> quads;  // those of a material become one mesh
  for (std::size_t i = 0; i < scene.quads.size(); ++i) {
    const Quad& quad = scene.quads[i];
    if (emits(scene.quad_material[i], glm::length(glm::cross(quad.edge_a, quad.edge_b))))
      quads.insert(scene.quad_material[i]);
  }
  count += quads.size();
  for (std::size_t i = 0; i < scene.spheres.size(); ++i)
    count += !is_black(scene.materials[scene.sphere_material[i]].emission.radiance) &&
             scene.spheres[i].radius_squared > 0;
  for (const DeltaLight& light : scene.delta_lights) count += make_light(light, 1.0f).weight > 0;
  return count + (scene.sun.one_minus_cos > 0.0f && luminance(scene.sun.radiance) > 0);
}

}  // namespace pt
