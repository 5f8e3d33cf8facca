#include "common/device/cuda/counter_session_cuda.h"

#include <cuda_runtime_api.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "common/cuda/cuda_check.cuh"
#include "common/cuda/used_gpu.cuh"

// CUDA 12.6 brought the range profiler.
#if __has_include(<cupti_range_profiler.h>)
#define PT_HAS_RANGE_PROFILER 1
#include <cupti_profiler_host.h>
#include <cupti_range_profiler.h>
#include <cupti_target.h>
#endif

namespace pt {

std::vector<std::string> cupti_paths() {
  if (const char* named = std::getenv("PTEXP_CUPTI"); named != nullptr && *named != '\0') {
    return {named};
  }
  const std::string library = fmt::format("libcupti.so.{}", CUDART_VERSION / 1000);
  std::vector<std::string> paths{library};
  for (const char* variable : {"CUDA_HOME", "CUDA_PATH"}) {
    const char* folder = std::getenv(variable);
    if (folder == nullptr) continue;
    paths.push_back(fmt::format("{}/lib64/{}", folder, library));
    paths.push_back(fmt::format("{}/extras/CUPTI/lib64/{}", folder, library));
  }
  const std::string versioned =
      fmt::format("/usr/local/cuda-{}.{}", CUDART_VERSION / 1000, CUDART_VERSION % 1000 / 10);
  for (const std::string& folder : {std::string("/usr/local/cuda"), versioned}) {
    for (const char* below : {"lib64", "extras/CUPTI/lib64", "targets/x86_64-linux/lib"}) {
      paths.push_back(fmt::format("{}/{}/{}", folder, below, library));
    }
  }
  return paths;
}

#ifdef PT_HAS_RANGE_PROFILER

namespace {

// What is called of libcupti. All are there since 12.6 but the last, which tells more of an error.
#define PT_CUPTI_FUNCTIONS(FUNCTION)                     \
  FUNCTION(cuptiGetResultString)                         \
  FUNCTION(cuptiProfilerInitialize)                      \
  FUNCTION(cuptiDeviceGetChipName)                       \
  FUNCTION(cuptiProfilerGetCounterAvailability)          \
  FUNCTION(cuptiProfilerHostInitialize)                  \
  FUNCTION(cuptiProfilerHostDeinitialize)                \
  FUNCTION(cuptiProfilerHostGetMetricProperties)         \
  FUNCTION(cuptiProfilerHostConfigAddMetrics)            \
  FUNCTION(cuptiProfilerHostGetConfigImageSize)          \
  FUNCTION(cuptiProfilerHostGetConfigImage)              \
  FUNCTION(cuptiProfilerHostGetNumOfPasses)              \
  FUNCTION(cuptiProfilerHostEvaluateToGpuValues)         \
  FUNCTION(cuptiRangeProfilerEnable)                     \
  FUNCTION(cuptiRangeProfilerDisable)                    \
  FUNCTION(cuptiRangeProfilerGetCounterDataSize)         \
  FUNCTION(cuptiRangeProfilerCounterDataImageInitialize) \
  FUNCTION(cuptiRangeProfilerSetConfig)                  \
  FUNCTION(cuptiRangeProfilerStart)                      \
  FUNCTION(cuptiRangeProfilerStop)                       \
  FUNCTION(cuptiRangeProfilerDecodeData)                 \
  FUNCTION(cuptiRangeProfilerGetCounterDataInfo)         \
  FUNCTION(cuptiRangeProfilerCounterDataGetRangeInfo)

/// libcupti's functions, by their own names.
struct Cupti {
  std::string path;
#define PT_CUPTI_MEMBER(name) decltype(&::name) name = nullptr;
  PT_CUPTI_FUNCTIONS(PT_CUPTI_MEMBER)
#undef PT_CUPTI_MEMBER
};

Cupti load_cupti() {
  std::string tried;
  for (const std::string& path : cupti_paths()) {
    void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
      const char* reason = dlerror();
      tried += fmt::format("; {}", reason != nullptr ? reason : path.c_str());
      continue;
    }
    Cupti cupti;
    cupti.path = path;
#define PT_CUPTI_LOAD(name)                                                              \
  cupti.name = reinterpret_cast<decltype(cupti.name)>(dlsym(library, #name));            \
  if (cupti.name == nullptr) {                                                           \
    throw CountersUnavailable(                                                           \
        fmt::format("{} has no {}: expected CUPTI of CUDA 12.6 or newer", path, #name)); \
  }
    PT_CUPTI_FUNCTIONS(PT_CUPTI_LOAD)
#undef PT_CUPTI_LOAD
    return cupti;
  }
  throw CountersUnavailable(
      "CUPTI's library was not found: expected libcupti of the CUDA toolkit, where the loader "
      "looks "
      "or where PTEXP_CUPTI says" +
      tried);
}

/// Loaded once, and never unloaded: CUPTI would leave its hooks in the driver.
const Cupti& cupti() {
  static const Cupti loaded = load_cupti();
  return loaded;
}

const char* remedy_of(CUptiResult result) {
  switch (result) {
    case CUPTI_ERROR_INSUFFICIENT_PRIVILEGES:
    case CUPTI_ERROR_VIRTUALIZED_DEVICE_INSUFFICIENT_PRIVILEGES:
      return ": the driver lets administrators alone read the counters; run as root, in a "
             "container "
             "with CAP_SYS_ADMIN, or load the driver with "
             "NVreg_RestrictProfilingToAdminUsers=0 (developer.nvidia.com/ERR_NVGPUCTRPERM)";
    case CUPTI_ERROR_HARDWARE_BUSY:
      return ": another profiler uses the counters";
    default:
      return "";
  }
}

void check_cupti(CUptiResult result, const char* call) {
  if (result == CUPTI_SUCCESS) return;
  const char* name = nullptr;
  cupti().cuptiGetResultString(result, &name);
  throw CountersUnavailable(fmt::format("CUPTI: {}: {} ({}){}", call,
                                        name != nullptr ? name : "unknown result",
                                        static_cast<int>(result), remedy_of(result)));
}

/// Calls a function of CUPTI with its structure of parameters.
#define PT_CUPTI(name, params) check_cupti(cupti().name(&(params)), #name)

/// CUPTI's structures begin with their size; all else is 0.
#define PT_CUPTI_PARAMS(Type, variable) \
  Type variable{};                      \
  variable.structSize = Type##_STRUCT_SIZE

using Image = std::vector<std::uint8_t>;

/// What needs no GPU: metrics by name, of one kind of chip.
class MetricHost {
 public:
  /// `availability`: of the device's counters; empty for a chip that CUPTI knows.
  explicit MetricHost(const std::string& chip, Image availability = {})
      : chip_(chip), availability_(std::move(availability)) {
    PT_CUPTI_PARAMS(CUpti_Profiler_Host_Initialize_Params, params);
    params.profilerType = CUPTI_PROFILER_TYPE_RANGE_PROFILER;
    params.pChipName = chip_.c_str();
    params.pCounterAvailabilityImage = availability_.empty() ? nullptr : availability_.data();
    PT_CUPTI(cuptiProfilerHostInitialize, params);
    host_ = params.pHostObject;
    for (const CounterInfo& counter : counter_table) names_.push_back(find_metric(counter));
    for (const std::string& name : names_) pointers_.push_back(name.c_str());
  }
  MetricHost(const MetricHost&) = delete;
  MetricHost& operator=(const MetricHost&) = delete;
  ~MetricHost() {
    PT_CUPTI_PARAMS(CUpti_Profiler_Host_Deinitialize_Params, params);
    params.pHostObject = host_;
    cupti().cuptiProfilerHostDeinitialize(&params);
  }

  const std::vector<std::string>& names() const { return names_; }
  const char** pointers() { return pointers_.data(); }
  std::size_t count() const { return pointers_.size(); }

  /// What the hardware is to be told.
  Image make_config() {
    PT_CUPTI_PARAMS(CUpti_Profiler_Host_ConfigAddMetrics_Params, metrics);
    metrics.pHostObject = host_;
    metrics.ppMetricNames = pointers();
    metrics.numMetrics = count();
    PT_CUPTI(cuptiProfilerHostConfigAddMetrics, metrics);
    PT_CUPTI_PARAMS(CUpti_Profiler_Host_GetConfigImageSize_Params, size);
    size.pHostObject = host_;
    PT_CUPTI(cuptiProfilerHostGetConfigImageSize, size);
    Image image(size.configImageSize);
    PT_CUPTI_PARAMS(CUpti_Profiler_Host_GetConfigImage_Params, params);
    params.pHostObject = host_;
    params.configImageSize = image.size();
    params.pConfigImage = image.data();
    PT_CUPTI(cuptiProfilerHostGetConfigImage, params);
    return image;
  }

  CounterValues evaluate(const Image& data, std::size_t range) {
    CounterValues values{};
    PT_CUPTI_PARAMS(CUpti_Profiler_Host_EvaluateToGpuValues_Params, params);
    params.pHostObject = host_;
    params.pCounterDataImage = data.data();
    params.counterDataImageSize = data.size();
    params.rangeIndex = range;
    params.ppMetricNames = pointers();
    params.numMetrics = count();
    params.pMetricValues = values.data();
    PT_CUPTI(cuptiProfilerHostEvaluateToGpuValues, params);
    return values;
  }

 private:
  std::string find_metric(const CounterInfo& counter) const {
    for (const char* metric : {counter.metric, counter.other_metric}) {
      if (*metric == '\0') continue;
      PT_CUPTI_PARAMS(CUpti_Profiler_Host_GetMetricProperties_Params, params);
      params.pHostObject = host_;
      params.pMetricName = metric;
      if (cupti().cuptiProfilerHostGetMetricProperties(&params) == CUPTI_SUCCESS) return metric;
    }
    throw CountersUnavailable(
        fmt::format("CUPTI: the chip {} has no metric {}", chip_, counter.metric));
  }

  std::string chip_;
  Image availability_;  ///< read by later calls, too: CUPTI makes no copy
  CUpti_Profiler_Host_Object* host_ = nullptr;
  std::vector<std::string> names_;
  std::vector<const char*> pointers_;
};

CUcontext current_context() {
  using GetCurrent = int (*)(CUcontext*);
  const auto get = reinterpret_cast<GetCurrent>(find_in_driver("cuCtxGetCurrent"));
  CUcontext context = nullptr;
  if (get == nullptr || get(&context) != 0 || context == nullptr) {
    throw CountersUnavailable("CUPTI: the driver (libcuda.so.1) tells no current context");
  }
  return context;
}

std::string chip_name(int device) {
  PT_CUPTI_PARAMS(CUpti_Device_GetChipName_Params, params);
  params.deviceIndex = static_cast<std::size_t>(device);
  PT_CUPTI(cuptiDeviceGetChipName, params);
  return params.pChipName;
}

Image counter_availability(CUcontext context) {
  PT_CUPTI_PARAMS(CUpti_Profiler_GetCounterAvailability_Params, params);
  params.ctx = context;
  PT_CUPTI(cuptiProfilerGetCounterAvailability, params);
  Image image(params.counterAvailabilityImageSize);
  params.pCounterAvailabilityImage = image.data();
  PT_CUPTI(cuptiProfilerGetCounterAvailability, params);
  return image;
}

void initialize_cupti() {
  PT_CUPTI_PARAMS(CUpti_Profiler_Initialize_Params, params);
  PT_CUPTI(cuptiProfilerInitialize, params);
}

/// The range profiler of the current context.
struct Profiler {
  Profiler(int device, CounterReplay replay_mode)
      : context((initialize_cupti(), current_context())),
        host(chip_name(device), counter_availability(context)),
        config(host.make_config()),
        replay(replay_mode) {
    PT_CUPTI_PARAMS(CUpti_RangeProfiler_Enable_Params, params);
    params.ctx = context;
    PT_CUPTI(cuptiRangeProfilerEnable, params);
    object = params.pRangeProfilerObject;
  }
  Profiler(const Profiler&) = delete;
  Profiler& operator=(const Profiler&) = delete;
  ~Profiler() {
    PT_CUPTI_PARAMS(CUpti_RangeProfiler_Disable_Params, params);
    params.pRangeProfilerObject = object;
    cupti().cuptiRangeProfilerDisable(&params);
  }

  int passes() {
    PT_CUPTI_PARAMS(CUpti_Profiler_Host_GetNumOfPasses_Params, params);
    params.configImageSize = config.size();
    params.pConfigImage = config.data();
    PT_CUPTI(cuptiProfilerHostGetNumOfPasses, params);
    return static_cast<int>(params.numOfPasses);
  }

  void prepare(std::size_t ranges) {
    PT_CUPTI_PARAMS(CUpti_RangeProfiler_GetCounterDataSize_Params, size);
    size.pRangeProfilerObject = object;
    size.pMetricNames = host.pointers();
    size.numMetrics = host.count();
    size.maxNumOfRanges = ranges;
    size.maxNumRangeTreeNodes = static_cast<std::uint32_t>(ranges);
    PT_CUPTI(cuptiRangeProfilerGetCounterDataSize, size);
    data.assign(size.counterDataSize, 0);
    PT_CUPTI_PARAMS(CUpti_RangeProfiler_CounterDataImage_Initialize_Params, init);
    init.pRangeProfilerObject = object;
    init.counterDataSize = data.size();
    init.pCounterData = data.data();
    PT_CUPTI(cuptiRangeProfilerCounterDataImageInitialize, init);
    PT_CUPTI_PARAMS(CUpti_RangeProfiler_SetConfig_Params, params);
    params.pRangeProfilerObject = object;
    params.configSize = config.size();
    params.pConfig = config.data();
    params.counterDataImageSize = data.size();
    params.pCounterDataImage = data.data();
    params.range = CUPTI_AutoRange;
    params.replayMode = replay == CounterReplay::user ? CUPTI_UserReplay : CUPTI_KernelReplay;
    params.maxRangesPerPass = ranges;
    params.numNestingLevels = 1;
    params.minNestingLevel = 1;
    params.passIndex = 0;
    params.targetNestingLevel = 1;
    PT_CUPTI(cuptiRangeProfilerSetConfig, params);
  }

  void start() {
    PT_CUPTI_PARAMS(CUpti_RangeProfiler_Start_Params, params);
    params.pRangeProfilerObject = object;
    PT_CUPTI(cuptiRangeProfilerStart, params);
  }

  /// Returns whether that was the last pass.
  bool stop() {
    PT_CUPTI_PARAMS(CUpti_RangeProfiler_Stop_Params, params);
    params.pRangeProfilerObject = object;
    PT_CUPTI(cuptiRangeProfilerStop, params);
    return params.isAllPassSubmitted != 0;
  }

  /// Gets the ranges; returns how many there are.
  std::size_t decode() {
    PT_CUPTI_PARAMS(CUpti_RangeProfiler_DecodeData_Params, decoding);
    decoding.pRangeProfilerObject = object;
    PT_CUPTI(cuptiRangeProfilerDecodeData, decoding);
    PT_CUPTI_PARAMS(CUpti_RangeProfiler_GetCounterDataInfo_Params, info);
    info.pCounterDataImage = data.data();
    info.counterDataImageSize = data.size();
    PT_CUPTI(cuptiRangeProfilerGetCounterDataInfo, info);
    return info.numTotalRanges;
  }

  /// The number of the launch that the range is: its name.
  std::size_t launch_of(std::size_t range) {
    PT_CUPTI_PARAMS(CUpti_RangeProfiler_CounterData_GetRangeInfo_Params, params);
    params.pCounterDataImage = data.data();
    params.counterDataImageSize = data.size();
    params.rangeIndex = range;
    params.rangeDelimiter = "/";
    PT_CUPTI(cuptiRangeProfilerCounterDataGetRangeInfo, params);
    const std::string name = params.rangeName != nullptr ? params.rangeName : "";
    std::size_t launch = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), launch);
    if (error != std::errc() || end != name.data() + name.size()) {
      throw CountersUnavailable(fmt::format(
          "CUPTI: range {} is called '{}': expected the number of a launch", range, name));
    }
    return launch;
  }

  CUcontext context;
  MetricHost host;
  Image config, data;
  CounterReplay replay;
  CUpti_RangeProfiler_Object* object = nullptr;
};

}  // namespace

std::vector<std::string> metrics_of_chip(const std::string& chip) {
  return MetricHost(chip).names();
}

HardwareCounters CounterSession::count(const std::function<void()>& render) {
  launches_.clear();
  render();
  const std::vector<LaunchCounters> expected = launches_;
  HardwareCounters result;
  result.launches = expected;
  if (expected.size() > launches_max) result.launches.resize(launches_max);
  result.uncounted_launches = expected.size() - result.launches.size();
  Profiler profiler(device_, replay_);
  profiler.prepare(result.launches.size());
  const int passes_max = 2 * profiler.passes() + 2;  // whatever else CUPTI may want
  for (bool done = false; !done;) {
    if (++result.passes > passes_max) {
      throw CountersUnavailable(fmt::format("CUPTI: is not content with {} passes; it announced {}",
                                            passes_max, profiler.passes()));
    }
    profiler.start();
    launches_.clear();
    render();
    check_cuda(cudaDeviceSynchronize(), "rendering under the profiler");
    done = profiler.stop();
    check_launches(expected);
  }
  const std::size_t ranges = profiler.decode();
  if (ranges != result.launches.size()) {
    throw CountersUnavailable(fmt::format("CUPTI: counted {} launches, the render made {}", ranges,
                                          result.launches.size()));
  }
  for (std::size_t range = 0; range < ranges; ++range) {
    result.launches.at(profiler.launch_of(range)).values =
        profiler.host.evaluate(profiler.data, range);
  }
  return result;
}

#else  // without the headers

std::vector<std::string> metrics_of_chip(const std::string&) {
  throw CountersUnavailable(
      fmt::format("this program was built without CUPTI's range profiler: CUDA {}.{} has no "
                  "cupti_range_profiler.h, expected 12.6 or newer",
                  CUDART_VERSION / 1000, CUDART_VERSION % 1000 / 10));
}

HardwareCounters CounterSession::count(const std::function<void()>&) {
  metrics_of_chip("");
  return {};
}

#endif

void CounterSession::note_launch(const char* kernel, int wave) {
  launches_.push_back({kernel, wave, {}, {}});
}

void CounterSession::check_launches(const std::vector<LaunchCounters>& expected) const {
  const auto same = [](const LaunchCounters& a, const LaunchCounters& b) {
    return a.kernel == b.kernel && a.wave == b.wave;
  };
  if (std::ranges::equal(launches_, expected, same)) return;
  throw CountersUnavailable(
      fmt::format("the render launched {} kernels in one pass and {} in another, or others; "
                  "expected the same",
                  expected.size(), launches_.size()));
}

}  // namespace pt
