#include "common/scene/prepare/list_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

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

LightError PlacementErrors::of_triangle(const Vec3 vertices[3], const Vec3& edge1,
                                        const Vec3& edge2) const {
  const Vec3 normal = glm::cross(edge1, edge2);
  const float area = glm::length(normal);  // twice
  const float edge = std::max({glm::length(edge1), glm::length(edge2), glm::length(edge2 - edge1)});
  if (!(area > 0.0f)) return {};
  const float aspect = std::clamp(edge * edge / area, 1.0f, aspect_max);
  LightError error{light_rounding * edge * aspect, light_rounding * condition_};
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
    const MotionTracks& tracks = scene_.motion.tracks();
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      const Instance& instance = scene_.instances[i];
      add_group(instance.group, &instance.to_world,
                tracks.moves(i) ? tracks.instances[i] : MotionTrack());
    }
    add_group(0, nullptr, {});
    for (std::size_t i = 0; i < scene_.spheres.size(); ++i) add_sphere(i);
    for (const DeltaLight& light : scene_.delta_lights) {
      if (has_position(light.kind)) add_delta(light);
    }
    const std::size_t first_distant = data_.lights.size();
    for (const DeltaLight& light : scene_.delta_lights) {
      if (!has_position(light.kind)) add_delta(light);
    }
    if (scene_.sun.one_minus_cos > 0.0f) add_sun();
    if (selection_ == LightSelection::tree) data_.tree = build_light_tree(data_.lights);
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

  bool shines(const Mesh& mesh) const {
    return !is_black(scene_.materials[mesh.material].emission.radiance);
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
      if (shines(mesh)) {
        emissive_meshes_[mesh.group].push_back({&mesh, first_triangle});
        data_.rank.resize(first_triangle + count);
        std::uint32_t& next = ranks[mesh.group];
        std::iota(data_.rank.end() - count, data_.rank.end(), next);
        next += count;
      }
      first_triangle += count;
    }
  }

  /// The lights of an instance that moves are listed in its own space.
  void add_group(std::uint32_t group, const Affine* to_world, const MotionTrack& track) {
    data_.first.push_back(static_cast<std::uint32_t>(data_.lights.size()));
    for (const EmissiveMesh& emissive : emissive_meshes_[group])
      add_placed(*emissive.mesh, emissive.first_triangle, to_world, track);
  }

  /// The largest of all keys, twice: for the poses between them.
  LightError moving_error(const MotionTrack& track, const Vec3 v[3]) const {
    const MotionSegment* const segments = &scene_.motion.tracks().segments[track.first];
    LightError most{};
    for (std::uint32_t key = 0; key <= track.count; ++key) {
      const Affine pose = key == 0 ? pose_in(segments[0], 0.0f) : pose_in(segments[key - 1], 1.0f);
      const LightError error =
          PlacementErrors(&pose).of_triangle(v, pose.vector(v[1] - v[0]), pose.vector(v[2] - v[0]));
      most.absolute = std::max(most.absolute, 2.0f * error.absolute);
      most.relative = std::max(most.relative, 2.0f * error.relative);
    }
    return most;
  }

  void add_placed(const Mesh& mesh, std::uint32_t first_triangle, const Affine* to_world,
                  const MotionTrack& track) {
    const Emission& emission = scene_.materials[mesh.material].emission;
    const PlacementErrors errors(to_world);
    if (data_.lights.size() + mesh.triangles.size() > lights_max) {
      throw Error(fmt::format("scene '{}' has more than {} triangles that emit light", scene_.name,
                              lights_max));
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      Vec3 v[3];
      for (int k = 0; k < 3; ++k) v[k] = mesh.positions[mesh.triangles[i].v[k]];
      Vec3 edge1 = v[1] - v[0], edge2 = v[2] - v[0];
      TriangleLight light;
      light.vertex = v[0];
      if (to_world != nullptr) {
        light.vertex = to_world->point(v[0]);
        edge1 = to_world->vector(edge1), edge2 = to_world->vector(edge2);
      }
      const bool turned = to_world != nullptr && to_world->determinant() < 0.0f;
      light.kind = turned ? LightKind::flipped_triangle : LightKind::triangle;
      light.edge1 = turned ? edge2 : edge1, light.edge2 = turned ? edge1 : edge2;
      const PackedLightError error = pack_light_error(
          track.moves() ? moving_error(track, v) : errors.of_triangle(v, edge1, edge2));
      light.relative_error = error.relative, light.absolute_error = error.absolute;
      light.weight = emitter_weight(emission.radiance, 0.5f * glm::length(glm::cross(edge1, edge2)),
                                    emission.texture_mean);
      if (track.moves()) {
        light.vertex = v[0];
        light.edge1 = v[turned ? 2 : 1] - v[0], light.edge2 = v[turned ? 1 : 2] - v[0];
      }
      // Emission is scaled by opacity: such emitters are hit by BSDF sampling alone.
      if (!scene_.materials[mesh.material].opacity.is_opaque()) light.weight = 0.0f;
      light.triangle =
          mesh.uvs.empty() ? no_texture : first_triangle + static_cast<std::uint32_t>(i);
      light.radiance = emission.radiance;
      light.emission_texture = emission.texture;
      data_.lights.push_back(Light::of(light));
    }
    finish_emitter(data_.lights.size() - mesh.triangles.size());
  }

  void add_sphere(std::size_t i) {
    data_.spheres.push_back(static_cast<std::uint32_t>(data_.lights.size()));
    const Color& radiance = scene_.materials[scene_.sphere_material[i]].emission.radiance;
    if (is_black(radiance)) return;
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
    meshes[mesh.group] += std::ranges::any_of(mesh.triangles, [&](const TriangleIndices& t) {
      const Vec3& a = mesh.positions[t.v[0]];
      const Vec3 normal = glm::cross(mesh.positions[t.v[1]] - a, mesh.positions[t.v[2]] - a);
      return emits(mesh.material, 0.5f * glm::length(normal));
    });
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
