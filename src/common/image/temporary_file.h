// A file beside the one that it will replace.
#pragma once

#include <filesystem>
#include <string_view>

namespace pt {

/// Throws the std::system_error of a value of errno.
[[noreturn]] void throw_system_error(int error);

/// A file descriptor, closed at the end. Failures are std::system_errors.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor();

  int get() const { return fd_; }
  bool is_open() const { return fd_ >= 0; }
  int release();
  void write(std::string_view bytes);
  /// Unlike the destructor, reports the delayed write errors of network file systems.
  void close();

 private:
  int fd_;
};

/// A new file in the folder of `target`, removed again unless it is renamed. What a process left
/// there that was killed while it wrote to this target is removed first: a living one holds a lock
/// on its file. (A number of the process would not do: it is given to another, or belongs to
/// another container.)
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target);
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile();

  Descriptor& descriptor() { return descriptor_; }
  void rename(const std::filesystem::path& target);

 private:
  std::filesystem::path path_;  // before descriptor_, whose initialization fills it
  Descriptor descriptor_;
  Descriptor lock_;  ///< of the same file, open until it has its name
};

}  // namespace pt
