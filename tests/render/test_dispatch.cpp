// From run-time choices to kernels: every kind of scene has its own, and one without has an error.
#include <gtest/gtest.h>

#include "common/error/error.h"
#include "common/render/dispatch.h"
#include "mode_cases.h"

namespace pt {
namespace {

template <class... T, class Test>
void for_each_kind(TypeList<T...>, Test&& test) {
  (test(T{}), ...);
}

TEST(Dispatch, EveryKindOfSceneFindsItself) {
  for_each_kind(CpuSceneKinds{}, [](auto kind) {
    int calls = 0;
    dispatch_traits(CpuSceneKinds{}, kind.value(), [&](auto found) {
      ++calls;
      EXPECT_TRUE(found.value() == kind.value());
    });
    EXPECT_EQ(calls, 1);
    // The paper's scenes have kernels for their structures alone.
    constexpr SceneTraits traits = decltype(kind)::value();
    EXPECT_EQ(traits.accel == Accel::any, traits.lighting == Lighting::full);
  });
}

// A GPU's kernels are compiled for a structure.
using GpuStages = KernelSelection<true, SamplerSource, SceneMemory::global, KernelBody::stages>;
static_assert(GpuStages::has({Accel::cwbvh, Geometry::triangles, Lighting::full}));
static_assert(!GpuStages::has({Accel::any, Geometry::triangles, Lighting::full}));
constexpr SceneTraits moving_on_gpu{.accel = Accel::bvh2,
                                    .geometry = Geometry::mixed,
                                    .lighting = Lighting::full,
                                    .has_motion = true};
static_assert(GpuStages::has(moving_on_gpu));
static_assert(!GpuStages::has({Accel::cwbvh, Geometry::mixed, Lighting::full, false, false, false,
                               true}));
template <KernelBody body>
using GpuBody = KernelSelection<true, SamplerSource, SceneMemory::global, body>;
static_assert(GpuBody<KernelBody::loop>::has(moving_on_gpu));
static_assert(GpuBody<KernelBody::fused>::has(moving_on_gpu));
static_assert(!GpuBody<KernelBody::warps>::has(moving_on_gpu));
static_assert(!GpuBody<KernelBody::blocks>::has(moving_on_gpu));

TEST(Dispatch, EveryRowOfTheTableHasAKernel) {
  int scenes = 0;
  for (const KernelRow& row : kernel_table) {
    for (int i = 0; i < detail::traits_count && !row.on_cuda; ++i) {
      const SceneTraits traits = detail::traits_at(i);
      if (!row.accels.contains(traits.accel) || !is_of_scene(row, traits)) continue;
      dispatch_traits(CpuSceneKinds{}, traits, [&](auto kind) {
        ++scenes;
        SceneTraits kernel = kind.value();
        if (kernel.accel == Accel::any) {
          EXPECT_EQ(kernel.geometry, Geometry::mixed);
          kernel.accel = traits.accel, kernel.geometry = traits.geometry;
        }
        EXPECT_TRUE(kernel == traits);
      });
    }
  }
  EXPECT_EQ(scenes, 29);
}

void expect_no_kernel(const std::function<void()>& call, const std::string& traits) {
  try {
    call();
    ADD_FAILURE() << "not refused; expected: " << traits;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(traits), std::string::npos) << error.what();
  }
}

TEST(Dispatch, NamesTheTraitsThatHaveNoKernel) {
  const auto call = [](SceneTraits traits) {
    return [traits] {
      dispatch_traits(CpuKindsWith<PhiloxSource>{}, traits, [](auto) { FAIL() << "called"; });
    };
  };
  expect_no_kernel(call({Accel::cwbvh, Geometry::triangles, Lighting::full}),
                   "--accel cwbvh, geometry: triangles, lights: all kinds");
  expect_no_kernel(call({Accel::brute, Geometry::spheres_and_quads, Lighting::full}),
                   "--accel brute, geometry: spheres and quads, lights: all kinds");
  expect_no_kernel(call({Accel::embree, Geometry::mixed, Lighting::emitters}),
                   "--accel embree, geometry: triangles and others, lights: emitters");
  // One kernel for all structures, but not for those that no row names.
  expect_no_kernel(
      [] {
        dispatch_traits(CpuSceneKinds{}, {Accel::embree, Geometry::mixed, Lighting::full, true},
                        [](auto) { FAIL() << "called"; });
      },
      "--accel embree");
}

TEST(Dispatch, ARenderWithoutAKernelIsNoBlackImage) {
  for (const char* mode : {"serial", "megakernel", "wavefront"}) {
    SCOPED_TRACE(mode);
    const Options options = with({}, {{"scene", "terrain:1K"},
                                      {"width", "8"},
                                      {"height", "8"},
                                      {"spp", "1"},
                                      {"device", "cpu"},
                                      {"mode", mode}});
    const DeviceInfo device = choose_device(options.device);
    SceneData scene = make_scene_for(options, device);
    scene.traits.lighting = Lighting::emitters;
    expect_no_kernel([&] { take_image(*make_renderer(options, scene, device)); },
                     "geometry: triangles, lights: emitters");
  }
}

}  // namespace
}  // namespace pt
