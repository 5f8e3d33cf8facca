#include <fmt/format.h>

#include "common/accel/build_triangle_tree.h"
#include "common/error.h"
#include "common/image/atomic_file.h"
#include "common/render/option_values.h"
#include "common/scene/prepare_camera.h"
#include "trace_command.h"

namespace pt {
namespace {

/// Inside of the box near its +z side, looking down along it: sees something in most meshes.
CameraParameters default_camera(const Bounds& bounds) {
  const Vec3 size = bounds.max - bounds.min;
  CameraParameters camera;
  camera.look_from = bounds.center() + Vec3(0.1434f, 0.0107f, 0.4422f) * size;
  camera.look_at = bounds.center() + Vec3(0.0045f, -0.1575f, -0.2407f) * size;
  return camera;
}

}  // namespace

int rays_command(const RaysCommand& command) {
  check_writable(command.output);
  const Mesh mesh = read_trace_mesh(command.mesh);
  if (mesh.triangles.empty()) throw Error(fmt::format("{}: has no triangles", command.mesh));
  const TriangleTreeData tree = build_triangle_tree({&mesh, 1}, {}, TreeOptions());
  const Bounds bounds = tree.groups.front().bounds;
  CameraParameters parameters = default_camera(bounds);
  override_camera(parameters, command.camera);
  check_camera(parameters);
  const Camera camera = make_camera(parameters, command.size, command.size);
  const RaySet rays =
      generate_rays(command.kind, tree, camera, command.size, scale_ray_kinds(bounds));
  write_rays(command.output, rays);
  fmt::print("wrote {}: {} rays\n", command.output, grouped(rays.rays.size()));
  return 0;
}

}  // namespace pt
