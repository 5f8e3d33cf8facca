#include "common/scene/edit/scene_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "common/error/error.h"

namespace pt {
namespace {

using Values = std::span<const float>;

void check_finite(const std::string& name, Values values) {
  for (const float x : values) {
    if (!std::isfinite(x)) throw Error(fmt::format("{}: {}: expected finite numbers", name, x));
  }
}

Vec3 vector_of(Values v) { return {v[0], v[1], v[2]}; }
std::vector<float> list_of(const Vec3& v) { return {v.x, v.y, v.z}; }

/// Collects the parameters of a scene.
class Lister {
 public:
  explicit Lister(const SceneData& scene) : scene_(scene) {}

  std::vector<SceneParameter> list() {
    add_camera();
    add_materials();
    add_lights();
    add_instances();
    add_meshes();
    return std::move(list_);
  }

 private:
  /// The setter is given finite numbers.
  template <class Get, class Set>
  void add(std::string name, std::vector<std::size_t> shape, Get get, Set set) {
    auto checked = [name, set](SceneData& scene, Values values) {
      check_finite(name, values);
      set(scene, values);
    };
    const SceneChanges changes = changes_of(name);
    list_.push_back({std::move(name), std::move(shape), changes, get, checked});
  }

  /// `part(scene)` is a reference to a vector or colour in the scene.
  template <class Part>
  void add_vector(const std::string& name, Part part) {
    add(
        name, {3}, [part](const SceneData& scene) { return list_of(part(scene)); },
        [part](SceneData& scene, Values v) { part(scene) = vector_of(v); });
  }

  template <class Part>
  void add_number(const std::string& name, Part part) {
    add(
        name, {}, [part](const SceneData& scene) { return std::vector<float>{part(scene)}; },
        [part](SceneData& scene, Values v) { part(scene) = v[0]; });
  }

  /// The radiance or intensity of a light.
  template <class Part>
  void add_radiance(const std::string& name, Part part) {
    add(
        name, {3}, [part](const SceneData& scene) { return list_of(part(scene)); },
        [name, part](SceneData& scene, Values v) {
          if (*std::ranges::min_element(v) < 0.0f)
            throw Error(fmt::format("{}: expected numbers of 0 or more", name));
          part(scene) = vector_of(v);
        });
  }

  void add_camera() {
    add_vector(
        "camera.origin", [](auto& s) -> auto& { return s.camera.look_from; });
    add_vector(
        "camera.target", [](auto& s) -> auto& { return s.camera.look_at; });
    add_vector(
        "camera.up", [](auto& s) -> auto& { return s.camera.up; });
    if (!scene_.camera.orthographic) {
      add_number(
          "camera.fov", [](auto& s) -> auto& { return s.camera.fov_degrees; });
      add_number(
          "camera.aperture", [](auto& s) -> auto& { return s.camera.aperture; });
      add_number(
          "camera.focus_distance", [](auto& s) -> auto& { return s.camera.focus_distance; });
    }
  }

  void add_materials() {
    names_ = material_names(scene_);
    for (std::uint32_t m = 0; m < scene_.materials.size(); ++m) {
      const MaterialNode node = scene_.materials[m].node;
      if (node == MaterialNode::none) add_material(m);
      if (node == MaterialNode::blend)
        add_number(
            "materials." + names_[m] + ".weight", [m](auto& s) -> auto& {
              return s.materials[m].parameters[0].value.x;
            });
    }
  }

  void add_material(std::uint32_t m) {
    for (const MaterialValue& value : material_values(scene_.materials[m])) {
      const std::string name = "materials." + names_[m] + "." + value.name;
      add(
          name, value.is_color ? std::vector<std::size_t>{3} : std::vector<std::size_t>{},
          [m, value](const SceneData& scene) {
            const Color color = value.get(scene.materials[m]);
            return value.is_color ? list_of(color) : std::vector<float>{color.x};
          },
          [m, value](SceneData& scene, Values v) {
            value.set(scene.materials[m], value.is_color ? vector_of(v) : Color(v[0]));
          });
    }
  }

  void add_lights() {
    for (std::uint32_t m = 0; m < scene_.materials.size(); ++m) {
      if (is_black(scene_.materials[m].emission.radiance)) continue;
      const auto named = scene_.names.emitters.find(m);
      const std::string& name = named == scene_.names.emitters.end() ? names_[m] : named->second;
      add_radiance(
          unique("lights." + name + ".radiance"), [m](auto& s) -> auto& {
            return s.materials[m].emission.radiance;
          });
    }
    for (std::uint32_t i = 0; i < scene_.delta_lights.size(); ++i) {
      const auto named = scene_.names.delta_lights.find(i);
      const std::string name =
          named == scene_.names.delta_lights.end() ? fmt::format("light_{}", i) : named->second;
      add_radiance(
          unique("lights." + name + ".intensity"), [i](auto& s) -> auto& {
            return s.delta_lights[i].intensity;
          });
    }
    add_radiance(
        "lights.sky.nadir", [](auto& s) -> auto& { return s.sky.nadir; });
    add_radiance(
        "lights.sky.zenith", [](auto& s) -> auto& { return s.sky.zenith; });
    if (scene_.sun.one_minus_cos > 0.0f)
      add_radiance(
          "lights.sun.radiance", [](auto& s) -> auto& { return s.sun.radiance; });
  }

  void add_instances() {
    for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
      const std::string name = fmt::format("instances.{}.to_world", i);
      add(
          name, {4, 4},
          [i](const SceneData& scene) {
            const auto& [a, b, c] = scene.instances[i].to_world.row;
            return std::vector{a.x, a.y, a.z, a.w, b.x,  b.y,  b.z,  b.w,
                               c.x, c.y, c.z, c.w, 0.0f, 0.0f, 0.0f, 1.0f};
          },
          [i, name](SceneData& scene, Values v) {
            Affine map;
            for (int r = 0; r < 3; ++r) {
              const auto* const at = &v[static_cast<std::size_t>(4 * r)];
              map.row[r] = {at[0], at[1], at[2], at[3]};
            }
            if (v[12] != 0 || v[13] != 0 || v[14] != 0 || v[15] != 1 || map.determinant() == 0.0f)
              throw Error(name +
                          ": expected an affine map that can be inverted, its last row 0 0 "
                          "0 1");
            scene.instances[i].to_world = map;
          });
    }
  }

  /// `part(scene)` is a reference to a list of vectors in the scene.
  template <class Part>
  void add_rows(const std::string& name, Part part) {
    add(
        name, {part(scene_).size(), 3},
        [part](const SceneData& scene) {
          const float* const first = &part(scene).front().x;
          return std::vector<float>(first, first + 3 * part(scene).size());
        },
        [part](SceneData& scene, Values v) {
          static_assert(sizeof(Vec3) == 3 * sizeof(float));
          std::memcpy(part(scene).data(), v.data(), v.size_bytes());
        });
  }

  void add_meshes() {
    std::set<std::string> taken;
    for (std::uint32_t i = 0; i < scene_.meshes.size(); ++i) {
      const Mesh& mesh = scene_.meshes[i];
      if (mesh.positions.empty()) continue;
      const auto& names = scene_.names;
      const auto own = names.meshes.find(i);
      const auto of_material = names.materials.find(mesh.material);
      const std::string named = own != names.meshes.end()              ? own->second
                                : of_material != names.materials.end() ? of_material->second
                                                                       : fmt::format("mesh_{}", i);
      std::string name = named;
      for (int n = 2; !taken.insert(name).second; ++n) name = fmt::format("{}_{}", named, n);
      add_rows(
          "meshes." + name + ".vertices", [i](auto& s) -> auto& { return s.meshes[i].positions; });
      if (!mesh.normals.empty())
        add_rows(
            "meshes." + name + ".normals", [i](auto& s) -> auto& { return s.meshes[i].normals; });
    }
  }

  /// Names of lights need not differ in their files.
  std::string unique(const std::string& name) const {
    std::string result = name;
    const auto is_taken = [&] {
      return std::ranges::find(list_, result, &SceneParameter::name) != list_.end();
    };
    const std::size_t dot = name.rfind('.');
    for (int n = 2; is_taken(); ++n)
      result = fmt::format("{}_{}{}", name.substr(0, dot), n, name.substr(dot));
    return result;
  }

  const SceneData& scene_;
  std::vector<std::string> names_;
  std::vector<SceneParameter> list_;
};

}  // namespace

SceneChanges changes_of(std::string_view parameter) {
  const std::string_view part = parameter.substr(0, parameter.find('.'));
  const std::string_view value = parameter.substr(parameter.rfind('.') + 1);
  SceneChanges changes;
  changes.camera = part == "camera";
  changes.shading = part == "materials" || part == "lights";
  changes.lights = part == "lights" || (part == "materials" && value == "opacity");
  changes.instances = part == "instances";
  changes.vertices = part == "meshes" && value == "vertices";
  changes.normals = part == "meshes" && value == "normals";
  return changes;
}

std::vector<SceneParameter> scene_parameters(const SceneData& scene) {
  return Lister(scene).list();
}

}  // namespace pt
