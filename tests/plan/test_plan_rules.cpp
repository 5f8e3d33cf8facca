// What a scene cannot have is refused when it is prepared, whatever the mode and the device.
#include <gtest/gtest.h>

#include "app/options/option_list.h"
#include "common/accel/traverse_triangles.h"
#include "common/error/error.h"
#include "common/options/option_names.h"
#include "common/plan/plan_steps.h"
#include "common/scene/builtin/builtin_scenes.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/scene/prepare/prepare_steps.h"

namespace pt {
namespace {

Options with_scene(const std::string& scene) {
  Options options;
  options.scene = scene;
  return options;
}

/// Prepares a scene with one option; the message, or nothing.
std::string refusal(const std::string& scene, const std::string& name, const std::string& value) {
  Options options = with_scene(scene);
  find_option(name).set(options, value);
  SceneData data = build_scene(options);
  try {
    prepare_scene(data, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(SceneOptions, OfTrianglesAreRefusedInScenesOfSpheresAndQuads) {
  for (const std::string value : {"cwbvh", "embree"}) {
    EXPECT_EQ(
        refusal("cornell", "accel", value),
        "--accel " + value +
            ": no kernel on the CPU renders scene 'cornell' (spheres and quads, emitters) so; "
            "expected --accel brute or bvh2");
  }
  for (const std::string value : {"sah", "sbvh", "lbvh", "hploc", "hploc-reinsert"}) {
    EXPECT_EQ(refusal("spheres", "builder", value),
              "--builder " + value + ": builds trees over triangles; scene 'spheres' has none");
  }
  for (const char* value : {"auto", "brute", "bvh2"})
    EXPECT_EQ(refusal("cornell", "accel", value), "");
  EXPECT_EQ(refusal("spheres", "builder", "auto"), "");
  EXPECT_EQ(refusal("spheres", "rng", "xorwow"), "");
  EXPECT_EQ(refusal("spheres", "branching", "reduced"), "");
  for (const char* value : {"auto", "global", "shared", "constant"}) {
    EXPECT_EQ(refusal("spheres", "scene-memory", value), "");
  }
}

TEST(SceneOptions, VotesAreForTrianglesAlone) {
  const auto check = [](MegakernelKind kernel, const char* name, bool masked = false) {
    Options options = with_scene(name);
    options.device.kind = DeviceChoice::Kind::cuda;
    options.mode = Mode::megakernel;
    options.kernel = kernel;
    SceneData scene = build_scene(options);
    if (masked) scene.materials[0].opacity.offset = 0.5f;
    try {
      prepare_scene(scene, options);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  using enum MegakernelKind;
  EXPECT_EQ(check(vote, "boxes"), "");
  EXPECT_EQ(check(vote, "boxes", true),
            "--kernel vote: no kernel on CUDA renders scene 'boxes' (triangles, masks, a far plane "
            "or hidden emitters) so; expected --kernel sort");
  EXPECT_EQ(check(sort, "boxes", true), "");
  EXPECT_EQ(check(sort, "instances:20"), "");
  EXPECT_EQ(check(sort, "instances:20", true),
            "--kernel sort: no kernel on CUDA renders scene 'instances:20' (triangles, instances, "
            "masks, a far plane or hidden emitters) so; expected --accel bvh2, --kernel loop");
  EXPECT_EQ(
      check(vote, "instances:20"),
      "--kernel vote: no kernel on CUDA renders scene 'instances:20' (triangles, instances) so; "
      "expected --kernel sort");
  for (const auto& [kernel, name] : {std::pair{sort, "sort"}, {vote, "vote"}}) {
    EXPECT_EQ(check(kernel, "cornell"),
              "--kernel " + std::string(name) +
                  ": no kernel on CUDA renders scene 'cornell' (spheres and quads, emitters) so; "
                  "expected --kernel loop");
  }
  for (const char* scene : {"cornell", "spheres", "instances:20", "boxes"})
    EXPECT_EQ(check(loop, scene), "");
}

// Threads that follow rays alone are faster in a binary tree, warps that vote and blocks that sort
// in a wide one. The latter have blocks of their own; with others votes decide by themselves where
// all surfaces have one kind of BSDF and the blocks suit them.
TEST(SceneOptions, VotesTakeAWideTree) {
  const auto accel_of = [](const char* name, MegakernelKind kernel, BlockSize block = {}) {
    Options options = with_scene(name);
    options.device.kind = DeviceChoice::Kind::cuda;
    options.mode = Mode::megakernel;
    options.kernel = kernel;
    options.block = block;
    SceneData scene = build_scene(options);
    prepare_scene(scene, options);
    return scene.traits.accel;
  };
  using enum MegakernelKind;
  EXPECT_EQ(accel_of("boxes", vote), Accel::cwbvh);
  EXPECT_EQ(accel_of("dial:2", sort), Accel::cwbvh);
  EXPECT_EQ(accel_of("boxes", loop), Accel::bvh2);
  EXPECT_EQ(accel_of("boxes", automatic), Accel::cwbvh);
  EXPECT_EQ(accel_of("boxes", automatic, {5, 3}), Accel::bvh2);
  EXPECT_EQ(accel_of("boxes", automatic, {32, 4}), Accel::cwbvh);
  EXPECT_EQ(accel_of("dial:2", automatic), Accel::cwbvh);
  EXPECT_EQ(accel_of("dial:2", automatic, {32, 4}), Accel::bvh2);
  EXPECT_EQ(accel_of("dial:2", loop), Accel::bvh2);
  EXPECT_EQ(accel_of("dial:2", vote), Accel::cwbvh);
}

// Persistent warps trace wide trees, with instances or without, but no spheres; where no queue is
// appended there are none.
TEST(SceneOptions, PersistentWarpsTakeAWideTree) {
  const auto accel_of = [](SceneData scene, Compaction compaction = Compaction::atomic) {
    Options options;
    options.device.kind = DeviceChoice::Kind::cuda;
    options.mode = Mode::wavefront;
    options.compaction = compaction;
    prepare_scene(scene, options);
    return scene.traits.accel;
  };
  const SceneData boxes = build_scene(with_scene("boxes"));
  const SceneData forest = build_scene(with_scene("instances:20"));
  for (const SceneData& scene : {boxes, forest}) {
    EXPECT_EQ(accel_of(scene), Accel::cwbvh);
    EXPECT_EQ(accel_of(scene, Compaction::cub), Accel::bvh2);
    SceneData with_sphere = scene;
    with_sphere.add_sphere({0, 0, 0}, 1, 0);
    EXPECT_EQ(accel_of(with_sphere), Accel::bvh2);
  }
  for (const auto& [scene, accel] : {std::pair{boxes, Accel::cwbvh}, {forest, Accel::bvh2}}) {
    SceneData masked = scene;
    masked.materials[0].opacity.offset = 0.5f;
    EXPECT_EQ(accel_of(masked), accel);
  }
}

// On CUDA a pass over spheres is in half precision.
TEST(SceneOptions, MoreSpheresAreScannedOnCudaThanOnTheCpu) {
  const auto accel_of = [](int spheres, DeviceChoice::Kind device, Mode mode = Mode::wavefront) {
    Options options;
    options.scene = "spheres", options.spheres = spheres;  // and the ground
    options.device.kind = device;
    options.mode = mode;
    SceneData scene = make_scene(options);
    prepare_scene(scene, options);
    return scene.traits.accel;
  };
  EXPECT_EQ(accel_of(95, DeviceChoice::Kind::cpu), Accel::brute);
  EXPECT_EQ(accel_of(96, DeviceChoice::Kind::cpu), Accel::bvh2);
  EXPECT_EQ(accel_of(383, DeviceChoice::Kind::cuda), Accel::brute);
  EXPECT_EQ(accel_of(384, DeviceChoice::Kind::cuda), Accel::bvh2);
  EXPECT_EQ(accel_of(223, DeviceChoice::Kind::cuda, Mode::megakernel), Accel::brute);
  EXPECT_EQ(accel_of(224, DeviceChoice::Kind::cuda, Mode::megakernel), Accel::bvh2);
}

// Where blocks of rays go through masks.
TEST(SceneOptions, MaskedTreesAreWideForTheWavefrontOfTheCpu) {
  const auto accel_of = [](const char* name, Mode mode) {
    SceneData masked = build_scene(with_scene(name));
    masked.materials[0].opacity.offset = 0.5f;
    Options options;
    options.device.kind = DeviceChoice::Kind::cpu;
    options.mode = mode;
    prepare_scene(masked, options);
    return masked.traits.accel;
  };
  EXPECT_EQ(accel_of("boxes", Mode::wavefront), has_avx2() ? Accel::cwbvh : Accel::bvh2);
  EXPECT_EQ(accel_of("boxes", Mode::megakernel), Accel::bvh2);
  EXPECT_EQ(accel_of("instances:20", Mode::wavefront), Accel::bvh2);
}

TEST(SceneOptions, OfThePaperAreRefusedInAllOthers) {
  EXPECT_EQ(
      refusal("boxes", "rng", "xorwow"),
      "--rng xorwow: no kernel on the CPU renders scene 'boxes' (triangles) so; expected --rng "
      "philox");
  EXPECT_EQ(refusal("boxes", "branching", "reduced"),
            "--branching reduced: no kernel on the CPU renders scene 'boxes' (triangles) so; "
            "expected --branching divergent");
  for (const std::string value : {"shared", "constant"}) {
    EXPECT_EQ(refusal("boxes", "scene-memory", value),
              "--scene-memory " + value +
                  ": no kernel on the CPU renders scene 'boxes' (triangles) so; expected "
                  "--scene-memory global");
  }
  for (const char* value : {"auto", "global"})
    EXPECT_EQ(refusal("boxes", "scene-memory", value), "");
  for (const char* value : {"auto", "brute", "bvh2", "cwbvh"}) {
    EXPECT_EQ(refusal("boxes", "accel", value), "");
  }
  EXPECT_EQ(refusal("boxes", "builder", "sbvh"), "");
  for (const char* scene : {"boxes", "rtow"}) {
    EXPECT_EQ(refusal(scene, "multiple-scattering", "on"),
              std::string("--multiple-scattering on: makes up for what rough conductors lose; "
                          "scene '") +
                  scene + "' has none");
    EXPECT_EQ(refusal(scene, "multiple-scattering", "off"), "");
  }
  EXPECT_EQ(refusal("dial", "multiple-scattering", "on"), "");
}

TEST(SceneOptions, LeanKernelsKnowThePapersCameraAlone) {
  SceneData scene = build_scene(with_scene("spheres"));
  EXPECT_TRUE(has_primitives_only(scene));
  scene.camera.orthographic = true;
  EXPECT_FALSE(has_primitives_only(scene));
  scene.camera.orthographic = false, scene.camera.far_clip = 10;
  EXPECT_FALSE(has_primitives_only(scene));
}

TEST(SceneOptions, LeanKernelsAreRefusedWithAReason) {
  EXPECT_EQ(refusal("spheres", "kernel-set", "lean"), "");
  EXPECT_EQ(refusal("spheres", "kernel-set", "general"), "");
  EXPECT_EQ(refusal("boxes", "kernel-set", "lean"),
            "--kernel-set lean: not here, the scene has more than the paper's spheres and quads; "
            "expected auto or general");
  Options options = with_scene("spheres");
  options.kernel_set = KernelSet::specialized;
  options.mis = MisHeuristic::balance;
  SceneData scene = build_scene(options);
  EXPECT_THROW(prepare_scene(scene, options), Error);
}

TEST(SceneOptions, ARefusalSaysWhatAsksForGeneralKernels) {
  Options options = with_scene("spheres");
  options.rng = RngKind::xorwow;
  options.mis = MisHeuristic::balance;
  SceneData scene = build_scene(options);
  try {
    prepare_scene(scene, options);
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "--rng xorwow: no kernel on the CPU renders scene 'spheres' (spheres and quads by "
                 "general kernels, because of --mis balance) so; expected --rng philox");
  }
}

}  // namespace
}  // namespace pt
