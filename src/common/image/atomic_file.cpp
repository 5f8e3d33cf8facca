#include "common/image/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <optional>
#include <system_error>

#include "common/error/error.h"

namespace pt {
namespace {

namespace fs = std::filesystem;

std::atomic<bool> is_in_hurry{false};
static_assert(std::atomic<bool>::is_always_lock_free);  // or a handler must not touch it

/// Waits for the reader of a pipe as long as nobody wants to end.
class Patience {
 public:
  /// To be called now and then while nothing moves.
  void check() {
    if (!is_in_hurry) return;
    const auto now = std::chrono::steady_clock::now();
    if (!end_) end_ = now + std::chrono::seconds(1);
    if (now > *end_) throw Error("nobody reads this pipe");
  }
  void renew() { end_.reset(); }

 private:
  std::optional<std::chrono::steady_clock::time_point> end_;
};

constexpr int pipe_interval_ms = 50;

/// A pipe without a reader cannot be opened for writing without waiting.
int open_device(const std::string& path, Patience& patience) {
  for (;;) {
    const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK);
    const int problem = errno;
    struct stat status {};
    if (file >= 0) return file;
    if (problem != ENXIO || ::stat(path.c_str(), &status) != 0 || !S_ISFIFO(status.st_mode))
      throw_system_error(problem);
    patience.check();
    ::poll(nullptr, 0, pipe_interval_ms);
  }
}

void write_to_device(const std::string& path, std::string_view bytes) {
  Patience patience;
  Descriptor device(open_device(path, patience));
  while (!bytes.empty()) {
    const ssize_t written = ::write(device.get(), bytes.data(), bytes.size());
    if (written > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
      patience.renew();
    } else if (written < 0 && errno != EINTR && errno != EAGAIN) {
      throw_system_error(errno);
    } else {
      patience.check();
      pollfd room{device.get(), POLLOUT, 0};
      ::poll(&room, 1, pipe_interval_ms);
    }
  }
  device.close();
}

struct Target {
  fs::path file;                 ///< links resolved, so that rename() does not replace a link
  std::optional<mode_t> mode{};  ///< permissions of the file to replace, if there is one
  bool is_special = false;       ///< a device or pipe
};

fs::path folder_of(const Target& target) {
  return target.file.has_parent_path() ? target.file.parent_path() : ".";
}

Target find_target(const std::string& path) {
  Target target{path};
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) throw Error("it is a folder");
    // rename() would not mind, but whoever protects a file means it.
    if (::access(path.c_str(), W_OK) != 0) throw_system_error(errno);
    target.is_special = !S_ISREG(status.st_mode);
    if (!target.is_special) target.file = fs::canonical(path);
    target.mode = status.st_mode & 0777;
  } else if (errno != ENOENT) {
    throw_system_error(errno);
  } else if (fs::is_symlink(path)) {  // rename() would replace the link, such as /dev/stdout
    throw Error("it is a link to nothing");
  }
  if (!target.file.has_filename()) throw Error("it names no file");
  if (!fs::exists(folder_of(target))) {
    throw Error(fmt::format("the folder {} does not exist", folder_of(target).native()));
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
    if (!target.is_special) TemporaryFile probe(target.file);
  });
}

void check_room(const std::string& path, std::uint64_t size_bytes) {
  naming(path, [&] {
    const Target target = find_target(path);
    if (target.is_special) return;
    rlimit limit{};
    std::uint64_t room = fs::space(folder_of(target)).available;
    if (::getrlimit(RLIMIT_FSIZE, &limit) == 0)
      room = std::min(room, std::uint64_t{limit.rlim_cur});
    if (size_bytes <= room) return;
    throw Error(fmt::format("{} MB are needed, {} MB are free", (size_bytes + 999'999) / 1'000'000,
                            room / 1'000'000));
  });
}

bool is_same_file(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return false;
  std::error_code error;
  const bool is_device = fs::exists(a, error) && !fs::is_regular_file(a, error);
  if (is_device)  // /dev/stdout and /dev/stderr may well be one
    return fs::absolute(a).lexically_normal() == fs::absolute(b).lexically_normal();
  if (fs::equivalent(a, b, error)) return true;
  const fs::path place_a = fs::weakly_canonical(fs::absolute(a), error);
  const fs::path place_b = fs::weakly_canonical(fs::absolute(b), error);
  return !place_a.empty() && place_a == place_b;
}

void check_not_read(const std::string& option, const std::string& written,
                    const std::string& read) {
  if (is_same_file(written, read))
    throw Error(fmt::format("{} {}: is the file {}, which is read; expected another one", option,
                            written, read));
}

void hurry_pipe_writers() { is_in_hurry = true; }

void write_file_atomically(const std::string& path, std::string_view bytes) {
  naming(path, [&] {
    const Target target = find_target(path);
    if (target.is_special) return write_to_device(path, bytes);
    TemporaryFile successor(target.file);
    Descriptor& descriptor = successor.descriptor();
    // File systems without permissions or without sync are no reason to lose the content.
    if (target.mode && ::fchmod(descriptor.get(), *target.mode) != 0 && errno != EPERM)
      throw_system_error(errno);
    descriptor.write(bytes);
    if (::fsync(descriptor.get()) != 0 && errno != EINVAL) throw_system_error(errno);
    descriptor.close();
    successor.rename(target.file);
  });
}

}  // namespace pt
