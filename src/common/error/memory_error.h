// What did not fit into a memory.
#pragma once

#include <fmt/format.h>

#include <cstdint>

#include "common/error/error.h"

namespace pt {

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
