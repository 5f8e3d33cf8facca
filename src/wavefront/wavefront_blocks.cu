// The last paths, followed to their ends by block-local wavefronts.
#include "wavefront/wavefront_enqueue.cuh"

namespace pt {

void WavefrontCuda::finish_in_blocks(const SampleBuffer& batch) {
  if (host_counters_->finish == 0) return;
  const BegunPaths paths = blocks_->place(host_counters_->finish);
  run(HandOver{buffers_.pool, batch, paths},
      buffers_.stage_queues(StageId::hand_over, &buffers_.counters->finish, nullptr));
  blocks_->finish(scene_, batch, sampler_source_of(plan_), path_settings_, StageId::finish, paths);
}

}  // namespace pt
