// Scenes with media, and scenes that move.
#include "wavefront/fly_queue.cuh"
#include "wavefront/wavefront_enqueue.cuh"

namespace pt {

void WavefrontCuda::fly_queue(const StageQueues& queues, const SampleBuffer& samples) {
  const auto kernel = traits_.has_sparse ? fly_flights_of_queue<QueuedFlights, true>
                                         : fly_flights_of_queue<QueuedFlights, false>;
  const std::uint32_t blocks =
      resident_blocks(reinterpret_cast<const void*>(kernel), flight_block, 0);
  constexpr StageId id = StageId::sample_medium;
  launch(stage_info(id).name.data(), kernel, blocks, flight_block, 0,
         QueuedFlights{scene_, buffers_.pool, samples, queues, &buffers_.counters->flown}, clock());
}

using SamplerContext = StageContext<SamplerSource>;
using MediaKinds = WaveKinds<SamplerSource, true>;

template void WavefrontCuda::enqueue_wave_of<MediaKinds>(const SamplerContext&, bool);
template void WavefrontCuda::enqueue_finish_of<MediaKinds>(const SamplerContext&);

using MovingKinds = WaveKinds<SamplerSource, false, true>;

template void WavefrontCuda::enqueue_wave_of<MovingKinds>(const SamplerContext&, bool);
template void WavefrontCuda::enqueue_finish_of<MovingKinds>(const SamplerContext&);

using MovingMediaKinds = WaveKinds<SamplerSource, true, true>;

template void WavefrontCuda::enqueue_wave_of<MovingMediaKinds>(const SamplerContext&, bool);
template void WavefrontCuda::enqueue_finish_of<MovingMediaKinds>(const SamplerContext&);

}  // namespace pt
