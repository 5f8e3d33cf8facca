#include "common/image/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <optional>
#include <random>
#include <system_error>
#include <utility>

#include "common/error.h"

namespace pt {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(int error) { throw std::system_error(error, std::generic_category()); }

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }

  int get() const { return fd_; }

  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(fd_, bytes.data(), bytes.size());
      if (written >= 0) {
        bytes.remove_prefix(static_cast<std::size_t>(written));
      } else if (errno != EINTR) {
        fail(errno);
      }
    }
  }

  /// Unlike the destructor, reports the delayed write errors of network file systems.
  void close() {
    if (::close(std::exchange(fd_, -1)) != 0 && errno != EINTR) fail(errno);
  }

 private:
  int fd_;
};

/// A new file in `folder`, removed again unless it is renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& folder) : descriptor_(create(folder, path_)) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (!path_.empty()) ::unlink(path_.c_str());
  }

  Descriptor& descriptor() { return descriptor_; }

  void rename(const fs::path& target) {
    if (::rename(path_.c_str(), target.c_str()) != 0) fail(errno);
    path_.clear();
  }

 private:
  /// open() instead of mkstemp(): it applies the umask, which cannot be read without setting it.
  static int create(const fs::path& folder, fs::path& path) {
    std::random_device random;
    for (;;) {
      // A name of its own length, so that any name that fits the folder can be written.
      path = folder / fmt::format(".ptexp-{:08x}{:08x}.tmp", random(), random());
      const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (fd >= 0) return fd;
      if (errno != EEXIST) fail(errno);
    }
  }

  fs::path path_;  // before descriptor_, whose initialization fills it
  Descriptor descriptor_;
};

struct Target {
  fs::path file;                 ///< links resolved, so that rename() does not replace a link
  fs::path folder;               ///< of `file`
  std::optional<mode_t> mode{};  ///< permissions of the file to replace, if there is one
  bool is_special = false;       ///< a device or pipe
};

Target find_target(const std::string& path) {
  Target target{path, {}};
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) throw Error("it is a folder");
    // rename() would not mind, but whoever protects a file means it.
    if (::access(path.c_str(), W_OK) != 0) fail(errno);
    target.is_special = !S_ISREG(status.st_mode);
    if (!target.is_special) target.file = fs::canonical(path);
    target.mode = status.st_mode & 0777;
  } else if (errno != ENOENT) {
    fail(errno);
  } else if (fs::is_symlink(path)) {  // rename() would replace the link, such as /dev/stdout
    throw Error("it is a link to nothing");
  }
  if (!target.file.has_filename()) throw Error("it names no file");
  target.folder = target.file.has_parent_path() ? target.file.parent_path() : ".";
  if (!fs::exists(target.folder)) {
    throw Error(fmt::format("the folder {} does not exist", target.folder.native()));
  }
  return target;
}

template <class Action>
void naming(const std::string& path, Action action) {
  try {
    action();
  } catch (const std::system_error& error) {
    throw Error(fmt::format("cannot write {}: {}", path, error.code().message()));
  } catch (const std::exception& error) {
    throw Error(fmt::format("cannot write {}: {}", path, error.what()));
  }
}

}  // namespace

void check_writable(const std::string& path) {
  naming(path, [&] {
    const Target target = find_target(path);
    if (!target.is_special) TemporaryFile probe(target.folder);
  });
}

void write_file_atomically(const std::string& path, std::string_view bytes) {
  naming(path, [&] {
    const Target target = find_target(path);
    if (target.is_special) {
      Descriptor device(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
      if (device.get() < 0) fail(errno);
      device.write(bytes);
      return device.close();
    }
    TemporaryFile successor(target.folder);
    Descriptor& descriptor = successor.descriptor();
    // File systems without permissions or without sync are no reason to lose the content.
    if (target.mode && ::fchmod(descriptor.get(), *target.mode) != 0 && errno != EPERM) fail(errno);
    descriptor.write(bytes);
    if (::fsync(descriptor.get()) != 0 && errno != EINVAL) fail(errno);
    descriptor.close();
    successor.rename(target.file);
  });
}

}  // namespace pt
