#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "app/doctor/doctor.h"
#include "app/options/option_values.h"

namespace pt {
namespace {

/// 12040 -> "12.4"
std::string version_text(int version) {
  return fmt::format("{}.{}", version / 1000, version % 1000 / 10);
}

/// The text behind "architectures " in the build's description; empty: none.
std::string architectures_of(const BuildInfo& build) {
  constexpr std::string_view word = "architectures ";
  const std::size_t at = build.cuda.find(word);
  return at == std::string::npos ? "" : build.cuda.substr(at + word.size());
}

/// The check of a build without CUDA, which cannot use a GPU.
Check check_absent_cuda(const DriverFacts& driver) {
  if (driver.gpus.empty()) {
    return {"CUDA", Health::ok, "off: this ptexp is for the CPU, and no NVIDIA GPU is here", ""};
  }
  return {"CUDA", Health::warning,
          fmt::format("this ptexp was built without it, though here is {}{}", driver.gpus.front(),
                      driver.gpus.size() > 1 ? " and others" : ""),
          "install CUDA's toolkit, 12.4 or newer, and build with -DPTEXP_CUDA=ON"};
}

Check check_driver(const DriverFacts& driver, const CudaFacts& cuda) {
  const std::string number = driver.version.empty() ? "" : driver.version + ", ";
  if (cuda.driver == 0) {
    return {"driver", Health::missing, driver.version.empty() ? "none" : number + "not usable",
            "install NVIDIA's driver (in a container: start it with --gpus all); meanwhile "
            "--device cpu works"};
  }
  Check check{"driver", Health::ok, fmt::format("{}for CUDA {}", number, version_text(cuda.driver)),
              ""};
  const std::string update = fmt::format("install a driver for CUDA {} or newer",
                                         version_text(std::max(cuda.built, 12040)));
  if (cuda.driver / 1000 < cuda.built / 1000) {
    check.health = Health::missing, check.remedy = update;
  } else if (cuda.driver < cuda.built) {  // kernels run by minor version compatibility
    check.health = Health::warning;
    check.remedy = update + ": an older one compiles no PTX of this build";
  }
  return check;
}

Check check_runtime(const Machine& machine) {
  return {"CUDA", Health::ok,
          fmt::format("runtime {}, built by nvcc {}", version_text(machine.cuda.runtime),
                      machine.build.cuda),
          ""};
}

Check check_gpu(const GpuFacts& gpu, std::size_t index, int driver) {
  constexpr double gib = 1 << 30, kib = 1 << 10;
  const char* const parts = driver < 12040 ? " (all: --sms wants a driver for CUDA 12.4)" : "";
  Check check{
      fmt::format("GPU cuda:{}", index), Health::ok,
      fmt::format("{}, {} multiprocessors{}, compute capability {}.{}, {:.1f} GiB free of {:.1f} "
                  "GiB, {:.0f} KiB of shared memory per block (at most {:.0f} KiB)",
                  gpu.name, gpu.multiprocessors, parts, gpu.major, gpu.minor,
                  static_cast<double>(gpu.free_memory) / gib, static_cast<double>(gpu.memory) / gib,
                  static_cast<double>(gpu.block_shared) / kib,
                  static_cast<double>(gpu.block_shared_max) / kib),
      ""};
  if (!gpu.problem.empty()) {
    check.health = Health::missing;
    check.detail += "; an empty kernel does not run: " + gpu.problem;
    check.remedy =
        "see `nvidia-smi`: another process may own the GPU (exclusive mode), its memory "
        "be full, or this ptexp have no code for it";
  } else if (static_cast<double>(gpu.free_memory) < gib) {
    check.health = Health::warning;
    check.remedy = "scene and paths need memory: see `nvidia-smi` for who has it";
  }
  return check;
}

Check check_code(const GpuFacts& gpu, std::size_t index, const std::string& architectures) {
  const std::string number = fmt::format("{}{}", gpu.major, gpu.minor);
  const std::string rebuild = "build with -DCMAKE_CUDA_ARCHITECTURES=" + number;
  const std::string name = fmt::format("code for cuda:{}", index);
  switch (code_for(architectures, gpu.major, gpu.minor)) {
    case GpuCode::machine:
      return {name, Health::ok, "machine code, of " + architectures, ""};
    case GpuCode::ptx:
      return {name, Health::warning,
              fmt::format("PTX alone, of {}: the driver compiles it at the first start, for a "
                          "minute or more, and keeps it in ~/.nv/ComputeCache",
                          architectures),
              rebuild};
    case GpuCode::unknown:
      return {name, Health::ok, "by CMAKE_CUDA_ARCHITECTURES=" + architectures, ""};
    case GpuCode::none:
      break;
  }
  return {name, Health::missing, "none: this ptexp was built for " + architectures, rebuild};
}

Check check_counters(const Machine& machine) {
  const std::string& library = machine.cuda.cupti;
  if (library.empty()) {
    return {"counters", Health::warning, "CUPTI's library was not found: --counters cannot work",
            "install CUDA's toolkit, or name libcupti in the variable PTEXP_CUPTI"};
  }
  if (machine.driver.counters_restricted && !machine.is_admin) {
    return {"counters", Health::warning,
            library + "; the driver lets administrators alone read counters (also ncu's)",
            "run --counters as root, in a container with CAP_SYS_ADMIN, or load the driver with "
            "NVreg_RestrictProfilingToAdminUsers=0"};
  }
  return {"counters", Health::ok,
          library + (machine.driver.counters_known ? "; the driver lets this user read them"
                                                   : "; whether the driver permits is unknown"),
          ""};
}

Check check_optix(const CudaFacts& cuda) {
  if (cuda.optix_problem.empty()) return {"OptiX", Health::ok, cuda.optix, ""};
  return {"OptiX", Health::warning, cuda.optix_problem,
          "only --accel optix needs it: install all of NVIDIA's driver (in a container: "
          "NVIDIA_DRIVER_CAPABILITIES=all), 535 or newer"};
}

}  // namespace

GpuCode code_for(const std::string& architectures, int major, int minor) {
  const int wanted = 10 * major + minor;
  GpuCode best = GpuCode::none;
  for (const std::string& one : split(architectures, ';')) {
    int number = 0;
    const char* end = one.data() + one.size();
    const auto [stop, error] = std::from_chars(one.data(), end, number);
    if (error != std::errc()) {  // "native", "all"
      if (best == GpuCode::none) best = GpuCode::unknown;
      continue;
    }
    // 90a is for that GPU alone, 100f for those of its generation.
    const bool is_specific = stop != end && *stop == 'a', is_family = stop != end && *stop == 'f';
    const std::string_view form(stop + (is_specific || is_family), end);
    const bool in_family = !is_specific && number / 10 == major && number <= wanted;
    if (form != "-virtual" && (number == wanted || in_family)) return GpuCode::machine;
    const bool compiles = is_specific ? number == wanted : is_family ? in_family : number <= wanted;
    if (form != "-real" && compiles) best = GpuCode::ptx;
  }
  return best;
}

void add_gpu_checks(const Machine& machine, std::vector<Check>& checks) {
  const CudaFacts& cuda = machine.cuda;
  if (!cuda.is_built) return checks.push_back(check_absent_cuda(machine.driver));
  checks.push_back(check_driver(machine.driver, cuda));
  checks.push_back(check_runtime(machine));
  if (cuda.gpus.empty()) {
    checks.push_back({"GPU", Health::missing,
                      cuda.problem.empty() ? "none" : "none; CUDA says: " + cuda.problem,
                      "see `nvidia-smi`, and the variable CUDA_VISIBLE_DEVICES; meanwhile "
                      "--device cpu works"});
  }
  for (std::size_t i = 0; i < cuda.gpus.size(); ++i) {
    checks.push_back(check_gpu(cuda.gpus[i], i, cuda.driver));
    const std::string architectures = architectures_of(machine.build);
    if (cuda.gpus[i].major > 0) checks.push_back(check_code(cuda.gpus[i], i, architectures));
  }
  checks.push_back(check_counters(machine));
  if (!cuda.optix.empty() || !cuda.optix_problem.empty()) checks.push_back(check_optix(cuda));
}

}  // namespace pt
