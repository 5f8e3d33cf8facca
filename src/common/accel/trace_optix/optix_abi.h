// The part of OptiX's binary interface that ptexp calls, declared here because NVIDIA's headers
// have no open licence. Version 87 (OptiX 8.0), which every driver from 535 on answers.
//
// Where the numbers come from, by the letter behind each declaration:
//   [D] drjit-core (BSD-3), src/optix_api.h and src/optix_api.cpp: table, contexts, modules,
//       program groups, pipelines
//   [M] mitsuba3 (BSD-3), include/mitsuba/render/optix_api.h: build inputs, instances, structures
//   [L] LuisaCompute (Apache-2.0), src/backends/cuda/optix_api.h: results, properties, flags;
//       property_reordering in its versions for OptiX 8
//   [N] NVIDIA's documentation (raytracing-docs.nvidia.com, 'OptiX 8.0 API reference')
// tests/accel/test_optix_abi.cpp has the sizes and offsets.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pt::optix {

inline constexpr int abi_version = 87;             // [D]
inline constexpr std::size_t table_pointers = 48;  // [D] and an H200's driver 580.159

using Result = int;
using DevicePointer = std::uint64_t;      ///< CUdeviceptr
using TraversableHandle = std::uint64_t;  // [M]
using Context = struct ContextObject*;
using Module = struct ModuleObject*;
using ProgramGroup = struct ProgramGroupObject*;
using Pipeline = struct PipelineObject*;
using Stream = void*;  ///< CUstream

// Results [L].
inline constexpr Result success = 0;
inline constexpr Result error_unsupported_abi = 7801;
inline constexpr Result error_table_size = 7802;

// Properties of a device [L].
inline constexpr int property_max_primitives = 0x2003, property_max_instances = 0x2004,
                     property_rtcore_version = 0x2005, property_reordering = 0x200a;

// Enumerators of one use each [D] [M] [L].
inline constexpr int optimization_level_default = 0, debug_level_none = 0x2350;
inline constexpr int group_kind_raygen = 0x2421, group_kind_miss = 0x2422,
                     group_kind_hitgroup = 0x2424;
inline constexpr int build_operation_build = 0x2161;
inline constexpr int input_triangles = 0x2141, input_custom = 0x2142, input_instances = 0x2143;
inline constexpr int vertex_format_float3 = 0x2121, index_format_none = 0;
inline constexpr int emit_compacted_size = 0x2181;
inline constexpr unsigned build_allow_compaction = 1u << 1, build_prefer_fast_trace = 1u << 2;
inline constexpr unsigned graph_single_gas = 1u << 0, graph_single_level_instancing = 1u << 1;
inline constexpr unsigned primitives_custom = 1u << 0, primitives_triangle = 1u << 31;
inline constexpr unsigned geometry_none = 0;
inline constexpr unsigned exception_none = 0;

// Flags of a ray [L].
inline constexpr unsigned ray_disable_anyhit = 1u << 0, ray_terminate_on_first_hit = 1u << 2,
                          ray_disable_closesthit = 1u << 3;

inline constexpr std::size_t record_header_bytes = 32;  // [D] [L]

using LogCallback = void (*)(unsigned level, const char* tag, const char* message, void* data);

struct ContextOptions {  // [D]
  LogCallback log;
  void* log_data;
  int log_level;  ///< 0 none, 1 fatal, 2 error, 3 warning, 4 all
  int validation;
};

/// Launch parameters that the compiler may take for constants.
struct BoundValue {  // [L]
  std::size_t offset, bytes;
  const void* value;
  const char* annotation;
};

struct ModuleOptions {  // [D]
  int max_registers;
  int optimization_level;
  int debug_level;
  const BoundValue* bound_values;
  unsigned bound_value_count;
  unsigned payload_type_count;
  const void* payload_types;
};

struct PipelineOptions {  // [M]; from ABI 105 on it has one more member
  int uses_motion_blur;
  unsigned graph_flags;
  int payload_values;
  int attribute_values;
  unsigned exception_flags;
  const char* params_name;
  unsigned primitive_flags;
  int allow_micromaps;
};

struct LinkOptions {  // [D]
  unsigned max_trace_depth;
};

struct Program {  // [D]
  Module module;
  const char* entry;
};

struct HitPrograms {  // [D]
  Program closest, any, intersection;
};

struct ProgramGroupDescription {  // [D]
  int kind;
  unsigned flags;
  union {
    Program single;  ///< ray generation, miss
    HitPrograms hit;
  };
};

struct ProgramGroupOptions {  // [D]
  const void* payload_type;
};

struct StackSizes {  // [D]
  unsigned continuation_raygen, continuation_miss, continuation_closest, continuation_any,
      continuation_intersection, continuation_callable, direct_callable;
};

struct BindingTable {  // [M]
  DevicePointer raygen;
  DevicePointer exception;
  DevicePointer miss;
  unsigned miss_stride, miss_count;
  DevicePointer hit;
  unsigned hit_stride, hit_count;
  DevicePointer callables;
  unsigned callable_stride, callable_count;
};

struct MotionOptions {  // [M]
  unsigned short keys, flags;
  float begin, end;
};

struct BuildOptions {  // [M]
  unsigned flags;
  int operation;
  MotionOptions motion;
};

struct BufferSizes {  // [M]
  std::size_t output, scratch, update_scratch;
};

/// Vertices three by three, where `index_format` is index_format_none.
struct TriangleInput {  // [M]; micromaps follow, which stay 0
  const DevicePointer* vertex_buffers;
  unsigned vertex_count;
  int vertex_format;
  unsigned vertex_stride;
  DevicePointer index_buffer;
  unsigned index_count;
  int index_format;
  unsigned index_stride;
  DevicePointer transform;
  const unsigned* flags;
  unsigned record_count;
  DevicePointer record_offsets;
  unsigned record_offset_bytes, record_offset_stride;
  unsigned primitive_offset;
  int transform_format;
};

struct BoxInput {  // [M]
  const DevicePointer* boxes;
  unsigned count;
  unsigned stride;
  const unsigned* flags;
  unsigned record_count;
  DevicePointer record_offsets;
  unsigned record_offset_bytes, record_offset_stride;
  unsigned primitive_offset;
};

struct InstanceInput {  // [M]
  DevicePointer instances;
  unsigned count;
  unsigned stride;
};

struct BuildInput {  // [M]
  int type;
  union {
    TriangleInput triangles;
    BoxInput boxes;
    InstanceInput instances;
    char padding[1024];
  };
};

struct Box {  // [L]
  float min[3], max[3];
};

struct Instance {      // [M]
  float to_world[12];  ///< rows
  unsigned id;
  unsigned record_offset;
  unsigned visibility;
  unsigned flags;
  TraversableHandle group;
  unsigned padding[2];
};

struct EmitDescription {  // [M]
  DevicePointer result;
  int type;
};

/// The function table, by position [D]; pointers that are not called have none of their own type.
struct FunctionTable {
  const char* (*error_name)(Result);
  const char* (*error_string)(Result);
  Result (*context_create)(void* cuda_context, const ContextOptions*, Context*);
  Result (*context_destroy)(Context);
  Result (*context_property)(Context, int property, void* value, std::size_t bytes);
  void* unused_5_11[7];
  Result (*module_create)(Context, const ModuleOptions*, const PipelineOptions*, const char* code,
                          std::size_t code_bytes, char* log, std::size_t* log_bytes, Module*);
  void* unused_13_14[2];
  Result (*module_destroy)(Module);
  void* unused_16_17[2];
  Result (*group_create)(Context, const ProgramGroupDescription*, unsigned count,
                         const ProgramGroupOptions*, char* log, std::size_t* log_bytes,
                         ProgramGroup*);
  Result (*group_destroy)(ProgramGroup);
  Result (*group_stack_size)(ProgramGroup, StackSizes*, Pipeline);
  Result (*pipeline_create)(Context, const PipelineOptions*, const LinkOptions*,
                            const ProgramGroup*, unsigned count, char* log, std::size_t* log_bytes,
                            Pipeline*);
  Result (*pipeline_destroy)(Pipeline);
  Result (*pipeline_stack_size)(Pipeline, unsigned direct_from_traversal,
                                unsigned direct_from_state, unsigned continuation,
                                unsigned graph_depth);
  Result (*accel_memory)(Context, const BuildOptions*, const BuildInput*, unsigned count,
                         BufferSizes*);
  Result (*accel_build)(Context, Stream, const BuildOptions*, const BuildInput*, unsigned count,
                        DevicePointer scratch, std::size_t scratch_bytes, DevicePointer output,
                        std::size_t output_bytes, TraversableHandle*, const EmitDescription*,
                        unsigned emit_count);
  void* unused_26_28[3];
  Result (*accel_compact)(Context, Stream, TraversableHandle, DevicePointer output,
                          std::size_t output_bytes, TraversableHandle*);
  void* unused_30_37[8];
  Result (*record_header)(ProgramGroup, void* header);
  Result (*launch)(Pipeline, Stream, DevicePointer params, std::size_t params_bytes,
                   const BindingTable*, unsigned width, unsigned height, unsigned depth);
  void* unused_40_47[8];
};
static_assert(sizeof(FunctionTable) == table_pointers * sizeof(void*));

/// The library's one symbol, "optixQueryFunctionTable" [D].
using QueryFunctionTable = Result (*)(int abi, unsigned option_count, void* option_keys,
                                      const void** option_values, void* table,
                                      std::size_t table_bytes);

}  // namespace pt::optix
