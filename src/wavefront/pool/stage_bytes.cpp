#include "wavefront/pool/stage_bytes.h"

#include <string_view>

namespace pt {
namespace {

constexpr double record = sizeof(PathRecord), index = sizeof(std::uint32_t), tag = sizeof(StageId);
constexpr double sample = sizeof(Sample), radiance = sizeof(Color);

class Predictor {
 public:
  Predictor(const WaveFlow& flow, const WaveLayout& layout) : flow_(flow), layout_(layout) {}

  PredictedBytes generate() const {
    const double sample_bytes = layout_.fields.lights ? sample : 0;
    const double ray_index = layout_.has_queues ? index : 0;
    const bool has_input = layout_.queues_free || !layout_.has_queues;
    return {has_input ? find(flow_.generated) : 0,
            flow_.generated * (2 * record + extra() + ray_index + sample_bytes + own_tag())};
  }

  PredictedBytes intersect() const {
    const double n = flow_.rays, stored = layout_.persistent ? n : n - flow_.misses;
    const double sent = layout_.persistent ? 0 : n * send();
    return {find(n) + n * 2 * record, stored * hit() + sent};
  }

  PredictedBytes route_hits() const {
    return {find(flow_.rays) + flow_.rays * sizeof(StoredHit), flow_.rays * send()};
  }

  PredictedBytes shade_miss() const {
    const double n = flow_.misses;
    // The direction alone, but where it shares a sector with the origin both move.
    const bool whole = layout_.all_lights || layout_.fields.layout == PoolLayout::sectors;
    const double ray = whole ? 2 * record : record;
    return {find(n) + n * (ray + old_path() + extra() + before()), n * (sample + free())};
  }

  PredictedBytes shade_surface() const {
    const double n = flow_.surfaces, alive = flow_.continued, ended = n - alive;
    const double shadows = flow_.shadows;
    const double loaded = 2 * record + old_path() + hit() + receiver() + extra();
    return {find(n) + n * loaded + ended * before(),
            alive * (3 * record + receiver() + extra() + send()) + ended * (sample + free()) +
                shadows * (3 * record + (layout_.appends ? index : 0)) +
                (layout_.fields.lights && !layout_.appends ? n * tag : 0)};
  }

  PredictedBytes shadow() const {
    const double n = flow_.shadows;
    return {find(n) + n * (3 * record + radiance), n * (radiance + own_tag())};
  }

  PredictedBytes bounce() const {
    // The pool holds the whole batch, and its first wave begins all paths.
    const bool starts = layout_.appends && !layout_.queues_free && flow_.generated > 0;
    const double n = flow_.rays, alive = flow_.continued, ended = flow_.rays - alive;
    const double loaded = 2 * record + old_path() + receiver() + before();
    const double sample_bytes = layout_.fields.lights ? sample : 0;
    return {starts ? 0 : find(n) + n * loaded,
            alive * (3 * record + receiver() + sample_bytes + send()) + ended * (sample + free())};
  }

  PredictedBytes finish() const {
    const double n = flow_.finished;
    return {find(n) + n * (3 * record + receiver() + before()), n * (sample + own_tag())};
  }

  PredictedBytes order_tiles() const {
    return {flow_.surfaces * (index + hit()), flow_.surfaces * index};
  }

 private:
  /// To find the `n` slots that wait.
  double find(double n) const { return layout_.has_queues ? n * index : layout_.slots * tag; }
  /// To send a slot on.
  double send() const { return layout_.appends ? index : tag; }
  /// To give a slot back.
  double free() const {
    if (!layout_.appends) return tag;
    return layout_.queues_free ? index : 0;
  }
  /// The bytes of a slot's own tag, which stages that append do not have.
  double own_tag() const { return layout_.appends ? 0 : tag; }
  double hit() const {
    return sizeof(StoredHit) + (layout_.fields.instances ? sizeof(std::uint32_t) : 0);
  }
  /// The records of --path-bytes, which each ray loads and, if its path goes on, stores.
  double extra() const { return record * layout_.fields.extra_records; }
  double receiver() const { return layout_.fields.receivers ? sizeof(Receiver) : 0; }
  /// What has happened to a path; nothing has to a new one.
  double old_path() const {
    return flow_.rays > 0 ? record * (1 - flow_.generated / flow_.rays) : 0;
  }
  /// The radiance that lights have added.
  double before() const { return layout_.fields.lights ? radiance : 0; }

  const WaveFlow& flow_;
  const WaveLayout& layout_;
};

/// The kernels by the names of the statistics.
struct PredictedKernel {
  std::string_view name;
  PredictedBytes (Predictor::*bytes)() const;
};
constexpr PredictedKernel predicted_kernels[] = {
    {stage_info(StageId::generate).name, &Predictor::generate},
    {stage_info(StageId::intersect).name, &Predictor::intersect},
    {stage_info(StageId::route_hits).name, &Predictor::route_hits},
    {stage_info(StageId::shade_miss).name, &Predictor::shade_miss},
    {stage_info(StageId::shadow).name, &Predictor::shadow},
    {stage_info(StageId::bounce).name, &Predictor::bounce},
    {stage_info(StageId::finish).name, &Predictor::finish},
    {stage_info(StageId::shade_surface).name, &Predictor::shade_surface},
    {"order_tiles", &Predictor::order_tiles}};

}  // namespace

WaveFlow flow_of(const WaveCounters& counters) {
  const auto waiting = [&](StageId id) { return counters.waiting[queue_index(id)]; };
  WaveFlow flow;
  flow.generated = counters.generate;
  flow.rays = counters.intersect;
  flow.misses = waiting(StageId::shade_miss);
  flow.surfaces = waiting(StageId::shade_surface);
  flow.shadows = waiting(StageId::shadow);
  flow.finished = counters.finish;
  return flow;
}

PredictedBytes predict_bytes(const std::string& kernel, const WaveFlow& flow,
                             const WaveLayout& layout) {
  const Predictor predict(flow, layout);
  for (const PredictedKernel& one : predicted_kernels) {
    if (one.name == kernel) return (predict.*one.bytes)();
  }
  return {};
}

}  // namespace pt
