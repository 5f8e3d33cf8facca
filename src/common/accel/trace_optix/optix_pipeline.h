// OptiX's programs, compiled and linked: what a launch runs.
#pragma once

#include <cstdint>
#include <string>

#include "common/accel/trace_optix/optix_library.h"
#include "common/accel/trace_optix/optix_memory.h"
#include "common/choices/optix_hits.h"

namespace pt {

/// Threads of a launch, at most; each takes every so many rays.
inline constexpr std::uint32_t optix_width_max = 1u << 20;

/// Two launches, for each kind of rays, over the programs of optix_programs.h.
class OptixPipeline {
 public:
  /// `code`: a module in PTX; its launch parameters are the variable `params`, of `params_bytes`.
  OptixPipeline(const OptixContext& context, OptixMemory& memory, const std::string& code,
                OptixHits hits, std::size_t params_bytes, bool has_instances);
  ~OptixPipeline();
  OptixPipeline(const OptixPipeline&) = delete;
  OptixPipeline& operator=(const OptixPipeline&) = delete;

  enum Launch { closest, any };

  /// Enqueues `width` threads on the memory's stream.
  void launch(Launch kind, const void* params, std::uint32_t width);

 private:
  static constexpr int launch_kinds = 2, hit_kinds = 3;
  static constexpr int group_count = launch_kinds + 1 + hit_kinds;

  void create_module(const std::string& code);
  void create_groups(OptixHits hits);
  void link(bool has_instances);
  void fill_records();
  void destroy() noexcept;

  const OptixContext& context_;
  OptixMemory& memory_;
  std::size_t params_bytes_;
  optix::PipelineOptions options_{};
  optix::Module module_ = nullptr;
  optix::ProgramGroup groups_[group_count] = {};  ///< ray generation, miss, hits
  optix::Pipeline pipeline_ = nullptr;
  OptixBuffer records_, params_;
};

}  // namespace pt
