#include "serial/serial.h"

#include "common/device/cpu/cpu_renderer.h"
#include "common/transport/follow_path.h"

namespace pt {
namespace {

class SerialRenderer : public CpuRenderer {
 public:
  SerialRenderer(const ExecutionPlan& plan, const SceneData& scene) : CpuRenderer(plan, scene) {}

 private:
  bool can_repeat_paths() const override { return false; }  // the plain reference

  void trace_batch(const SampleBuffer& batch) override {
    with_random_source(batch, [&](const auto& source) {
      using Source = std::remove_cvref_t<decltype(source)>;
      dispatch_traits(CpuKindsWith<Source>{}, traits_, [&](auto traits) {
        timer_.time("serial", [&] { trace_all<decltype(traits)>(source, batch); });
      });
    });
  }

  template <class Traits, class Source>
  void trace_all(const Source& source, const SampleBuffer& batch) {
    for (std::uint32_t i = 0; i < batch.path_count && !is_cancelled(); ++i) {
      const PathId id = batch.id_of(i);
      auto random = source.open(id);
      PathState path;
      path.index = i;
      set_time<Traits>(scene_, id, path);
      const Ray ray = begin_path<Traits::has_motion>(scene_, id, random, path.time);
      batch.store(path, follow_path<Traits>(scene_, ray, path, Color(0.0f), path_settings_, random,
                                            path_hash<Traits>(scene_, id)));
    }
  }
};

}  // namespace

std::unique_ptr<Renderer> make_serial_renderer(const ExecutionPlan& plan, const SceneData& scene) {
  return std::make_unique<SerialRenderer>(plan, scene);
}

}  // namespace pt
