// What `ptexp doctor` looks at: facts, not yet judged.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/platform/build_info.h"

namespace pt {

struct GpuFacts {
  std::string name;                                      ///< e.g. "NVIDIA H200"
  int major = 0, minor = 0;                              ///< compute capability
  std::uint64_t memory = 0, free_memory = 0;             ///< bytes
  std::uint64_t block_shared = 0, block_shared_max = 0;  ///< bytes: as it is, and if asked for
  std::string problem;  ///< why no kernel of this program runs there; empty: one does
};

/// What CUDA says. In a build without it nothing is known.
struct CudaFacts {
  bool is_built = false;
  int built = 0, runtime = 0, driver = 0;  ///< as CUDA has it: 12040 is 12.4; 0: none
  std::string problem;                     ///< why no GPU was found
  std::vector<GpuFacts> gpus;
  std::string cupti;  ///< the library that --counters would load; empty: none was found
};

struct MpiFacts {
  std::string built, loaded;  ///< "Open MPI 4.1.4", "Open MPI v4.1.4"; "off": none
  std::string launcher;       ///< mpirun of PATH, links followed; empty: none
};

struct CpuFacts {
  std::string name;
  int threads = 1;
  bool has_avx2 = false, has_avx512 = false;
};

struct FolderFacts {
  std::string path, problem;  ///< why nothing can be written there; empty: it can
  std::uint64_t free = 0;     ///< bytes
};

/// What the kernel driver says, whether or not ptexp was built for it.
struct DriverFacts {
  std::string version;            ///< e.g. "535.104.05"; empty: no driver is loaded
  std::vector<std::string> gpus;  ///< their models
  bool counters_known = false, counters_restricted = false;  ///< to administrators
};

struct Machine {
  BuildInfo build;
  DriverFacts driver;
  CudaFacts cuda;
  MpiFacts mpi;
  CpuFacts cpu;
  std::uint64_t memory = 0, free_memory = 0;  ///< of the host, bytes; 0: unknown
  bool is_admin = false;                      ///< may read a GPU's counters in any case
  FolderFacts temp, current;
};

/// `root`: of /proc.
Machine read_machine(const std::filesystem::path& root = "/");

/// What read_machine takes from /proc/driver/nvidia.
DriverFacts read_driver(const std::filesystem::path& root);

/// Writes a file there, and removes it.
FolderFacts try_folder(const std::filesystem::path& folder);

/// Never throws: what CUDA refuses is a fact, too.
CudaFacts read_cuda();

}  // namespace pt
