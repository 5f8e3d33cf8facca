// Random numbers on the GPU against cuRAND's own, and intersections there against the host's.
#include <curand_kernel.h>

#include <iostream>

#include "common/device/cuda/curand_state.cuh"
#include "common/device/cuda/film_kernels.cuh"
#include "common/geometry/quad.h"
#include "common/geometry/sphere.h"
#include "cuda_test.h"
#include "statistics.h"

namespace pt {
namespace {

constexpr int block_threads = 128;

/// Launches kernel(count, arguments...) with a thread for each of `count` things.
template <class... Parameters, class... Arguments>
void launch_for_each(std::size_t count, void (*kernel)(std::uint32_t, Parameters...),
                     Arguments... arguments) {
  const auto n = static_cast<std::uint32_t>(count);
  kernel<<<(n + block_threads - 1) / block_threads, block_threads>>>(n, arguments...);
  check_cuda(cudaGetLastError(), "launching a test's kernel");
}

__device__ std::uint32_t thread_index() { return blockIdx.x * blockDim.x + threadIdx.x; }

/// One draw of the renderer's.
struct Draw {
  std::uint64_t seed;
  std::uint32_t pixel, sample, block;
};

__global__ void draw_curand_philox(std::uint32_t n, const Draw* draws, uint4* bits) {
  if (const std::uint32_t i = thread_index(); i < n) {
    const Draw& d = draws[i];
    curandStatePhilox4_32_10_t state;
    curand_init(d.seed, d.pixel | std::uint64_t{d.sample} << 32, std::uint64_t{d.block} * 4,
                &state);
    bits[i] = curand4(&state);
  }
}

__global__ void draw_philox(std::uint32_t n, const Draw* draws, Vec4* values) {
  if (const std::uint32_t i = thread_index(); i < n) {
    const Draw& d = draws[i];
    values[i] = PhiloxSource{d.seed}.open({d.pixel, d.sample, i}).draw(d.block);
  }
}

/// Every corner of the counter's words, then random ones.
std::vector<Draw> many_draws() {
  std::vector<Draw> draws;
  const std::uint32_t words[] = {0, 1, 2, 100, 0x7fffffffu, 0x80000000u, 0xffffffffu};
  const std::uint64_t seeds[] = {0, 1, 0xffffffffu, std::uint64_t{1} << 32, ~std::uint64_t{0}};
  for (const std::uint64_t seed : seeds) {
    for (const std::uint32_t pixel : words) {
      for (const std::uint32_t sample : words) {
        // cuRAND's offset counts numbers and has 64 bits, so block's upper bits are kept.
        for (const std::uint32_t block : words) draws.push_back({seed, pixel, sample, block});
      }
    }
  }
  TestRandom random;
  for (int i = 0; i < 20'000; ++i) {
    const std::uint64_t seed = std::uint64_t{random.bits()} << 32 | random.bits();
    draws.push_back({seed, random.bits(), random.bits(), random.below(1000)});
  }
  return draws;
}

class CudaRandom : public CudaTest {};

TEST_F(CudaRandom, PhiloxEqualsCurandOnBothDevices) {
  const std::vector<Draw> draws = many_draws();
  const DeviceArray<Draw> device_draws(draws);
  const DeviceArray<uint4> curand_bits(draws.size());
  const DeviceArray<Vec4> device_values(draws.size());
  launch_for_each(draws.size(), draw_curand_philox, device_draws.data(), curand_bits.data());
  launch_for_each(draws.size(), draw_philox, device_draws.data(), device_values.data());
  const std::vector<uint4> expected = curand_bits.download();
  const std::vector<Vec4> found = device_values.download();
  for (std::size_t i = 0; i < draws.size(); ++i) {
    const Draw& d = draws[i];
    SCOPED_TRACE(testing::Message() << "seed " << d.seed << ", pixel " << d.pixel << ", sample "
                                    << d.sample << ", block " << d.block);
    const Uint4 host =
        philox4x32_10({d.block, 0, d.pixel, d.sample}, static_cast<std::uint32_t>(d.seed),
                      static_cast<std::uint32_t>(d.seed >> 32));
    const uint4& e = expected[i];
    ASSERT_EQ(host.x, e.x);
    ASSERT_EQ(host.y, e.y);
    ASSERT_EQ(host.z, e.z);
    ASSERT_EQ(host.w, e.w);
    const std::uint32_t words[] = {e.x, e.y, e.z, e.w};
    const Vec4 host_value = PhiloxSource{d.seed}.open({d.pixel, d.sample, 0}).draw(d.block);
    for (int c = 0; c < 4; ++c) {
      const float unit = static_cast<float>(words[c] / 256) / 16777216.0f;
      ASSERT_EQ(found[i][c], unit);
      ASSERT_EQ(host_value[c], unit);
    }
  }
}

__global__ void draw_curand_xorwow(std::uint32_t n, const std::uint64_t* seeds, int count,
                                   std::uint32_t* bits) {
  if (const std::uint32_t i = thread_index(); i < n) {
    curandStateXORWOW_t state;
    curand_init(seeds[i], 0, 0, &state);
    for (int k = 0; k < count; ++k) bits[i * count + k] = curand(&state);
  }
}

TEST_F(CudaRandom, XorwowOnTheHostEqualsCurand) {
  constexpr int draw_count = 4096;
  std::vector<std::uint64_t> seeds{
      0, 1, 2, 0xffffffffu, std::uint64_t{1} << 32, ~std::uint64_t{0}, 0xf7dcefddaad26b49u};
  TestRandom random(2);
  while (seeds.size() < 500) seeds.push_back(std::uint64_t{random.bits()} << 32 | random.bits());
  const DeviceArray<std::uint64_t> device_seeds(seeds);
  const DeviceArray<std::uint32_t> bits(seeds.size() * draw_count);
  launch_for_each(seeds.size(), draw_curand_xorwow, device_seeds.data(), draw_count, bits.data());
  const std::vector<std::uint32_t> expected = bits.download();
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    XorwowState state;
    xorwow_init(seeds[i], state);
    for (std::size_t k = 0; k < draw_count; ++k) {
      ASSERT_EQ(xorwow_next(state), expected[i * draw_count + k])
          << "seed " << seeds[i] << ", draw " << k;
    }
  }
}

__global__ void draw_source(std::uint32_t n, CurandState* states, SampleBuffer batch, int blocks,
                            Vec4* values) {
  if (const std::uint32_t i = thread_index(); i < n) {
    const XorwowSource<CurandState> source{states};
    const PathId id = batch.id_of(i);
    // Half of the numbers in one go, the others one block at a time as in the wavefront.
    auto stream = source.open(id);
    for (int k = 0; k < blocks / 2; ++k) values[i * blocks + k] = stream.draw(k);
    source.close(id, stream);
    for (int k = blocks / 2; k < blocks; ++k) {
      stream = source.open(id);
      values[i * blocks + k] = stream.draw(k);
      source.close(id, stream);
    }
  }
}

// The renderer's kernel and source, of a batch that does not begin with the first sample.
TEST_F(CudaRandom, RenderInitGivesEveryPathTheHostsSequence) {
  constexpr std::uint64_t seed = 0x123456789abcdefu;
  constexpr int blocks = 10;
  SampleBuffer batch;
  batch.width = FastDivider(23);
  batch.pixel_count = FastDivider(23 * 11);
  batch.first_sample = 1000;
  batch.sample_count = 5;
  batch.path_count = 23 * 11 * 5;
  const DeviceArray<CurandState> states(batch.path_count);
  const DeviceArray<StageClock> clock{std::vector<StageClock>(1)};
  const DeviceArray<Vec4> values(batch.path_count * blocks);
  render_init<<<(batch.path_count + 255) / 256, 256>>>(states.data(), batch, seed, clock.data());
  check_cuda(cudaGetLastError(), "render_init");
  launch_for_each(batch.path_count, draw_source, states.data(), batch, blocks, values.data());
  const std::vector<Vec4> found = values.download();
  for (std::uint32_t i = 0; i < batch.path_count; ++i) {
    const std::uint32_t x = i % 23, y = i / 23 % 11, sample = 1000 + i / (23 * 11);
    XorwowState state;
    xorwow_init(xorwow_seed(seed, {x | y << 16, sample, 0}), state);
    for (std::uint32_t k = 0; k < 4 * blocks; ++k) {
      ASSERT_EQ(found[i * blocks + k / 4][static_cast<int>(k % 4)],
                static_cast<float>(xorwow_next(state) / 256) / 16777216.0f)
          << "path " << i << ", number " << k;
    }
  }
}

/// A ray that meets its primitive well inside, where no rounding decides.
template <class Primitive>
struct Shot {
  Primitive primitive;
  Ray ray;
  double scale;  ///< magnitude of the operands whose rounding reaches the distance
};

__device__ float distance_to(const Sphere& sphere, const Ray& ray) {
  return sphere_distance(sphere, ray);
}
__device__ float distance_to(const Quad& quad, const Ray& ray) { return quad_distance(quad, ray); }

template <class Primitive>
__global__ void shoot(std::uint32_t n, const Shot<Primitive>* shots, float* distances) {
  if (const std::uint32_t i = thread_index(); i < n) {
    distances[i] = distance_to(shots[i].primitive, shots[i].ray);
  }
}

template <class Primitive>
std::vector<float> shoot_on_device(const std::vector<Shot<Primitive>>& shots) {
  const DeviceArray<Shot<Primitive>> device_shots(shots);
  const DeviceArray<float> distances(shots.size());
  launch_for_each(shots.size(), shoot<Primitive>, device_shots.data(), distances.data());
  return distances.download();
}

/// Keeps the worst of |a - b| in units of the last place of `scale`.
class UlpError {
 public:
  void add(double a, double b, double scale) {
    const double ulp = std::ldexp(1.0, std::ilogb(scale) - 23);
    worst_ = std::max(worst_, std::abs(a - b) / ulp);
  }
  double worst() const { return worst_; }

 private:
  double worst_ = 0;
};

Vec3 to_float(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

constexpr int shot_count = 200'000;

class CudaIntersections : public CudaTest {};

TEST_F(CudaIntersections, SphereDistancesEqualTheHosts) {
  TestRandom random(3);
  std::vector<Shot<Sphere>> shots;
  for (int i = 0; i < shot_count; ++i) {
    const double radius = random.log_uniform(0.1, 1000);
    const glm::dvec3 center = random.uniform(0, 20) * random.direction();
    // From outside or inside, through a point within 0.9 of the radius.
    const double away = radius * (i % 3 == 0 ? random.uniform(0, 0.9) : random.uniform(1.1, 20));
    const glm::dvec3 origin = center + away * random.direction();
    const glm::dvec3 target = center + radius * random.uniform(0, 0.9) * random.direction();
    if (glm::length(target - origin) < 0.01 * radius) continue;
    const Sphere sphere{to_float(center), static_cast<float>(radius * radius)};
    shots.push_back({sphere, {to_float(origin), normalize(to_float(target - origin))}, 0});
    shots.back().scale = std::max(radius, glm::length(center - origin));
  }
  const std::vector<float> found = shoot_on_device(shots);
  UlpError error;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const float host = sphere_distance(shots[i].primitive, shots[i].ray);
    ASSERT_GT(host, 0.0f) << i;
    ASSERT_GT(found[i], 0.0f) << i;
    error.add(found[i], host, shots[i].scale);
  }
  std::cout << "spheres: worst difference " << error.worst() << " ulp\n";
  EXPECT_LE(error.worst(), 16);
}

TEST_F(CudaIntersections, QuadDistancesEqualTheHosts) {
  TestRandom random(4);
  std::vector<Shot<Quad>> shots;
  while (shots.size() < shot_count) {
    const glm::dvec3 corner = random.uniform(0, 20) * random.direction();
    const glm::dvec3 a = random.log_uniform(0.1, 20) * random.direction();
    const glm::dvec3 b = random.log_uniform(0.1, 20) * random.direction();
    const glm::dvec3 target =
        corner + random.uniform(0.05, 0.95) * a + random.uniform(0.05, 0.95) * b;
    const glm::dvec3 origin = target + random.log_uniform(0.1, 100) * random.direction();
    const glm::dvec3 n = glm::normalize(glm::cross(a, b));
    const double cosine = std::abs(glm::dot(n, glm::normalize(target - origin)));
    const double sine = glm::length(glm::cross(glm::normalize(a), glm::normalize(b)));
    if (cosine < 0.1 || sine < 0.1) continue;
    shots.push_back({make_quad(to_float(corner), to_float(a), to_float(b)),
                     {to_float(origin), normalize(to_float(target - origin))},
                     glm::length(corner - origin) / cosine});
  }
  const std::vector<float> found = shoot_on_device(shots);
  UlpError error;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const float host = quad_distance(shots[i].primitive, shots[i].ray);
    ASSERT_GT(host, 0.0f) << i;
    ASSERT_GT(found[i], 0.0f) << i;
    error.add(found[i], host, shots[i].scale);
  }
  std::cout << "quads: worst difference " << error.worst() << " ulp\n";
  EXPECT_LE(error.worst(), 16);
}

}  // namespace
}  // namespace pt
