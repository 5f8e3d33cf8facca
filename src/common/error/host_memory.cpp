#include "common/error/host_memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <new>
#include <stdexcept>
#include <string_view>
#include <system_error>

namespace pt {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t unlimited = ~std::uint64_t{0};

std::uint64_t less(std::uint64_t whole, std::uint64_t part) {
  return whole == unlimited ? unlimited : whole - std::min(whole, part);
}

/// The number that a file consists of, or that follows `key` at the start of a line.
std::uint64_t number_in(const fs::path& path, std::string_view key, std::uint64_t otherwise) {
  std::ifstream file(path);
  std::string word;
  std::uint64_t value = 0;
  if (key.empty()) return file >> value ? value : otherwise;
  while (file >> word) {
    if (word == key) return file >> value ? value : otherwise;
  }
  return otherwise;
}

std::uint64_t of_machine(const fs::path& root) {
  const std::uint64_t kib = number_in(root / "proc/meminfo", "MemAvailable:", unlimited);
  return kib == unlimited ? unlimited : kib * 1024;
}

/// What version 1 or 2 of control groups calls its files.
struct GroupFiles {
  const char *folder, *limit, *used, *cache;
};

/// A group's limit holds for those below it too. Files in its cache give way.
std::uint64_t of_groups(const fs::path& root, const GroupFiles& files, fs::path group) {
  std::uint64_t least = unlimited;
  for (group = group.relative_path();; group = group.parent_path()) {
    const fs::path folder = root / files.folder / group;
    const std::uint64_t cache = number_in(folder / "memory.stat", files.cache, 0);
    const std::uint64_t used = less(number_in(folder / files.used, "", 0), cache);
    least = std::min(least, less(number_in(folder / files.limit, "", unlimited), used));
    if (group.empty()) return least;
  }
}

std::uint64_t of_groups(const fs::path& root) {
  constexpr GroupFiles v1 = {"sys/fs/cgroup/memory", "memory.limit_in_bytes",
                             "memory.usage_in_bytes", "total_inactive_file"};
  constexpr GroupFiles v2 = {"sys/fs/cgroup", "memory.max", "memory.current", "inactive_file"};
  std::ifstream file(root / "proc/self/cgroup");
  std::uint64_t least = unlimited;
  for (std::string line; std::getline(file, line);) {  // number:controllers:/group
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    if (!controllers.empty() && controllers != "memory") continue;
    least =
        std::min(least, of_groups(root, controllers.empty() ? v2 : v1, line.substr(second + 1)));
  }
  return least;
}

std::uint64_t of_process() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unlimited;
  const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  return less(limit.rlim_cur, page * number_in("/proc/self/statm", "", 0));
}

}  // namespace

std::uint64_t free_host_memory(const fs::path& root) {
  return std::min({of_machine(root), of_groups(root), of_process()});
}

std::string message_of(const std::exception& error) {
  const auto* const system = dynamic_cast<const std::system_error*>(&error);
  const bool is_thread =
      (system != nullptr && system->code() == std::errc::resource_unavailable_try_again) ||
      std::string_view(error.what()).starts_with("pthread_create has failed");  // oneTBB's
  if (is_thread)
    return "a thread cannot be started: expected higher limits of memory (ulimit -v) or processes "
           "(ulimit -u), or fewer --threads";
  const bool is_memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
                         dynamic_cast<const std::length_error*>(&error) != nullptr;  // of a vector
  return is_memory ? "not enough host memory for this scene and image size" : error.what();
}

void check_host_memory(std::uint64_t size_bytes, const std::string& purpose) {
  const std::uint64_t available = free_host_memory();
  if (size_bytes > available) throw memory_error("memory", purpose, size_bytes, available);
}

}  // namespace pt
