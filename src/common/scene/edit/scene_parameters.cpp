#include "common/scene/edit/scene_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "common/error/error.h"

namespace pt {
namespace {

using Values = std::span<const float>;

Vec3 vector_of(Values v) { return {v[0], v[1], v[2]}; }
std::vector<float> list_of(const Vec3& v) { return {v.x, v.y, v.z}; }

void check_finite(Values v, const std::string& what) {
  for (const float x : v)
    if (!std::isfinite(x)) throw Error(fmt::format("{}: {}: expected finite numbers", what, x));
}

/// From a space where the camera looks along z, with x to the left and y up; any, if its parameters
/// describe none.
Affine view_of(const CameraParameters& camera) {
  using DVec3 = glm::dvec3;
  const DVec3 forward = glm::normalize(DVec3(camera.look_at) - DVec3(camera.look_from));
  const DVec3 left = glm::normalize(glm::cross(DVec3(camera.up), forward));
  const DVec3 up = glm::cross(forward, left);
  Affine view;
  for (int i = 0; i < 3; ++i)
    view.row[i] = Vec4(glm::dvec4(left[i], up[i], forward[i], camera.look_from[i]));
  return view;
}

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
    add_spheres();
    return std::move(list_);
  }

 private:
  /// The setter is given finite numbers.
  template <class Get, class Set>
  void add(std::string name, std::vector<std::size_t> shape, Get get, Set set) {
    auto checked = [name, set](SceneData& scene, Values values) {
      check_finite(values, name);
      set(scene, values);
    };
    const SceneChanges changes = changes_of(name);
    list_.push_back({std::move(name), std::move(shape), changes, get, checked});
  }

  /// `part(scene)` is a reference to a vector or colour in the scene.
  template <class Part>
  void add_vector(const std::string& name, Part part, bool may_be_negative = true) {
    add(
        name, {3}, [part](const SceneData& scene) { return list_of(part(scene)); },
        [name, part, may_be_negative](SceneData& scene, Values v) {
          if (!may_be_negative && *std::ranges::min_element(v) < 0.0f)
            throw Error(fmt::format("{}: expected numbers of 0 or more", name));
          part(scene) = vector_of(v);
        });
  }

  void add_radiance(const std::string& name, auto part) { add_vector(name, part, false); }

  template <class Part>
  void add_number(const std::string& name, Part part) {
    add(
        name, {}, [part](const SceneData& scene) { return std::vector<float>{part(scene)}; },
        [part](SceneData& scene, Values v) { part(scene) = v[0]; });
  }

  void add_camera() {
    const auto part = [](auto field) {
      return [field](auto& scene) -> auto& { return scene.camera.*field; };
    };
    const auto place = [](auto field) {
      return [field](auto& scene) -> auto& {
        if constexpr (requires { scene.motion.camera.clear(); }) scene.motion.camera.clear();
        return scene.camera.*field;
      };
    };
    add_vector("camera.origin", place(&CameraParameters::look_from));  // set, it stands there
    add_vector("camera.target", place(&CameraParameters::look_at));
    add_vector("camera.up", place(&CameraParameters::up));
    add_view();
    add_number(
        "camera.shutter_open", [](auto& s) -> auto& { return s.motion.shutter.open; });
    add_number(
        "camera.shutter_close", [](auto& s) -> auto& { return s.motion.shutter.close; });
    if (scene_.camera.orthographic) return;
    add_number("camera.fov", part(&CameraParameters::fov_degrees));
    add_number("camera.aperture", part(&CameraParameters::aperture));
    add_number("camera.focus_distance", part(&CameraParameters::focus_distance));
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
    std::set<std::string> emitters, lights;  // their names need not differ in files
    for (std::uint32_t m = 0; m < scene_.materials.size(); ++m) {
      if (is_black(scene_.materials[m].emission.radiance)) continue;
      const std::string name = name_of(scene_.names.emitters, m, names_[m], emitters);
      add_radiance(
          "lights." + name + ".radiance", [m](auto& s) -> auto& {
            return s.materials[m].emission.radiance;
          });
    }
    for (std::uint32_t i = 0; i < scene_.delta_lights.size(); ++i) {
      const std::string name =
          name_of(scene_.names.delta_lights, i, fmt::format("light_{}", i), lights);
      add_radiance(
          "lights." + name + ".intensity", [i](auto& s) -> auto& {
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

  /// `get(scene)`: where it is, or where its motion begins. `place(scene, map)` puts it there.
  /// `set_keys` has checked ones, or none.
  template <class Get, class Place, class GetKeys, class SetKeys>
  void add_place(const std::string& name, const std::vector<std::size_t>& shape, Get get,
                 Place place, GetKeys get_keys, SetKeys set_keys) {
    add(
        name, shape, [=](const SceneData& scene) { return numbers_of_key(shape, get(scene)); },
        [=](SceneData& scene, Values v) {
          place(scene, affine_of_key(shape, v, name));
          set_keys(scene, {});
        });
    list_.back().get_keys = get_keys;
    list_.back().set_keys = [=](SceneData& scene, const std::vector<TransformKey>& keys) {
      check_keys(keys, name);
      place(scene, keys.front().to_world);
      set_keys(scene, keys);
    };
  }

  void add_view() {
    const std::string name = "camera.to_world";
    add_place(
        name, {4, 4}, [](const SceneData& scene) { return view_of(scene.camera); },
        [name](SceneData& scene, const Affine& map) {
          if (!(map.determinant() > 0.0f))
            throw Error(name + ": expected a matrix that does not mirror");
          if (map != view_of(scene.camera)) look_along_z(map, scene.camera);
        },
        [](const SceneData& scene) { return scene.motion.camera; },
        [](SceneData& scene, const std::vector<TransformKey>& keys) {
          scene.motion.camera = keys;
        });
  }

  /// Of what has the number i; none: it stands.
  template <class Moving>
  static void set_keys_of(std::vector<Moving>& moving, std::uint32_t Moving::*number,
                          std::uint32_t i, const std::vector<TransformKey>& keys) {
    std::erase_if(moving, [&](const Moving& one) { return one.*number == i; });
    if (!keys.empty()) moving.push_back({i, keys});
  }

  void add_instances() {
    using Moving = MotionData::MovingInstance;
    for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
      add_place(
          fmt::format("instances.{}.to_world", i), {4, 4},
          [i](const SceneData& scene) { return scene.instances[i].to_world; },
          [i](SceneData& scene, const Affine& map) { scene.instances[i].to_world = map; },
          [i](const SceneData& scene) {
            const std::vector<Moving>& moving = scene.motion.instances;
            const auto own = std::ranges::find(moving, i, &Moving::instance);
            return own == moving.end() ? std::vector<TransformKey>() : own->keys;
          },
          [i](SceneData& scene, const std::vector<TransformKey>& keys) {
            set_keys_of(scene.motion.instances, &Moving::instance, i, keys);
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

  /// Of what has the number i in the file; `other`: without a name there.
  static std::string name_of(const std::map<std::uint32_t, std::string>& names, std::uint32_t i,
                             const std::string& other, std::set<std::string>& taken) {
    const auto own = names.find(i);
    const std::string& given = own == names.end() ? other : own->second;
    std::string name = given;
    for (int n = 2; !taken.insert(name).second; ++n) name = fmt::format("{}_{}", given, n);
    return name;
  }

  /// The name of a material in the file, or "KIND_i".
  std::string or_material(const char* kind, std::size_t i, std::uint32_t material) const {
    const auto named = scene_.names.materials.find(material);
    return named == scene_.names.materials.end() ? fmt::format("{}_{}", kind, i) : named->second;
  }

  /// Between keys it moves straight on.
  void add_center(const std::string& name, std::uint32_t i) {
    add_place(
        name, {3}, [i](const SceneData& scene) { return translate(scene.spheres[i].center); },
        [i](SceneData& scene, const Affine& map) {
          scene.spheres[i].center = map.point(Vec3(0.0f));
        },
        [i](const SceneData& scene) {
          std::vector<TransformKey> keys;
          const auto& moving = scene.motion.spheres;
          const auto own = std::ranges::find(moving, i, &MotionData::MovingSphere::sphere);
          if (own == moving.end()) return keys;
          const Vec3 center = own->own_center(scene.spheres[i].center);
          for (const TransformKey& key : own->keys)
            keys.push_back({key.time, translate(key.to_world.point(center))});
          return keys;
        },
        [i](SceneData& scene, const std::vector<TransformKey>& keys) {
          set_keys_of(scene.motion.spheres, &MotionData::MovingSphere::sphere, i, keys);
        });
  }

  void add_spheres() {
    std::set<std::string> taken;
    for (std::uint32_t i = 0; i < scene_.spheres.size(); ++i) {
      const auto own = name_of({}, i, or_material("sphere", i, scene_.sphere_material[i]), taken);
      const auto name = "spheres." + own;
      add_center(name + ".center", i);
      add(
          name + ".radius", {},
          [i](const SceneData& scene) {
            return std::vector<float>{std::sqrt(scene.spheres[i].radius_squared)};
          },
          [i, name](SceneData& scene, Values v) {
            const float squared = v[0] * v[0];
            if (!(v[0] > 0.0f && squared > 0.0f && std::isfinite(squared)))
              throw Error(name + ".radius: expected a number above 0");
            scene.spheres[i].radius_squared = squared;
          });
    }
  }

  void add_meshes() {
    std::set<std::string> taken;
    for (std::uint32_t i = 0; i < scene_.meshes.size(); ++i) {
      const Mesh& mesh = scene_.meshes[i];
      if (mesh.positions.empty()) continue;
      const auto name =
          name_of(scene_.names.meshes, i, or_material("mesh", i, mesh.material), taken);
      // Set, they stay so while the shutter is open.
      add_rows(
          "meshes." + name + ".vertices", [i](auto& s) -> auto& {
            auto& own = s.meshes[i];
            if constexpr (requires { own.positions.clear(); }) own.stop_deforming();
            return own.positions;
          });
      if (mesh.normals.empty()) continue;
      add_rows(
          "meshes." + name + ".normals", [i](auto& s) -> auto& {
            auto& own = s.meshes[i];
            if constexpr (requires { own.normals.clear(); }) own.later_normals.clear();
            return own.normals;
          });
    }
  }

  const SceneData& scene_;
  std::vector<std::string> names_;
  std::vector<SceneParameter> list_;
};

}  // namespace

Affine affine_of(Values v, const std::string& what) {
  static_assert(sizeof(Affine) == 12 * sizeof(float));
  if (v.size() != 16)
    throw Error(fmt::format("{}: {} numbers; expected a 4x4 matrix", what, v.size()));
  check_finite(v, what);
  Affine map;
  std::memcpy(&map.row, v.data(), sizeof(Affine));
  if (v[12] != 0 || v[13] != 0 || v[14] != 0 || v[15] != 1 || !is_invertible(map))
    throw Error(what +
                ": expected an affine map that can be inverted, its last row 0 0 "
                "0 1");
  return map;
}

std::vector<float> matrix_of(const Affine& map) {
  std::vector<float> values(16, 0.0f);
  std::memcpy(values.data(), &map.row, sizeof(Affine));
  values.back() = 1.0f;
  return values;
}

Affine affine_of_key(std::span<const std::size_t> shape, Values v, const std::string& what) {
  if (shape.size() > 1) return affine_of(v, what);
  if (v.size() != 3) throw Error(fmt::format("{}: {} numbers; expected 3", what, v.size()));
  check_finite(v, what);
  return translate(vector_of(v));
}

std::vector<float> numbers_of_key(std::span<const std::size_t> shape, const Affine& map) {
  return shape.size() > 1 ? matrix_of(map) : list_of(map.point(Vec3(0.0f)));
}

SceneChanges changes_of(std::string_view parameter) {
  const std::string_view part = parameter.substr(0, parameter.find('.'));
  const std::string_view value = parameter.substr(parameter.rfind('.') + 1);
  SceneChanges changes;
  changes.camera = part == "camera";
  changes.shading = part == "materials" || part == "lights";
  changes.lights = part == "lights" || (part == "materials" && value == "opacity");
  changes.instances = part == "instances" || part == "spheres";
  changes.vertices = part == "meshes" && value == "vertices";
  changes.normals = part == "meshes" && value == "normals";
  return changes;
}

std::vector<SceneParameter> scene_parameters(const SceneData& scene) {
  return Lister(scene).list();
}

}  // namespace pt
