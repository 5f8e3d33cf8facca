// Meshes that deform against Embree's motion blur of many time steps.
#include <gtest/gtest.h>

#include "common/accel/traverse_triangles.h"
#include "scene/deforming_triangles.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace pt {
namespace {

class EmbreeInTime {
 public:
  explicit EmbreeInTime(const Mesh& mesh) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(mesh.vertex_sets()));
    for (std::size_t set = 0; set < mesh.vertex_sets(); ++set)
      std::ranges::copy(mesh.positions_of(set),
                        static_cast<Vec3*>(rtcSetNewGeometryBuffer(
                            geometry, RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(set),
                            RTC_FORMAT_FLOAT3, sizeof(Vec3), mesh.positions.size())));
    std::ranges::copy(mesh.triangles, static_cast<TriangleIndices*>(rtcSetNewGeometryBuffer(
                                          geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          sizeof(TriangleIndices), mesh.triangles.size())));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene_);
  }
  ~EmbreeInTime() { rtcReleaseScene(scene_), rtcReleaseDevice(device_); }
  EmbreeInTime(const EmbreeInTime&) = delete;
  EmbreeInTime& operator=(const EmbreeInTime&) = delete;

  /// The distance, infinite for a miss.
  float closest(const Ray& ray, float time) const {
    RTCRayHit hit{};
    hit.ray.org_x = ray.origin.x, hit.ray.org_y = ray.origin.y, hit.ray.org_z = ray.origin.z;
    hit.ray.dir_x = ray.direction.x, hit.ray.dir_y = ray.direction.y;
    hit.ray.dir_z = ray.direction.z;
    hit.ray.tfar = HUGE_VALF, hit.ray.mask = ~0u, hit.ray.time = time;
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect1(scene_, &hit, nullptr);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &hit);
#endif
    return hit.hit.geomID == RTC_INVALID_GEOMETRY_ID ? HUGE_VALF : hit.ray.tfar;
  }

 private:
  RTCDevice device_ = rtcNewDevice(nullptr);
  RTCScene scene_ = rtcNewScene(device_);
};

TEST(DeformingMeshes, MeetWhatEmbreeMeets) {
  TestRandom random(9);
  for (const std::size_t sets : {2u, 3u, 17u}) {
    SceneData scene;
    scene.name = "deforming";
    scene.add_material(make_diffuse(Color(0.5f)));
    scene.meshes = {deforming_triangles(random, sets)};
    const EmbreeInTime embree(scene.meshes[0]);
    Options options = motion_options(8, 8, 1);
    options.accel = AccelKind::bvh2;
    prepare_scene_for(scene, options, cpu_of_motion());
    int hits = 0, differ = 0;
    for (int i = 0; i < 20000; ++i) {
      const Ray ray = ray_among(random);
      const float time = random.unit();
      MovingQuery<ClosestTriangle> query(0.0f, infinite_distance, scene.motion.prepared->view,
                                         time);
      traverse_triangles<Accel::bvh2, true>(scene.tree.view(), ray, query);
      const Hit hit = query.result();
      const float expected = embree.closest(ray, time);
      hits += !hit.is_miss();
      differ += hit.is_miss() ? expected < HUGE_VALF
                              : !(std::abs(hit.t - expected) <= 1e-4f * (1 + hit.t));
    }
    EXPECT_GT(hits, 1000) << sets;
    EXPECT_LE(differ, 10) << sets;  // at edges
  }
}

}  // namespace
}  // namespace pt
