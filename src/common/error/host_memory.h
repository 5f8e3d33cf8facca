// The memory that the program may still take, and the check of it before it is taken: where
// memory is overcommitted an allocation succeeds, and the process is killed later.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <exception>
#include <filesystem>
#include <string>

#include "common/error/error.h"

namespace pt {

/// The least that the machine, the process's control groups (of containers and batch systems) and
/// its own limits (ulimit -v) leave; 2^64 - 1 where nothing is known. `root`: of /proc and /sys.
std::uint64_t free_host_memory(const std::filesystem::path& root = "/");

/// The message for a user: the exception's own, or that memory is lacking.
std::string message_of(const std::exception& error);

/// Throws Error when `size_bytes` exceed it; `purpose` is what needs them.
void check_host_memory(std::uint64_t size_bytes, const std::string& purpose);

/// A device had less memory than it said it had; with less to do the same may succeed.
class OutOfMemory : public Error {
 public:
  using Error::Error;
};

/// `memory`: "memory" or "device memory"; `purpose`: what needs so many bytes.
inline Error memory_error(const std::string& memory, const std::string& purpose,
                          std::uint64_t needed_bytes, std::uint64_t free_bytes) {
  constexpr double mib = 1024.0 * 1024.0;
  return Error(fmt::format("not enough {}: {} needs {:.0f} MiB, {:.0f} MiB are free", memory,
                           purpose, static_cast<double>(needed_bytes) / mib,
                           static_cast<double>(free_bytes) / mib));
}

}  // namespace pt
