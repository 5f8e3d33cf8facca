// Writing a file so that its readers find the old content or the new one, never a part.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace pt {

/// Throws Error when write_file_atomically(path, ...) could not begin: the folder is missing or
/// closed to us, or `path` is a folder or write-protected. Leaves nothing behind, and removes what
/// a process left that was killed while it wrote to `path`.
void check_writable(const std::string& path);

/// Throws Error when the file system, or the process's limit of a file's size, has less room for a
/// successor of `path` than `size_bytes`.
void check_room(const std::string& path, std::uint64_t size_bytes);

/// Replaces `path` by `bytes`: they go to a temporary file in the same folder, which is synced and
/// then renamed. After any failure `path` is as it was and the temporary is gone. A new file gets
/// the permissions of the umask, a replaced one keeps its own; a link stays, its target is
/// replaced. A device or pipe (/dev/stdout) has nothing to protect and is written directly: whoever
/// reads a pipe is waited for. Throws Error naming `path`.
void write_file_atomically(const std::string& path, std::string_view bytes);

/// Whether both are one file, by whatever names and links; of files that do not exist yet, whether
/// they will be.
bool is_same_file(const std::string& a, const std::string& b);

/// Throws Error, naming `option`, where the file that is to be written is one that was read.
void check_not_read(const std::string& option, const std::string& written, const std::string& read);

/// For handlers of signals that do not end the program: whoever waits for the reader of a pipe,
/// now or later, gives up after a second.
void hurry_pipe_writers();

/// Removes the temporary file of a write that will not go on. May be called by signal handlers.
void remove_unfinished_file();

// The parts of an atomic write.

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
