#include "common/accel/trace_optix/optix_pipeline.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <vector>

#include "common/error/error.h"

namespace pt {
namespace {

/// Calls function(log, &bytes) and gives what it wrote.
template <class Function>
void call_with_log(const OptixLibrary& library, const char* name, Function&& function) {
  std::array<char, 4096> log{};
  std::size_t bytes = log.size();
  const optix::Result result = function(log.data(), &bytes);
  log.back() = '\0';
  library.check(result, name, log.data());
}

constexpr std::size_t record_bytes = optix::record_header_bytes;

/// Programs of the records of triangles, or of spheres, which are boxes in any case.
void name_programs(std::span<optix::ProgramGroupDescription> records, OptixHits hits,
                   optix::Module module, bool are_spheres) {
  optix::HitPrograms* hit[optix_records];
  for (unsigned i = 0; i < optix_records; ++i) hit[i] = &records[i].hit;
  const auto set = [&](OptixRecord record, optix::Program optix::HitPrograms::*kind,
                       const char* name) {
    hit[record]->*kind = {module, name};
  };
  using P = optix::HitPrograms;
  if (hits == OptixHits::built_in) {
    for (const OptixRecord record : {optix_record_closest, optix_record_any, optix_record_ties}) {
      set(record, &P::closest, are_spheres ? "__closesthit__name_sphere" : "__closesthit__name");
      if (are_spheres) set(record, &P::intersection, "__intersection__sphere");
    }
  } else if (are_spheres || hits == OptixHits::custom) {
    const char* const closest =
        are_spheres ? "__intersection__closest_sphere" : "__intersection__closest";
    set(optix_record_closest, &P::intersection, closest);
    set(optix_record_ties, &P::intersection, closest);
    set(optix_record_any, &P::intersection,
        are_spheres ? "__intersection__any_sphere" : "__intersection__any");
    if (hits == OptixHits::any_hit) set(optix_record_any, &P::any, "__anyhit__end");
  } else {
    set(optix_record_closest, &P::any, "__anyhit__closest");
    set(optix_record_any, &P::any, "__anyhit__any");
    set(optix_record_ties, &P::any, "__anyhit__ties");
  }
}

}  // namespace

std::string unpack_optix_code(std::span<const unsigned char> packed) {
  std::string text;
  if (packed.size() < 4) return text;
  // gzip's last four bytes are the text's size.
  for (int i = 1; i <= 4; ++i) text.resize(text.size() << 8 | packed[packed.size() - i]);
  z_stream stream{};
  stream.next_in = const_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(text.data());
  stream.avail_out = static_cast<uInt>(text.size());
  const bool is_whole =
      inflateInit2(&stream, 15 + 16) == Z_OK && inflate(&stream, Z_FINISH) == Z_STREAM_END;
  inflateEnd(&stream);
  if (!is_whole) throw Error("OptiX: the programs in ptexp are damaged");
  return text;
}

OptixPipeline::OptixPipeline(const OptixContext& context, OptixMemory& memory,
                             const OptixModule& module, OptixHits hits, const OptixContent& content)
    : context_(context),
      memory_(memory),
      params_bytes_(module.params_bytes),
      hit_count_(content.has_spheres ? 2 * optix_records : optix_records) {
  if (module.code.empty())
    throw Error("OptiX: ptexp was built without programs for it (PTEXP_OPTIX and PTEXP_CUDA)");
  options_.graph_flags =
      content.has_instances ? optix::graph_single_level_instancing : optix::graph_single_gas;
  options_.payload_values = optix_payload_words;
  options_.attribute_values = 2;  // the least
  options_.exception_flags = optix::exception_none;
  options_.params_name = "params";
  options_.primitive_flags =
      hits == OptixHits::custom ? optix::primitives_custom : optix::primitives_triangle;
  if (content.has_spheres) options_.primitive_flags |= optix::primitives_custom;
  try {
    create_module(module);
    create_groups(module.launches, hits);
    link(content.has_instances);
    fill_records();
    params_ = OptixBuffer(memory, params_bytes_, "OptiX's parameters");
  } catch (...) {
    destroy();
    throw;
  }
}

OptixPipeline::~OptixPipeline() { destroy(); }

void OptixPipeline::destroy() noexcept {
  const optix::FunctionTable& call = context_.functions();
  if (pipeline_ != nullptr) call.pipeline_destroy(pipeline_);
  for (optix::ProgramGroup group : groups_)
    if (group != nullptr) call.group_destroy(group);
  if (module_ != nullptr) call.module_destroy(module_);
}

void OptixPipeline::create_module(const OptixModule& module) {
  optix::ModuleOptions options{};
  options.optimization_level = optix::optimization_level_default;
  options.debug_level = optix::debug_level_none;
  const optix::BoundValue constants{0, module.constants.size(), module.constants.data(), nullptr};
  if (!module.constants.empty()) options.bound_values = &constants, options.bound_value_count = 1;
  call_with_log(context_.library(), "optixModuleCreate", [&](char* log, std::size_t* bytes) {
    return context_.functions().module_create(context_.get(), &options, &options_,
                                              module.code.data(), module.code.size(), log, bytes,
                                              &module_);
  });
}

void OptixPipeline::create_groups(std::vector<std::string> launches, OptixHits hits) {
  const char* suffix = hits == OptixHits::custom    ? "custom"
                       : hits == OptixHits::any_hit ? "any_hit"
                                                    : "built_in";
  if (launches.empty())
    launches = {std::string("__raygen__closest_") + suffix, std::string("__raygen__any_") + suffix};
  launch_count_ = launches.size();
  std::vector<optix::ProgramGroupDescription> all(launch_count_ + 1 + hit_count_);
  for (optix::ProgramGroupDescription& group : all) group.kind = optix::group_kind_hitgroup;
  for (std::size_t i = 0; i < launch_count_; ++i) {
    all[i].kind = optix::group_kind_raygen;
    all[i].single = {module_, launches[i].c_str()};
  }
  // No program for rays that miss: their payload says so.
  all[launch_count_].kind = optix::group_kind_miss;
  const std::span<optix::ProgramGroupDescription> records = std::span(all).last(hit_count_);
  for (std::size_t first = 0; first < hit_count_; first += optix_records)
    name_programs(records.subspan(first, optix_records), hits, module_, first > 0);
  const optix::ProgramGroupOptions options{};
  groups_.resize(all.size());
  call_with_log(context_.library(), "optixProgramGroupCreate", [&](char* log, std::size_t* bytes) {
    return context_.functions().group_create(context_.get(), all.data(),
                                             static_cast<unsigned>(all.size()), &options, log,
                                             bytes, groups_.data());
  });
}

void OptixPipeline::link(bool has_instances) {
  const optix::FunctionTable& call = context_.functions();
  const optix::LinkOptions options{1};
  call_with_log(context_.library(), "optixPipelineCreate", [&](char* log, std::size_t* bytes) {
    return call.pipeline_create(context_.get(), &options_, &options, groups_.data(),
                                static_cast<unsigned>(groups_.size()), log, bytes, &pipeline_);
  });
  optix::StackSizes most{};
  for (optix::ProgramGroup group : groups_) {
    optix::StackSizes size{};
    context_.library().check(call.group_stack_size(group, &size, pipeline_),
                             "optixProgramGroupGetStackSize");
    const auto raise = [&](unsigned optix::StackSizes::*member) {
      most.*member = std::max(most.*member, size.*member);
    };
    raise(&optix::StackSizes::continuation_raygen);
    raise(&optix::StackSizes::continuation_miss);
    raise(&optix::StackSizes::continuation_closest);
    raise(&optix::StackSizes::continuation_any);
    raise(&optix::StackSizes::continuation_intersection);
  }
  // A trace of depth 1: the ray generation's frame, and one of the programs that it meets.
  const unsigned continuation =
      most.continuation_raygen + std::max({most.continuation_closest, most.continuation_miss,
                                           most.continuation_any + most.continuation_intersection});
  context_.library().check(
      call.pipeline_stack_size(pipeline_, 0, 0, continuation, has_instances ? 2 : 1),
      "optixPipelineSetStackSize");
}

void OptixPipeline::fill_records() {
  std::vector<char> headers(groups_.size() * record_bytes);
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    context_.library().check(
        context_.functions().record_header(groups_[i], headers.data() + i * record_bytes),
        "optixSbtRecordPackHeader");
  }
  records_ = OptixBuffer(memory_, headers.size(), "OptiX's records");
  memory_.to_device(records_.get(), headers.data(), headers.size());
}

void OptixPipeline::launch(Launch kind, const void* params, std::uint32_t width) {
  if (width == 0) return;
  memory_.enqueue_to_device(params_.get(), params, params_bytes_);
  const auto record = [&](std::size_t i) { return records_.address() + i * record_bytes; };
  optix::BindingTable table{};
  table.raygen = record(kind);
  table.miss = record(launch_count_);
  table.miss_stride = record_bytes, table.miss_count = 1;
  table.hit = record(launch_count_ + 1);
  table.hit_stride = record_bytes, table.hit_count = static_cast<unsigned>(hit_count_);
  context_.library().check(
      context_.functions().launch(pipeline_, memory_.stream(), params_.address(), params_bytes_,
                                  &table, width, 1, 1),
      "optixLaunch");
}

}  // namespace pt
