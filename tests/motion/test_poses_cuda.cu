// Poses and their inverses on a GPU against the CPU's.
#include "common/geometry/motion.h"
#include "common/sampling/random.h"
#include "cuda_test.h"

namespace pt {
namespace {

constexpr std::uint32_t poses = 1u << 16;

/// Four numbers in [-1, 1).
Vec4 numbers(std::uint32_t i, std::uint32_t k) {
  const Uint4 bits = philox4x32_10({i, k, 0, 0}, 1, 2);
  const auto number = [](std::uint32_t b) { return 2.0f * to_unit_float(b) - 1.0f; };
  return {number(bits.x), number(bits.y), number(bits.z), number(bits.w)};
}

MotionSegment segment_of(std::uint32_t i) {
  MotionSegment segment;
  segment.translation = 10.0f * Vec3(numbers(i, 0));
  segment.translated = Vec3(numbers(i, 1));
  segment.inverse_length = segment.end = 1.0f;
  const Vec4 q = numbers(i, 2), p = numbers(i, 3);
  segment.rotation = q / glm::length(q);
  const Vec4 across = p - segment.rotation * glm::dot(p, segment.rotation);
  segment.towards = across / glm::length(across);
  segment.turns = 0.125f * (1.0f + numbers(i, 4).x);
  for (int k = 0; k < 3; ++k) segment.stretched[k][k] = 0.5f * numbers(i, 5)[k];
  return segment;
}

__global__ void pose_segments(const MotionSegment* segments, Affine* result) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  result[i] = pose_at(segments, {i, 1}, static_cast<float>(i) / static_cast<float>(poses));
}

__global__ void invert_poses(const Affine* from, Affine* result) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  result[i] = inverse(from[i]);
}

class CudaPoses : public CudaTest {};

TEST_F(CudaPoses, AreTheCpusAndTheirInversesHaveItsBits) {
  std::vector<MotionSegment> segments;
  std::vector<Affine> expected;
  for (std::uint32_t i = 0; i < poses; ++i) segments.push_back(segment_of(i));
  for (std::uint32_t i = 0; i < poses; ++i)
    expected.push_back(
        pose_at(segments.data(), {i, 1}, static_cast<float>(i) / static_cast<float>(poses)));
  const DeviceArray<MotionSegment> input(segments);
  const DeviceArray<Affine> found(segments.size()), inverses(segments.size());
  pose_segments<<<poses / 128, 128>>>(input.data(), found.data());
  invert_poses<<<poses / 128, 128>>>(found.data(), inverses.data());
  const std::vector<Affine> gpu = found.download(), inverted = inverses.download();
  for (std::size_t i = 0; i < poses; ++i) {
    const Affine back = inverse(gpu[i]);
    for (int row = 0; row < 3; ++row) {
      for (int k = 0; k < 4; ++k) {
        ASSERT_NEAR(gpu[i].row[row][k], expected[i].row[row][k], 1e-5f) << i;
        ASSERT_EQ(float_to_bits(inverted[i].row[row][k]), float_to_bits(back.row[row][k])) << i;
      }
    }
  }
}

}  // namespace
}  // namespace pt
