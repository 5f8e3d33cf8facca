// Rays against triangles in Python: `ptexp trace` of what is in memory.
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <tbb/parallel_for.h>

#include <cstring>
#include <memory>
#include <optional>

#include "app/commands/commands.h"
#include "app/options/option_values.h"
#include "common/accel/build/build_triangle_tree.h"
#include "common/error/error.h"
#include "common/rays/ray_file.h"
#include "common/scene/data/material_description.h"
#include "python/arrays.h"
#include "python/module.h"
#include "python/unlocked.h"

namespace pt::python {
namespace {

namespace nb = nanobind;

/// Triangles on a device. A tree of the host is built once.
class TracedMesh {
 public:
  TracedMesh(const FloatsIn& vertices, const IndicesIn& triangles, const std::string& device,
             const std::string& accel, const std::string& builder)
      : device_(choose_device(parse_device("device", device))) {
    const Unlocked unlocked;
    scene_.meshes.push_back(mesh_of(vertices, triangles));
    scene_.add_material(MaterialDescription());
    check_trace_mesh(scene_.meshes[0], "mesh");
    if (scene_.meshes[0].triangles.empty()) throw Error("mesh: has no triangles");
    options_.accel = parse_name<AccelKind>("accel", accel);
    if (options_.accel == AccelKind::automatic) options_.accel = AccelKind::cwbvh;
    options_.builder = parse_name<TreeBuilder>("builder", builder);
    check_tracing(options_, {}, device_);
    if (!is_device_builder(options_.builder))
      tree_ = build_triangle_tree(scene_.meshes, scene_.instances, options_);
  }

  TraceResult trace(const RaySet& rays) const {
    if (tree_) return trace_tree(*tree_, rays, {}, device_);
    return build_and_trace(scene_, options_, rays, {}, device_).result;
  }

  const Mesh& mesh() const { return scene_.meshes[0]; }

 private:
  DeviceInfo device_;
  SceneData scene_;
  TreeOptions options_;
  std::optional<TriangleTreeData> tree_;
};

RaySet ray_set(const FloatsIn& rays, bool any) {
  RaySet set;
  set.type = any ? RayType::any : RayType::closest;
  set.rays.resize(rays.shape(0));
  const std::size_t columns = rays.shape(1);
  if (columns == 8) {
    std::memcpy(set.rays.data(), rays.data(), set.rays.size() * sizeof(RayRecord));
  } else if (columns == 6) {
    for (std::size_t i = 0; i < set.rays.size(); ++i) {
      const float* const r = rays.data() + 6 * i;
      set.rays[i] = {{r[0], r[1], r[2]}, 0.0f, {r[3], r[4], r[5]}, HUGE_VALF};
    }
  } else {
    throw Error(
        fmt::format("rays: {} numbers each; expected 6 (origin, direction) or 8 (origin, "
                    "t_min, direction, t_max)",
                    columns));
  }
  check_rays(set, "rays");
  return set;
}

/// Barycentric coordinates of the second and third vertex where the ray intersects the triangle's
/// plane (Moeller and Trumbore 1997), in double precision.
void barycentrics(const Mesh& mesh, const RayRecord& ray, std::uint32_t triangle, float* uv) {
  using DVec3 = glm::dvec3;
  const auto& v = mesh.triangles[triangle].v;
  const DVec3 p0(mesh.positions[v[0]]), e1 = DVec3(mesh.positions[v[1]]) - p0,
                                        e2 = DVec3(mesh.positions[v[2]]) - p0;
  const DVec3 d(ray.direction), s = DVec3(ray.origin) - p0, p = glm::cross(d, e2),
                                q = glm::cross(s, e1);
  const double determinant = glm::dot(e1, p);
  uv[0] = static_cast<float>(glm::dot(s, p) / determinant);
  uv[1] = static_cast<float>(glm::dot(d, q) / determinant);
}

/// (t, primitive, uv) as arrays.
nb::tuple trace(const TracedMesh& mesh, const FloatsIn& given, bool any) {
  std::vector<float> t, uv;
  std::vector<std::uint32_t> primitive;
  double time_ms = 0;
  {
    const Unlocked unlocked;
    const RaySet rays = ray_set(given, any);
    const TraceResult result = mesh.trace(rays);
    time_ms = result.times_ms.front();
    const std::size_t count = rays.rays.size();
    t.resize(count), primitive.resize(count), uv.resize(2 * count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      const HitRecord& hit = result.hits[i];
      t[i] = hit.t < 0.0f ? HUGE_VALF : hit.t, primitive[i] = hit.primitive;
      if (hit.primitive != no_primitive)
        barycentrics(mesh.mesh(), rays.rays[i], hit.primitive, &uv[2 * i]);
    });
  }
  const std::size_t count = t.size();
  return nb::make_tuple(array_of(std::move(t), {count}), array_of(std::move(primitive), {count}),
                        array_of(std::move(uv), {count, 2}), time_ms);
}

}  // namespace

void add_trace(nb::module_& m) {
  nb::class_<TracedMesh>(m, "TracedMesh")
      .def(nb::init<FloatsIn, IndicesIn, std::string, std::string, std::string>())
      .def("trace", trace, nb::arg("rays"), nb::arg("any_hit"));
}

}  // namespace pt::python
