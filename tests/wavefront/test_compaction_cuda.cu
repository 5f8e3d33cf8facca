// Compaction on CUDA; the tests are in compaction_cases.h.
#include "compaction_cases.h"
#include "cuda_test.h"
#include "wavefront/compaction_cuda.h"
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
