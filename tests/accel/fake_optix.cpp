// See tests/support/accel/fake_optix.h.
#include "accel/fake_optix.h"

#include <cstring>

namespace pt {
namespace {

FakeOptix fake;

/// Notes the call; false: it is to fail.
bool begin(const char* name) {
  fake.calls.emplace_back(name);
  return static_cast<int>(fake.calls.size()) - 1 != fake.fail_at;
}

optix::Result fail(char* log = nullptr, std::size_t* log_bytes = nullptr) {
  if (log != nullptr) std::strncpy(log, "the log\nof two lines", *log_bytes - 1);
  return fake.error;
}

template <class Object>
Object make(void* value) {
  ++fake.live;
  return static_cast<Object>(value);
}

struct Group {
  optix::ProgramGroupDescription description;
  std::string names[3];
};

const char* error_name(optix::Result) { return "OPTIX_ERROR_FAKE"; }

optix::Result context_create(void*, const optix::ContextOptions*, optix::Context* context) {
  if (!begin("context_create")) return fail();
  *context = make<optix::Context>(&fake);
  return 0;
}
optix::Result context_destroy(optix::Context) {
  --fake.live;
  return 0;
}
optix::Result context_property(optix::Context, int property, void* value, std::size_t bytes) {
  if (!begin("context_property")) return fail();
  if (bytes != sizeof(unsigned)) return 7001;
  const unsigned known = property == optix::property_max_primitives  ? fake.primitives_max
                         : property == optix::property_max_instances ? fake.instances_max
                         : property == optix::property_reordering    ? fake.reordering
                                                                     : fake.rtcore_version;
  std::memcpy(value, &known, sizeof known);
  return 0;
}
optix::Result module_create(optix::Context, const optix::ModuleOptions* options,
                            const optix::PipelineOptions*, const char* code, std::size_t bytes,
                            char* log, std::size_t* log_bytes, optix::Module* module) {
  if (!begin("module_create")) return fail(log, log_bytes);
  fake.code.assign(code, bytes);
  fake.constants.clear();
  for (unsigned i = 0; i < options->bound_value_count; ++i) {
    const optix::BoundValue& bound = options->bound_values[i];
    fake.constants.resize(bound.offset);
    fake.constants.append(static_cast<const char*>(bound.value), bound.bytes);
  }
  *module = make<optix::Module>(&fake.code);
  return 0;
}
optix::Result module_destroy(optix::Module) {
  --fake.live;
  return 0;
}

// Groups keep the names of their programs, which the caller may forget.
optix::Result group_create(optix::Context, const optix::ProgramGroupDescription* descriptions,
                           unsigned count, const optix::ProgramGroupOptions*, char* log,
                           std::size_t* log_bytes, optix::ProgramGroup* groups) {
  if (!begin("group_create")) return fail(log, log_bytes);
  for (unsigned i = 0; i < count; ++i) {
    auto* group = new Group{descriptions[i], {}};
    const auto keep = [](optix::Program& program, std::string& name) {
      if (program.entry == nullptr) return;
      name = program.entry;
      program.entry = name.c_str();
    };
    if (group->description.kind == optix::group_kind_hitgroup) {
      keep(group->description.hit.closest, group->names[0]);
      keep(group->description.hit.any, group->names[1]);
      keep(group->description.hit.intersection, group->names[2]);
    } else {
      keep(group->description.single, group->names[0]);
    }
    groups[i] = make<optix::ProgramGroup>(static_cast<void*>(group));
  }
  return 0;
}
optix::Result group_destroy(optix::ProgramGroup group) {
  --fake.live;
  delete reinterpret_cast<Group*>(group);
  return 0;
}
optix::Result group_stack_size(optix::ProgramGroup, optix::StackSizes* sizes, optix::Pipeline) {
  if (!begin("group_stack_size")) return fail();
  *sizes = {};
  sizes->continuation_raygen = 100;
  return 0;
}
optix::Result pipeline_create(optix::Context, const optix::PipelineOptions* options,
                              const optix::LinkOptions*, const optix::ProgramGroup*, unsigned,
                              char* log, std::size_t* log_bytes, optix::Pipeline* pipeline) {
  if (!begin("pipeline_create")) return fail(log, log_bytes);
  fake.pipeline = *options;
  *pipeline = make<optix::Pipeline>(&fake.pipeline);
  return 0;
}
optix::Result pipeline_destroy(optix::Pipeline) {
  --fake.live;
  return 0;
}
optix::Result pipeline_stack_size(optix::Pipeline, unsigned, unsigned, unsigned, unsigned) {
  return begin("pipeline_stack_size") ? 0 : fail();
}

optix::Result accel_memory(optix::Context, const optix::BuildOptions*, const optix::BuildInput*,
                           unsigned, optix::BufferSizes* sizes) {
  if (!begin("accel_memory")) return fail();
  *sizes = {512, 256, 0};
  return 0;
}
optix::Result accel_build(optix::Context, optix::Stream, const optix::BuildOptions*,
                          const optix::BuildInput* input, unsigned, optix::DevicePointer scratch,
                          std::size_t scratch_bytes, optix::DevicePointer output,
                          std::size_t output_bytes, optix::TraversableHandle* handle,
                          const optix::EmitDescription* emit, unsigned) {
  if (!begin("accel_build")) return fail();
  std::memset(reinterpret_cast<void*>(scratch), 1, scratch_bytes);
  std::memset(reinterpret_cast<void*>(output), 1, output_bytes);
  FakeOptix::Structure structure;
  if (input->type == optix::input_custom) {
    const auto* boxes = reinterpret_cast<const optix::Box*>(*input->boxes.boxes);
    structure.count = input->boxes.count;
    structure.boxes.assign(boxes, boxes + structure.count);
  } else if (input->type == optix::input_triangles) {
    structure.count = input->triangles.vertex_count / 3;
    structure.vertices = reinterpret_cast<const char*>(*input->triangles.vertex_buffers);
  } else {
    const auto* instances = reinterpret_cast<const optix::Instance*>(input->instances.instances);
    structure.count = input->instances.count;
    structure.instances.assign(instances, instances + structure.count);
  }
  *handle = output;
  fake.structures[*handle] = std::move(structure);
  const std::uint64_t compacted = 128;
  std::memcpy(reinterpret_cast<void*>(emit->result), &compacted, sizeof compacted);
  return 0;
}
optix::Result accel_compact(optix::Context, optix::Stream, optix::TraversableHandle from,
                            optix::DevicePointer output, std::size_t bytes,
                            optix::TraversableHandle* handle) {
  if (!begin("accel_compact")) return fail();
  std::memset(reinterpret_cast<void*>(output), 1, bytes);
  FakeOptix::Structure structure = std::move(fake.structures.at(from));
  fake.structures.erase(from);
  *handle = output;
  fake.structures[*handle] = std::move(structure);
  return 0;
}

optix::Result record_header(optix::ProgramGroup group, void* header) {
  if (!begin("record_header")) return fail();
  std::memcpy(header, &group, sizeof group);
  return 0;
}

const Group& group_in(optix::DevicePointer record) {
  Group* group = nullptr;
  std::memcpy(&group, reinterpret_cast<const void*>(record), sizeof group);
  return *group;
}

optix::Result launch(optix::Pipeline, optix::Stream, optix::DevicePointer params,
                     std::size_t params_bytes, const optix::BindingTable* table, unsigned width,
                     unsigned, unsigned) {
  if (!begin("launch")) return fail();
  FakeOptix::Launch run{group_in(table->raygen).names[0],
                        {},
                        reinterpret_cast<const void*>(params),
                        params_bytes,
                        width};
  for (unsigned i = 0; i < table->hit_count; ++i)
    run.hit.push_back(group_in(table->hit + i * table->hit_stride).description);
  if (fake.run) fake.run(run);
  return 0;
}

}  // namespace
}  // namespace pt

extern "C" {

__attribute__((visibility("default"))) pt::FakeOptix* fake_optix() { return &pt::fake; }

__attribute__((visibility("default"))) pt::optix::Result optixQueryFunctionTable(
    int abi, unsigned, void*, const void**, void* table, std::size_t table_bytes) {
  using namespace pt;
  if (!begin("query")) return fail();
  if (abi != fake.known_abi) return optix::error_unsupported_abi;
  if (table_bytes != fake.pointers * sizeof(void*)) return optix::error_table_size;
  optix::FunctionTable functions{};
  functions.error_name = error_name;
  functions.context_create = context_create;
  functions.context_destroy = context_destroy;
  functions.context_property = context_property;
  functions.module_create = module_create;
  functions.module_destroy = module_destroy;
  functions.group_create = group_create;
  functions.group_destroy = group_destroy;
  functions.group_stack_size = group_stack_size;
  functions.pipeline_create = pipeline_create;
  functions.pipeline_destroy = pipeline_destroy;
  functions.pipeline_stack_size = pipeline_stack_size;
  functions.accel_memory = accel_memory;
  functions.accel_build = accel_build;
  functions.accel_compact = accel_compact;
  functions.record_header = record_header;
  functions.launch = launch;
  std::memcpy(table, &functions, sizeof functions);
  return 0;
}
}
