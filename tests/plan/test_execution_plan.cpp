// The plan of a render as a table: options, scene and device in, choices out.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "app/options/option_list.h"
#include "common/error/error.h"
#include "common/options/option_names.h"
#include "common/plan/execution_plan.h"
#include "common/plan/kernels.h"
#include "common/scene/prepare/prepare_steps.h"

namespace pt {
namespace {

using Choices = std::map<std::string, std::string>;

std::uint32_t bit(MaterialKind kind) { return 1u << static_cast<int>(kind); }

const std::uint32_t five_kinds = bit(kind_of<Diffuse>) | bit(kind_of<Plastic>) |
                                 bit(kind_of<Phong>) | bit(kind_of<Ward>) | bit(kind_of<Conductor>);

SceneProperties spheres(std::size_t count) {
  SceneProperties scene;
  scene.spheres = count, scene.is_primitive_only = true, scene.bsdf_kinds = bit(kind_of<Diffuse>);
  return scene;
}

SceneProperties quads(std::size_t count) {
  SceneProperties scene = spheres(0);
  scene.quads = count;
  return scene;
}

SceneProperties mesh(std::uint32_t kinds = bit(kind_of<Diffuse>)) {
  SceneProperties scene;
  scene.triangles = 1000, scene.bsdf_kinds = kinds;
  return scene;
}

template <class Change>
SceneProperties changed(SceneProperties scene, Change&& change) {
  change(scene);
  return scene;
}

SceneProperties masked_mesh() {
  return changed(mesh(), [](SceneProperties& s) { s.has_masks = true; });
}
/// `open`: with boundaries that have no BSDF.
SceneProperties filled_glass(bool open = false) {
  return changed(mesh(),
                 [open](SceneProperties& s) { s.has_media = true, s.has_open_boundaries = open; });
}
SceneProperties forest() {
  return changed(mesh(), [](SceneProperties& s) { s.instances = 20; });
}
SceneProperties mesh_and_sphere() {
  return changed(mesh(), [](SceneProperties& s) { s.spheres = 1; });
}

SceneProperties moving_mesh() {
  return changed(mesh(), [](SceneProperties& s) {
    s.name = "x", s.has_motion = s.has_moving_surfaces = true;
  });
}

SceneProperties moving_masks() {
  return changed(moving_mesh(), [](SceneProperties& s) { s.has_masks = true; });
}

DeviceProperties gpu(std::size_t shared_kib = 227) {
  DeviceProperties device;
  device.is_cuda = true, device.block_shared_bytes = shared_kib * 1024;
  return device;
}

DeviceProperties cpu(bool has_vectors = true) {
  DeviceProperties device;
  device.has_avx2 = device.has_ray_blocks = has_vectors, device.threads = 4;
  return device;
}

ExecutionPlan plan_of(const Choices& settings, const SceneProperties& scene,
                      const DeviceProperties& device) {
  Options options;
  options.mode = Mode::wavefront;
  for (const auto& [name, value] : settings) find_option(name).set(options, value);
  return plan_execution(options, scene, device);
}

struct Row {
  const char* about;
  Choices settings;
  SceneProperties scene;
  DeviceProperties device;
  Choices expected;  ///< among others
};

Choices mega(Choices more = {}) {
  more.insert({"mode", "megakernel"});
  return more;
}

const std::vector<Row>& rows() {
  static const std::vector<Row> table = {
      {"the paper's image, waves",
       {},
       spheres(51),
       gpu(),
       {{"kernel-set", "lean"},
        {"accel", "brute"},
        {"scene-memory", "constant"},
        {"stages", "fused"},
        {"persistent", "off"},
        {"finish-paths", "131072"},
        {"pool-size", "the whole batch"},
        {"schedule", "graph"}}},
      {"more than constant memory is best for",
       {},
       spheres(65),
       gpu(),
       {{"scene-memory", "global"}, {"accel", "brute"}}},
      {"the last scan of waves",
       {},
       spheres(384),
       gpu(),
       {{"accel", "brute"}, {"stages", "fused"}}},
      {"the first tree of waves",
       {},
       spheres(385),
       gpu(),
       {{"accel", "bvh2"}, {"stages", "split"}}},
      {"the last scan of the megakernel", mega(), spheres(224), gpu(), {{"accel", "brute"}}},
      {"the first tree of the megakernel",
       mega(),
       spheres(225),
       gpu(),
       {{"accel", "bvh2"}, {"kernel", "loop"}}},
      {"quads have no half precision", {}, quads(97), gpu(), {{"accel", "bvh2"}}},
      {"the last scan of quads", {}, quads(96), gpu(), {{"accel", "brute"}}},
      {"a toggle scans on CUDA",
       mega({{"rng", "xorwow"}}),
       spheres(1025),
       gpu(),
       {{"accel", "brute"}, {"scene-memory", "global"}}},
      {"and chooses as ever on the CPU",
       mega({{"rng", "xorwow"}}),
       spheres(1025),
       cpu(),
       {{"accel", "bvh2"}}},
      {"the paper's image on a CPU by blocks of rays",
       {},
       spheres(51),
       cpu(),
       {{"kernel-set", "lean"}, {"accel", "brute"}, {"stages", "split"}, {"pool-size", "4096"}}},
      {"and by rays alone", {}, spheres(51), cpu(false), {{"stages", "fused"}}},
      {"the last scan of a CPU", {}, spheres(96), cpu(), {{"accel", "brute"}}},
      {"the first tree of a CPU", {}, spheres(97), cpu(), {{"accel", "bvh2"}}},
      {"general kernels, asked for",
       {{"kernel-set", "general"}},
       spheres(51),
       gpu(),
       {{"kernel-set", "general"}, {"accel", "bvh2"}, {"persistent", "off"}, {"stages", "split"}}},
      {"general kernels by a heuristic",
       {{"mis", "balance"}},
       spheres(51),
       gpu(),
       {{"kernel-set", "general"}}},
      {"general kernels by a sampler",
       {{"sampler", "sobol"}},
       quads(9),
       gpu(),
       {{"kernel-set", "general"}, {"accel", "cwbvh"}, {"persistent", "on"}}},
      {"triangles in waves",
       {},
       mesh(),
       gpu(),
       {{"kernel-set", "general"},
        {"accel", "cwbvh"},
        {"persistent", "on"},
        {"stages", "split"},
        {"finish-paths", "1048576"}}},
      {"chains, which blocks do not follow",
       {{"integrator", "mlt"}},
       mesh(),
       gpu(),
       {{"persistent", "on"}, {"finish-paths", "32768"}}},
      {"five kinds of BSDFs", {}, mesh(five_kinds), gpu(), {{"finish-paths", "1048576"}}},
      {"six",
       {},
       mesh(five_kinds | bit(kind_of<Metal>)),
       gpu(),
       {{"order-surfaces", "on"}, {"finish-paths", "1048576"}}},
      {"six where blocks have little memory",
       {},
       mesh(five_kinds | bit(kind_of<Metal>)),
       gpu(64),
       {{"finish-paths", "8192"}}},
      {"triangles there", {}, mesh(), gpu(64), {{"finish-paths", "32768"}}},
      {"a long one alone", {}, mesh(bit(kind_of<Principled>)), gpu(), {{"order-surfaces", "off"}}},
      {"and another",
       {},
       mesh(bit(kind_of<Principled>) | bit(kind_of<Diffuse>)),
       gpu(),
       {{"order-surfaces", "on"}}},
      {"six kinds on the CPU",
       {},
       mesh(five_kinds | bit(kind_of<Metal>)),
       cpu(),
       {{"order-surfaces", "off"}}},
      {"order, asked for", {{"order-surfaces", "on"}}, mesh(), cpu(), {{"order-surfaces", "on"}}},
      {"passes over tags",
       {{"compaction", "cub"}},
       mesh(),
       gpu(),
       {{"accel", "bvh2"}, {"persistent", "off"}, {"pool-size", "1048576"}}},
      {"threads, asked for",
       {{"persistent", "off"}},
       mesh(),
       gpu(),
       {{"accel", "cwbvh"}, {"persistent", "off"}}},
      {"instances without persistent warps",
       {{"persistent", "off"}},
       forest(),
       gpu(),
       {{"accel", "bvh2"}, {"persistent", "off"}}},
      {"rays of their own find spheres in global memory",
       {{"stages", "split"}},
       spheres(51),
       gpu(),
       {{"accel", "brute"}, {"scene-memory", "global"}}},
      {"masks in waves", {}, masked_mesh(), gpu(), {{"accel", "cwbvh"}, {"persistent", "on"}}},
      {"instances in waves",
       {},
       forest(),
       gpu(),
       {{"accel", "cwbvh"}, {"persistent", "on"}, {"finish-paths", "1048576"}}},
      {"instances there", {}, forest(), gpu(64), {{"finish-paths", "8192"}}},
      {"masked instances",
       {},
       changed(forest(), [](auto& s) { s.has_masks = true; }),
       gpu(),
       {{"accel", "bvh2"}, {"persistent", "off"}}},
      {"a sphere among triangles",
       {},
       mesh_and_sphere(),
       gpu(),
       {{"accel", "bvh2"}, {"persistent", "off"}}},
      {"triangles in a megakernel",
       mega(),
       mesh(five_kinds),
       gpu(),
       {{"kernel", "sort"}, {"accel", "cwbvh"}}},
      {"masks in a megakernel",
       mega(),
       masked_mesh(),
       gpu(),
       {{"kernel", "sort"}, {"accel", "cwbvh"}}},
      {"blocks of another size",
       mega({{"block", "32x4"}}),
       mesh(),
       gpu(),
       {{"kernel", "vote"}, {"accel", "cwbvh"}}},
      {"and several kinds",
       mega({{"block", "32x4"}}),
       mesh(five_kinds),
       gpu(),
       {{"kernel", "loop"}, {"accel", "bvh2"}}},
      {"no whole warps",
       mega({{"block", "5x3"}}),
       mesh(),
       gpu(),
       {{"kernel", "loop"}, {"accel", "bvh2"}}},
      {"little shared memory", mega(), mesh(), gpu(64), {{"kernel", "vote"}, {"accel", "cwbvh"}}},
      {"and masks", mega(), masked_mesh(), gpu(64), {{"kernel", "loop"}, {"accel", "bvh2"}}},
      {"a thread for each pixel",
       mega({{"work", "pixel"}}),
       mesh(),
       gpu(),
       {{"kernel", "loop"}, {"accel", "bvh2"}}},
      {"a binary tree, asked for", mega({{"accel", "bvh2"}}), mesh(), gpu(), {{"kernel", "loop"}}},
      {"instances in a megakernel",
       mega(),
       forest(),
       gpu(),
       {{"kernel", "sort"}, {"accel", "cwbvh"}}},
      {"masked instances in a megakernel",
       mega(),
       changed(forest(), [](auto& s) { s.has_masks = true; }),
       gpu(),
       {{"kernel", "loop"}, {"accel", "bvh2"}}},
      {"instances where blocks have little memory",
       mega(),
       forest(),
       gpu(64),
       {{"kernel", "loop"}, {"accel", "bvh2"}}},
      {"votes, asked for",
       mega({{"kernel", "vote"}}),
       mesh(five_kinds),
       gpu(),
       {{"kernel", "vote"}, {"accel", "cwbvh"}}},
      {"triangles on a CPU", {}, mesh(), cpu(), {{"accel", "cwbvh"}}},
      {"without vectors", {}, mesh(), cpu(false), {{"accel", "bvh2"}}},
      {"masks by the wavefront of a CPU", {}, masked_mesh(), cpu(), {{"accel", "cwbvh"}}},
      {"masks by the megakernel of a CPU", mega(), masked_mesh(), cpu(), {{"accel", "bvh2"}}},
      {"masked instances on a CPU",
       {},
       changed(forest(), [](auto& s) { s.has_masks = true; }),
       cpu(),
       {{"accel", "bvh2"}}},
      {"media in waves", {}, filled_glass(), gpu(), {{"accel", "cwbvh"}, {"persistent", "on"}}},
      {"media in a megakernel", mega(), filled_glass(), gpu(), {{"kernel", "sort"}}},
      {"a cloud in waves",
       {},
       filled_glass(true),
       gpu(),
       {{"accel", "bvh2"}, {"persistent", "off"}}},
      {"a cloud in a megakernel",
       mega(),
       filled_glass(true),
       gpu(),
       {{"kernel", "loop"}, {"accel", "bvh2"}}},
      {"media among instances",
       {},
       changed(forest(), [](auto& s) { s.has_media = true; }),
       gpu(),
       {{"accel", "bvh2"}, {"persistent", "off"}}},
      {"sparse grids in glass",
       {},
       changed(filled_glass(), [](auto& s) { s.has_sparse = true; }),
       gpu(),
       {{"accel", "bvh2"}, {"persistent", "off"}}},
      {"sparse grids in glass on a CPU",
       {},
       changed(filled_glass(), [](auto& s) { s.has_sparse = true; }),
       cpu(),
       {{"accel", "cwbvh"}}},
      {"media in fused stages", {{"stages", "fused"}}, filled_glass(), gpu(), {{"accel", "bvh2"}}},
      {"flights that pause",
       {{"wave-collisions", "3"}},
       filled_glass(),
       gpu(),
       {{"accel", "bvh2"}, {"persistent", "off"}}},
      {"media where blocks have little memory",
       {},
       filled_glass(),
       gpu(64),
       {{"accel", "bvh2"}, {"persistent", "off"}}},
      {"and in a megakernel there",
       mega(),
       filled_glass(),
       gpu(64),
       {{"kernel", "loop"}, {"accel", "bvh2"}}},
      {"media on a CPU", {}, filled_glass(), cpu(), {{"accel", "cwbvh"}}},
      {"media in a megakernel of a CPU", mega(), filled_glass(), cpu(), {{"accel", "bvh2"}}},
      {"a cloud on a CPU", {}, filled_glass(true), cpu(), {{"accel", "bvh2"}}},
      {"media without vectors", {}, filled_glass(), cpu(false), {{"accel", "bvh2"}}},
      {"motion in waves",
       {},
       moving_mesh(),
       gpu(),
       {{"accel", "cwbvh"},
        {"persistent", "on"},
        {"stages", "split"},
        {"schedule", "graph"},
        {"finish-paths", "1048576"}}},
      {"motion where threads trace a ray each",
       {{"persistent", "off"}},
       moving_mesh(),
       gpu(),
       {{"accel", "bvh2"}, {"persistent", "off"}, {"finish-paths", "32768"}}},
      {"motion in fused stages that the host launches",
       {{"stages", "fused"}, {"schedule", "host"}},
       moving_mesh(),
       gpu(),
       {{"accel", "bvh2"}, {"stages", "fused"}, {"schedule", "host"}}},
      {"motion in a megakernel",
       mega(),
       moving_mesh(),
       gpu(),
       {{"kernel", "sort"}, {"accel", "cwbvh"}}},
      {"motion in blocks of another size",
       mega({{"block", "32x2"}}),
       moving_mesh(),
       gpu(),
       {{"kernel", "loop"}, {"accel", "bvh2"}}},
      {"motion of spheres",
       {},
       changed(moving_mesh(), [](auto& s) { s.spheres = 1; }),
       gpu(),
       {{"accel", "bvh2"}, {"persistent", "off"}}},
      {"motion of many kinds of BSDFs",
       {{"mode", "auto"}},
       changed(moving_mesh(), [](auto& s) { s.bsdf_kinds = five_kinds | bit(kind_of<Metal>); }),
       gpu(),
       {{"mode", "megakernel"}, {"kernel", "sort"}, {"accel", "cwbvh"}}},
      {"motion of many kinds of BSDFs in waves",
       {},
       changed(moving_mesh(), [](auto& s) { s.bsdf_kinds = five_kinds | bit(kind_of<Metal>); }),
       gpu(),
       {{"mode", "wavefront"}, {"accel", "cwbvh"}, {"order-surfaces", "on"}}},
      {"motion on a CPU", {}, moving_mesh(), cpu(), {{"accel", "cwbvh"}}},
      {"motion of masks", {}, moving_masks(), cpu(), {{"accel", "bvh2"}}},
      {"motion of masks on CUDA", {}, moving_masks(), gpu(), {{"accel", "bvh2"}}},
      {"motion of masks in wide trees",
       {{"accel", "cwbvh"}},
       moving_masks(),
       cpu(),
       {{"accel", "cwbvh"}}},
      {"motion without AVX2", {}, moving_mesh(), cpu(false), {{"accel", "bvh2"}}},
      {"meshes that deform",
       {},
       changed(moving_mesh(), [](auto& s) { s.deforms = true; }),
       cpu(),
       {{"accel", "bvh2"}}},
      {"meshes that deform on CUDA",
       mega(),
       changed(moving_mesh(), [](auto& s) { s.deforms = true; }),
       gpu(),
       {{"kernel", "loop"}, {"accel", "bvh2"}}},
      {"sparse grids and motion",
       {},
       changed(moving_masks(), [](auto& s) { s.has_media = s.has_sparse = true; }),
       gpu(),
       {{"accel", "bvh2"}}},
      {"the host's waves", {{"schedule", "host"}}, mesh(), gpu(), {{"schedule", "host"}}},
      {"few emitters",
       {},
       changed(mesh(), [](auto& s) { s.emitters = 16; }),
       gpu(),
       {{"light-selection", "power"}}},
      {"many emitters",
       {},
       changed(mesh(), [](auto& s) { s.emitters = 17; }),
       gpu(),
       {{"light-selection", "tree"}}},
      {"what was built",
       {},
       changed(mesh(), [](auto& s) { s.structure = Accel::bvh2; }),
       gpu(),
       {{"accel", "bvh2"}, {"persistent", "off"}}},
  };
  return table;
}

TEST(ExecutionPlan, IsATable) {
  for (const Row& row : rows()) {
    SCOPED_TRACE(row.about);
    const ExecutionPlan plan = plan_of(row.settings, row.scene, row.device);
    Choices found;
    for (const Decision& d : plan.decisions) {
      EXPECT_TRUE(found.emplace(d.option, d.value).second) << d.option << " is decided twice";
      const bool is_built = d.option == "accel" && row.scene.structure;
      EXPECT_TRUE(is_built || !d.reason.empty()) << d.option;
      EXPECT_NO_THROW(find_option(d.option));
    }
    for (const auto& [option, value] : row.expected) EXPECT_EQ(found[option], value) << option;
  }
}

TEST(ExecutionPlan, RefusesWhatMotionOnCudaHasNoKernelsFor) {
  const auto refusal = [](const Choices& settings, const SceneProperties& scene) -> std::string {
    try {
      plan_of(settings, scene, gpu());
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  const std::string begin = ": no kernel on CUDA renders scene 'x' (triangles, motion) so; ";
  const std::pair<Choices, std::string> refused[] = {
      {mega({{"kernel", "vote"}}), "--kernel vote" + begin + "expected --kernel sort"},
      {mega({{"accel", "cwbvh"}, {"kernel", "loop"}}),
       "--accel cwbvh" + begin + "expected --accel bvh2"},
      {{{"accel", "brute"}}, "--accel brute" + begin + "expected --accel bvh2"},
      {{{"branching", "reduced"}},
       "--branching reduced" + begin + "expected --branching divergent"},
      {{{"rng", "xorwow"}}, "--rng xorwow" + begin + "expected --rng philox"},
      {{{"accel", "optix"}}, "--accel optix: OptiX traces what stands still; scene 'x' moves"}};
  for (const auto& [settings, text] : refused) EXPECT_EQ(refusal(settings, moving_mesh()), text);
  EXPECT_EQ(refusal({{"accel", "cwbvh"}}, moving_masks()),
            "--accel cwbvh: no kernel on CUDA renders scene 'x' (triangles, motion, masks, a far "
            "plane or hidden emitters) so; expected --accel bvh2");
  const SceneProperties deforming = changed(moving_mesh(), [](auto& s) { s.deforms = true; });
  EXPECT_EQ(refusal({{"accel", "cwbvh"}}, deforming),
            "--accel cwbvh: no kernel on CUDA renders scene 'x' (triangles, motion, deforming "
            "meshes) so; expected --accel bvh2");
  EXPECT_EQ(refusal({{"builder", "hploc"}}, moving_mesh()),
            "scene 'x' moves while the shutter is open: --builder hploc fits no tree to a motion; "
            "expected auto, sah, sah-reinsert, sbvh or best");
  EXPECT_EQ(refusal({{"builder", "hploc"}},
                    changed(moving_mesh(), [](auto& s) { s.has_moving_surfaces = false; })),
            "");
}

// For the measured scenes the mode that was faster (results/log/2026-11-sizes.md).
TEST(ExecutionPlan, TakesTheModeThatWasFaster) {
  const auto mode_of = [](const SceneProperties& scene, Choices settings = {},
                          const DeviceProperties& device = gpu()) {
    settings.insert({"mode", "auto"});
    return to_string(plan_of(settings, scene, device).mode);
  };
  const auto image = [](const char* size, const char* spp, const char* depth) {
    return Choices{{"width", size}, {"height", size}, {"spp", spp}, {"max-depth", depth}};
  };
  const SceneProperties dial = mesh(five_kinds | bit(kind_of<Metal>));
  EXPECT_EQ(mode_of(spheres(51)), "megakernel");
  EXPECT_EQ(mode_of(spheres(486), image("2048", "16", "50")), "megakernel");
  EXPECT_EQ(mode_of(quads(17), image("2048", "16", "4")), "wavefront");
  EXPECT_EQ(mode_of(quads(17), image("256", "1", "50")), "wavefront");
  EXPECT_EQ(mode_of(quads(17), image("1024", "16", "50")), "megakernel");
  EXPECT_EQ(mode_of(mesh()), "wavefront");
  EXPECT_EQ(mode_of(dial), "megakernel");
  EXPECT_EQ(mode_of(dial, image("512", "16", "4")), "wavefront");
  EXPECT_EQ(mode_of(dial, {{"accel", "bvh2"}}), "wavefront");
  EXPECT_EQ(mode_of(dial, {{"integrator", "mlt"}}), "wavefront");
  EXPECT_EQ(mode_of(dial, {}, gpu(64)), "wavefront");
  EXPECT_EQ(mode_of(forest()), "wavefront");
  EXPECT_EQ(mode_of(changed(dial, [](auto& s) { s.instances = 20; })), "wavefront");
  EXPECT_EQ(mode_of(filled_glass(true)), "wavefront");
  EXPECT_EQ(mode_of(dial, {}, cpu()), "wavefront");
  EXPECT_EQ(mode_of(spheres(51), {}, cpu()), "wavefront");
}

// Both sides of each limit between the modes: short paths have 6 rays, few paths are 2^19 on an
// H200 and as many on each multiprocessor of a smaller GPU.
TEST(ExecutionPlan, ModesChangeAtTheirLimits) {
  const SceneProperties dial = mesh(five_kinds | bit(kind_of<Metal>));
  struct Case {
    SceneProperties scene;
    const char *width, *depth, *mode;
  };
  const Case cases[] = {
      {quads(17), "2048", "6", "wavefront"},  {quads(17), "2048", "7", "megakernel"},
      {quads(17), "1024", "50", "wavefront"}, {quads(17), "1025", "50", "megakernel"},
      {dial, "2048", "6", "wavefront"},       {dial, "2048", "7", "megakernel"}};
  for (const Case& c : cases) {
    const Choices settings{{"mode", "auto"},
                           {"width", c.width},
                           {"height", "128"},
                           {"spp", "4"},
                           {"max-depth", c.depth}};
    EXPECT_EQ(to_string(plan_of(settings, c.scene, gpu()).mode), c.mode)
        << c.width << ' ' << c.depth;
  }
  DeviceProperties small = gpu();
  small.multiprocessors = 33;  // a quarter of an H200's
  const Choices settings{
      {"mode", "auto"}, {"width", "1024"}, {"height", "128"}, {"max-depth", "50"}};
  for (const char* spp : {"1", "2"}) {
    Choices image = settings;
    image["spp"] = spp;
    EXPECT_EQ(to_string(plan_of(image, quads(17), gpu()).mode), "wavefront") << spp;
    EXPECT_EQ(to_string(plan_of(image, quads(17), small).mode),
              *spp == '1' ? "wavefront" : "megakernel");
  }
}

// The numbers in the reasons are those that decided.
TEST(ExecutionPlan, ReasonsHaveTheirNumbers) {
  const auto reason = [](const char* option, const SceneProperties& scene,
                         const DeviceProperties& device, const Choices& settings = {}) {
    for (const Decision& d : plan_of(settings, scene, device).decisions) {
      if (d.option == option) return d.reason;
    }
    return std::string("not decided");
  };
  const auto lit_by = [](std::size_t count) {
    return changed(mesh(), [&](SceneProperties& s) { s.emitters = count; });
  };
  const std::string origin = " (from an H200)";
  const std::string walk = " are scanned faster than a tree is walked" + origin;
  EXPECT_EQ(reason("accel", spheres(51), gpu()), "51 primitives: up to 384" + walk);
  EXPECT_EQ(reason("accel", spheres(300), gpu(), mega()), "300 primitives: up to 224" + walk);
  EXPECT_EQ(reason("accel", quads(17), gpu()), "17 primitives: up to 96" + walk);
  EXPECT_EQ(reason("accel", spheres(97), cpu()), "97 primitives: up to 96" + walk);
  EXPECT_EQ(reason("accel", spheres(51), gpu(), {{"accel", "bvh2"}}), "asked for");
  EXPECT_EQ(reason("scene-memory", spheres(51), gpu()),
            "51 spheres, up to 64 are scanned fastest there" + origin);
  EXPECT_EQ(reason("scene-memory", spheres(65), gpu()), "more than 64 spheres" + origin);
  EXPECT_EQ(reason("light-selection", lit_by(30), gpu()),
            "30 lights; a light tree pays off from 17 lights on" + origin);
  EXPECT_EQ(reason("light-selection", lit_by(1), gpu()),
            "1 light; a light tree pays off from 17 lights on" + origin);
  EXPECT_EQ(reason("light-selection", lit_by(3), gpu(), {{"light-selection", "tree"}}),
            "asked for");
  EXPECT_EQ(reason("order-surfaces", mesh(), gpu()), "1 kind of BSDFs" + origin);
  EXPECT_EQ(reason("order-surfaces", mesh(five_kinds), gpu()), "5 kinds of BSDFs" + origin);
}

/// A decision that turns where a constant is another one.
struct Turn {
  PlanConstant constant;
  double value;
  const char *option, *before, *after;
  SceneProperties scene;
  DeviceProperties device;
  Choices settings;
};

std::vector<Turn> planted_turns() {
  using C = PlanConstants;
  const SceneProperties dial = mesh(five_kinds | bit(kind_of<Metal>));
  const Choices automatic{{"mode", "auto"}};
  const auto large = [](const char* depth) {
    return Choices{{"mode", "auto"}, {"width", "2048"}, {"height", "2048"}, {"max-depth", depth}};
  };
  return {
      {&C::scan_primitives, 16, "accel", "brute", "bvh2", quads(17), gpu(), {}},
      {&C::scan_primitives, 50, "accel", "brute", "bvh2", spheres(51), cpu(), {}},
      {&C::scan_spheres_wavefront, 299, "accel", "brute", "bvh2", spheres(300), gpu(), {}},
      {&C::scan_spheres_megakernel, 300, "accel", "bvh2", "brute", spheres(300), gpu(), mega()},
      {&C::constant_spheres, 50, "scene-memory", "constant", "global", spheres(51), gpu(), {}},
      {&C::few_emitters,
       0,
       "light-selection",
       "power",
       "tree",
       changed(mesh(), [](auto& s) { s.emitters = 1; }),
       gpu(),
       {}},
      {&C::order_kinds, 4, "order-surfaces", "off", "on", mesh(five_kinds), gpu(), {}},
      {&C::short_depth, 12, "mode", "megakernel", "wavefront", quads(17), gpu(), large("12")},
      {&C::short_depth_sorting, 12, "mode", "megakernel", "wavefront", dial, gpu(), large("12")},
      {&C::few_paths_multiprocessor, 1e9, "mode", "megakernel", "wavefront", quads(17), gpu(),
       large("50")},
      {&C::megakernel_spheres, 1.1, "mode", "megakernel", "wavefront", spheres(51), gpu(),
       automatic},
      {&C::megakernel_sorting, 1.1, "mode", "megakernel", "wavefront", dial, gpu(), automatic},
      {&C::megakernel_mesh, 0.9, "mode", "wavefront", "megakernel", mesh(), gpu(), automatic},
      {&C::megakernel_cpu, 0.9, "mode", "wavefront", "megakernel", mesh(), cpu(), automatic},
      {&C::finish_lean, 7, "finish-paths", "131072", "7", spheres(51), gpu(), {}},
      {&C::finish_blocks, 7, "finish-paths", "1048576", "7", mesh(), gpu(), {}},
      {&C::finish_plain, 7, "finish-paths", "32768", "7", mesh(), gpu(64), {}},
      {&C::finish_expensive, 7, "finish-paths", "8192", "7", dial, gpu(64), {}},
      {&C::pool_passes, 7, "pool-size", "1048576", "7", mesh(), gpu(), {{"compaction", "cub"}}},
      {&C::pool_thread, 7, "pool-size", "4096", "28", mesh(), cpu(), {}},
  };
}

// The constants of the trees' times: test_tree_times.cpp.
TEST(ExecutionPlan, PlantedConstantsTurnDecisions) {
  for (const Turn& turn : planted_turns()) {
    const auto of = [&](const DeviceProperties& device) {
      for (const Decision& d : plan_of(turn.settings, turn.scene, device).decisions)
        if (d.option == turn.option) return d;
      return Decision();
    };
    const Decision before = of(turn.device);
    DeviceProperties device = turn.device;
    set_measured(device.constants, turn.constant, turn.value);
    const Decision after = of(device);
    SCOPED_TRACE(std::string(turn.option) + ' ' + before.value + ": " + after.reason);
    EXPECT_EQ(before.value, turn.before);
    EXPECT_EQ(after.value, turn.after);
    EXPECT_NE(before.reason.find("(from an H200)"), std::string::npos) << before.reason;
    if (turn.constant == &PlanConstants::few_emitters) continue;  // in no calibration
    EXPECT_NE(after.reason.find("measured here)"), std::string::npos);
    device.constants.measured_on = "NVIDIA H100";
    EXPECT_NE(of(device).reason.find("measured on NVIDIA H100)"), std::string::npos);
  }
}

TEST(ExecutionPlan, SaysWhereItsConstantsAreFrom) {
  using C = PlanConstants;
  PlanConstants constants;
  EXPECT_EQ(origin_of(constants, {&C::sah_s, &C::few_paths_multiprocessor}), "from an H200");
  set_measured(constants, &C::sah_s, 2);
  EXPECT_EQ(origin_of(constants, {&C::sah_s, &C::few_paths_multiprocessor}),
            "partly measured here");
  EXPECT_EQ(origin_of(constants, {&C::few_paths_multiprocessor}), "from an H200");
  EXPECT_EQ(origin_of(constants, {&C::sah_s}), "measured here");
  DeviceProperties device = gpu();
  device.constants.calibration = "0123";
  EXPECT_EQ(plan_of({}, mesh(), device).calibration, "0123");
}

TEST(ExecutionPlan, EveryConstantHasAPossibleDefault) {
  std::set<std::string> names;
  for (const PlanConstantInfo& info : plan_constant_table) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_GE(PlanConstants().*info.value, info.lowest) << info.name;
    EXPECT_LE(PlanConstants().*info.value, info.highest) << info.name;
  }
}

// What is prepared for a mode is rendered by it.
TEST(ExecutionPlan, TakesTheSameModeWhenTheSceneIsPrepared) {
  for (const SceneProperties& scene :
       {spheres(51), spheres(300), quads(9), mesh(), mesh(five_kinds | bit(kind_of<Metal>)),
        masked_mesh(), forest(), filled_glass(), filled_glass(true)}) {
    for (const DeviceProperties& device : {gpu(), gpu(64), cpu(), cpu(false)}) {
      const ExecutionPlan plan = plan_of({{"mode", "auto"}}, scene, device);
      const SceneProperties prepared = changed(scene, [&](SceneProperties& s) {
        s.structure = plan.accel, s.why_structure = "as planned", s.emitters = 30;
      });
      const ExecutionPlan again = plan_of({{"mode", "auto"}}, prepared, device);
      EXPECT_EQ(again.mode, plan.mode);
      EXPECT_EQ(again.accel, plan.accel);
      EXPECT_EQ(again.megakernel, plan.megakernel);
    }
  }
}

// What is printed is what is done.
TEST(ExecutionPlan, SaysWhatItIs) {
  for (const Row& row : rows()) {
    SCOPED_TRACE(row.about);
    const ExecutionPlan plan = plan_of(row.settings, row.scene, row.device);
    Choices found;
    for (const Decision& d : plan.decisions) found[d.option] = d.value;
    const auto expect = [&](const char* option, const std::string& value) {
      if (!found.contains(option)) return;
      EXPECT_EQ(found[option], value) << option;
    };
    expect("mode", to_string(plan.mode));
    expect("accel", accel_name(plan.accel));
    expect("kernel-set", to_string(plan.kernel_set));
    expect("kernel", to_string(plan.megakernel));
    expect("scene-memory", to_string(plan.scene_memory));
    expect("stages", plan.fused ? "fused" : "split");
    expect("persistent", plan.persistent_warps ? "on" : "off");
    expect("finish-paths", std::to_string(plan.finish_paths));
    expect("schedule", plan.uses_graph ? "graph" : "host");
    expect("order-surfaces", plan.orders_surfaces ? "on" : "off");
  }
}

TEST(ExecutionPlan, OfTheCpuTracesByVectorsWhereItHasThem) {
  EXPECT_EQ(plan_of({}, mesh(), cpu()).traversal, Accel::cwbvh_avx2);
  EXPECT_EQ(plan_of({}, masked_mesh(), cpu()).traversal, Accel::cwbvh);
  EXPECT_EQ(plan_of({}, mesh(), cpu(false)).traversal, Accel::bvh2);
  EXPECT_EQ(plan_of({}, mesh(), gpu()).traversal, Accel::cwbvh);
}

TEST(ExecutionPlan, GivenValuesHold) {
  EXPECT_EQ(plan_of({{"finish-paths", "0"}}, spheres(51), gpu()).finish_paths, 0u);
  EXPECT_EQ(plan_of({{"finish-paths", "1000"}}, forest(), gpu()).finish_paths, 1000u);
  EXPECT_EQ(plan_of({{"pool-size", "77"}}, mesh(), cpu()).pool_paths_max, 77u);
  EXPECT_EQ(plan_of({}, mesh(), cpu()).pool_paths_max, 4096u);
  EXPECT_EQ(plan_of({}, mesh(), gpu()).pool_paths_max, 0u);
}

void expect_refused(const Choices& settings, const SceneProperties& scene,
                    const DeviceProperties& device, const std::string& message) {
  try {
    plan_of(settings, scene, device);
    ADD_FAILURE() << "not refused; expected: " << message;
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, message.size()), message);
  }
}

TEST(ExecutionPlan, SeesAGpuOfTheSizeThatIsAskedFor) {
  for (const int sms : {8, 16, 20, 66, 132}) {
    SCOPED_TRACE(sms);
    DeviceProperties small = gpu();
    small.multiprocessors = sms;
    const Choices asked = {{"mode", "auto"}, {"sms", std::to_string(sms)}};
    for (const std::size_t triangles : {std::size_t{1000}, std::size_t{10'000'000}}) {
      const SceneProperties scene =
          changed(mesh(), [&](SceneProperties& s) { s.triangles = triangles; });
      ExecutionPlan part = plan_of(asked, scene, gpu());
      const ExecutionPlan whole = plan_of({{"mode", "auto"}}, scene, small);
      EXPECT_EQ(part.decisions.front(),
                (Decision{"sms", std::to_string(sms), "asked for, of 132 multiprocessors"}));
      part.decisions.erase(part.decisions.begin());
      EXPECT_EQ(part.decisions, whole.decisions);
      EXPECT_EQ(part.builder, whole.builder);
      EXPECT_EQ(part.limits.sms, sms);
    }
  }
  // A smaller GPU renders for longer, by which a tree's builder is chosen.
  const auto builder = [](const char* sms) {
    const auto all = plan_of({{"sms", sms}}, mesh(), gpu()).decisions;
    return std::ranges::find(all, "builder", &Decision::option)->reason;
  };
  EXPECT_NE(builder("8"), builder("132"));
  EXPECT_TRUE(plan_of({{"sms", "0"}}, mesh(), gpu()).limits == DeviceLimits());
  expect_refused({{"sms", "133"}}, mesh(), gpu(),
                 "--sms 133: the GPU has 132 multiprocessors; expected at most as many");
}

TEST(ExecutionPlan, SeesBlocksOfTheSharedMemoryThatIsAskedFor) {
  for (const int kib : {48, 64, 90, 91, 100, 227}) {
    SCOPED_TRACE(kib);
    const Choices limit = {{"mode", "megakernel"}, {"shared-memory-max", std::to_string(kib)}};
    const bool has_room = kib >= 91;
    for (const SceneProperties& scene : {mesh(), forest()}) {
      ExecutionPlan part = plan_of(limit, scene, gpu());
      const ExecutionPlan small = plan_of(mega(), scene, gpu(static_cast<std::size_t>(kib)));
      EXPECT_EQ(part.decisions.front(),
                (Decision{"shared-memory-max", std::to_string(kib), "asked for, of 227 KiB"}));
      part.decisions.erase(part.decisions.begin());
      EXPECT_EQ(part.decisions, small.decisions);
      EXPECT_EQ(part.megakernel == MegakernelKind::sort, has_room);
    }
    EXPECT_EQ(
        plan_of({{"shared-memory-max", std::to_string(kib)}}, mesh(), gpu()).finishes_in_blocks,
        has_room);
  }
  expect_refused(
      mega({{"kernel", "sort"}, {"shared-memory-max", "64"}}), mesh(), gpu(),
      "--kernel sort: expected --accel cwbvh, --work persistent and a device whose blocks "
      "may have 91 KiB");
  expect_refused({{"shared-memory-max", "228"}}, mesh(), gpu(),
                 "--shared-memory-max 228: a block of this GPU has at most 227 KiB");
  const SceneProperties many = changed(spheres(8000), [](auto& s) { s.scan_bytes = 64000; });
  expect_refused(
      {{"scene-memory", "shared"}, {"accel", "brute"}, {"shared-memory-max", "48"}}, many, gpu(),
      "--scene-memory shared: the scene's 8000 spheres take 64000 bytes; a block of this "
      "device has at most 49152");
}

TEST(ExecutionPlan, WhatADeviceLacksIsRefused) {
  DeviceProperties small = gpu();
  small.block_threads_max = 512;
  expect_refused(mega({{"block", "32x32"}}), mesh(), small,
                 "--block 32x32: 1024 threads; a block has at most 512");
  EXPECT_NO_THROW(plan_of(mega({{"block", "32x16"}}), mesh(), small));
  expect_refused(mega({{"block", "19x27"}}), mesh(), small,
                 "--block 19x27: 513 threads; a block has at most 512");
  EXPECT_NO_THROW(plan_of(mega({{"kernel", "vote"}, {"block", "32x8"}}), mesh(), gpu()));
  EXPECT_NO_THROW(plan_of(mega({{"kernel", "sort"}}), mesh(), gpu(91)));
  expect_refused(mega({{"kernel", "vote"}, {"block", "32x9"}}), mesh(), gpu(), "--kernel vote: ");
  Options huge;
  huge.mode = Mode::megakernel, huge.block = {32768, 65536};  // 2^31 threads
  EXPECT_THROW(plan_execution(huge, mesh(), gpu()), Error);
  expect_refused(mega({{"kernel", "sort"}}), mesh(), gpu(64),
                 "--kernel sort: expected --accel cwbvh, --work persistent and a device whose "
                 "blocks may have 91 KiB");
  expect_refused(mega({{"kernel", "vote"}, {"block", "32x16"}}), mesh(), gpu(),
                 "--kernel vote: expected --accel cwbvh, --work persistent and a --block of 32 to "
                 "256 threads");
  expect_refused({{"scene-memory", "constant"}, {"accel", "brute"}}, spheres(1025), gpu(),
                 "--scene-memory constant: the scene has 1025 spheres; a kernel's parameters hold "
                 "at most 1024");
  // The largest that are taken.
  EXPECT_NO_THROW(plan_of({{"scene-memory", "constant"}, {"accel", "brute"}, {"stages", "fused"}},
                          spheres(1024), gpu()));
  const SceneProperties many = changed(spheres(8000), [](auto& s) { s.scan_bytes = 64000; });
  const Choices shared = {{"scene-memory", "shared"}, {"accel", "brute"}};
  expect_refused(shared, many, gpu(48),
                 "--scene-memory shared: the scene's 8000 spheres take 64000 bytes");
  EXPECT_EQ(plan_of(shared, many, gpu()).scene_memory, SceneMemory::shared);
  // The kernel itself needs 2 KiB of what a block may have.
  const auto with_scan = [](std::size_t bytes) {
    return changed(spheres(8000), [&](auto& s) { s.scan_bytes = bytes; });
  };
  constexpr std::size_t most = 96 * 1024 - 2048;
  EXPECT_EQ(plan_of(shared, with_scan(most), gpu(96)).scene_memory, SceneMemory::shared);
  expect_refused(shared, with_scan(most + 1), gpu(96),
                 "--scene-memory shared: the scene's 8000 spheres take 96257 bytes; a block of "
                 "this device has at most 98304");
}

TEST(ExecutionPlan, TogglesAreForScansOnCuda) {
  expect_refused(
      mega({{"rng", "xorwow"}, {"accel", "bvh2"}}), spheres(51), gpu(),
      "--accel bvh2: no kernel on CUDA renders scene '' (spheres and quads, --rng xorwow) so; "
      "expected --accel brute");
  expect_refused(
      {{"branching", "reduced"}, {"scene-memory", "constant"}}, spheres(51), gpu(),
      "--scene-memory constant: no kernel on CUDA renders scene '' (spheres and quads, --branching "
      "reduced) so; expected --scene-memory global");
  expect_refused({{"branching", "reduced"}, {"rng", "xorwow"}}, spheres(51), gpu(),
                 "--rng xorwow: no kernel on CUDA renders scene '' (spheres and quads, --branching "
                 "reduced) so; "
                 "expected --rng philox");
  EXPECT_NO_THROW(plan_of({{"branching", "reduced"}, {"rng", "xorwow"}}, spheres(51), cpu()));
}

SceneProperties lit(SceneProperties scene) {
  scene.has_emitters = true;
  return scene;
}

TEST(ExecutionPlan, KernelsThatWinNowhereAreRefused) {
  expect_refused(
      {{"accel", "brute"}}, mesh(), gpu(),
      "--accel brute: no kernel on CUDA renders scene '' (triangles) so; expected --accel bvh2 or "
      "cwbvh");
  expect_refused(
      mega({{"kernel", "loop"}, {"accel", "cwbvh"}}), forest(), gpu(),
      "--accel cwbvh: no kernel on CUDA renders scene '' (triangles, instances) so; expected "
      "--accel bvh2");
  expect_refused(
      {{"accel", "cwbvh"}, {"persistent", "off"}}, masked_mesh(), gpu(),
      "--accel cwbvh: no kernel on CUDA renders scene '' (triangles, masks, a far plane or "
      "hidden emitters) so; expected --accel bvh2");
  expect_refused({{"accel", "cwbvh"}}, mesh_and_sphere(), gpu(),
                 "--accel cwbvh: no kernel on CUDA renders scene '' (triangles, spheres) so; "
                 "expected --accel bvh2");
  EXPECT_TRUE(plan_of({{"accel", "cwbvh"}, {"stages", "fused"}}, forest(), gpu()).fused);
  EXPECT_EQ(plan_of(mega({{"accel", "cwbvh"}}), masked_mesh(), gpu()).megakernel,
            MegakernelKind::sort);
  for (const char* accel : {"brute", "cwbvh"})
    EXPECT_NO_THROW(plan_of({{"accel", accel}}, forest(), cpu())) << accel;
}

TEST(ExecutionPlan, SpheresLieInGlobalMemoryForMostKernels) {
  expect_refused(
      {{"scene-memory", "constant"}, {"stages", "split"}}, spheres(51), gpu(),
      "--scene-memory constant: no kernel on CUDA renders scene '' (spheres and quads) so; "
      "expected --scene-memory global");
  expect_refused(
      mega({{"scene-memory", "shared"}, {"accel", "bvh2"}}), spheres(51), gpu(),
      "--accel bvh2: no kernel on CUDA renders scene '' (spheres and quads) so; expected "
      "--accel brute");
  expect_refused(
      mega({{"scene-memory", "shared"}}), lit(spheres(51)), gpu(),
      "--scene-memory shared: no kernel on CUDA renders scene '' (spheres and quads, emitters) "
      "so; expected --scene-memory global");
  EXPECT_EQ(plan_of(mega(), lit(spheres(51)), gpu()).scene_memory, SceneMemory::constant);
  EXPECT_EQ(plan_of(mega({{"rng", "xorwow"}}), spheres(51), gpu()).scene_memory,
            SceneMemory::global);
  expect_refused(
      mega({{"rng", "xorwow"}}), lit(quads(9)), gpu(),
      "--rng xorwow: no kernel on CUDA renders scene '' (spheres and quads, emitters) so; "
      "expected --rng philox");
}

TEST(ExecutionPlan, PathBytesHaveKernelsOfTheirOwnOnCuda) {
  const auto place_of = [](Choices more, const DeviceProperties& device) {
    more.insert({"path-bytes", "64"});
    for (const Decision& decision : plan_of(more, mesh(), device).decisions)
      if (decision.option == "path-bytes") return decision.value + " " + decision.reason;
    return std::string();
  };
  EXPECT_EQ(place_of({}, cpu()), "64 in the pool");
  EXPECT_EQ(place_of(mega(), cpu()), "64 beside the thread's path");
  if (!has_carrying_kernels) {
    expect_refused(mega({{"path-bytes", "64"}}), mesh(), gpu(),
                   "--path-bytes 64: this build has no kernels on CUDA for it; expected 0, or a "
                   "build with -DPTEXP_PATH_STATE=ON");
    return;
  }
  EXPECT_EQ(place_of({}, gpu()), "64 in the pool, then in the blocks' slots");
  EXPECT_EQ(place_of(mega({{"kernel", "loop"}}), gpu()), "64 in registers");
  EXPECT_EQ(place_of(mega({{"kernel", "vote"}}), gpu()), "64 in shared memory");
  EXPECT_EQ(place_of(mega(), gpu()), "64 in the blocks' slots");
  expect_refused(mega({{"kernel", "loop"}, {"path-bytes", "48"}}), mesh(), gpu(),
                 "--path-bytes 48: no kernel on CUDA renders scene '' (triangles) so; expected "
                 "--path-bytes 32 or 64 or 128 or 256");
  expect_refused(mega({{"path-bytes", "64"}}), masked_mesh(), gpu(),
                 "--path-bytes 64: no kernel on CUDA renders scene '' (triangles, masks, a far "
                 "plane or hidden emitters) so; expected --path-bytes 0");
  expect_refused({{"path-bytes", "64"}}, spheres(51), gpu(),
                 "--path-bytes 64: on CUDA the lean kernels of spheres and quads know none; "
                 "expected --kernel-set general");
  expect_refused(mega({{"kernel", "vote"}, {"path-bytes", "256"}}), mesh(), gpu(99),
                 "--kernel vote: a block of 256 threads, with --path-bytes 256, needs 116 KiB of "
                 "shared memory; one of this device has at most 99");
  EXPECT_EQ(plan_of(mega(), mesh(), gpu(64)).megakernel, MegakernelKind::vote);
  EXPECT_EQ(plan_of(mega(), mesh(), gpu(48)).megakernel, MegakernelKind::loop);
}

TEST(ExecutionPlan, EmbreeHasNoMasks) {
  expect_refused(
      {{"accel", "embree"}}, masked_mesh(), cpu(),
      "--accel embree: no kernel on the CPU renders scene '' (triangles, masks, a far plane or "
      "hidden emitters) so; expected --accel brute or bvh2 or cwbvh");
}

TEST(ExecutionPlan, IsPrintedInColumns) {
  EXPECT_EQ(plan_text({{"accel", "brute", "few"}, {"scene-memory", "global", "asked for"}}),
            "--accel         brute   few\n"
            "--scene-memory  global  asked for\n");
}

}  // namespace
}  // namespace pt
