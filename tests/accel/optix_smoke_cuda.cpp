// Tries OptiX step by step, and says what each one gives: for a GPU that a developer cannot reach,
// and for users who ask why --accel optix does not work. Exits with 1 if a step fails.
#include <cuda_runtime_api.h>
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <vector>

#include "common/accel/trace_optix/optix_memory_cuda.h"
#include "common/accel/trace_optix/optix_pipeline.h"
#include "common/accel/trace_optix/optix_rays.h"
#include "common/accel/trace_optix/optix_structure.h"
#include "common/cuda/cuda_check.cuh"
#include "common/error/error.h"
#include "common/sampling/random.h"

namespace pt {
namespace {

int failures = 0;

void say(const std::string& text) {
  std::printf("%s\n", text.c_str());
  std::fflush(stdout);
}

bool step(const std::string& name, const std::function<void()>& action) {
  say("- " + name);
  try {
    action();
    return true;
  } catch (const std::exception& error) {
    say(fmt::format("  FAILED: {}", error.what()));
    cudaGetLastError();
    ++failures;
    return false;
  }
}

/// Numbers in [-1, 1).
struct Numbers {
  std::uint32_t state = 1;
  float next() {
    state = combine_hash(state, 0x9e3779b9u);
    return static_cast<float>(state >> 8) * 0x1p-23f - 1.0f;
  }
  Vec3 point() {
    const float x = next(), y = next();
    return {x, y, next()};
  }
};

constexpr std::uint32_t triangle_count = 2000, ray_count = 20000;

/// Random triangles, of which every eighth coincides with the one before.
std::vector<Triangle> make_triangles() {
  Numbers numbers;
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < triangle_count; ++i) {
    Triangle t{};
    const Vec3 centre = numbers.point();
    t.v0 = centre + 0.1f * numbers.point();
    t.v1 = centre + 0.1f * numbers.point();
    t.v2 = centre + 0.1f * numbers.point();
    if (i % 8 == 7) t = triangles.back();
    t.id = triangle_count - 1 - i;
    triangles.push_back(t);
  }
  return triangles;
}

std::vector<RayRecord> make_rays() {
  Numbers numbers{2};
  std::vector<RayRecord> rays;
  for (std::uint32_t i = 0; i < ray_count; ++i) {
    const Vec3 origin = 2.0f * numbers.point();
    rays.push_back({origin, 0.0f, normalize(numbers.point() - origin), infinite_distance});
  }
  return rays;
}

InstanceRecord make_instance(std::uint32_t index, const Vec3& scale, const Vec3& move,
                             std::uint32_t first, std::uint32_t count,
                             const std::vector<Triangle>& triangles) {
  InstanceRecord record{};
  for (int i = 0; i < 3; ++i) {
    record.to_object.row[i] = Vec4(0.0f);
    record.to_object.row[i][i] = 1.0f / scale[i];
    record.to_object.row[i][3] = -move[i] / scale[i];
  }
  record.index = index;
  record.first_slot = first, record.slot_count = count;
  Bounds box{Vec3(HUGE_VALF), Vec3(-HUGE_VALF)};
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (const Vec3& v : {triangles[i].v0, triangles[i].v1, triangles[i].v2}) {
      const Vec3 p = scale * v + move;
      box = {glm::min(box.min, p), glm::max(box.max, p)};
    }
  }
  record.bounds = {box.min - Vec3(1e-4f), box.max + Vec3(1e-4f)};
  return record;
}

/// The hit by every triangle's test on the host, whose distances may differ in the last bits.
Hit reference(const TriangleTree& tree, const RayRecord& record) {
  ClosestTriangle query(record.t_min, record.t_max);
  const std::uint32_t instances = tree.instance_count == 0 ? 1 : tree.instance_count;
  for (std::uint32_t i = 0; i < instances; ++i) {
    const std::uint32_t count =
        tree.instance_count == 0 ? tree.triangle_count : tree.instances[i].slot_count;
    for (std::uint32_t p = 0; p < count; ++p) offer_candidate(tree, record.ray(), p, i, query);
  }
  return query.result();
}

struct Arrays {
  CudaOptixMemory& memory;
  std::vector<OptixBuffer> buffers{};

  template <class T>
  T* upload(const std::vector<T>& values) {
    buffers.emplace_back(memory, values.size() * sizeof(T), "arrays");
    memory.to_device(buffers.back().get(), values.data(), values.size() * sizeof(T));
    return static_cast<T*>(buffers.back().get());
  }
};

enum class Content { triangles, instances, spheres };

struct Case {
  std::vector<Triangle> triangles = make_triangles();
  std::vector<InstanceRecord> instances;
  std::vector<Sphere> spheres;  ///< among the triangles
  std::vector<RayRecord> rays = make_rays();
  std::vector<Hit> expected;  ///< `primitive` as HitRecord has it

  explicit Case(Content content) {
    if (content == Content::instances) {
      instances = {make_instance(2, Vec3(1), Vec3(0), 0, 1000, triangles),
                   make_instance(0, Vec3(-1, 1, 1), Vec3(0.5f, 0, 0), 0, 1000, triangles),
                   make_instance(1, Vec3(0.5f, 2, 0.25f), Vec3(0, 0, 1), 1000, 1000, triangles)};
    }
    Numbers numbers{3};
    for (int i = 0; content == Content::spheres && i < 30; ++i)
      spheres.push_back({numbers.point(), 0.01f + 0.01f * numbers.next()});
    const TriangleTree tree = view(triangles.data(), instances.data());
    for (RayRecord ray : rays) {
      Hit nearest;
      for (std::uint32_t i = 0; i < spheres.size(); ++i)
        keep_nearer(nearest, sphere_distance(spheres[i], ray.ray()), i);
      ray.t_max = nearest.t;
      Hit hit = reference(tree, ray);
      if (!hit.is_miss())
        hit.primitive = triangles[hit.primitive].id + static_cast<std::uint32_t>(spheres.size());
      expected.push_back(hit.is_miss() ? nearest : hit);
    }
  }

  TriangleTree view(const Triangle* all, const InstanceRecord* records) const {
    TriangleTree tree{};
    tree.triangles = all, tree.triangle_count = triangle_count;
    tree.instance_count = static_cast<std::uint32_t>(instances.size());
    tree.instances = instances.empty() ? nullptr : records;
    return tree;
  }
};

/// `ties`: OptiX decides, which of triangles at the same distance names any.
void compare(const Case& expected, const std::vector<HitRecord>& hits, bool any, bool ties) {
  int met = 0, differ = 0, far = 0, tied = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Hit& hit = expected.expected[i];
    if (!hit.is_miss()) ++met;
    if (any) {
      if ((hits[i].t == 0.0f) == hit.is_miss()) ++differ;
      continue;
    }
    const std::uint32_t id = hit.primitive;
    const bool is_near = !hit.is_miss() && std::abs(hits[i].t - hit.t) <= 1e-5f * hit.t;
    if (hits[i].primitive != id && ties && is_near) {
      ++tied;
    } else if (hits[i].primitive != id) {
      if (++differ <= 3)
        say(fmt::format("  ray {}: primitive {} at {}, expected {} at {}", i, hits[i].primitive,
                        hits[i].t, id, hit.t));
    } else if (!hit.is_miss() && !is_near) {
      if (++far <= 3) say(fmt::format("  ray {}: t {}, expected {}", i, hits[i].t, hit.t));
    }
  }
  say(fmt::format(
      "  {} of {} rays meet something; {} differ, {} at other distances, {} name others "
      "at the same distance",
      met, hits.size(), differ, far, tied));
  if (differ > 10 || far > 0) throw Error("hits differ");
}

void try_capture(OptixPipeline& pipeline, const OptixRayParams& params, cudaStream_t stream) {
  check_cuda(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal), "begin capture");
  std::string problem;
  try {
    pipeline.launch(OptixPipeline::closest, &params, 1024);
  } catch (const std::exception& error) {
    problem = error.what();
  }
  cudaGraph_t graph = nullptr;
  const cudaError_t end = cudaStreamEndCapture(stream, &graph);
  std::size_t nodes = 0;
  if (graph != nullptr) cudaGraphGetNodes(graph, nullptr, &nodes);
  say(fmt::format("  capture: launch '{}', end '{}', {} nodes", problem, cudaGetErrorString(end),
                  nodes));
  if (graph != nullptr) {
    cudaGraphExec_t exec = nullptr;
    const cudaError_t made = cudaGraphInstantiate(&exec, graph, 0);
    const cudaError_t launched = exec != nullptr ? cudaGraphLaunch(exec, stream) : made;
    const cudaError_t run = cudaStreamSynchronize(stream);
    say(fmt::format("  graph: instantiate '{}', launch '{}', run '{}'", cudaGetErrorString(made),
                    cudaGetErrorString(launched), cudaGetErrorString(run)));
    if (exec != nullptr) cudaGraphExecDestroy(exec);
    cudaGraphDestroy(graph);
  }
  cudaGetLastError();
}

void try_case(const OptixContext& context, CudaOptixMemory& memory, cudaStream_t stream,
              const Case& scene, OptixHits hits) {
  Arrays arrays{memory};
  TriangleTree tree = scene.view(arrays.upload(scene.triangles), arrays.upload(scene.instances));
  // Nodes without children: a ray that passes through our own tree meets nothing, and differs.
  tree.cwbvh = arrays.upload(std::vector<CwbvhNode>(4));
  Primitives primitives;
  primitives.sphere_count = static_cast<std::uint32_t>(scene.spheres.size());
  if (!scene.spheres.empty()) primitives.spheres = arrays.upload(scene.spheres);
  const Bvh2Node* const nodes = arrays.upload(std::vector<Bvh2Node>(1));
  std::unique_ptr<OptixStructure> structure;
  if (!step("structure", [&] {
        structure = std::make_unique<OptixStructure>(context, memory, tree, hits, primitives);
        say(fmt::format("  handle {:#x}, {} bytes, compacted {}, {:.2f} ms, margin {}",
                        structure->handle(), structure->bytes_built(), structure->bytes_compacted(),
                        structure->build_ms(), structure->reach().cull_margin));
      }))
    return;
  std::unique_ptr<OptixPipeline> pipeline;
  if (!step("module, program groups, pipeline, records", [&] {
        const auto begin = std::chrono::steady_clock::now();
        const OptixModule module{optix_ray_code(), sizeof(OptixRayParams)};
        pipeline =
            std::make_unique<OptixPipeline>(context, memory, module, hits, structure->content());
        say(fmt::format("  {:.1f} ms", std::chrono::duration<double, std::milli>(
                                           std::chrono::steady_clock::now() - begin)
                                           .count()));
      }))
    return;
  OptixRayParams params;
  params.scene = optix_scene(tree, *structure, primitives, nodes);
  params.rays.rays = arrays.upload(scene.rays);
  params.rays.count = ray_count;
  std::vector<HitRecord> results(ray_count, HitRecord{-7.0f, 7});
  params.rays.hits = arrays.upload(results);
  for (const bool any : {false, true}) {
    step(any ? "launch: any" : "launch: closest", [&] {
      CudaEvent begin, end;
      const auto kind = any ? OptixPipeline::any : OptixPipeline::closest;
      pipeline->launch(kind, &params, 1024);
      memory.synchronize();
      begin.record(stream);
      pipeline->launch(kind, &params, ray_count);
      end.record(stream);
      say(fmt::format("  {:.3f} ms", end.ms_since(begin)));
      memory.to_host(results.data(), params.rays.hits, results.size() * sizeof(HitRecord));
      compare(scene, results, any, hits == OptixHits::built_in);
    });
  }
  step("capture", [&] { try_capture(*pipeline, params, stream); });
}

int run(const std::string& only_hits, const std::string& only_scene) {
  setenv("PTEXP_OPTIX_LOG", "3", 0);
  std::shared_ptr<const OptixLibrary> library;
  if (!step("library", [&] {
        library = std::make_shared<const OptixLibrary>();
        say("  " + library->path());
      }))
    return 1;
  cudaStream_t stream = nullptr;
  if (!step("CUDA", [&] {
        check_cuda(cudaFree(nullptr), "cudaFree");
        check_cuda(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "cudaStreamCreate");
      }))
    return 1;
  std::unique_ptr<OptixContext> context;
  if (!step("context", [&] { context = std::make_unique<OptixContext>(library); })) return 1;
  step("RT cores", [&] { say(fmt::format("  version {}", context->rtcore_version())); });
  CudaOptixMemory memory(stream);
  say(fmt::format("code: {} bytes", optix_ray_code().size()));
  for (const auto& [content, shapes] :
       {std::pair(Content::triangles, "triangles"), std::pair(Content::instances, "instances"),
        std::pair(Content::spheres, "spheres")}) {
    if (only_scene != shapes && only_scene != "all") continue;
    const Case scene(content);
    for (const auto& [hits, name] :
         {std::pair(OptixHits::custom, "custom"), std::pair(OptixHits::any_hit, "any-hit"),
          std::pair(OptixHits::built_in, "built-in")}) {
      if (only_hits != "all" && only_hits != name) continue;
      say(fmt::format("== {} {}", name, shapes));
      step("case", [&, hits = hits] { try_case(*context, memory, stream, scene, hits); });
    }
  }
  say(fmt::format("{} steps failed", failures));
  return failures == 0 ? 0 : 1;
}

}  // namespace
}  // namespace pt

/// Usage: ptexp_optix_smoke [custom|any-hit|built-in|all [triangles|instances|spheres|all]]
int main(int argc, char** argv) {
  return pt::run(argc > 1 ? argv[1] : "all", argc > 2 ? argv[2] : "all");
}
