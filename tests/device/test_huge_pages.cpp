#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "common/device/cpu/huge_pages.h"

namespace pt {
namespace {

constexpr std::uintptr_t page = HugePageRange::page_bytes;

HugePageRange range(std::uintptr_t begin, std::size_t size_bytes) {
  return huge_page_range(reinterpret_cast<const void*>(begin), size_bytes);
}

TEST(HugePages, AreThoseThatAnArrayFills) {
  EXPECT_EQ(range(3 * page, page).begin, 3 * page);
  EXPECT_EQ(range(3 * page, page).size_bytes, page);
  EXPECT_EQ(range(3 * page + 16, 3 * page).begin, 4 * page);
  EXPECT_EQ(range(3 * page + 16, 3 * page).size_bytes, 2 * page);
  EXPECT_EQ(range(3 * page - 16, page + 16).begin, 3 * page);
  EXPECT_EQ(range(3 * page - 16, page + 16).size_bytes, page);
}

TEST(HugePages, NoneForSmallArrays) {
  EXPECT_EQ(range(0, 0).size_bytes, 0u);
  EXPECT_EQ(range(3 * page, page - 1).size_bytes, 0u);
  EXPECT_EQ(range(3 * page + 1, 2 * page - 2).size_bytes, 0u);
  EXPECT_EQ(range(3 * page + 1, 2 * page - 1).size_bytes, page);
}

TEST(HugePages, KeepWhatTheyHold) {
  SceneData scene;
  scene.texels.resize(3 * page + 5);
  for (std::size_t i = 0; i < scene.texels.size(); ++i) scene.texels[i] = std::byte(i % 251);
  const std::vector<std::byte> before = scene.texels;
  use_huge_pages(scene, 1e6);
  EXPECT_EQ(scene.texels, before);
}

/// KiB of huge pages that the process has, or -1 where the system does not say.
long huge_kib() {
  std::ifstream file("/proc/self/smaps_rollup");
  for (std::string word; file >> word;) {
    long kib = 0;
    if (word == "AnonHugePages:" && file >> kib) return kib;
  }
  return -1;
}

TEST(HugePages, AreNotForShortRenders) {
  SceneData scene;
  scene.texels.resize(8 * page);
  const long before = huge_kib();
  use_huge_pages(scene, 1e-3);
  EXPECT_EQ(huge_kib(), before);
}

}  // namespace
}  // namespace pt
