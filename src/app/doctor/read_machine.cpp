#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "app/doctor/doctor.h"
#include "common/accel/trace_cpu/ray_block.h"
#include "common/accel/traverse_triangles.h"
#include "common/device/cpu/cpu_renderer.h"
#include "common/error/host_memory.h"
#include "common/mpi/channel.h"

namespace pt {
namespace {

namespace fs = std::filesystem;

/// The text behind `key` and a colon in the first line that begins with it; empty: none.
std::string value_in(const fs::path& path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(':');
    if (!line.starts_with(key) || colon == std::string::npos) continue;
    if (line.find_first_not_of(" \t", key.size()) != colon) continue;
    const std::size_t begin = line.find_first_not_of(" \t", colon + 1);
    return begin == std::string::npos ? "" : line.substr(begin);
  }
  return "";
}

/// CAP_SYS_ADMIN, which the driver asks for.
bool is_admin(const fs::path& root) {
  constexpr int cap_sys_admin = 21;
  const std::string mask = value_in(root / "proc/self/status", "CapEff");
  return (std::strtoull(mask.c_str(), nullptr, 16) >> cap_sys_admin & 1) != 0;
}

/// The first of these programs that PATH has, links followed.
std::string find_program(std::initializer_list<const char*> names) {
  const char* path = std::getenv("PATH");
  for (const char* name : names) {
    std::istringstream folders(path != nullptr ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
      const fs::path file = fs::path(folder.empty() ? "." : folder) / name;
      std::error_code error;
      if (!fs::is_regular_file(file, error) || ::access(file.c_str(), X_OK) != 0) continue;
      const fs::path real = fs::canonical(file, error);
      return error ? file.string() : real.string();
    }
  }
  return "";
}

fs::path temp_folder() {
  std::error_code error;
  const fs::path folder = fs::temp_directory_path(error);
  const char* named = std::getenv("TMPDIR");
  if (!error) return folder;
  return named != nullptr ? named : "/tmp";
}

CpuFacts read_cpu(const fs::path& root) {
  CpuFacts cpu;
  cpu.name = value_in(root / "proc/cpuinfo", "model name");
  cpu.threads = cpu_threads(0);
  cpu.has_avx2 = has_avx2();
  cpu.has_avx512 = tree_block_avx512() != nullptr;
  return cpu;
}

}  // namespace

DriverFacts read_driver(const fs::path& root) {
  const fs::path folder = root / "proc/driver/nvidia";
  DriverFacts driver;
  // "NVIDIA UNIX x86_64 Kernel Module  535.104.05  Sat Aug 19 ..."; of the open one "... for
  // x86_64  535.104.05  Release Build".
  std::istringstream words(value_in(folder / "version", "NVRM version"));
  for (std::string word; driver.version.empty() && words >> word;) {
    const bool is_number = word.find_first_not_of("0123456789.") == std::string::npos;
    if (is_number && word.find('.') != std::string::npos) driver.version = word;
  }
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder / "gpus", none)) {
    const std::string model = value_in(entry.path() / "information", "Model");
    driver.gpus.push_back(model.empty() ? "unknown model" : model);
  }
  for (const char* key : {"RmProfilingAdminOnly", "NVreg_RestrictProfilingToAdminUsers"}) {
    const std::string value = value_in(folder / "params", key);
    if (value.empty()) continue;
    driver.counters_known = true;
    driver.counters_restricted = value != "0";
  }
  return driver;
}

FolderFacts try_folder(const fs::path& folder) {
  FolderFacts facts{folder.string(), "", 0};
  std::string name = (folder / "ptexp-doctor-XXXXXX").string();
  const int file = ::mkstemp(name.data());
  std::error_code error(file < 0 ? errno : 0, std::generic_category());
  if (file >= 0) {
    if (::write(file, "ptexp", 5) != 5) error = {errno, std::generic_category()};
    ::close(file);
    ::unlink(name.c_str());
  }
  if (error) facts.problem = error.message();
  std::error_code unknown;
  const fs::space_info space = fs::space(folder, unknown);
  if (!unknown) facts.free = space.available;
  return facts;
}

Machine read_machine(const fs::path& root) {
  Machine machine;
  machine.build = build_info();
  machine.driver = read_driver(root);
  machine.cuda = read_cuda();
  machine.mpi = {mpi_built_with(), mpi_version(), find_program({"mpirun", "mpiexec", "srun"})};
  machine.cpu = read_cpu(root);
  const std::string total = value_in(root / "proc/meminfo", "MemTotal");
  machine.memory = std::strtoull(total.c_str(), nullptr, 10) * 1024;
  const std::uint64_t available = free_host_memory(root);
  machine.free_memory = available == ~std::uint64_t{0} ? 0 : available;
  machine.is_admin = is_admin(root);
  machine.temp = try_folder(temp_folder());
  std::error_code error;
  const fs::path current = fs::current_path(error);
  machine.current = try_folder(error ? "." : current);
  return machine;
}

}  // namespace pt
