#include "common/scene/load/pbrt/syntax/source.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <memory>
#include <new>

#include "common/error/error.h"
#include "common/scene/load/files/mapped_file.h"

namespace pt::pbrt {
namespace {

constexpr std::size_t step = 1 << 20;  // bytes decompressed at once

/// Scenes and meshes are packed to a third or a tenth; gzip can make a thousand times more of a
/// byte.
std::size_t most_for(std::size_t packed_bytes) {
  return std::max(std::size_t{64} << 20, 100 * packed_bytes);
}

struct End {
  void operator()(z_stream* stream) const { inflateEnd(stream); }
};

/// Several streams may follow each other.
std::string decompress(std::string_view bytes) {
  z_stream stream{};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  std::size_t left = bytes.size();
  const std::size_t most = most_for(left);
  if (inflateInit2(&stream, 15 + 16) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, End> end(&stream);
  std::string out;
  while (true) {
    const std::size_t before = out.size();
    if (before > most) {
      throw Error(
          fmt::format("more than {} MiB when decompressed; expected at most 64 MiB or a "
                      "hundred times the compressed size",
                      most >> 20));
    }
    out.resize(before + step);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = static_cast<uInt>(step);
    const auto part = static_cast<uInt>(std::min<std::size_t>(left, 1u << 30));
    stream.avail_in = part;
    const int status = inflate(&stream, Z_NO_FLUSH);
    left -= part - stream.avail_in;
    out.resize(before + step - stream.avail_out);
    if (status == Z_MEM_ERROR) throw std::bad_alloc();
    if (status == Z_STREAM_END) {
      if (left == 0) return out;
      if (inflateReset(&stream) != Z_OK) throw Error("corrupted compressed data");
    } else if (status != Z_OK) {
      throw Error("truncated or corrupted compressed data");
    }
  }
}

}  // namespace

std::string read_source(const std::filesystem::path& path) {
  try {
    const MappedFile file(path);
    if (file.bytes().starts_with("\x1f\x8b")) return decompress(file.bytes());
    return std::string(file.bytes());
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path.string(), error.what()));
  }
}

}  // namespace pt::pbrt
