// OptiX's device functions that the programs call. OptiX's compiler replaces calls by these names;
// CUDA's assembler does not know them. Names and operands as in LuisaCompute (Apache-2.0,
// src/backends/cuda/cuda_builtin/cuda_device_resource.h) and drjit-core (BSD-3,
// src/cuda_eval.cpp, where jitc_cuda_render_trace has those of hit objects).
#pragma once

#define PT_OPTIX_FUNCTION __device__ __forceinline__

#include "common/accel/trace_optix/optix_abi.h"
#include "common/accel/trace_optix/optix_scene.h"
#include "common/geometry/ray.h"

// The operands of calls that have a payload, of 32 words: the first ones are those of `p`, a
// OptixPayload's.
#define PT_OPTIX_PAYLOAD_OUT                                                                      \
  "=r"(p[0]), "=r"(p[1]), "=r"(p[2]), "=r"(p[3]), "=r"(p[4]), "=r"(p[5]), "=r"(p[6]), "=r"(p[7]), \
      "=r"(p[8]), "=r"(p[9]), "=r"(p[10]), "=r"(q[11]), "=r"(q[12]), "=r"(q[13]), "=r"(q[14]),    \
      "=r"(q[15]), "=r"(q[16]), "=r"(q[17]), "=r"(q[18]), "=r"(q[19]), "=r"(q[20]), "=r"(q[21]),  \
      "=r"(q[22]), "=r"(q[23]), "=r"(q[24]), "=r"(q[25]), "=r"(q[26]), "=r"(q[27]), "=r"(q[28]),  \
      "=r"(q[29]), "=r"(q[30]), "=r"(q[31])
#define PT_OPTIX_PAYLOAD_IN                                                                     \
  "r"(p[0]), "r"(p[1]), "r"(p[2]), "r"(p[3]), "r"(p[4]), "r"(p[5]), "r"(p[6]), "r"(p[7]),       \
      "r"(p[8]), "r"(p[9]), "r"(p[10]), "r"(no), "r"(no), "r"(no), "r"(no), "r"(no), "r"(no),   \
      "r"(no), "r"(no), "r"(no), "r"(no), "r"(no), "r"(no), "r"(no), "r"(no), "r"(no), "r"(no), \
      "r"(no), "r"(no), "r"(no), "r"(no), "r"(no)
// In besides: kind of payload, handle, origin, direction, interval, time, visibility, flags, offset
// and stride of records, record of the miss, words.
#define PT_OPTIX_TRACE(function)                                                                  \
  static_assert(optix_payload_words == 11);                                                       \
  std::uint32_t* p = payload.word;                                                                \
  const std::uint32_t no = 0, all = 0xffu, words = optix_payload_words;                           \
  [[maybe_unused]] std::uint32_t q[32]; /* whose first ones are no operands */                    \
  asm volatile(                                                                                   \
      "call "                                                                                     \
      "(%0,%1,%2,%3,%4,%5,%6,%7,%8,%9,%10,%11,%12,%13,%14,%15,%16,%17,%18,%19,%20,%21,%22,%23,"   \
      "%24,%25,%26,%27,%28,%29,%30,%31)," function                                                \
      ","                                                                                         \
      "(%32,%33,%34,%35,%36,%37,%38,%39,%40,%41,%42,%43,%44,%45,%46,%47,%48,"                     \
      "%49,%50,%51,%52,%53,%54,%55,%56,%57,%58,%59,%60,%61,%62,%63,%64,%65,%66,%67,%68,%69,%70,"  \
      "%71,%72,%73,%74,%75,%76,%77,%78,%79,%80);"                                                 \
      : PT_OPTIX_PAYLOAD_OUT                                                                      \
      : "r"(no), "l"(handle), "f"(ray.origin.x), "f"(ray.origin.y), "f"(ray.origin.z),            \
        "f"(ray.direction.x), "f"(ray.direction.y), "f"(ray.direction.z), "f"(t_min), "f"(t_max), \
        "f"(0.0f), "r"(all), "r"(flags), "r"(record), "r"(no), "r"(no), "r"(words),               \
        PT_OPTIX_PAYLOAD_IN)

namespace pt::optix {

struct DeviceApi {
  static __device__ __forceinline__ std::uint32_t launch_index() {
    std::uint32_t x;
    asm("call (%0), _optix_get_launch_index_x, ();" : "=r"(x));
    return x;
  }

  static __device__ __forceinline__ std::uint32_t launch_width() {
    std::uint32_t x;
    asm("call (%0), _optix_get_launch_dimension_x, ();" : "=r"(x));
    return x;
  }

  /// Of the primitive in its group.
  static __device__ __forceinline__ std::uint32_t primitive_index() {
    std::uint32_t i;
    asm("call (%0), _optix_read_primitive_idx, ();" : "=r"(i));
    return i;
  }

  /// Instance::id.
  static __device__ __forceinline__ std::uint32_t instance_id() {
    std::uint32_t i;
    asm("call (%0), _optix_read_instance_id, ();" : "=r"(i));
    return i;
  }

  /// The end of the ray's interval: of the closest hit so far, in a closest-hit program that of the
  /// hit.
  static __device__ __forceinline__ float ray_t_max() {
    float t;
    asm("call (%0), _optix_get_ray_tmax, ();" : "=f"(t));
    return t;
  }

  static __device__ __forceinline__ std::uint32_t payload_word(int i) {
    std::uint32_t word;
    asm volatile("call (%0), _optix_get_payload, (%1);" : "=r"(word) : "r"(i));
    return word;
  }
  static __device__ __forceinline__ void set_payload_word(int i, std::uint32_t word) {
    asm volatile("call _optix_set_payload, (%0, %1);" : : "r"(i), "r"(word));
  }

  /// In an intersection program: a hit at t, unless t is beyond ray_t_max().
  static __device__ __forceinline__ void report_intersection(float t) {
    [[maybe_unused]] int accepted;
    asm volatile("call (%0), _optix_report_intersection_0, (%1, %2);"
                 : "=r"(accepted)
                 : "f"(t), "r"(0));
  }

  /// In an any-hit program, which it ends.
  static __device__ __forceinline__ void ignore_intersection() {
    asm volatile("call _optix_ignore_intersection, ();");
  }
  static __device__ __forceinline__ void terminate_ray() {
    asm volatile("call _optix_terminate_ray, ();");
  }

  /// In a ray generation program. Hit records: that of `record`.
  static __device__ __forceinline__ void trace(TraversableHandle handle, const Ray& ray,
                                               float t_min, float t_max, unsigned flags,
                                               unsigned record, OptixPayload& payload) {
    PT_OPTIX_TRACE("_optix_trace_typed_32");
  }

  /// The same without closest-hit and miss programs, which invoke() runs; the thread's hit object
  /// is then what was met.
  static __device__ __forceinline__ void traverse(TraversableHandle handle, const Ray& ray,
                                                  float t_min, float t_max, unsigned flags,
                                                  unsigned record, OptixPayload& payload) {
    PT_OPTIX_TRACE("_optix_hitobject_traverse");
  }

  /// Threads go on together whose hit objects, and the last `bits` of whose `key`, are alike.
  static __device__ __forceinline__ void reorder(std::uint32_t key, std::uint32_t bits) {
    asm volatile("call (), _optix_hitobject_reorder, (%0, %1);" : : "r"(key), "r"(bits));
  }

  static __device__ __forceinline__ void invoke(OptixPayload& payload) {
    std::uint32_t* p = payload.word;
    const std::uint32_t no = 0, words = optix_payload_words;
    [[maybe_unused]] std::uint32_t q[32];
    // In: kind of payload, words, 32 words.
    asm volatile(
        "call "
        "(%0,%1,%2,%3,%4,%5,%6,%7,%8,%9,%10,%11,%12,%13,%14,%15,%16,%17,%18,%19,%20,%21,%22,%23,"
        "%24,%25,%26,%27,%28,%29,%30,%31),_optix_hitobject_invoke,"
        "(%32,%33,%34,%35,%36,%37,%38,%39,%40,%41,%42,%43,%44,%45,%46,%47,%48,%49,%50,%51,%52,%53,"
        "%54,%55,%56,%57,%58,%59,%60,%61,%62,%63,%64,%65);"
        : PT_OPTIX_PAYLOAD_OUT
        : "r"(no), "r"(words), PT_OPTIX_PAYLOAD_IN);
  }
};

}  // namespace pt::optix
