#include "app/doctor/doctor_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/error/terminal.h"

namespace pt {
namespace {

using Json = nlohmann::ordered_json;

int exit_code(const std::vector<Check>& checks) {
  return std::ranges::any_of(checks, [](const Check& one) { return one.health == Health::missing; })
             ? 1
             : 0;
}

Json gpu_json(const GpuFacts& gpu) {
  return {{"name", gpu.name},
          {"compute_capability", fmt::format("{}.{}", gpu.major, gpu.minor)},
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
