#include "common/scene/load/files/whole_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <new>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/scene/load/files/scene_files.h"
#include "common/scene/load/files/text.h"

namespace pt {
namespace {

namespace fs = std::filesystem;

/// What is called `name` in `folder`, itself first.
std::set<fs::path> alike(const fs::path& folder, const fs::path& name) {
  const std::string wanted = lower_case(name.string());
  std::set<fs::path> found;
  std::error_code error;
  const fs::path place = folder.empty() ? fs::path(".") : folder;
  for (fs::directory_iterator entry(place, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path candidate = entry->path().filename();
    if (candidate != name && lower_case(candidate.string()) == wanted) found.insert(candidate);
  }
  return found;
}

/// Looks for a name below a folder, part by part. Links may lead to one folder in many ways: each
/// is searched once for the same rest of the name.
class Search {
 public:
  explicit Search(const fs::path& name) : parts_(name.begin(), name.end()) {}

  /// parts[at], parts[at + 1], ... below `folder`, or an empty path.
  fs::path below(const fs::path& folder, std::size_t at) {
    if (at == parts_.size()) return folder;
    std::error_code failure;
    const fs::path place = fs::canonical(folder.empty() ? fs::path(".") : folder, failure);
    if (failure || !tried_.emplace(place, at).second) return {};
    const fs::path same = folder / parts_[at];
    if (fs::exists(same, failure)) {
      if (const fs::path found = below(same, at + 1); !found.empty()) return found;
    }
    for (const fs::path& other : alike(folder, parts_[at])) {
      if (const fs::path found = below(folder / other, at + 1); !found.empty()) return found;
    }
    return {};
  }

 private:
  std::vector<fs::path> parts_;
  std::set<std::pair<fs::path, std::size_t>> tried_;
};

}  // namespace

fs::path find_file(const fs::path& folder, const fs::path& name, const WarnOfName& warn) {
  std::error_code ignored;
  if (fs::exists(folder / name, ignored)) return folder / name;
  const fs::path relative = name.relative_path().lexically_normal();
  const fs::path found = Search(relative).below(name.is_absolute() ? name.root_path() : folder, 0);
  if (!found.empty() && warn) {
    warn(fmt::format("'{}' does not exist: {}, whose case differs, is used", name.string(),
                     found.string()));
  }
  return found;
}

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

namespace {

constexpr std::size_t most = 1u << 30;  // bytes at once: zlib counts with 32 bits

}  // namespace

Error unpacks_to_more(std::size_t packed_bytes) {
  return Error(
      fmt::format("{} bytes unpack to more than {} MiB; expected at most 256 MiB, or 100 "
                  "bytes for each",
                  packed_bytes, most_unpacked_bytes(packed_bytes) >> 20));
}

namespace {

struct End {
  void operator()(z_stream* stream) const { inflateEnd(stream); }
};

}  // namespace

std::string decompress_gzip(std::string_view bytes) {
  constexpr std::size_t block = 1 << 20;
  z_stream stream{};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  std::size_t left = bytes.size();
  if (inflateInit2(&stream, 15 + 16) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, End> end(&stream);
  std::string out;
  while (true) {
    const std::size_t before = out.size();
    if (before > most_unpacked_bytes(bytes.size())) throw unpacks_to_more(bytes.size());
    if (before + block > out.capacity()) check_host_memory(2 * before, "the unpacked file");
    out.resize(before + block);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = static_cast<uInt>(block);
    const auto part = static_cast<uInt>(std::min<std::size_t>(left, 1u << 30));
    stream.avail_in = part;
    const int status = inflate(&stream, Z_NO_FLUSH);
    left -= part - stream.avail_in;
    out.resize(before + block - stream.avail_out);
    if (status == Z_MEM_ERROR) throw std::bad_alloc();
    if (status == Z_STREAM_END) {
      if (left == 0) return out;
      if (inflateReset(&stream) != Z_OK) throw Error("corrupted compressed data");
    } else if (status != Z_OK) {
      throw Error("truncated or corrupted compressed data");
    }
  }
}

Inflater::Inflater(std::string_view bytes)
    : left_(most_unpacked_bytes(bytes.size())), packed_bytes_(bytes.size()) {
  // zlib takes at most 4 GB of input at once: the rest of a larger file is never one stream's.
  stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream_.avail_in = static_cast<uInt>(std::min<std::size_t>(bytes.size(), 0xffffffffu));
  if (inflateInit(&stream_) != Z_OK) throw std::bad_alloc();
}

void Inflater::read(void* out, std::size_t size) {
  if (size > left_) throw unpacks_to_more(packed_bytes_);
  left_ -= size;
  auto* next = static_cast<Bytef*>(out);
  while (size > 0) {
    const auto part = static_cast<uInt>(std::min(size, most));
    stream_.next_out = next;
    stream_.avail_out = part;
    while (stream_.avail_out > 0) {
      const int status = inflate(&stream_, Z_NO_FLUSH);
      if (status == Z_STREAM_END && stream_.avail_out > 0) {
        throw Error("truncated or corrupted: the compressed data end here");
      }
      if (status == Z_MEM_ERROR) throw std::bad_alloc();
      if (status != Z_OK && status != Z_STREAM_END) {
        throw Error("truncated or corrupted: the compressed data are wrong or end here");
      }
    }
    next += part;
    size -= part;
  }
}

void Inflater::check(std::uint64_t count, std::uint64_t size, std::size_t value_bytes) const {
  if ((count - size) > left_ / value_bytes) throw unpacks_to_more(packed_bytes_);
  constexpr std::uint64_t little = 1 << 20;
  if (size >= little) check_host_memory(2 * size * value_bytes, "the shape");
}

}  // namespace pt
