// Shading that draws numbers late and stores what it knows at once leaves the same bits as shading
// that is given its numbers and keeps all until the end.
#include <gtest/gtest.h>

#include "common/scene/prepare/prepare_scene.h"
#include "scene/material_room.h"
#include "wavefront/stages.h"

namespace pt {
namespace {

using Kind = Traits<Accel::bvh2, Geometry::triangles, Lighting::full>;
constexpr std::uint32_t width = 48, height = 48, sample_count = 4;

/// A wavefront's pool of one slot, and the samples of an image.
struct OneSlot {
  std::vector<Sample> samples = std::vector<Sample>(width * height * sample_count);
  SampleBuffer batch{samples.data(), {0, 0, width, height}, 0, sample_count};
  std::vector<std::shared_ptr<void>> arrays;
  PathPool pool;

  OneSlot() {
    pool.slot_count = 1;
    pool.allocate_arrays({true, false, false, true}, [&](auto* p, std::uint64_t count) {
      using T = std::remove_pointer_t<decltype(p)>;
      const auto memory = std::make_shared<std::vector<T>>(count);
      arrays.push_back(memory);
      return memory->data();
    });
  }
};

/// How often things happened that a test is about.
struct Seen {
  int surfaces = 0, shadow_rays = 0, emitted = 0, ended = 0;
};

void expect_same_ray(const Ray& a, const Ray& b) {
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.direction, b.direction);
}

/// Follows the path of this number; at each surface the stage does the same as shade_surface.
void follow(const Scene& scene, const SamplerSource& source, const PathSettings& settings,
            std::uint32_t path_index, OneSlot& slot, Seen& seen) {
  const StageContext<SamplerSource> context{slot.pool, slot.batch, source, nullptr,
                                            nullptr,   settings,   {}};
  const ShadeSurface<Kind, Branching::divergent, SamplerSource, true> stage{context};
  auto random = source.open(slot.batch.id_of(path_index));
  PathState path;
  path.index = path_index;
  Ray ray = generate_camera_path(scene, random, slot.batch.id_of(path_index).pixel, random.draw(0));
  for (bool alive = true; alive;) {
    const Hit hit = intersect_closest<Kind>(scene, ray);
    if (hit.is_miss()) return;
    ++seen.surfaces;
    slot.pool.store_path(0, ray, path);
    slot.pool.store_hit(0, hit);
    const Color before = slot.samples[path_index].radiance;
    const Next next = stage(scene, 0, 0);
    ++path.rays;
    const Scattering expected = surface_scattering<Kind>(scene, ray, hit, path, settings,
                                                         eager_shading<Kind>(random, path));
    alive = expected.alive, ray = expected.ray;
    EXPECT_EQ(slot.samples[path_index].radiance, before + expected.emitted);
    EXPECT_EQ(next.to, alive ? StageId::intersect : free_slot);
    EXPECT_EQ(next.shadow, !is_black(expected.shadow.radiance));
    seen.emitted += !is_black(expected.emitted), seen.ended += !alive;
    if (next.shadow) {
      ++seen.shadow_rays;
      std::uint32_t of = 0;
      const ShadowRay shadow = slot.pool.load_shadow(0, of);
      EXPECT_EQ(of, path_index);
      EXPECT_EQ(slot.pool.load_shadow_rays(0), path.rays);
      EXPECT_EQ(shadow.radiance, expected.shadow.radiance);
      EXPECT_EQ(shadow.distance, expected.shadow.distance);
      expect_same_ray(shadow.ray, expected.shadow.ray);
    }
    if (!alive) {
      EXPECT_EQ(slot.samples[path_index].rays, path.packed_rays());
      return;
    }
    Ray stored_ray;
    const PathState stored = slot.pool.load_path(0, stored_ray);
    expect_same_ray(stored_ray, ray);
    EXPECT_EQ(stored.beta, path.beta);
    EXPECT_EQ(stored.bsdf_pdf, path.bsdf_pdf);
    EXPECT_EQ(stored.packed_rays(), path.packed_rays());
    EXPECT_EQ(stored.receiver.bits, path.receiver.bits);
  }
}

TEST(SurfaceSteps, StoreWhatShadingKeeps) {
  SceneData data = material_room(false);
  Options options;
  options.accel = AccelKind::bvh2;
  options.light_selection = LightSelection::tree;
  prepare_scene(data, options);
  ASSERT_EQ(data.traits.geometry, Geometry::triangles);
  const Scene scene = host_view(data, width, height);
  PathSettings settings;
  settings.max_depth = 6;
  settings.roulette_depth = 3;
  for (const SamplerKind sampler : {SamplerKind::independent, SamplerKind::sobol}) {
    OneSlot slot;
    Seen seen;
    const SamplerSource source{7, make_sampler(sampler, sample_count)};
    for (std::uint32_t i = 0; i < width * height * sample_count && !HasFailure(); ++i) {
      follow(scene, source, settings, i, slot, seen);
    }
    EXPECT_GT(seen.surfaces, 10000);
    EXPECT_GT(seen.shadow_rays, 1000);
    EXPECT_GT(seen.emitted, 10);
    EXPECT_GT(seen.ended, 100);
  }
}

}  // namespace
}  // namespace pt
