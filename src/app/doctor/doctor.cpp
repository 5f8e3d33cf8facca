#include "app/doctor/doctor.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/options/subcommand_options.h"
#include "common/error/terminal.h"

namespace pt {
namespace {

constexpr std::uint64_t gib = std::uint64_t{1} << 30;

Check check_build(const BuildInfo& build) {
  Check check{"ptexp", Health::ok,
              fmt::format("{}, commit {}, {}, {}", build.version, build.commit, build.build_type,
                          build.compiler),
              ""};
  if (build.build_type != "Release") {
    check.health = Health::warning;
    check.remedy = "for times, build with -DCMAKE_BUILD_TYPE=Release";
  } else if (build.fast_math) {
    check.health = Health::warning;
    check.detail += ", fast math";
    check.remedy = "for images that are equal in all modes, build with -DPTEXP_FAST_MATH=OFF";
  }
  return check;
}

Check check_cpu(const CpuFacts& cpu) {
  const char* code = cpu.has_avx512 ? "AVX-512" : cpu.has_avx2 ? "AVX2" : "plain code: no AVX2";
  Check check{
      "CPU", Health::ok,
      fmt::format("{}{}{} thread{}, rays are traced by {}", cpu.name, cpu.name.empty() ? "" : ", ",
                  cpu.threads, cpu.threads == 1 ? "" : "s", code),
      ""};
  if (!cpu.has_avx2) {
    check.health = Health::warning;
    check.remedy = "a processor with AVX2 traces several times faster";
  }
  return check;
}

Check check_memory(const Machine& machine) {
  const double total = static_cast<double>(machine.memory) / gib;
  const double available = static_cast<double>(machine.free_memory) / gib;
  if (machine.free_memory == 0) {
    return {"memory", Health::warning, "how much is free is unknown",
            "large images end with an error only once memory is full"};
  }
  Check check{"memory", Health::ok,
              fmt::format("{:.1f} GiB may be used of {:.1f} GiB", available, total), ""};
  if (machine.free_memory < 2 * gib) {
    check.health = Health::warning;
    check.remedy =
        "scene, image and samples need it: end other programs, or raise the limit of "
        "the container or job";
  }
  return check;
}

Check check_folder(const std::string& name, const FolderFacts& folder, const char* remedy) {
  Check check{name, Health::ok,
              fmt::format("{}: writable, {:.1f} GiB free", folder.path,
                          static_cast<double>(folder.free) / gib),
              ""};
  if (!folder.problem.empty()) {
    check = {name, Health::missing, fmt::format("{}: {}", folder.path, folder.problem), remedy};
  } else if (folder.free < gib / 10) {
    check.health = Health::warning, check.remedy = remedy;
  }
  return check;
}

enum class MpiKind { none, open_mpi, mpich, unknown };

MpiKind mpi_kind_of(std::string text) {
  if (text.empty() || text == "off") return MpiKind::none;
  for (const char* word : {"Open MPI", "openmpi", "orterun", "prterun"})
    if (text.find(word) != std::string::npos) return MpiKind::open_mpi;
  for (const char* word : {"MPICH", "mpich", "hydra"})
    if (text.find(word) != std::string::npos) return MpiKind::mpich;
  return MpiKind::unknown;
}

bool differ(MpiKind a, MpiKind b) {
  return a != b && a != MpiKind::unknown && b != MpiKind::unknown;
}

Check check_mpi(const MpiFacts& mpi) {
  const MpiKind built = mpi_kind_of(mpi.built), launcher = mpi_kind_of(mpi.launcher);
  if (built == MpiKind::none) {
    return {"MPI", Health::warning, "this ptexp was built without it: one machine at a time",
            "for several machines, build with -DPTEXP_MPI=ON (docs/cluster.md)"};
  }
  Check check{"MPI", Health::ok,
              fmt::format("built with {}, loaded {}, {}", mpi.built, mpi.loaded,
                          mpi.launcher.empty() ? "no launcher" : "launched by " + mpi.launcher),
              ""};
  if (differ(built, mpi_kind_of(mpi.loaded))) {
    check.health = Health::missing;
    check.remedy = "the library that was loaded is another MPI's: mend LD_LIBRARY_PATH";
  } else if (launcher == MpiKind::none) {
    check.health = Health::warning;
    check.remedy = fmt::format("for several processes, install {}'s mpirun, or have it in PATH",
                               built == MpiKind::open_mpi ? "Open MPI" : "the same MPI");
  } else if (differ(built, launcher)) {
    check.health = Health::warning;
    check.remedy =
        "this launcher is another MPI's, and its processes would not find each other: "
        "use the mpirun of the MPI that ptexp was built with";
  }
  return check;
}

using Json = nlohmann::ordered_json;

int exit_code(const std::vector<Check>& checks) {
  return std::ranges::any_of(checks, [](const Check& one) { return one.health == Health::missing; })
             ? 1
             : 0;
}

Json gpu_json(const GpuFacts& gpu) {
  return {{"name", gpu.name},
          {"compute_capability", fmt::format("{}.{}", gpu.major, gpu.minor)},
          {"multiprocessors", gpu.multiprocessors},
          {"memory_bytes", gpu.memory},
          {"free_memory_bytes", gpu.free_memory},
          {"block_shared_bytes", gpu.block_shared},
          {"block_shared_bytes_max", gpu.block_shared_max},
          {"problem", gpu.problem}};
}

Json machine_json(const Machine& machine) {
  Json gpus = Json::array();
  for (const GpuFacts& gpu : machine.cuda.gpus) gpus.push_back(gpu_json(gpu));
  return {{"driver", machine.driver.version}, {"gpus", gpus},
          {"cpu", machine.cpu.name},          {"threads", machine.cpu.threads},
          {"avx2", machine.cpu.has_avx2},     {"avx512", machine.cpu.has_avx512},
          {"memory_bytes", machine.memory},   {"free_memory_bytes", machine.free_memory}};
}

}  // namespace

std::string_view to_string(Health health) {
  constexpr std::string_view names[] = {"ok", "warning", "missing"};
  return names[static_cast<int>(health)];
}

std::vector<Check> check_machine(const Machine& machine) {
  std::vector<Check> checks{check_build(machine.build)};
  add_gpu_checks(machine, checks);
  checks.push_back(check_mpi(machine.mpi));
  checks.push_back(check_cpu(machine.cpu));
  checks.push_back(check_memory(machine));
  checks.push_back(
      check_folder("temporary files", machine.temp, "name another folder in the variable TMPDIR"));
  checks.push_back(check_folder("current folder", machine.current,
                                "images go there: change it, or name files by --output"));
  return checks;
}

std::string doctor_text(const std::vector<Check>& checks) {
  std::string text;
  for (const Check& check : checks) {
    text += fmt::format("{:<8} {:<16} {}\n", to_string(check.health), check.name, check.detail);
    if (!check.remedy.empty()) text += fmt::format("{:<8} {:<16} -> {}\n", "", "", check.remedy);
  }
  return text;
}

std::string doctor_json(const Machine& machine, const std::vector<Check>& checks) {
  Json list = Json::array();
  for (const Check& check : checks) {
    list.push_back({{"name", check.name},
                    {"status", to_string(check.health)},
                    {"detail", check.detail},
                    {"remedy", check.remedy}});
  }
  const Json json = {{"version", machine.build.version}, {"commit", machine.build.commit},
                     {"cuda", machine.build.cuda},       {"mpi", machine.mpi.built},
                     {"machine", machine_json(machine)}, {"checks", list},
                     {"exit_code", exit_code(checks)}};
  // A folder's name need not be UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

int doctor_command(const DoctorCommand& command) {
  const Machine machine = read_machine();
  const std::vector<Check> checks = check_machine(machine);
  print("{}", command.as_json ? doctor_json(machine, checks) : doctor_text(checks));
  return exit_code(checks);
}

}  // namespace pt
