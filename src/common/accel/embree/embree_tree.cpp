#include "common/accel/embree/embree_tree.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "common/accel/traverse_triangles.h"
#include "common/error/error.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace pt {
namespace {

// The two versions of Embree that distributions have, as one.
#if RTC_VERSION_MAJOR >= 4

void embree_intersect(RTCScene scene, RTCRayHit* ray_hit) {
  rtcIntersect1(scene, ray_hit, nullptr);
}
void embree_occluded(RTCScene scene, RTCRay* ray) { rtcOccluded1(scene, ray, nullptr); }

#else

void embree_intersect(RTCScene scene, RTCRayHit* ray_hit) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, ray_hit);
}
void embree_occluded(RTCScene scene, RTCRay* ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, ray);
}

#endif

struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice>;
using EmbreeScene = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;

void check(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE) {
    throw Error(fmt::format("--accel embree: Embree's error {}, expected none{}",
                            static_cast<int>(error),
                            error == RTC_ERROR_OUT_OF_MEMORY ? " (too little memory)" : ""));
  }
}

EmbreeScene make_scene(RTCDevice device) {
  EmbreeScene scene(rtcNewScene(device));
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  return scene;
}

void attach(RTCScene scene, RTCGeometry geometry, std::uint32_t id) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

/// A group's triangles. Their records are read in place: a vertex is the first 12 of 16 bytes.
EmbreeScene make_group_scene(RTCDevice device, const Triangle* triangles, std::uint32_t count) {
  static_assert(sizeof(Triangle) == 3 * 16);
  EmbreeScene scene = make_scene(device);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const std::size_t vertices = 3 * static_cast<std::size_t>(count);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, triangles, 0,
                             16, vertices);
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, count));
  for (std::size_t i = 0; indices != nullptr && i < vertices; ++i) {
    indices[i] = static_cast<std::uint32_t>(i);
  }
  attach(scene.get(), geometry, 0);
  rtcCommitScene(scene.get());
  check(device);
  return scene;
}

RTCGeometry make_instance(RTCDevice device, RTCScene group, const Affine& to_object) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, group);
  rtcSetGeometryTimeStepCount(geometry, 1);
  const Affine to_world = inverse(to_object);
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, to_world.row);
  return geometry;
}

RTCRay make_ray(const Ray& ray, float t_min, float t_max) {
  RTCRay result{};
  result.org_x = ray.origin.x, result.org_y = ray.origin.y, result.org_z = ray.origin.z;
  result.dir_x = ray.direction.x, result.dir_y = ray.direction.y, result.dir_z = ray.direction.z;
  result.tnear = std::nextafter(t_min, HUGE_VALF);  // Embree's interval is closed
  result.tfar = std::nextafter(t_max, 0.0f);
  result.mask = ~0u;
  return result;
}

}  // namespace

struct EmbreeTree::Scenes {
  Device device;
  std::vector<EmbreeScene> groups;
  EmbreeScene top;                        // of the instances, if there are any
  std::vector<std::uint32_t> first_slot;  // by instance
  RTCScene root = nullptr;                // null: nothing to meet
};

std::string embree_version() { return RTC_VERSION_STRING; }

EmbreeTree::EmbreeTree(const TriangleTreeData& tree) : scenes_(std::make_unique<Scenes>()) {
  Scenes& scenes = *scenes_;
  scenes.device.reset(rtcNewDevice(nullptr));
  RTCDevice const device = scenes.device.get();
  check(device);
  for (const GroupTree& group : tree.groups) {
    scenes.groups.push_back(
        make_group_scene(device, tree.triangles.data() + group.first_slot, group.slot_count));
  }
  if (tree.instances.empty()) {
    if (!scenes.groups.empty()) scenes.root = scenes.groups.front().get();
    return;
  }
  scenes.top = make_scene(device);
  for (const InstanceRecord& record : tree.instances) {
    std::size_t g = 0;
    while (tree.groups[g].first_slot != record.first_slot) ++g;
    const auto id = static_cast<std::uint32_t>(scenes.first_slot.size());
    attach(scenes.top.get(), make_instance(device, scenes.groups[g].get(), record.to_object), id);
    scenes.first_slot.push_back(record.first_slot);
  }
  rtcCommitScene(scenes.top.get());
  check(device);
  scenes.root = scenes.top.get();
}

EmbreeTree::~EmbreeTree() = default;
EmbreeTree::EmbreeTree(EmbreeTree&&) noexcept = default;
EmbreeTree& EmbreeTree::operator=(EmbreeTree&&) noexcept = default;

Hit closest_triangle_embree(const EmbreeTree& tree, const Ray& ray, float t_min, float t_max) {
  if (tree.scenes_->root == nullptr || !is_traceable(ray)) return {};
  RTCRayHit found{};
  found.ray = make_ray(ray, t_min, t_max);
  found.hit.geomID = found.hit.primID = found.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  embree_intersect(tree.scenes_->root, &found);
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  if (tree.scenes_->top == nullptr) return {found.ray.tfar, found.hit.primID, 0};
  const std::uint32_t instance = found.hit.instID[0];
  return {found.ray.tfar, tree.scenes_->first_slot[instance] + found.hit.primID, instance};
}

bool any_triangle_embree(const EmbreeTree& tree, const Ray& ray, float t_min, float t_max) {
  if (tree.scenes_->root == nullptr || !is_traceable(ray)) return false;
  RTCRay found = make_ray(ray, t_min, t_max);
  embree_occluded(tree.scenes_->root, &found);
  return found.tfar < 0.0f;
}

}  // namespace pt
