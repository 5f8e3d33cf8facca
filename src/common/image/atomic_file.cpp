#include "common/image/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <optional>
#include <system_error>

#include "common/error/error.h"
#include "common/image/temporary_file.h"

namespace pt {
namespace {

namespace fs = std::filesystem;

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

void write_file_atomically(const std::string& path, std::string_view bytes) {
  naming(path, [&] {
    const Target target = find_target(path);
    if (target.is_special) {
      Descriptor device(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
      if (device.get() < 0) throw_system_error(errno);
      device.write(bytes);
      return device.close();
    }
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
