#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstring>
#include <random>
#include <system_error>
#include <utility>

#include "common/image/atomic_file.h"

namespace pt {
namespace {

namespace fs = std::filesystem;

// For signal handlers, which may run beside the thread that writes: a name that is never freed.
char unfinished[PATH_MAX];
std::atomic<bool> is_unfinished{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void note_unfinished(const fs::path& path) {
  if (path.native().size() >= sizeof unfinished) return;
  std::strcpy(unfinished, path.c_str());
  is_unfinished = true;
}

/// The same for all writers of a file on this machine: not every network file system shows the
/// locks of writers on others.
std::string prefix_of(const fs::path& target) {
  char host[256] = {};
  ::gethostname(host, sizeof host - 1);
  std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a
  for (const char c : host + ('/' + target.filename().native())) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  }
  return fmt::format(".ptexp-{:016x}-", hash);
}

void remove_leftovers(const fs::path& folder, const std::string& prefix) {
  std::error_code error;  // whoever may not list the folder may still write to it
  for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
    if (!i->path().filename().native().starts_with(prefix)) continue;
    const Descriptor file(::open(i->path().c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
    if (file.is_open() && ::flock(file.get(), LOCK_EX | LOCK_NB) == 0) ::unlink(i->path().c_str());
  }
}

/// open() instead of mkstemp(): it applies the umask, which cannot be read without setting it.
int create(const fs::path& target, fs::path& path) {
  const fs::path folder = target.has_parent_path() ? target.parent_path() : ".";
  const std::string prefix = prefix_of(target);
  remove_leftovers(folder, prefix);
  std::random_device random;
  for (;;) {
    // A name of its own length, so that any name that fits the folder can be written.
    path = folder / fmt::format("{}{:08x}.tmp", prefix, random());
    Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (!file.is_open()) {
      if (errno != EEXIST) throw_system_error(errno);
      continue;
    }
    note_unfinished(path);
    ::flock(file.get(), LOCK_EX);  // best effort: some network file systems have none
    // Not locked yet, it may have been taken for a leftover.
    if (::access(path.c_str(), F_OK) == 0) return file.release();
  }
}

}  // namespace

void throw_system_error(int error) { throw std::system_error(error, std::generic_category()); }

void Descriptor::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd_, bytes.data(), bytes.size());
    if (written >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      throw_system_error(errno);
    }
  }
}

Descriptor::~Descriptor() {
  if (fd_ >= 0) ::close(fd_);
}

int Descriptor::release() { return std::exchange(fd_, -1); }

void Descriptor::close() {
  if (::close(release()) != 0 && errno != EINTR) throw_system_error(errno);
}

TemporaryFile::TemporaryFile(const fs::path& target)
    : descriptor_(create(target, path_)), lock_(::fcntl(descriptor_.get(), F_DUPFD_CLOEXEC, 0)) {}

TemporaryFile::~TemporaryFile() {
  if (!path_.empty()) ::unlink(path_.c_str());
  is_unfinished = false;
}

void TemporaryFile::rename(const fs::path& target) {
  if (::rename(path_.c_str(), target.c_str()) != 0) throw_system_error(errno);
  path_.clear();
}

void remove_unfinished_file() {
  if (is_unfinished) ::unlink(unfinished);
}

}  // namespace pt
