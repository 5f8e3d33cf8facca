#include "app/standard_output.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "common/error/error.h"

namespace pt {

void flush_output() {
  errno = 0;
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return;
  throw Error(fmt::format("cannot write to the standard output{}{}", errno ? ": " : "",
                          errno ? std::strerror(errno) : ""));
}

}  // namespace pt
