#include "common/scene/list_lights.h"

#include <fmt/format.h>

#include "common/error.h"
#include "common/light/area_light.h"
#include "common/light/triangle_light.h"
#include "common/scene/light_errors.h"

namespace pt {
namespace {

constexpr std::size_t lights_max = std::size_t{1} << 24;

class Lister {
 public:
  Lister(const SceneData& scene, const Bounds& bounds) : scene_(scene) {
    radius_ = bounds.is_empty() ? 1.0f : 0.5f * glm::length(bounds.max - bounds.min);
  }

  LightListData list() {
    std::uint32_t first_triangle = 0;
    for (const Mesh& mesh : scene_.meshes) {
      if (!is_black(scene_.materials[mesh.material].emission)) add_mesh(mesh, first_triangle);
      first_triangle += static_cast<std::uint32_t>(mesh.triangles.size());
    }
    for (std::size_t i = 0; i < scene_.spheres.size(); ++i) add_sphere(i);
    for (const DeltaLight& light : scene_.delta_lights) add_delta(light);
    LightListData data;
    std::vector<float> weights;
    for (const Light& light : lights_) {
      weights.push_back(light.weight);
      total_weight_ += light.weight;
    }
    if (!weights.empty()) data.selection = build_alias_table(weights);
    data.lights = std::move(lights_);
    data.total_weight = total_weight_ > 0 ? static_cast<float>(total_weight_) : 1.0f;  // a divisor
    if (scene_.environment.width > 0) {
      data.environment_probability = data.lights.empty() ? 1.0f : 0.5f;
    }
    return data;
  }

 private:
  void add_mesh(const Mesh& mesh, std::uint32_t first_triangle) {
    if (mesh.group == 0) return add_placed(mesh, first_triangle, nullptr);
    for (const Instance& instance : scene_.instances) {
      if (instance.group == mesh.group) add_placed(mesh, first_triangle, &instance.to_world);
    }
  }

  void add_placed(const Mesh& mesh, std::uint32_t first_triangle, const Affine* to_world) {
    const Material& material = scene_.materials[mesh.material];
    const MaterialTextures& textures = scene_.material_textures[material.textures];
    const PlacementErrors errors(to_world);
    if (lights_.size() + mesh.triangles.size() > lights_max) {
      throw Error(fmt::format("scene '{}' has more than {} triangles that emit light", scene_.name,
                              lights_max));
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      Vec3 v[3];
      for (int k = 0; k < 3; ++k) v[k] = mesh.positions[mesh.triangles[i].v[k]];
      Vec3 edge1 = v[1] - v[0], edge2 = v[2] - v[0];
      Light light{};
      light.a = v[0];
      if (to_world != nullptr) {
        light.a = to_world->point(v[0]);
        edge1 = to_world->vector(edge1), edge2 = to_world->vector(edge2);
      }
      const bool turned = to_world != nullptr && to_world->determinant() < 0.0f;
      light.kind = turned ? LightKind::turned_triangle : LightKind::triangle;
      light.b = turned ? edge2 : edge1, light.c = turned ? edge1 : edge2;
      const PackedLightError error = pack_light_error(errors.of_triangle(v, edge1, edge2));
      light.relative_error = error.relative, light.absolute_error = error.absolute;
      light.weight = emitter_weight(material.emission, 0.5f * glm::length(glm::cross(edge1, edge2)),
                                    textures.emission_mean);
      light.triangle =
          mesh.uvs.empty() ? no_texture : first_triangle + static_cast<std::uint32_t>(i);
      light.radiance = material.emission;
      light.emission_texture = textures.emission;
      add(light);
    }
  }

  void add_sphere(std::size_t i) {
    const Material& material = scene_.materials[scene_.sphere_material[i]];
    if (is_black(material.emission)) return;
    const Sphere& sphere = scene_.spheres[i];
    Light light{};
    light.kind = LightKind::sphere;
    light.a = sphere.center;
    light.c.x = sphere.radius_squared;
    light.weight = emitter_weight(material.emission, sphere_area(sphere));
    light.radiance = material.emission;
    light.triangle = light.emission_texture = no_texture;
    add(light);
  }

  void add_delta(const DeltaLight& delta) {
    Light light{};
    light.a = delta.position;
    light.b = delta.direction;
    light.c = {delta.cos_inner, delta.cos_outer,
               bits_to_float(static_cast<std::uint32_t>(delta.falloff))};
    light.radiance = delta.intensity;
    light.triangle = light.emission_texture = no_texture;
    light.kind = static_cast<LightKind>(static_cast<std::uint32_t>(LightKind::point) +
                                        static_cast<std::uint32_t>(delta.kind));
    light.weight = inverse_pi * luminance(delta_light_power(delta, radius_));
    add(light);
  }

  void add(const Light& light) {
    if (light.weight > 0.0f) lights_.push_back(light);
  }

  const SceneData& scene_;
  float radius_;
  std::vector<Light> lights_;
  double total_weight_ = 0;
};

}  // namespace

LightListData list_lights(const SceneData& scene, const Bounds& bounds) {
  return Lister(scene, bounds).list();
}

}  // namespace pt
