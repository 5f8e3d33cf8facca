// The memory that the program may still take, and the check of it before it is taken: where
// memory is overcommitted an allocation succeeds, and the process is killed later.
#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <string>

namespace pt {

/// The least that the machine, the process's control groups (of containers and batch systems) and
/// its own limits (ulimit -v) leave; 2^64 - 1 where nothing is known. `root`: of /proc and /sys.
std::uint64_t free_host_memory(const std::filesystem::path& root = "/");

/// What a user is told of an exception: of one for want of memory, that.
std::string message_of(const std::exception& error);

/// Throws Error when `size_bytes` exceed it; `purpose` is what needs them.
void check_host_memory(std::uint64_t size_bytes, const std::string& purpose);

}  // namespace pt
