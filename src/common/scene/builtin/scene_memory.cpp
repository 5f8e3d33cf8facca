#include "common/scene/builtin/scene_memory.h"

#include <fmt/format.h>

#include "common/accel/build/check_builder.h"
#include "common/error/host_memory.h"

namespace pt {
namespace {

// Rounded down from the peaks of resident memory of a million, so that nothing is refused that
// would fit.
constexpr std::uint64_t sphere_bytes = 450, instance_bytes = 500;
constexpr std::uint64_t mesh_bytes = 18;       // a triangle and half a vertex
constexpr std::uint64_t slot_bytes = 48;       // in the order of the leaves
constexpr std::uint64_t building_bytes = 100;  // a reference and a node besides the mesh
constexpr std::uint64_t voxel_bytes = 8;       // as it is made, and in the scene

std::uint64_t triangle_bytes(const Options& options) {
  if (is_device_builder(options.builder)) return mesh_bytes;
  return mesh_bytes + (options.accel == AccelKind::brute ? slot_bytes : building_bytes);
}

}  // namespace

void check_triangle_memory(const SceneRequest& request, std::uint64_t count) {
  check_host_memory(count * triangle_bytes(request.options), "--scene " + request.name.full);
}

void check_instance_memory(const SceneRequest& request, std::uint64_t count) {
  check_host_memory(count * instance_bytes, "--scene " + request.name.full);
}

void check_cloud_memory(const SceneRequest& request, std::uint64_t side) {
  check_host_memory(side * side * side * voxel_bytes, "--scene " + request.name.full);
}

void check_sphere_memory(std::uint64_t count) {
  check_host_memory(count * sphere_bytes, fmt::format("--spheres {}", count));
}

}  // namespace pt
