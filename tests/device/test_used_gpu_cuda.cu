// Parts of a GPU by green contexts: with a driver that is none, and on a GPU.
#include <cstring>
#include <set>

#include "common/cuda/cuda_memory.cuh"
#include "common/cuda/used_gpu.cuh"
#include "common/device/cuda/counter_session_cuda.h"
#include "common/error/error.h"
#include "common/rays/trace_rays.h"
#include "common/scene/builtin/generated_scenes.h"
#include "cuda_test.h"
#include "mode_cases.h"
#include "temp_folder.h"
#include "wavefront/measure/measure_compaction.h"

namespace pt {
namespace {

/// A driver of a GPU of 132 multiprocessors that come in eights. It keeps count of what is made.
struct FakeDriver {
  std::string failing;  ///< the call that returns an error
  std::string missing;  ///< the function that it lacks
  int made = 0, destroyed = 0;
  CUcontext current = nullptr;
} fake;

CUresult outcome(const char* name) {
  return fake.failing == name ? CUDA_ERROR_OUT_OF_MEMORY : CUDA_SUCCESS;
}

CUgreenCtx green_handle() { return reinterpret_cast<CUgreenCtx>(&fake.made); }
CUcontext context_handle() { return reinterpret_cast<CUcontext>(&fake.current); }

const GreenDriver fake_driver = {
    .error_string = [](CUresult, const char** text) { return *text = "is full", CUDA_SUCCESS; },
    .device = [](CUdevice* device, int index) { return *device = index, outcome("cuDeviceGet"); },
    .resource =
        [](CUdevice, CUdevResource* all, CUdevResourceType type) {
          all->type = type;
          all->sm.smCount = 132;
          return outcome("cuDeviceGetDevResource");
        },
    .split =
        [](CUdevResource* part, unsigned* groups, const CUdevResource* all, CUdevResource*,
           unsigned, unsigned least) {
          *part = *all;
          part->sm.smCount = (least + 7) / 8 * 8;
          if (part->sm.smCount > all->sm.smCount) return CUDA_ERROR_INVALID_RESOURCE_CONFIGURATION;
          if (fake.failing == "no group") *groups = 0;
          return outcome("cuDevSmResourceSplitByCount");
        },
    .describe = [](CUdevResourceDesc*, CUdevResource*,
                   unsigned) { return outcome("cuDevResourceGenerateDesc"); },
    .create =
        [](CUgreenCtx* green, CUdevResourceDesc, CUdevice, unsigned flags) {
          EXPECT_EQ(flags, unsigned{CU_GREEN_CTX_DEFAULT_STREAM});
          const CUresult result = outcome("cuGreenCtxCreate");
          if (result == CUDA_SUCCESS) *green = green_handle(), ++fake.made;
          return result;
        },
    .destroy =
        [](CUgreenCtx green) {
          EXPECT_EQ(green, green_handle());
          return ++fake.destroyed, CUDA_SUCCESS;
        },
    .context_of =
        [](CUcontext* context, CUgreenCtx) {
          *context = context_handle();
          return outcome("cuCtxFromGreenCtx");
        },
    .set_current =
        [](CUcontext context) {
          const CUresult result = outcome("cuCtxSetCurrent");
          if (result == CUDA_SUCCESS) fake.current = context;
          return result;
        },
};

TEST(GreenContext, IsUsedAndDestroyed) {
  fake = {};
  {
    const GreenContext context(fake_driver, 0, 16);
    EXPECT_EQ(context.whole(), 132);
    context.use();
    EXPECT_EQ(fake.current, context_handle());
    EXPECT_EQ(fake.destroyed, 0);
  }
  EXPECT_EQ(fake.made, 1);
  EXPECT_EQ(fake.destroyed, 1);
}

TEST(GreenContext, NamesTheCallThatFailsAndReleasesWhatWasMade) {
  for (const char* name :
       {"cuDeviceGet", "cuDeviceGetDevResource", "cuDevSmResourceSplitByCount",
        "cuDevResourceGenerateDesc", "cuGreenCtxCreate", "cuCtxFromGreenCtx", "cuCtxSetCurrent"}) {
    SCOPED_TRACE(name);
    fake = {};
    fake.failing = name;
    expect_error([] { GreenContext(fake_driver, 0, 16).use(); },
                 std::string("--sms 16: ") + name + ": is full");
    EXPECT_EQ(fake.made, fake.destroyed);
    EXPECT_EQ(fake.current, nullptr);
  }
}

TEST(GreenContext, RefusesWhatTheDriverDoesNotDivideOff) {
  fake = {};
  const auto make = [](int sms) { GreenContext(fake_driver, 0, sms); };
  expect_error([&] { make(20); },
               "--sms 20: of this GPU's 132 multiprocessors the driver gives 24 instead");
  expect_error([&] { make(130); },
               "--sms 130: of this GPU's 132 multiprocessors the driver gives 0 instead");
  fake.failing = "no group";
  expect_error([&] { make(16); },
               "--sms 16: of this GPU's 132 multiprocessors the driver gives 0 instead");
  EXPECT_EQ(fake.made, 0);
}

TEST(GreenContext, WantsADriverThatHasAllFunctions) {
  const auto find = [](const char* name) -> void* {
    return fake.missing == name ? nullptr : &fake;
  };
  for (const char* name :
       {"cuGetErrorString", "cuDeviceGet", "cuDeviceGetDevResource", "cuDevSmResourceSplitByCount",
        "cuDevResourceGenerateDesc", "cuGreenCtxCreate", "cuGreenCtxDestroy", "cuCtxFromGreenCtx",
        "cuCtxSetCurrent"}) {
    fake.missing = name;
    expect_error([&] { load_green_driver(find); }, std::string("--sms: the driver has no ") + name +
                                                       "; expected one of CUDA 12.4 or newer");
  }
  fake.missing = "";
  EXPECT_EQ(reinterpret_cast<void*>(load_green_driver(find).split), &fake);
}

__global__ void note_multiprocessor(unsigned* used, unsigned turns) {
  unsigned id = 0;
  asm volatile("mov.u32 %0, %%smid;" : "=r"(id));
  if (threadIdx.x == 0) used[blockIdx.x] = id;
  for (unsigned i = 0; i < turns; ++i) __nanosleep(1000);  // others go elsewhere
}

class CudaUsedGpu : public CudaTest {
 protected:
  void SetUp() override {
    CudaTest::SetUp();
    if (IsSkipped()) return;
    index = choose_device({}).choice.index;
    try {
      const UsedGpu part(index, 16);
    } catch (const Error& error) {
      GTEST_SKIP() << error.what();
    }
  }

  void TearDown() override {
    if (!IsSkipped()) const UsedGpu whole(index);
  }

  /// Multiprocessors that have run blocks of a kernel on the stream, launched there or by a graph.
  static std::size_t count_used(cudaStream_t stream, bool in_graph = false) {
    constexpr int blocks = 2048;
    const DeviceArray<unsigned> used(blocks);
    if (in_graph) check_cuda(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal), "");
    note_multiprocessor<<<blocks, 1024, 0, stream>>>(used.data(), 20);
    check_cuda(cudaGetLastError(), "note_multiprocessor");
    if (in_graph) {
      cudaGraph_t graph{};
      cudaGraphExec_t launched{};
      check_cuda(cudaStreamEndCapture(stream, &graph), "cudaStreamEndCapture");
      check_cuda(cudaGraphInstantiate(&launched, graph, 0), "cudaGraphInstantiate");
      check_cuda(cudaGraphLaunch(launched, stream), "cudaGraphLaunch");
      check_cuda(cudaStreamSynchronize(stream), "cudaGraphLaunch");
      cudaGraphExecDestroy(launched);
      cudaGraphDestroy(graph);
    }
    check_cuda(cudaStreamSynchronize(stream), "note_multiprocessor");
    const std::vector<unsigned> ids = used.download();
    return std::set<unsigned>(ids.begin(), ids.end()).size();
  }

  int index = 0;
};

TEST_F(CudaUsedGpu, KernelsRunOnSoManyMultiprocessors) {
  const UsedGpu whole(index);
  const int all = used_multiprocessors();
  EXPECT_EQ(count_used(nullptr), static_cast<std::size_t>(all));
  for (const int sms : {8, 16, 32, 64}) {
    SCOPED_TRACE(sms);
    const UsedGpu part(index, sms);
    EXPECT_EQ(part.part_text(),
              ", " + std::to_string(sms) + " of " + std::to_string(all) + " multiprocessors");
    EXPECT_EQ(used_multiprocessors(), sms);
    EXPECT_EQ(count_used(nullptr), static_cast<std::size_t>(sms));
    cudaStream_t stream = nullptr;
    check_cuda(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "cudaStreamCreate");
    EXPECT_EQ(count_used(stream), static_cast<std::size_t>(sms));
    EXPECT_EQ(count_used(stream, true), static_cast<std::size_t>(sms));
    cudaStreamDestroy(stream);
    whole.use();
    EXPECT_EQ(used_multiprocessors(), all);
    EXPECT_EQ(count_used(nullptr), static_cast<std::size_t>(all));
  }
  EXPECT_FALSE(UsedGpu(index, all).is_part());
}

TEST_F(CudaUsedGpu, ReachingAGpuKeepsItsPart) {
  const UsedGpu part(index, 16);
  reach_gpu(index);
  EXPECT_EQ(used_multiprocessors(), 16);
  // A large upload takes several threads, this one included.
  CudaMemory memory;
  const std::vector<char> bytes(std::size_t{48} << 20, 'x');
  const char* const there = memory.upload("bytes", bytes);
  std::vector<char> back(bytes.size());
  check_cuda(cudaMemcpy(back.data(), there, back.size(), cudaMemcpyDeviceToHost), "cudaMemcpy");
  EXPECT_EQ(back, bytes);
  EXPECT_EQ(count_used(nullptr), 16u);
}

TEST_F(CudaUsedGpu, RefusesOtherNumbers) {
  const int all = used_multiprocessors();
  expect_error([&] { UsedGpu(index, all - 1); }, "instead; expected a number that it gives");
}

TEST_F(CudaUsedGpu, ImagesKeepTheirBits) {
  const std::vector<Settings> ways{
      {{"scene", "spheres"}, {"mode", "megakernel"}},
      {{"scene", "spheres"}, {"mode", "wavefront"}, {"schedule", "graph"}},
      {{"scene", "spheres"}, {"mode", "wavefront"}, {"schedule", "host"}},
      {{"scene", "spheres"}, {"create-world", "device"}, {"mode", "wavefront"}},
      {{"scene", "cornell"}, {"mode", "wavefront"}, {"compaction", "cub"}, {"finish-paths", "0"}},
      {{"scene", "statue:3K"}, {"mode", "megakernel"}, {"kernel", "sort"}},
      {{"scene", "statue:3K"}, {"mode", "megakernel"}, {"kernel", "vote"}},
      {{"scene", "statue:3K"}, {"mode", "wavefront"}, {"builder", "hploc-reinsert"}},
      {{"scene", "statue:3K"}, {"mode", "wavefront"}, {"schedule", "host"}},
      {{"scene", "dial:4:0:closed"}, {"mode", "wavefront"}, {"order-surfaces", "on"}},
      {{"scene", "cornell"}, {"integrator", "mlt"}, {"mode", "wavefront"}, {"chains", "4096"}}};
  for (const Settings& way : ways) {
    Options options = with(Options(), {{"width", "160"}, {"height", "90"}, {"spp", "5"}});
    apply(options, {{"device", "cuda"}, {"max-depth", "6"}});
    apply(options, way);
    SCOPED_TRACE(command_of(options));
    const Rendered whole = render_options(options);
    const Rendered part = render_options(with(options, {{"sms", "16"}}));
    EXPECT_EQ(part.image.rgb, whole.image.rgb);
    EXPECT_EQ(part.counts.rays, whole.counts.rays);
  }
}

TEST_F(CudaUsedGpu, SmallerBlocksKeepTheBits) {
  Options options = with(Options(), {{"width", "160"}, {"height", "90"}, {"spp", "5"}});
  apply(options, {{"device", "cuda"}, {"scene", "statue:3K"}, {"mode", "megakernel"}});
  apply(options, {{"accel", "cwbvh"}});  // with which blocks of 48 KiB leave warps that vote
  const Rendered whole = render_options(options);
  for (const char* kib : {"100", "64", "48"}) {
    SCOPED_TRACE(kib);
    const Options smaller = with(options, {{"shared-memory-max", kib}});
    EXPECT_EQ(render_options(smaller).image.rgb, whole.image.rgb);
  }
}

TEST_F(CudaUsedGpu, SizesKernelsByItsPart) {
  Options options = cuda_options("megakernel", {{"scene", "spheres"}, {"sms", "16"}});
  apply(options, {{"width", "64"}, {"height", "64"}, {"spp", "2"}});
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  const auto renderer = make_renderer(options, scene, device);
  renderer->render({});
  const RenderReport report = report_of(*renderer);
  EXPECT_TRUE(report.device_name.find(", 16 of ") != std::string::npos) << report.device_name;
  ASSERT_FALSE(report.kernels.empty());
  for (const KernelInfo& kernel : report.kernels) EXPECT_LE(kernel.occupancy, 1.0) << kernel.name;
  EXPECT_THROW(renderer->count_hardware(), CountersUnavailable);
}

TEST_F(CudaUsedGpu, RaysFindTheSameAndCompactionKeepsItsContract) {
  const Mesh mesh = generate_terrain(5000);
  TreeOptions options;
  options.accel = AccelKind::cwbvh;
  RaySet rays;
  for (int i = 0; i < 5000; ++i)
    rays.rays.push_back(
        {Vec3(0.0002f * float(i) - 0.5f, 9.0f, 0.1f), 0.0f, Vec3(0.01f, -1, 0.02f), 1000.0f});
  options.builder = TreeBuilder::hploc;
  const auto trace = [&](int sms) {
    return build_and_trace_cuda({&mesh, 1}, {}, options, rays, {TraceVariant::persistent}, index,
                                sms)
        .result.hits;
  };
  const auto whole = trace(0), part = trace(16);
  ASSERT_EQ(whole.size(), part.size());
  EXPECT_EQ(std::memcmp(whole.data(), part.data(), whole.size() * sizeof whole[0]), 0);
  const CompactionCase slots{1u << 18, 0.5f, 1, 2};
  const std::vector<StageId> tags = make_tags(slots);
  const auto compaction = make_compaction_cuda(index, 16);
  for (const Compaction strategy : {Compaction::atomic, Compaction::scan, Compaction::cub})
    EXPECT_EQ(contract_breach(strategy, tags, compaction->compact(strategy, tags, 2)), "");
}

}  // namespace
}  // namespace pt
