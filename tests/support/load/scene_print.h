// A scene as text, in which any two that differ in what is seen differ.
#pragma once

#include <fmt/format.h>

#include <string>

#include "common/scene/data/scene_data.h"

namespace pt {

class ScenePrint {
 public:
  explicit ScenePrint(const SceneData& scene) {
    const CameraParameters& c = scene.camera;
    vectors("camera", {c.look_from, c.look_at, c.up});
    numbers({c.fov_degrees, c.aperture, c.focus_distance, c.principal_point.x, c.principal_point.y,
             c.orthographic_size.x, c.orthographic_size.y, c.near_clip, c.far_clip});
    integers({c.mirrored, static_cast<int>(c.fov_axis), c.orthographic, c.hides_emitters,
              static_cast<int>(scene.camera_medium)});
    defaults(scene.defaults);
    vectors("sky", {scene.sky.nadir, scene.sky.zenith, scene.sun.direction, scene.sun.radiance});
    numbers({scene.sun.one_minus_cos});
    integers({scene.environment.width, scene.environment.height});
    bytes(scene.environment.pixels), rows(scene.environment.to_world);
    for (const DeltaLight& light : scene.delta_lights) add(light);
    for (const MaterialDescription& material : scene.materials) add(material);
    for (const Mesh& mesh : scene.meshes) add(mesh);
    bytes(scene.spheres), bytes(scene.sphere_material), bytes(scene.sphere_frames);
    for (const Quad& q : scene.quads) vectors("quad", {q.corner, q.edge_a, q.edge_b});
    bytes(scene.quad_material);
    for (const Instance& instance : scene.instances)
      integers({static_cast<int>(instance.group)}), rows(instance.to_world);
    for (const Medium& medium : scene.media) add(medium);
    for (const VolumeGrid& grid : scene.grids) {
      rows(grid.to_unit), bytes(grid.size);
      integers({static_cast<int>(grid.channels), static_cast<int>(grid.interpolates)});
    }
    bytes(scene.grid_values);
    for (const Texture& texture : scene.textures) add(texture);
    bytes(scene.texels);
  }

  std::string text;

 private:
  void vectors(const char* name, std::initializer_list<Vec3> list) {
    text += fmt::format("\n{}", name);
    for (const Vec3& v : list) text += fmt::format(" {} {} {}", v.x, v.y, v.z);
  }
  void numbers(std::initializer_list<float> list) {
    text += fmt::format(" {}", fmt::join(list, " "));
  }
  void integers(std::initializer_list<int> list) {
    text += fmt::format(" {}", fmt::join(list, " "));
  }
  void rows(const Affine& map) {
    for (const Vec4& r : map.row) numbers({r.x, r.y, r.z, r.w});
  }
  /// For records without padding.
  template <class Values>
  void bytes(const Values& values) {
    const std::string_view all(reinterpret_cast<const char*>(std::data(values)),
                               std::size(values) * sizeof *std::data(values));
    if (!all.empty())
      text += fmt::format(" {}:{:x}", std::size(values), std::hash<std::string_view>()(all));
  }
  void defaults(const SceneDefaults& d) {
    for (const auto& n : {d.width, d.height, d.spp, d.max_depth, d.rr_depth})
      integers({n.value_or(-1)});
    integers({d.measure_exposure});
    if (d.crop) integers({d.crop->x0, d.crop->y0, d.crop->x1, d.crop->y1});
    if (d.filter) integers({static_cast<int>(d.filter->kind)}), numbers({d.filter->a, d.filter->b});
  }
  void add(const DeltaLight& l) {
    vectors("light", {l.position, l.direction, l.intensity, l.right});
    numbers({l.cos_inner, l.cos_outer, l.aspect});
    integers({static_cast<int>(l.kind), static_cast<int>(l.falloff), static_cast<int>(l.texture)});
  }
  void add(const MaterialDescription& m) {
    vectors("material", {m.emission.radiance});
    for (const Parameter& p : m.parameters)
      numbers({p.value.x, p.value.y, p.value.z}), integers({static_cast<int>(p.texture)});
    numbers({m.opacity.offset, m.opacity.scale, m.opacity.cutoff});
    integers({static_cast<int>(m.kind), m.one_sided, static_cast<int>(m.emission.texture),
              static_cast<int>(m.opacity.texture), static_cast<int>(m.node),
              static_cast<int>(m.children[0]), static_cast<int>(m.children[1]), m.is_boundary,
              m.passes, m.media.outside, m.media.inside});
  }
  void add(const Mesh& mesh) {
    vectors("mesh", {});
    bytes(mesh.positions), bytes(mesh.triangles), bytes(mesh.normals), bytes(mesh.uvs);
    integers({static_cast<int>(mesh.material), static_cast<int>(mesh.group)});
  }
  void add(const Medium& m) {
    vectors("medium", {m.extinction, m.albedo, m.emission});
    numbers({m.phase_parameter});
    integers({static_cast<int>(m.phase), static_cast<int>(m.density_grid),
              static_cast<int>(m.albedo_grid), static_cast<int>(m.emission_grid), m.priority});
  }
  void add(const Texture& t) {
    vectors("texture", {t.color0, t.color1});
    for (const float* row : {t.u_row, t.v_row}) numbers({row[0], row[1], row[2]});
    integers({static_cast<int>(t.kind), static_cast<int>(t.format), static_cast<int>(t.wrap_u),
              static_cast<int>(t.wrap_v), static_cast<int>(t.filter), static_cast<int>(t.width),
              static_cast<int>(t.height), static_cast<int>(t.nested[0]),
              static_cast<int>(t.nested[1])});
  }
};

inline std::string print_of(const SceneData& scene) { return ScenePrint(scene).text; }

}  // namespace pt
