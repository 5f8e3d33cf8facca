// `ptexp doctor` of machines that are not here: what it says of each, and what to do.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/doctor/doctor.h"
#include "app/options/command_line.h"
#include "temp_folder.h"

namespace pt {
namespace {

/// One H200, for which this program was built, and nothing wrong.
Machine healthy() {
  Machine machine;
  machine.build = {
      "0.1.0", "abc", "2025-01-31", "Release", "GNU 12.2.0", "13.0.88, architectures 90", false};
  machine.driver = {"580.95.05", {"NVIDIA H200"}, true, false};
  machine.cuda.is_built = true;
  machine.cuda.built = machine.cuda.runtime = machine.cuda.driver = 13000;
  machine.cuda.cupti = "libcupti.so.13";
  machine.cuda.gpus = {
      {"NVIDIA H200", 9, 0, 132, 150'000'000'000, 149'000'000'000, 49152, 232448, ""}};
  machine.mpi = {"Open MPI 4.1.4", "Open MPI v4.1.4", "/usr/bin/orterun"};
  machine.cpu = {"Some CPU", 8, true, false};
  machine.memory = 64ull << 30, machine.free_memory = 32ull << 30;
  machine.temp = {"/tmp", "", 10ull << 30};
  machine.current = {"/home/me", "", 10ull << 30};
  return machine;
}

Check find(const Machine& machine, const std::string& name) {
  for (const Check& check : check_machine(machine))
    if (check.name == name) return check;
  ADD_FAILURE() << "no check " << name;
  return {};
}

/// The checks that are not ok.
std::vector<std::string> complaints(const Machine& machine) {
  std::vector<std::string> names;
  for (const Check& check : check_machine(machine)) {
    EXPECT_EQ(check.remedy.empty(), check.health == Health::ok) << check.name;
    if (check.health != Health::ok)
      names.push_back(std::string(to_string(check.health)) + " " + check.name);
  }
  return names;
}

using Names = std::vector<std::string>;

TEST(Doctor, HasNoComplaintOfAHealthyMachine) {
  EXPECT_EQ(complaints(healthy()), Names{});
  const std::string gpu = find(healthy(), "GPU cuda:0").detail;
  for (const char* part : {"H200", "9.0", "138.8 GiB free of 139.7 GiB", "48 KiB", "227 KiB"})
    EXPECT_NE(gpu.find(part), std::string::npos) << gpu;
}

TEST(Doctor, NamesEachFaultAlone) {
  const auto faulty = [](auto&& change) {
    Machine machine = healthy();
    change(machine);
    return complaints(machine);
  };
  using M = Machine&;
  EXPECT_EQ(faulty([](M m) { m.build.build_type = "Debug"; }), Names{"warning ptexp"});
  EXPECT_EQ(faulty([](M m) { m.build.fast_math = true; }), Names{"warning ptexp"});
  EXPECT_EQ(faulty([](M m) { m.cuda.driver = 0; }), Names{"missing driver"});
  EXPECT_EQ(faulty([](M m) { m.cuda.driver = 12080; }), Names{"missing driver"});
  EXPECT_EQ(faulty([](M m) { m.cuda.built = 13010; }), Names{"warning driver"});
  EXPECT_EQ(faulty([](M m) { m.cuda.gpus.clear(); }), Names{"missing GPU"});
  EXPECT_EQ(faulty([](M m) { m.cuda.gpus[0].problem = "busy"; }), Names{"missing GPU cuda:0"});
  EXPECT_EQ(faulty([](M m) { m.cuda.gpus[0].free_memory = 1 << 29; }), Names{"warning GPU cuda:0"});
  EXPECT_EQ(faulty([](M m) { m.cuda.gpus[0].major = 8; }), Names{"missing code for cuda:0"});
  EXPECT_EQ(faulty([](M m) { m.cuda.gpus[0].major = 10; }), Names{"warning code for cuda:0"});
  EXPECT_EQ(faulty([](M m) { m.cuda.optix_problem = "no library"; }), Names{"warning OptiX"});
  EXPECT_EQ(faulty([](M m) { m.cuda.optix = "ABI 87"; }), Names{});
  EXPECT_EQ(faulty([](M m) { m.cuda.cupti = ""; }), Names{"warning counters"});
  EXPECT_EQ(faulty([](M m) { m.driver.counters_restricted = true; }), Names{"warning counters"});
  EXPECT_EQ(faulty([](M m) { m.driver.counters_restricted = m.is_admin = true; }), Names{});
  EXPECT_EQ(faulty([](M m) { m.mpi = {"off", "off", ""}; }), Names{"warning MPI"});
  EXPECT_EQ(faulty([](M m) { m.mpi.loaded = "MPICH Version: 4.0.2"; }), Names{"missing MPI"});
  EXPECT_EQ(faulty([](M m) { m.mpi.launcher = "/usr/bin/mpiexec.hydra"; }), Names{"warning MPI"});
  EXPECT_EQ(faulty([](M m) { m.mpi.launcher = ""; }), Names{"warning MPI"});
  EXPECT_EQ(faulty([](M m) { m.mpi.launcher = "/usr/bin/srun"; }), Names{});
  EXPECT_EQ(faulty([](M m) { m.cpu.has_avx2 = false; }), Names{"warning CPU"});
  EXPECT_EQ(faulty([](M m) { m.free_memory = 1 << 30; }), Names{"warning memory"});
  EXPECT_EQ(faulty([](M m) { m.free_memory = 0; }), Names{"warning memory"});
  EXPECT_EQ(faulty([](M m) { m.temp.problem = "read-only"; }), Names{"missing temporary files"});
  EXPECT_EQ(faulty([](M m) { m.current.free = 1000; }), Names{"warning current folder"});
}

// Both sides of each limit: 2 GiB of memory, 1 GiB of a GPU's, 0.1 GiB of a folder.
TEST(Doctor, WarnsBelowItsLimits) {
  constexpr std::uint64_t gib = 1ull << 30;
  const auto complaints_of = [](std::uint64_t memory, std::uint64_t gpu, std::uint64_t temp,
                                std::uint64_t current) {
    Machine machine = healthy();
    machine.free_memory = memory, machine.cuda.gpus[0].free_memory = gpu;
    machine.temp.free = temp, machine.current.free = current;
    return complaints(machine);
  };
  EXPECT_EQ(complaints_of(2 * gib, gib, gib / 10, gib / 10), Names{});
  EXPECT_EQ(complaints_of(2 * gib - 1, gib, gib / 10, gib / 10), Names{"warning memory"});
  EXPECT_EQ(complaints_of(2 * gib, gib - 1, gib / 10, gib / 10), Names{"warning GPU cuda:0"});
  EXPECT_EQ(complaints_of(2 * gib, gib, gib / 10 - 1, gib / 10), Names{"warning temporary files"});
  EXPECT_EQ(complaints_of(2 * gib, gib, gib / 10, gib / 10 - 1), Names{"warning current folder"});
}

TEST(Doctor, VersionsHaveMinorNumbersOfTwoDigits) {
  Machine machine = healthy();
  machine.cuda.driver = 13120;
  EXPECT_EQ(find(machine, "driver").detail, "580.95.05, for CUDA 13.12");
}

// Every number is another one: which is whose, and in which unit.
TEST(Doctor, PrintsTheMachinesNumbers) {
  Machine machine = healthy();
  machine.cuda.driver = 13020, machine.cuda.built = machine.cuda.runtime = 13010;
  machine.cuda.gpus = {{"GPU", 9, 3, 78, 8ull << 30, 6ull << 30, 48 << 10, 227 << 10, ""}};
  machine.build.cuda = "13.1.20, architectures 90";
  machine.cpu.has_avx512 = true;
  machine.temp.free = 3ull << 30, machine.current.free = 5ull << 30;
  EXPECT_EQ(doctor_text(check_machine(machine)),
            R"(ok       ptexp            0.1.0, commit abc, Release, GNU 12.2.0
ok       driver           580.95.05, for CUDA 13.2
ok       CUDA             runtime 13.1, built by nvcc 13.1.20, architectures 90
ok       GPU cuda:0       GPU, 78 multiprocessors, compute capability 9.3, 6.0 GiB free of 8.0 GiB, 48 KiB of shared memory per block (at most 227 KiB)
ok       code for cuda:0  machine code, of 90
ok       counters         libcupti.so.13; the driver lets this user read them
ok       MPI              built with Open MPI 4.1.4, loaded Open MPI v4.1.4, launched by /usr/bin/orterun
ok       CPU              Some CPU, 8 threads, rays are traced by AVX-512
ok       memory           32.0 GiB may be used of 64.0 GiB
ok       temporary files  /tmp: writable, 3.0 GiB free
ok       current folder   /home/me: writable, 5.0 GiB free
)");
  machine.cuda.driver = 12080, machine.mpi.launcher = "", machine.driver.counters_known = false;
  machine.cpu = {"", 1, false, false};
  machine.free_memory = 3ull << 29;
  machine.temp.free = 1ull << 26, machine.current.problem = "read-only";
  machine.cuda.gpus[0].free_memory = 1ull << 29;
  machine.build.cuda = "13.1.20, architectures 80";
  EXPECT_EQ(doctor_text(check_machine(machine)),
            R"(ok       ptexp            0.1.0, commit abc, Release, GNU 12.2.0
missing  driver           580.95.05, for CUDA 12.8
                          -> install a driver for CUDA 13.1 or newer
ok       CUDA             runtime 13.1, built by nvcc 13.1.20, architectures 80
warning  GPU cuda:0       GPU, 78 multiprocessors, compute capability 9.3, 0.5 GiB free of 8.0 GiB, 48 KiB of shared memory per block (at most 227 KiB)
                          -> scene and paths need memory: see `nvidia-smi` for who has it
warning  code for cuda:0  PTX alone, of 80: the driver compiles it at the first start, for a minute or more, and keeps it in ~/.nv/ComputeCache
                          -> build with -DCMAKE_CUDA_ARCHITECTURES=93
ok       counters         libcupti.so.13; whether the driver permits is unknown
warning  MPI              built with Open MPI 4.1.4, loaded Open MPI v4.1.4, no launcher
                          -> for several processes, install Open MPI's mpirun, or have it in PATH
warning  CPU              1 thread, rays are traced by plain code: no AVX2
                          -> a processor with AVX2 traces several times faster
warning  memory           1.5 GiB may be used of 64.0 GiB
                          -> scene, image and samples need it: end other programs, or raise the limit of the container or job
warning  temporary files  /tmp: writable, 0.1 GiB free
                          -> name another folder in the variable TMPDIR
missing  current folder   /home/me: read-only
                          -> images go there: change it, or name files by --output
)");
}

TEST(Doctor, SaysWhatToBuildForAnotherGpu) {
  Machine machine = healthy();
  machine.build.cuda = "13.0.88, architectures 75-virtual";
  machine.cuda.gpus.push_back({"NVIDIA L4", 8, 9, 58, 1ull << 34, 1ull << 34, 49152, 101376, ""});
  EXPECT_EQ(complaints(machine), (Names{"warning code for cuda:0", "warning code for cuda:1"}));
  EXPECT_EQ(find(machine, "code for cuda:1").remedy, "build with -DCMAKE_CUDA_ARCHITECTURES=89");
}

TEST(Doctor, WithoutCudaAGpuIsAWarning) {
  Machine machine = healthy();
  machine.build.cuda = "off";
  machine.cuda = {};
  EXPECT_EQ(complaints(machine), Names{"warning CUDA"});
  EXPECT_NE(find(machine, "CUDA").detail.find("H200"), std::string::npos);
  machine.driver = {};
  EXPECT_EQ(complaints(machine), Names{});
}

TEST(Doctor, KnowsWhichCodeRunsOnAGpu) {
  const auto expect = [](const char* architectures, int capability, GpuCode code) {
    EXPECT_EQ(code_for(architectures, capability / 10, capability % 10), code)
        << architectures << " on " << capability;
  };
  expect("90", 90, GpuCode::machine);
  expect("80", 86, GpuCode::machine);  // of the same generation, and not newer
  expect("86", 80, GpuCode::none);
  expect("89", 90, GpuCode::ptx);
  expect("90", 89, GpuCode::none);
  expect("90", 120, GpuCode::ptx);
  expect("75-virtual", 75, GpuCode::ptx);
  expect("75-virtual", 90, GpuCode::ptx);
  expect("75-virtual", 70, GpuCode::none);
  expect("75-real", 90, GpuCode::none);
  expect("75-virtual;80-real;90-real", 90, GpuCode::machine);
  expect("75-virtual;80-real", 100, GpuCode::ptx);
  expect("90a", 90, GpuCode::machine);
  expect("90a", 100, GpuCode::none);  // its PTX is for no other GPU
  expect("90a-virtual", 90, GpuCode::ptx);
  expect("100f", 103, GpuCode::machine);
  expect("100f-real", 103, GpuCode::machine);
  expect("native", 90, GpuCode::unknown);
  expect("all-major", 90, GpuCode::unknown);
  expect("100f", 120, GpuCode::none);
  expect("", 90, GpuCode::unknown);
}

class DriverFiles : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) {
    const std::filesystem::path path = folder_.file("proc/driver/nvidia/" + name);
    std::filesystem::create_directories(path.parent_path());
    write_text(path.string(), text);
  }
  DriverFacts read() const { return read_driver(folder_.file("")); }

  TempFolder folder_;
};

TEST_F(DriverFiles, AreReadAsTheDriverWritesThem) {
  EXPECT_EQ(read().version, "");
  EXPECT_FALSE(read().counters_known);
  write("version",
        "NVRM version: NVIDIA UNIX x86_64 Kernel Module  535.104.05  Sat Aug 19 01:15:15 UTC 2023\n"
        "GCC version:  gcc version 12.2.0 (Debian 12.2.0-14)\n");
  EXPECT_EQ(read().version, "535.104.05");
  write("version",
        "NVRM version: NVIDIA UNIX Open Kernel Module for x86_64  580.95.05  Release Build\n");
  EXPECT_EQ(read().version, "580.95.05");
  write("gpus/0000:17:00.0/information", "Model: \t\t NVIDIA H200\nIRQ:   \t\t 90\n");
  EXPECT_EQ(read().gpus, Names{"NVIDIA H200"});
}

TEST_F(DriverFiles, SayWhoMayReadCounters) {
  write("params", "RmLogonRC: 1\nRmProfilingAdminOnly: 1\n");
  EXPECT_TRUE(read().counters_known && read().counters_restricted);
  write("params", "RmProfilingAdminOnlyOther: 1\nRmProfilingAdminOnly: 0\n");
  EXPECT_TRUE(read().counters_known);
  EXPECT_FALSE(read().counters_restricted);
  write("params", "RmProfilingAdminOnly: 2\n");  // whatever is not 0
  EXPECT_TRUE(read().counters_restricted);
}

// CapEff of capabilities(7): bit 21 is CAP_SYS_ADMIN; its neighbours are SYS_PACCT and SYS_BOOT.
TEST(DoctorMachine, IsAnAdministratorsByOneBit) {
  const TempFolder folder;
  const auto is_admin = [&](const std::string& mask) {
    const std::string path = folder.file("proc/self/status");
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    write_text(path, "Name:\tptexp\nCapPrm:\tffffffffffffffff\nCapEff:\t" + mask + "\nCapBnd:\t" +
                         "000001ffffffffff\n");
    return read_machine(folder.file("")).is_admin;
  };
  EXPECT_TRUE(is_admin("0000000000200000"));
  EXPECT_TRUE(is_admin("000001ffffffffff"));
  EXPECT_FALSE(is_admin("0000000000100000"));
  EXPECT_FALSE(is_admin("0000000000400000"));
  EXPECT_FALSE(is_admin("000001ffffdfffff"));
  EXPECT_FALSE(is_admin("0000000000000000"));
}

// The kernel counts kilobytes of 1024 bytes.
TEST(DoctorMachine, HasTheMemoryOfItsFiles) {
  const TempFolder folder;
  const std::string path = folder.file("proc/meminfo");
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  write_text(path,
             "MemTotal:       65536000 kB\nMemFree:         1000 kB\n"
             "MemAvailable:   32768000 kB\n");
  const Machine machine = read_machine(folder.file(""));
  EXPECT_EQ(machine.memory, 65536000ull * 1024);
  EXPECT_EQ(machine.free_memory, 32768000ull * 1024);
}

TEST(DoctorFolders, AreTriedByWriting) {
  const TempFolder folder;
  EXPECT_EQ(try_folder(folder.file("")).problem, "");
  EXPECT_EQ(folder.entries(), Names{});
  EXPECT_EQ(try_folder(folder.file("absent")).problem, "No such file or directory");
}

TEST(DoctorJson, ExitCodeTellsWhetherAnythingIsMissing) {
  const auto code_of = [](Health health) {
    const auto json = nlohmann::json::parse(doctor_json({}, {{"a", health, "", ""}}));
    return json["exit_code"].get<int>();
  };
  EXPECT_EQ(code_of(Health::ok), 0);
  EXPECT_EQ(code_of(Health::warning), 0);
  EXPECT_EQ(code_of(Health::missing), 1);
}

TEST(DoctorJson, HasChecksAndNumbers) {
  Machine machine = healthy();
  machine.cuda.gpus[0].problem = "busy";
  machine.temp.path = "/tmp/\xff";
  const auto json = nlohmann::json::parse(doctor_json(machine, check_machine(machine)));
  EXPECT_EQ(json["exit_code"], 1);
  EXPECT_EQ(json["machine"]["gpus"][0]["compute_capability"], "9.0");
  EXPECT_EQ(json["machine"]["gpus"][0]["block_shared_bytes_max"], 232448);
  EXPECT_EQ(json["checks"].size(), check_machine(machine).size());
  EXPECT_EQ(json["checks"][0]["status"], "ok");
}

TEST(DoctorJson, HasTheNumbersOfTheMachine) {
  Machine machine = healthy();
  machine.memory = 111, machine.free_memory = 22;
  machine.cpu = {"Name", 33, true, false};
  machine.cuda.gpus = {{"G", 8, 6, 82, 444, 55, 66, 77, "p"}};
  const auto json = nlohmann::json::parse(doctor_json(machine, {}));
  EXPECT_EQ(json["machine"], nlohmann::json::parse(R"({
    "driver": "580.95.05", "cpu": "Name", "threads": 33, "avx2": true, "avx512": false,
    "memory_bytes": 111, "free_memory_bytes": 22,
    "gpus": [{"name": "G", "compute_capability": "8.6", "multiprocessors": 82, "memory_bytes": 444,
              "free_memory_bytes": 55, "block_shared_bytes": 66, "block_shared_bytes_max": 77,
              "problem": "p"}]})"));
  EXPECT_EQ(json["version"], "0.1.0");
  EXPECT_EQ(json["commit"], "abc");
  EXPECT_EQ(json["cuda"], "13.0.88, architectures 90");
  EXPECT_EQ(json["mpi"], "Open MPI 4.1.4");
  EXPECT_EQ(json["exit_code"], 0);
}

TEST(DoctorCommandLine, IsASubcommandAlone) {
  EXPECT_FALSE(std::get<DoctorCommand>(parse_command_line({"doctor"})).as_json);
  EXPECT_TRUE(std::get<DoctorCommand>(parse_command_line({"doctor", "--json"})).as_json);
  expect_error([] { parse_command_line({"--spp", "4", "doctor"}); }, "--spp: has no effect");
}

}  // namespace
}  // namespace pt
