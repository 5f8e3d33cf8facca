#include <fmt/format.h>

#include "app/commands/trace_command.h"
#include "app/commands/trace_scene.h"
#include "app/options/option_values.h"
#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/error/terminal.h"
#include "common/image/atomic_file.h"
#include "common/scene/data/frame_scene.h"
#include "common/scene/prepare/prepare_camera.h"
#include "common/scene/prepare/prepare_scene.h"

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

/// Such files are large: it is said, and asked for disk and memory, before the scene is prepared.
void check_size(const RaysCommand& command) {
  const std::uint64_t size_bytes = ray_bytes_max(command.kind, command.size);
  check_writable(command.output);
  check_not_read("--output", command.output, command.scene);
  check_room(command.output, size_bytes);
  check_host_memory(2 * size_bytes, fmt::format("--size {}: the rays", command.size));
  print_notice(fmt::format("rays: up to {} MB will be written to {}",
                           grouped((size_bytes + 999'999) / 1'000'000), command.output));
}

}  // namespace

int rays_command(const RaysCommand& command) {
  if (command.scene.empty()) throw Error("rays: expected --scene NAME|FILE or --mesh FILE");
  check_size(command);
  SceneData scene = load_traced_scene(command.scene);
  if (command.scene.ends_with(".mesh")) scene.camera = default_camera(scene_bounds(scene));
  override_camera(scene.camera, command.camera);
  prepare_scene(scene, {});
  const RaySet rays = generate_rays(command.kind, scene, command.size, command.bounces);
  write_rays(command.output, rays);
  print("wrote {}: {} rays\n", command.output, grouped(rays.rays.size()));
  return 0;
}

}  // namespace pt
