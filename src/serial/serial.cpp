#include "serial/serial.h"

#include "common/device/cpu_renderer.h"
#include "common/transport/generate_camera_path.h"
#include "common/transport/shade_miss.h"
#include "common/transport/shade_surface.h"

namespace pt {
namespace {

/// One path from the camera to its end: the whole algorithm, in the order of the textbooks.
template <class Traits, class Stream>
Color trace_path(const Scene& scene, std::uint32_t pixel, PathState& path, Stream& random,
                 const PathLimits& limits) {
  Color radiance(0.0f);
  Ray ray = generate_camera_path(scene, pixel, random.draw(scatter_block(0)));
  for (;;) {
    const Hit hit = intersect_closest<Traits>(scene, ray);
    ++path.rays;
    if (hit.is_miss())
      return add_rounded(radiance, shade_miss<Traits::lighting>(scene, ray.direction, path));

    const Vec4 u = random.draw(scatter_block(path.rays));
    const Vec4 light = Traits::has_lights ? random.draw(light_block(path.rays)) : Vec4(0.0f);
    const Scattering scattering = shade_surface<Traits>(scene, ray, hit, path, limits, u, light);
    radiance = add_rounded(radiance, scattering.emitted);
    if (!is_black(scattering.shadow.radiance) &&
        !intersect_shadow<Traits>(scene, scattering.shadow)) {
      radiance = add_rounded(radiance, scattering.shadow.radiance);
    }
    if (!scattering.alive) return radiance;
    ray = scattering.ray;
  }
}

class SerialRenderer : public CpuRenderer {
 public:
  SerialRenderer(const Options& options, const SceneData& scene) : CpuRenderer(options, scene, 1) {}

 private:
  void trace_batch(const SampleBuffer& batch) override {
    with_random_source(batch, [&](const auto& source) {
      using Source = std::remove_cvref_t<decltype(source)>;
      dispatch_traits(KindsWith<Source, CpuSceneKinds>{}, traits_, [&](auto traits) {
        timer_.time("serial", [&] { trace_all<decltype(traits)>(source, batch); });
      });
    });
  }

  template <class Traits, class Source>
  void trace_all(const Source& source, const SampleBuffer& batch) {
    for (std::uint32_t i = 0; i < batch.path_count; ++i) {
      const PathId id = batch.id_of(i);
      PathState path;
      path.number = i;
      auto random = source.open(id);
      const Color radiance = trace_path<Traits>(scene_, id.pixel, path, random, limits_);
      batch.store(path, radiance);
    }
  }
};

}  // namespace

std::unique_ptr<Renderer> make_serial_renderer(const Options& options, const SceneData& scene) {
  return std::make_unique<SerialRenderer>(options, scene);
}

}  // namespace pt
