// Division and root without branches on the GPU, against the CPU's own.
#include <cmath>
#include <limits>

#include "common/sampling/random.h"
#include "cuda_test.h"

namespace pt {
namespace {

constexpr std::uint32_t pairs = 1u << 20;

struct Numbers {
  float a, b;
};

/// Has either sign, and an absolute value between 2^-50 and 2^50.
float spread(std::uint32_t bits) {
  const float fraction = bits_to_float(0x3f800000u | (bits & 0x807fffffu));
  return std::ldexp(fraction, static_cast<int>(bits >> 23 & 0xffu) % 100 - 50);
}

std::vector<Numbers> spread_numbers() {
  std::vector<Numbers> numbers;
  for (std::uint32_t i = 0; i < pairs; ++i) {
    const Uint4 bits = philox4x32_10({i, 0, 0, 0}, 1, 2);
    numbers.push_back({spread(bits.x), spread(bits.y)});
  }
  return numbers;
}

__global__ void divide_pairs(std::uint32_t n, const Numbers* numbers, float* quotients) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < n) quotients[i] = divide(numbers[i].a, numbers[i].b);
}

__global__ void take_roots(std::uint32_t n, const Numbers* numbers, float* roots) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < n) roots[i] = square_root(numbers[i].a);
}

class CudaDivision : public CudaTest {
 protected:
  using Kernel = void (*)(std::uint32_t, const Numbers*, float*);

  static std::vector<float> run(Kernel kernel, const std::vector<Numbers>& numbers) {
    const DeviceArray<Numbers> input(numbers);
    const DeviceArray<float> output(numbers.size());
    const auto n = static_cast<std::uint32_t>(numbers.size());
    kernel<<<(n + 127) / 128, 128>>>(n, input.data(), output.data());
    return output.download();
  }
};

TEST_F(CudaDivision, RoundsAsTheOperatorDoes) {
  const std::vector<Numbers> numbers = spread_numbers();
  const std::vector<float> quotients = run(divide_pairs, numbers);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const float expected = numbers[i].a / numbers[i].b;
    ASSERT_EQ(float_to_bits(quotients[i]), float_to_bits(expected))
        << numbers[i].a << " / " << numbers[i].b;
  }
}

TEST_F(CudaDivision, TakesZeroAndInfinityForWhatTheyAre) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const std::vector<Numbers> numbers = {{0.0f, 3.0f},     {0.0f, -1e-30f},  {1.0f, 0.0f},
                                        {-2.0f, 0.0f},    {1.0f, infinity}, {-1.0f, infinity},
                                        {infinity, 2.0f}, {infinity, -2.0f}};
  const std::vector<float> quotients = run(divide_pairs, numbers);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    EXPECT_EQ(quotients[i], numbers[i].a / numbers[i].b) << numbers[i].a << " / " << numbers[i].b;
  }
  EXPECT_TRUE(std::isnan(run(divide_pairs, {{0.0f, 0.0f}})[0]));
}

TEST_F(CudaDivision, RootsRoundAsThoseOfTheLibraryDo) {
  std::vector<Numbers> numbers = spread_numbers();
  for (Numbers& pair : numbers) pair.a = std::fabs(pair.a);
  numbers.push_back({0.0f, 0.0f});
  const std::vector<float> roots = run(take_roots, numbers);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    ASSERT_EQ(float_to_bits(roots[i]), float_to_bits(std::sqrt(numbers[i].a))) << numbers[i].a;
  }
}

}  // namespace
}  // namespace pt
