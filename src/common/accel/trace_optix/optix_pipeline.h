// OptiX's programs, compiled and linked: what a launch runs.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/accel/trace_optix/optix_library.h"
#include "common/accel/trace_optix/optix_memory.h"
#include "common/accel/trace_optix/optix_scene.h"
#include "common/choices/optix_hits.h"

namespace pt {

/// Threads of a launch, at most; each takes every so many rays.
inline constexpr std::uint32_t optix_width_max = 1u << 20;

/// A module in PTX, whose launch parameters are the variable `params`, of `params_bytes`.
struct OptixModule {
  std::string_view code;  ///< empty where ptexp was built without it
  std::size_t params_bytes;
  /// Names of its ray generation programs; none: those for each kind of rays (optix_programs.h).
  std::vector<std::string> launches{};
  /// Launch parameters that OptiX's compiler takes for constants: the first ones.
  std::span<const char> constants{};
};

/// The PTX that CMake has packed; empty where it has none (cmake/Optix.cmake).
std::string unpack_optix_code(std::span<const unsigned char> packed);

/// The launches of a module, over the programs of optix_programs.h.
class OptixPipeline {
 public:
  OptixPipeline(const OptixContext& context, OptixMemory& memory, const OptixModule& module,
                OptixHits hits, const OptixContent& content);
  ~OptixPipeline();
  OptixPipeline(const OptixPipeline&) = delete;
  OptixPipeline& operator=(const OptixPipeline&) = delete;

  /// By kind of rays, or of whole paths.
  enum Launch { closest, any, paths = 0 };

  /// Enqueues `width` threads on the memory's stream.
  void launch(Launch kind, const void* params, std::uint32_t width);

 private:
  void create_module(const OptixModule& module);
  void create_groups(std::vector<std::string> launches, OptixHits hits);
  void link(bool has_instances);
  void fill_records();
  void destroy() noexcept;

  const OptixContext& context_;
  OptixMemory& memory_;
  std::size_t params_bytes_;
  optix::PipelineOptions options_{};
  optix::Module module_ = nullptr;
  std::size_t launch_count_ = 0, hit_count_;
  std::vector<optix::ProgramGroup>
      groups_;  ///< ray generation, miss, hits of triangles, of spheres
  optix::Pipeline pipeline_ = nullptr;
  OptixBuffer records_, params_;
};

}  // namespace pt
