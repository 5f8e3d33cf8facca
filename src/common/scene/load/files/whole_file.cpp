#include "common/scene/load/files/whole_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/scene/load/files/scene_files.h"

namespace pt {
namespace {

constexpr std::size_t step = std::size_t{1} << 24;  // bytes that a thread reads at once

[[noreturn]] void fail() { throw Error(std::generic_category().message(errno)); }

struct Descriptor {
  int fd;
  ~Descriptor() { ::close(fd); }
};

void read_bytes(int fd, char* out, std::size_t begin, std::size_t end) {
  while (begin < end) {
    const ssize_t count = ::pread(fd, out + begin, end - begin, static_cast<off_t>(begin));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail();
    if (count == 0) throw Error("it became shorter while it was read");
    begin += static_cast<std::size_t>(count);
  }
}

}  // namespace

WholeFile::WholeFile(const std::filesystem::path& path) {
  // O_NONBLOCK: a pipe is refused below instead of waited for.
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) fail();
  const Descriptor file{fd};
  struct stat status {};
  if (::fstat(fd, &status) != 0) fail();
  if (!S_ISREG(status.st_mode)) throw Error("not a regular file");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > step) check_host_memory(size, "the file");
  memory_ = std::make_unique_for_overwrite<char[]>(size);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, size, step), [&](const auto& block) {
    read_bytes(fd, memory_.get(), block.begin(), block.end());
  });
  bytes_ = {memory_.get(), size};
  SceneFiles::note(path, bytes_);
}

}  // namespace pt
