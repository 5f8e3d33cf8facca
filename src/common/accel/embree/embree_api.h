// The two versions of Embree that distributions have, as one.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace pt {

#if RTC_VERSION_MAJOR >= 4

inline void embree_intersect(RTCScene scene, RTCRayHit* ray_hit) {
  rtcIntersect1(scene, ray_hit, nullptr);
}
inline void embree_occluded(RTCScene scene, RTCRay* ray) { rtcOccluded1(scene, ray, nullptr); }

#else

inline void embree_intersect(RTCScene scene, RTCRayHit* ray_hit) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, ray_hit);
}
inline void embree_occluded(RTCScene scene, RTCRay* ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, ray);
}

#endif

}  // namespace pt
