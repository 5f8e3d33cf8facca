#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "common/error/host_memory.h"
#include "common/image/codecs/image_codec.h"
#include "load/png_bytes.h"
#include "temp_folder.h"

namespace pt {
namespace {

constexpr std::uint64_t unlimited = ~std::uint64_t{0};

/// A machine's /proc and /sys.
class Machine {
 public:
  explicit Machine(const std::string& groups) {
    write("proc/meminfo", "MemTotal: 9000 kB\nMemFree: 10 kB\nMemAvailable:    5000 kB\n");
    write("proc/self/cgroup", groups);
  }

  void write(const std::string& path, const std::string& text) const {
    const std::filesystem::path file = folder_.file(path);
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }

  std::uint64_t free_bytes() const { return free_host_memory(folder_.file("")); }

 private:
  TempFolder folder_;
};

TEST(HostMemory, IsWhatTheMachineHas) {
  EXPECT_EQ(Machine("").free_bytes(), 5000u * 1024);
  EXPECT_EQ(free_host_memory(TempFolder().file("")), unlimited) << "where nothing is known";
}

TEST(HostMemory, IsWhatTheGroupHas) {
  const Machine machine("0::/batch/job\n");
  EXPECT_EQ(machine.free_bytes(), 5000u * 1024);
  machine.write("sys/fs/cgroup/batch/job/memory.max", "max\n");
  machine.write("sys/fs/cgroup/batch/job/memory.current", "700000\n");
  EXPECT_EQ(machine.free_bytes(), 5000u * 1024);
  machine.write("sys/fs/cgroup/batch/job/memory.max", "1000000\n");
  EXPECT_EQ(machine.free_bytes(), 300000u);
  machine.write("sys/fs/cgroup/batch/job/memory.stat",
                "anon 100\nactive_file 1\ninactive_file 50000\n");
  EXPECT_EQ(machine.free_bytes(), 350000u) << "a cache of files gives way";
}

TEST(HostMemory, IsWhatTheGroupsAboveHave) {
  const Machine machine("0::/batch/job\n");
  machine.write("sys/fs/cgroup/batch/job/memory.max", "1000000\n");
  machine.write("sys/fs/cgroup/batch/memory.max", "500000\n");
  machine.write("sys/fs/cgroup/batch/memory.current", "480000\n");
  EXPECT_EQ(machine.free_bytes(), 20000u);
  machine.write("sys/fs/cgroup/batch/memory.current", "600000\n");
  EXPECT_EQ(machine.free_bytes(), 0u);
}

TEST(HostMemory, IsWhatTheFirstVersionOfGroupsHas) {
  const Machine machine("5:cpu,cpuacct:/cpu\n4:memory:/docker/1\n0::/unused\n");
  machine.write("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_EQ(machine.free_bytes(), 5000u * 1024);
  // In a container the group's folder is the root of what it sees.
  machine.write("sys/fs/cgroup/memory/memory.limit_in_bytes", "2000000\n");
  machine.write("sys/fs/cgroup/memory/memory.usage_in_bytes", "500000\n");
  machine.write("sys/fs/cgroup/memory/memory.stat",
                "inactive_file 7\ntotal_inactive_file 100000\n");
  EXPECT_EQ(machine.free_bytes(), 1600000u);
}

/// Leaves the process, and a sanitizer's shadow memory in it, so much more than it has.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::uint64_t margin_bytes) {
    EXPECT_EQ(::getrlimit(RLIMIT_AS, &old_), 0);
    std::uint64_t pages = 0;
    EXPECT_TRUE(std::ifstream("/proc/self/statm") >> pages);
    const rlimit small{pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) + margin_bytes,
                       old_.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_AS, &small), 0);
  }
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;
  ~MemoryLimit() { ::setrlimit(RLIMIT_AS, &old_); }

 private:
  rlimit old_{};
};

TEST(HostMemory, IsWhatTheProcessMayTake) {
  constexpr std::uint64_t margin = 256 << 20;
  const std::uint64_t before = free_host_memory();
  std::uint64_t within = 0;
  {
    const MemoryLimit limit(margin);
    within = free_host_memory();
  }
  EXPECT_GT(before, margin);
  EXPECT_LE(within, margin);
  EXPECT_GT(within, margin / 2) << "what this test itself may have taken since";
}

// Of 2^23 pixels: a texture takes four channels of one or two bytes, which are what is announced
// before they are read.
TEST(HostMemory, PicturesSayWhatTheyTake) {
  const std::string samples(48 << 20, '\0');
  const auto ppm = [&](const char* kind, int maximum) {
    return std::string(kind) + " 4096 2048 " + std::to_string(maximum) + "\n" + samples;
  };
  const auto png = [](int depth, int type) {
    return png_file(4096, 2048, depth, type, std::string(2048, '\0'));
  };
  const auto expect = [](const std::string& file, auto decode, int needed_mib) {
    const MemoryLimit limit(16 << 20);
    expect_error([&] { decode(file); },
                 fmt::format("an image of 4096x2048 pixels needs {} MiB", needed_mib));
  };
  expect(ppm("P6", 255), decode_ppm_integers, 32);
  expect(ppm("P6", 256), decode_ppm_integers, 64);
  expect(ppm("P5", 65535), decode_ppm_integers, 64);
  expect(png(8, 2), decode_png_integers, 32);
  expect(png(16, 0), decode_png_integers, 64);
  expect(png(16, 6), decode_png_integers, 64);
}

TEST(HostMemory, TheErrorTellsWhatIsNeededAndFree) {
  expect_error([] { check_host_memory(std::uint64_t{1} << 60, "the moon"); },
               "not enough memory: the moon needs 1099511627776 MiB, ");
  check_host_memory(1, "nothing");
}

}  // namespace
}  // namespace pt
