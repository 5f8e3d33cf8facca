// Compaction on CUDA; the tests are in compaction_cases.h.
#include "compaction_cases.h"
#include "cuda_test.h"
#include "temp_folder.h"
#include "wavefront/compaction/compaction_cuda.h"
#include "wavefront/stage_kernel.cuh"

namespace pt {
namespace {

class CudaDevice {
 public:
  static constexpr const char* name = "CUDA";
  static constexpr int pass_queues_max = 2;
  struct Shape {
    int block;
    std::uint32_t blocks_max;
    std::string text() const {
      return std::to_string(blocks_max) + " blocks of " + std::to_string(block) + " threads";
    }
  };

  static bool available() { return has_cuda_device(); }

  static std::vector<Shape> shapes() {
    std::vector<Shape> shapes{{256, 1000}};
    for (const int block : {1, 2, 3, 16, 32, 33, 48, 64, 96, 256, 1023, 1024}) {
      for (const std::uint32_t blocks_max : {1u, 3u, 100000u})
        shapes.push_back({block, blocks_max});
    }
    return shapes;
  }

  void* allocate(std::size_t size_bytes) {
    void* memory = nullptr;
    check_cuda(cudaMalloc(&memory, size_bytes), "cudaMalloc");
    return memory;
  }
  void release(void* memory) { cudaFree(memory); }
  void upload(void* to, const void* from, std::size_t size_bytes) {
    check_cuda(cudaMemcpy(to, from, size_bytes, cudaMemcpyHostToDevice), "upload");
  }
  void download(void* to, const void* from, std::size_t size_bytes) {
    check_cuda(cudaMemcpy(to, from, size_bytes, cudaMemcpyDeviceToHost), "download");
  }

  Compactor compactor(TagPass pass, std::uint32_t slot_count_max) {
    const auto memory = std::make_shared<CudaMemory>();
    const auto compactor = std::make_shared<CudaCompactor>(pass, slot_count_max, *memory);
    return [this, memory, compactor](const CompactionRequest& request) {
      compactor->enqueue(request, clock_.data(), nullptr);
      check_cuda(cudaDeviceSynchronize(), "compact");
    };
  }

  template <class Stage>
  void run(const Stage& stage, const StageQueues& queues, const Shape& shape) {
    std::uint32_t count = 0;
    download(&count, queues.count, sizeof count);
    const auto block = static_cast<std::uint32_t>(shape.block);
    const std::uint32_t blocks = std::clamp((count + block - 1) / block, 1u, shape.blocks_max);
    constexpr SceneMemory memory = SceneMemory::global;
    stage_kernel<Stage, memory>
        <<<blocks, block>>>(SceneStorage<memory>{Scene{}}, stage, queues, clock_.data());
    check_cuda(cudaGetLastError(), shape.text().c_str());
    check_cuda(cudaDeviceSynchronize(), shape.text().c_str());
  }

 private:
  DeviceArray<StageClock> clock_{std::vector<StageClock>(1)};
};

INSTANTIATE_TYPED_TEST_SUITE_P(Cuda, CompactionOf, CudaDevice);

class CudaCompactorTest : public CudaTest {};

TEST_F(CudaCompactorTest, RefusesMoreSlotsThanAnnounced) {
  CudaDevice device;
  for (const CompactionInfo& strategy : pass_strategies) {
    PassTest<CudaDevice> test(device, strategy.pass, 1000, 999);
    test.expect_refusal([](CompactionRequest& r) { r.wanted[1] = StageId::shade_miss; },
                        "1000 slots; expected at most the 999 announced");
  }
}

// A tile's size follows from the slots announced, however few come.
TEST_F(CudaCompactorTest, ScansTilesOfAllSizes) {
  CudaDevice device;
  for (const std::uint32_t announced : {0u, 1u << 23, 1u << 24, 1u << 25, 1u << 26, 1u << 28}) {
    for (const std::uint32_t n : {0u, 5u, 8193u, 16384u, 70001u}) {
      SCOPED_TRACE(testing::Message() << n << " slots of " << announced);
      PassTest<CudaDevice> test(device, TagPass::scan, n, std::max(n, announced));
      for (const RolePattern& pattern : role_patterns) {
        test.expect_pass(make_roles(pattern, n), tag_meanings[0]);
      }
    }
  }
}

// Stores of four slots go to multiples of 16 bytes, wherever a queue begins.
TEST_F(CudaCompactorTest, ScansToAnyPlace) {
  constexpr std::uint32_t n = 20000;
  std::vector<StageId> tags;
  for (std::uint32_t i = 0; i < n; ++i) {
    tags.push_back(random_role(i, 0.5) == Role::first ? StageId::shade_miss : free_slot);
  }
  const DeviceArray<StageId> device_tags{tags};
  const DeviceArray<std::uint32_t> counts(2);
  CudaMemory memory;
  const CudaCompactor compactor(TagPass::scan, n, memory);
  CompactionRequest request;
  request.tags = device_tags.data(), request.slot_count = request.capacity = n;
  request.queues_wanted = 1, request.wanted[0] = StageId::shade_miss;
  request.counts = counts.data();
  for (std::uint32_t offset = 0; offset < 4; ++offset) {
    const DeviceArray<std::uint32_t> queue{Slots(n + 8, poison)};
    request.queues[0] = queue.data() + offset;
    compactor.enqueue(request, nullptr, nullptr);
    Slots expected(offset, poison);
    for (std::uint32_t i = 0; i < n; ++i) {
      if (tags[i] == StageId::shade_miss) expected.push_back(i);
    }
    EXPECT_EQ(counts.download()[0], expected.size() - offset);
    expected.resize(n + 8, poison);
    expect_equal_arrays(queue.download(), expected, "queue at " + std::to_string(offset));
  }
  request.tags += 8;
  request.slot_count = n - 8;
  expect_error([&] { compactor.enqueue(request, nullptr, nullptr); }, "a multiple of 16 bytes");
}

// Nothing resets the state of the tiles between two launches, in a graph neither.
TEST_F(CudaCompactorTest, ScansInAGraphThatIsLaunchedAgain) {
  constexpr std::uint32_t n = 100000;
  const DeviceArray<StageId> tags{std::vector<StageId>(n, free_slot)};
  const DeviceArray<std::uint32_t> queue(n), counts(2);
  CudaMemory memory;
  const CudaCompactor compactor(TagPass::scan, n, memory);
  CompactionRequest request;
  request.tags = tags.data(), request.slot_count = request.capacity = n;
  request.queues_wanted = 1, request.wanted[0] = StageId::shade_miss;
  request.queues[0] = queue.data(), request.counts = counts.data();
  cudaStream_t stream = nullptr;
  cudaGraph_t graph = nullptr;
  cudaGraphExec_t exec = nullptr;
  check_cuda(cudaStreamCreate(&stream), "cudaStreamCreate");
  check_cuda(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal), "capture");
  for (int i = 0; i < 3; ++i) compactor.enqueue(request, nullptr, stream);
  check_cuda(cudaStreamEndCapture(stream, &graph), "capture");
  check_cuda(cudaGraphInstantiate(&exec, graph, 0), "cudaGraphInstantiate");
  for (std::uint32_t waiting = 1; waiting <= n; waiting *= 10) {
    std::vector<StageId> now(n, free_slot);
    std::fill_n(now.end() - waiting, waiting, StageId::shade_miss);
    check_cuda(cudaMemcpy(tags.data(), now.data(), n, cudaMemcpyHostToDevice), "upload");
    check_cuda(cudaGraphLaunch(exec, stream), "cudaGraphLaunch");
    check_cuda(cudaStreamSynchronize(stream), "scan");
    EXPECT_EQ(counts.download()[0], waiting);
    EXPECT_EQ(queue.download()[waiting - 1], n - 1);
  }
  cudaGraphExecDestroy(exec);
  cudaGraphDestroy(graph);
  cudaStreamDestroy(stream);
}

// CUB asks each slot once, which is how the clock knows of a pass.
TEST_F(CudaCompactorTest, StampsTheClockOncePerPass) {
  const DeviceArray<StageId> tags{std::vector<StageId>(5000, StageId::shade_miss)};
  const DeviceArray<std::uint32_t> first(5000), second(5000), counts(2);
  for (const CompactionInfo& strategy : pass_strategies) {
    for (const int queues : {1, 2}) {
      const DeviceArray<StageClock> clock{std::vector<StageClock>(1)};
      CudaMemory memory;
      const CudaCompactor compactor(strategy.pass, 5000, memory);
      CompactionRequest request;
      request.tags = tags.data(), request.slot_count = 5000, request.queues_wanted = queues;
      request.wanted[0] = StageId::shade_miss, request.wanted[1] = free_slot;
      request.queues[0] = first.data(), request.queues[1] = second.data();
      request.capacity = 5000, request.counts = counts.data();
      for (int i = 0; i < 3; ++i) compactor.enqueue(request, clock.data(), nullptr);
      compactor.enqueue(request, nullptr, nullptr);
      EXPECT_EQ(clock.download()[0].launches[static_cast<int>(StageId::compact)], 3u)
          << strategy.name << ", " << queues;
      EXPECT_EQ(counts.download()[0], 5000u);
      EXPECT_TRUE(queues == 1 || counts.download()[1] == 0);
    }
  }
}

}  // namespace
}  // namespace pt
