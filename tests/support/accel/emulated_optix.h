// OptiX on the host, over the tests' library: memory, and a traversal that meets the boxes or
// triangles of a structure in an order of its own and runs the programs that the GPU runs.
#pragma once

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>

#include "accel/fake_optix.h"
#include "common/accel/trace_optix/optix_memory.h"
#include "common/accel/trace_optix/optix_programs.h"

namespace pt {

/// The host's memory; `allocated` are the blocks that are not released.
class HostOptixMemory : public OptixMemory {
 public:
  void* allocate(std::size_t bytes, const char*) override {
    void* memory = std::aligned_alloc(128, (bytes + 127) / 128 * 128);
    allocated.insert(memory);
    return memory;
  }
  void release(void* memory) noexcept override {
    allocated.erase(memory);
    std::free(memory);
  }
  void to_device(void* to, const void* from, std::size_t bytes) override {
    std::memcpy(to, from, bytes);
  }
  void to_host(void* to, const void* from, std::size_t bytes) override {
    std::memcpy(to, from, bytes);
  }
  void enqueue_to_device(void* to, const void* from, std::size_t bytes) override {
    std::memcpy(to, from, bytes);
  }
  void synchronize() override {}
  optix::Stream stream() const override { return nullptr; }
  void enqueue_boxes(optix::Box* boxes, const Triangle* triangles, std::size_t count,
                     const OptixBoxMargin& margin) override {
    for (std::size_t i = 0; i < count; ++i) boxes[i] = optix_box(triangles[i], margin);
  }

  std::set<void*> allocated;
};

/// The programs of a module, by name.
using OptixPrograms = std::map<std::string, std::function<void()>>;

/// OptiX's functions (optix_programs.h) for one thread after the other.
struct EmulatedApi {
  // What optixIgnoreIntersection and optixTerminateRay end a program by.
  struct Ignored {};
  struct Terminated {};

  struct State {
    const FakeOptix* library = nullptr;
    const FakeOptix::Launch* launch = nullptr;
    const OptixPrograms* programs = nullptr;
    std::uint32_t index = 0;
    // Of the trace that runs:
    Ray ray;
    float t_min = 0, t_max = 0;
    unsigned flags = 0, record = 0;
    OptixPayload payload{};
    std::uint32_t primitive = 0, instance = 0, offset = 0;  ///< offset: of the instance's records
    bool ended = false, accepted = false;
    bool has_hit_object = false;            ///< a traversal's
    std::map<std::uint32_t, int> reorders;  ///< of the launch: how often, by key
    int traversals = 0;                     ///< likewise
    std::uint32_t hit_primitive = 0, hit_instance = 0, hit_offset = 0;
  };
  static State& state() {
    static thread_local State one;
    return one;
  }

  static std::uint32_t launch_index() { return state().index; }
  static std::uint32_t launch_width() { return state().launch->width; }
  static std::uint32_t primitive_index() { return state().primitive; }
  static std::uint32_t instance_id() { return state().instance; }
  static float ray_t_max() { return state().t_max; }
  static std::uint32_t payload_word(int i) { return state().payload.word[i]; }
  static void set_payload_word(int i, std::uint32_t word) { state().payload.word[i] = word; }
  static void report_intersection(float t) {
    State& s = state();
    if (!(t >= s.t_min && t <= s.t_max)) return;
    if ((s.flags & optix::ray_disable_anyhit) != 0) return accept(t);
    run_any(t);
  }
  static void ignore_intersection() { throw Ignored(); }
  static void terminate_ray() { throw Terminated(); }

  static void trace(optix::TraversableHandle handle, const Ray& ray, float t_min, float t_max,
                    unsigned flags, unsigned record, OptixPayload& payload) {
    traverse(handle, ray, t_min, t_max, flags, record, payload);
    invoke(payload);
  }

  static void traverse(optix::TraversableHandle handle, const Ray& ray, float t_min, float t_max,
                       unsigned flags, unsigned record, OptixPayload& payload) {
    State& s = state();
    s.ray = ray, s.t_min = t_min, s.t_max = t_max, s.flags = flags, s.record = record;
    s.payload = payload, s.ended = s.accepted = false, s.offset = 0;
    ++s.traversals;
    if (handle != 0) traverse(handle);
    payload = s.payload;
    s.has_hit_object = true;
  }

  static void reorder(std::uint32_t key, std::uint32_t bits) {
    if (!state().has_hit_object) throw std::logic_error("nothing was traversed");
    if (key >> bits != 0) throw std::logic_error("the key has more bits");
    ++state().reorders[key];
  }

  static void invoke(OptixPayload& payload) {
    State& s = state();
    s.payload = payload;
    if (s.accepted && (s.flags & optix::ray_disable_closesthit) == 0) {
      s.primitive = s.hit_primitive, s.instance = s.hit_instance, s.offset = s.hit_offset;
      run(group().hit.closest);
    }
    payload = s.payload;
    s.has_hit_object = false;
  }

 private:
  static const optix::ProgramGroupDescription& group() {
    return state().launch->hit.at(state().record + state().offset);
  }
  static void run(const optix::Program& program) {
    if (program.entry != nullptr) state().programs->at(program.entry)();
  }

  static void accept(float t) {
    State& s = state();
    s.t_max = t, s.accepted = true;
    s.hit_primitive = s.primitive, s.hit_instance = s.instance, s.hit_offset = s.offset;
    if ((s.flags & optix::ray_terminate_on_first_hit) != 0) s.ended = true;
  }

  static void traverse(optix::TraversableHandle handle) {
    State& s = state();
    const FakeOptix::Structure& top = s.library->structures.at(handle);
    if (top.instances.empty()) return traverse_group(top, s.ray);
    for (const optix::Instance& instance : top.instances) {
      Affine to_world;
      std::memcpy(to_world.row, instance.to_world, sizeof instance.to_world);
      const Affine to_object = inverse(to_world);
      s.instance = instance.id, s.offset = instance.record_offset;
      traverse_group(s.library->structures.at(instance.group),
                     {to_object.point(s.ray.origin), to_object.vector(s.ray.direction)});
      if (s.ended) return;
    }
  }

  /// Every primitive, in an order that is no traversal's.
  static void traverse_group(const FakeOptix::Structure& group_data, const Ray& ray) {
    State& s = state();
    for (unsigned k = 0; k < group_data.count && !s.ended; ++k) {
      const unsigned i =
          static_cast<unsigned>((std::uint64_t{k} * 7919 + s.index) % group_data.count);
      s.primitive = group_data.count % 7919 == 0 ? k : i;
      if (group_data.vertices == nullptr) {
        double near, far;
        if (enters(group_data.boxes[s.primitive], ray, near, far)) run(group().hit.intersection);
      } else {
        meet_triangle(group_data.vertices + 48 * std::size_t{s.primitive}, ray);
      }
    }
  }

  /// Where the ray is inside, in double precision, up to where the interval ends.
  static bool enters(const optix::Box& box, const Ray& ray, double& near, double& far) {
    near = state().t_min, far = state().t_max;
    for (int i = 0; i < 3; ++i) {
      const double o = ray.origin[i], d = ray.direction[i];
      if (d == 0) {
        if (o < box.min[i] || o > box.max[i]) return false;
        continue;
      }
      const double a = (box.min[i] - o) / d, b = (box.max[i] - o) / d;
      near = std::max(near, std::min(a, b)), far = std::min(far, std::max(a, b));
    }
    return near <= far;
  }

  /// Moeller and Trumbore in double precision. Where programs judge, every triangle is named whose
  /// box is entered: none that our test meets is missing, as a GPU's may be.
  static void meet_triangle(const char* vertices, const Ray& ray) {
    State& s = state();
    const bool judged = (s.flags & optix::ray_disable_anyhit) == 0;
    using V = glm::dvec3;
    Vec3 v[3];
    for (int i = 0; i < 3; ++i) std::memcpy(&v[i], vertices + 16 * i, sizeof v[i]);
    const V e1 = V(v[1]) - V(v[0]), e2 = V(v[2]) - V(v[0]), d(ray.direction);
    const V p = glm::cross(d, e2);
    const double det = glm::dot(e1, p);
    if (det == 0 && !judged) return;
    const V to = V(ray.origin) - V(v[0]), q = glm::cross(to, e1);
    const double b1 = glm::dot(to, p) / det, b2 = glm::dot(d, q) / det;
    auto t = static_cast<float>(glm::dot(e2, q) / (det == 0 ? 1 : det));
    if (!judged) {
      const bool is_inside = b1 >= 0 && b2 >= 0 && b1 + b2 <= 1;
      if (is_inside && t >= s.t_min && t <= s.t_max) accept(t);
      return;
    }
    double near, far;
    const Triangle triangle{v[0], 0, v[1], 0, v[2], 0};
    if (!enters(optix_box(triangle, {1e-4f}), ray, near, far)) return;
    run_any(std::clamp(t, static_cast<float>(near), static_cast<float>(far)));
  }

  /// What meets a candidate at `t`; without a program it is accepted.
  static void run_any(float t) {
    try {
      run(group().hit.any);
      accept(t);
    } catch (Ignored) {
    } catch (Terminated) {
      accept(t);
      state().ended = true;
    }
  }
};

/// The programs that judge (PT_OPTIX_HIT_PROGRAMS); `scene` gives the module's OptixScene.
template <class Api, class Closest, class Any, class Scene>
OptixPrograms hit_programs(Scene scene) {
  using namespace optix;
  OptixPrograms programs;
  programs["__intersection__closest"] = [=] { intersect_closest_box<Api, Closest>(scene()); };
  programs["__intersection__any"] = [=] { intersect_any_box<Api, Any>(scene()); };
  programs["__anyhit__closest"] = [=] { accept_closest<Api, Closest>(scene()); };
  programs["__anyhit__ties"] = [=] { judge_all<Api, Closest>(scene()); };
  programs["__anyhit__any"] = [=] { accept_any<Api, Any>(scene()); };
  programs["__closesthit__name"] = [=] { name_hit<Api>(scene()); };
  programs["__intersection__closest_sphere"] = [=] {
    intersect_closest_box<Api, Closest, true>(scene());
  };
  programs["__intersection__any_sphere"] = [=] { intersect_any_box<Api, Any, true>(scene()); };
  programs["__intersection__sphere"] = [=] { report_sphere<Api>(scene()); };
  programs["__anyhit__end"] = [] { Api::terminate_ray(); };
  programs["__closesthit__name_sphere"] = [] { name_sphere<Api>(); };
  return programs;
}

/// The names of kinds of hits as parameters of tests.
inline std::string hits_name(const testing::TestParamInfo<OptixHits>& test) {
  return test.param == OptixHits::custom    ? "custom"
         : test.param == OptixHits::any_hit ? "any_hit"
                                            : "built_in";
}

/// The tests' library, which lies beside their program, and which PTEXP_OPTIX_LIBRARY names as long
/// as this lives.
class UsedFakeOptix {
 public:
  UsedFakeOptix() {
    const std::string path =
        (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "libptexp_fake_optix.so")
            .string();
    handle_ = dlopen(path.c_str(), RTLD_NOW);
    if (handle_ == nullptr) throw std::runtime_error(dlerror());
    fake_ = reinterpret_cast<GetFakeOptix>(dlsym(handle_, "fake_optix"))();
    fake_->reset();
    setenv("PTEXP_OPTIX_LIBRARY", path.c_str(), 1);
  }
  ~UsedFakeOptix() {
    unsetenv("PTEXP_OPTIX_LIBRARY");
    fake_->reset();
    dlclose(handle_);
  }
  UsedFakeOptix(const UsedFakeOptix&) = delete;
  UsedFakeOptix& operator=(const UsedFakeOptix&) = delete;

  FakeOptix& operator*() const { return *fake_; }
  FakeOptix* operator->() const { return fake_; }

  /// Launches run these programs; `set_params` is told the launch's parameters.
  void emulate(OptixPrograms programs, std::function<void(const void*)> set_params) {
    fake_->run = [this, programs = std::move(programs),
                  set_params = std::move(set_params)](const FakeOptix::Launch& launch) {
      set_params(launch.params);
      EmulatedApi::State& state = EmulatedApi::state();
      state.reorders.clear(), state.traversals = 0;
      state.library = fake_, state.launch = &launch, state.programs = &programs;
      for (state.index = 0; state.index < launch.width; ++state.index) programs.at(launch.raygen)();
    };
  }

 private:
  void* handle_ = nullptr;
  FakeOptix* fake_ = nullptr;
};

}  // namespace pt
