// Sizes and offsets of OptiX's structures, as the compilers of public declarations lay them out
// (optix_abi.h says where these are); written out here, not computed.
#include <gtest/gtest.h>

#include "common/accel/trace_optix/optix_abi.h"

namespace pt::optix {
namespace {

TEST(OptixAbi, SizesAreThoseOfTheInterface) {
  EXPECT_EQ(sizeof(ContextOptions), 24u);
  EXPECT_EQ(sizeof(BoundValue), 32u);
  EXPECT_EQ(sizeof(ModuleOptions), 40u);
  EXPECT_EQ(sizeof(PipelineOptions), 40u);
  EXPECT_EQ(sizeof(LinkOptions), 4u);
  EXPECT_EQ(sizeof(Program), 16u);
  EXPECT_EQ(sizeof(HitPrograms), 48u);
  EXPECT_EQ(sizeof(ProgramGroupDescription), 56u);
  EXPECT_EQ(sizeof(ProgramGroupOptions), 8u);
  EXPECT_EQ(sizeof(StackSizes), 28u);
  EXPECT_EQ(sizeof(BindingTable), 64u);
  EXPECT_EQ(sizeof(MotionOptions), 12u);
  EXPECT_EQ(sizeof(BuildOptions), 20u);
  EXPECT_EQ(sizeof(BufferSizes), 24u);
  EXPECT_EQ(sizeof(TriangleInput), 96u);  // without micromaps
  EXPECT_EQ(sizeof(BoxInput), 56u);
  EXPECT_EQ(sizeof(InstanceInput), 16u);
  EXPECT_EQ(sizeof(BuildInput), 1032u);
  EXPECT_EQ(sizeof(Box), 24u);
  EXPECT_EQ(sizeof(Instance), 80u);
  EXPECT_EQ(sizeof(EmitDescription), 16u);
}

#define EXPECT_OFFSET(type, member, offset) EXPECT_EQ(offsetof(type, member), std::size_t{offset})

TEST(OptixAbi, MembersLieWhereTheInterfaceHasThem) {
  EXPECT_OFFSET(ContextOptions, log_level, 16);
  EXPECT_OFFSET(BoundValue, bytes, 8);
  EXPECT_OFFSET(BoundValue, annotation, 24);
  EXPECT_OFFSET(ModuleOptions, bound_values, 16);
  EXPECT_OFFSET(ModuleOptions, bound_value_count, 24);
  EXPECT_OFFSET(ModuleOptions, payload_type_count, 28);
  EXPECT_OFFSET(PipelineOptions, exception_flags, 16);
  EXPECT_OFFSET(PipelineOptions, params_name, 24);
  EXPECT_OFFSET(PipelineOptions, primitive_flags, 32);
  EXPECT_OFFSET(ProgramGroupDescription, single, 8);
  EXPECT_OFFSET(ProgramGroupDescription, hit, 8);
  EXPECT_OFFSET(HitPrograms, any, 16);
  EXPECT_OFFSET(HitPrograms, intersection, 32);
  EXPECT_OFFSET(BindingTable, miss, 16);
  EXPECT_OFFSET(BindingTable, hit, 32);
  EXPECT_OFFSET(BindingTable, hit_count, 44);
  EXPECT_OFFSET(TriangleInput, vertex_count, 8);
  EXPECT_OFFSET(TriangleInput, vertex_stride, 16);
  EXPECT_OFFSET(TriangleInput, index_buffer, 24);
  EXPECT_OFFSET(TriangleInput, index_format, 36);
  EXPECT_OFFSET(TriangleInput, flags, 56);
  EXPECT_OFFSET(TriangleInput, record_count, 64);
  EXPECT_OFFSET(TriangleInput, record_offsets, 72);
  EXPECT_OFFSET(TriangleInput, transform_format, 92);
  EXPECT_OFFSET(BoxInput, count, 8);
  EXPECT_OFFSET(BoxInput, flags, 16);
  EXPECT_OFFSET(BoxInput, record_count, 24);
  EXPECT_OFFSET(BoxInput, primitive_offset, 48);
  EXPECT_OFFSET(BuildInput, triangles, 8);
  EXPECT_OFFSET(Instance, id, 48);
  EXPECT_OFFSET(Instance, flags, 60);
  EXPECT_OFFSET(Instance, group, 64);
}

TEST(OptixAbi, FunctionsStandAtTheirPlacesInTheTable) {
  constexpr std::size_t p = sizeof(void*);
  EXPECT_EQ(sizeof(FunctionTable), 48 * p);
  EXPECT_OFFSET(FunctionTable, context_create, 2 * p);
  EXPECT_OFFSET(FunctionTable, context_property, 4 * p);
  EXPECT_OFFSET(FunctionTable, module_create, 12 * p);
  EXPECT_OFFSET(FunctionTable, module_destroy, 15 * p);
  EXPECT_OFFSET(FunctionTable, group_create, 18 * p);
  EXPECT_OFFSET(FunctionTable, pipeline_create, 21 * p);
  EXPECT_OFFSET(FunctionTable, pipeline_stack_size, 23 * p);
  EXPECT_OFFSET(FunctionTable, accel_memory, 24 * p);
  EXPECT_OFFSET(FunctionTable, accel_build, 25 * p);
  EXPECT_OFFSET(FunctionTable, accel_compact, 29 * p);
  EXPECT_OFFSET(FunctionTable, record_header, 38 * p);
  EXPECT_OFFSET(FunctionTable, launch, 39 * p);
}

}  // namespace
}  // namespace pt::optix
