#include "common/scene/load/files/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "common/error/error.h"
#include "common/scene/load/files/scene_files.h"

namespace pt {
namespace {

[[noreturn]] void fail() { throw Error(std::generic_category().message(errno)); }

struct Descriptor {
  int fd;
  ~Descriptor() { ::close(fd); }
};

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) {
  // O_NONBLOCK: a pipe is refused below instead of waited for.
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) fail();
  const Descriptor file{fd};
  struct stat status {};
  if (::fstat(fd, &status) != 0) fail();
  if (!S_ISREG(status.st_mode)) throw Error("not a regular file");
  if (status.st_size == 0) {  // nothing to map
    SceneFiles::note(path, {});
    return;
  }
  const auto size = static_cast<std::size_t>(status.st_size);
  void* memory = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0);
  if (memory == MAP_FAILED) fail();
  ::madvise(memory, size, MADV_WILLNEED);  // advice only: it may be refused
  bytes_ = {static_cast<const char*>(memory), size};
  SceneFiles::note(path, bytes_);
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) ::munmap(const_cast<char*>(bytes_.data()), bytes_.size());
}

}  // namespace pt
