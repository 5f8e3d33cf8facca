#include "app/report/csv_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/error/error.h"
#include "common/platform/build_info.h"

namespace pt {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& problem) {
  throw Error(fmt::format("{}: {}", path, problem));
}

/// An open file, or nothing where `flags` does not ask to create a missing one.
class File {
 public:
  File(const std::string& path, int flags) : path_(path), fd_(open(path.c_str(), flags, 0666)) {
    if (fd_ < 0 && (errno != ENOENT || (flags & O_CREAT)))
      fail(path, fmt::format("cannot be appended to: {}", std::strerror(errno)));
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    if (fd_ >= 0) close(fd_);  // releases the lock too
  }

  bool is_open() const { return fd_ >= 0; }
  void lock() const { flock(fd_, LOCK_EX); }  // best effort: some network file systems have none

  std::size_t size() const {
    struct stat status {};
    if (fstat(fd_, &status) != 0) fail(path_, std::strerror(errno));
    return static_cast<std::size_t>(status.st_size);
  }

  /// Up to `count` bytes from `offset`.
  std::string read(std::size_t offset, std::size_t count) const {
    std::string bytes(count, '\0');
    const ssize_t got = pread(fd_, bytes.data(), count, static_cast<off_t>(offset));
    if (got < 0) fail(path_, fmt::format("cannot be read: {}", std::strerror(errno)));
    bytes.resize(static_cast<std::size_t>(got));
    return bytes;
  }

  void append(const std::string& bytes) const {
    const std::size_t old_size = size();
    std::size_t done = 0;
    int problem = 0;
    while (done < bytes.size() && problem == 0) {  // the second write of a row says why
      const ssize_t written = write(fd_, bytes.data() + done, bytes.size() - done);
      if (written < 0 && errno != EINTR) problem = errno;
      if (written > 0) done += static_cast<std::size_t>(written);
    }
    if (problem == 0) return;
    const std::string reason = std::strerror(problem);
    const bool undone = done == 0 || ftruncate(fd_, static_cast<off_t>(old_size)) == 0;
    fail(path_, fmt::format("cannot be appended to: {}{}", reason,
                            undone ? "" : "; the last row is incomplete"));
  }

 private:
  std::string path_;
  int fd_;
};

/// Version of the kernel module; empty where there is none.
std::string driver_version() {
  std::ifstream file("/sys/module/nvidia/version");
  std::string version;
  std::getline(file, version);
  return version;
}

/// RFC 4180: quoted where a comma, quote or line break would end the field.
std::string quoted(const std::string& field) {
  if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
  std::string text = "\"";
  for (const char c : field) text.append(c == '"' ? 2 : 1, c);
  return text + '"';
}

std::string header_line(const CsvRow& row) {
  std::string line;
  for (const auto& [name, value] : row) line += (line.empty() ? "" : ",") + quoted(name);
  return line + '\n';
}

std::string value_line(const CsvRow& row) {
  std::string line;
  for (const auto& [name, value] : row) line += quoted(value) + ',';
  line.back() = '\n';
  return line;
}

/// The file is empty (true) or begins with the header of `row` (false).
bool needs_header(const File& file, const std::string& path, const CsvRow& row) {
  if (file.size() == 0) return true;
  const std::string header = header_line(row);
  if (file.read(0, header.size()) != header)
    fail(path, fmt::format("has other columns than this version writes (schema version {}); "
                           "choose another file",
                           report_schema_version));
  return false;
}

}  // namespace

void check_csv(const std::string& path, const CsvRow& row) {
  const File file(path, O_RDWR | O_APPEND | O_CLOEXEC);
  if (file.is_open()) {
    needs_header(file, path, row);
    return;
  }
  // Not tried by creating it: a run that started meanwhile could lose its row to the clean-up.
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (access(folder.empty() ? "." : folder.c_str(), W_OK | X_OK) != 0)
    fail(path, fmt::format("cannot be created: {}", std::strerror(errno)));
}

void append_csv_row(const std::string& path, const CsvRow& row) {
  const File file(path, O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC);
  file.lock();
  std::string bytes = value_line(row);
  if (needs_header(file, path, row))
    bytes.insert(0, header_line(row));
  else if (file.read(file.size() - 1, 1) != "\n")  // a row that an editor or a crash left open
    bytes.insert(0, "\n");
  file.append(bytes);
}

CsvRow build_columns() {
  const BuildInfo& build = build_info();
  return {{"version", build.version},
          {"commit", build.commit},
          {"build_type", build.build_type},
          {"compiler", build.compiler},
          {"cuda", build.cuda},
          {"fast_math", build.fast_math ? "on" : "off"}};
}

CsvRow origin_columns(const std::string& command_line, const DeviceInfo& device, int threads) {
  const bool is_cuda = device.choice.kind == DeviceChoice::Kind::cuda;
  CsvRow row = build_columns();
  const CsvRow more{{"command", command_line},
                    {"device", device.name},
                    {"device_kind", is_cuda ? "cuda" : "cpu"},
                    {"threads", is_cuda ? "" : std::to_string(threads)},
                    {"driver", is_cuda ? driver_version() : ""}};
  row.insert(row.end(), more.begin(), more.end());
  return row;
}

}  // namespace pt
