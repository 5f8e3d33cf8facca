// `ptexp doctor`: facts of this machine, and what they mean for ptexp: what would run, what not,
// and the remedy.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/platform/build_info.h"

namespace pt {

struct GpuFacts {
  std::string name;          ///< e.g. "NVIDIA H200"
  int major = 0, minor = 0;  ///< compute capability
  int multiprocessors = 0;
  std::uint64_t memory = 0, free_memory = 0;             ///< bytes
  std::uint64_t block_shared = 0, block_shared_max = 0;  ///< bytes: as it is, and if asked for
  std::string problem;  ///< why no kernel of this program runs there; empty: one does
};

/// What CUDA reports; empty in a build without CUDA.
struct CudaFacts {
  bool is_built = false;
  int built = 0, runtime = 0, driver = 0;  ///< as CUDA has it: 12040 is 12.4; 0: none
  std::string problem;                     ///< why no GPU was found
  std::vector<GpuFacts> gpus;
  std::string cupti;  ///< the library that --counters would load; empty: none was found
  std::string optix, optix_problem;  ///< what --accel optix would use, or why it cannot
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

/// What the kernel driver reports, in builds without CUDA, too.
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

/// Reads /proc/driver/nvidia.
DriverFacts read_driver(const std::filesystem::path& root);

/// Writes a file there, and removes it.
FolderFacts try_folder(const std::filesystem::path& folder);

/// Never throws: an error of CUDA is a fact, too.
CudaFacts read_cuda();

/// ok; warning: something is slow or left out; missing: something that this program was built for
/// does not work here.
enum class Health { ok, warning, missing };

std::string_view to_string(Health health);

struct Check {
  std::string name;
  Health health;
  std::string detail;
  std::string remedy;  ///< empty if ok
};

std::vector<Check> check_machine(const Machine& machine);
/// Adds the checks of driver, GPUs, CUDA and its counters.
void add_gpu_checks(const Machine& machine, std::vector<Check>& checks);

/// How code that was built for some CUDA architectures, a CMake list such as "75-virtual;90-real",
/// comes to run on a GPU of a compute capability.
enum class GpuCode {
  machine,  ///< machine code for it
  ptx,      ///< PTX, which the driver compiles first
  none,
  unknown  ///< an architecture's name does not tell
};

GpuCode code_for(const std::string& architectures, int major, int minor);

/// A line for each check, and one for its remedy below.
std::string doctor_text(const std::vector<Check>& checks);
std::string doctor_json(const Machine& machine, const std::vector<Check>& checks);

struct DoctorCommand;

/// Prints the checks of this machine. Returns 0, or 1 where anything is missing.
int doctor_command(const DoctorCommand& command);

}  // namespace pt
