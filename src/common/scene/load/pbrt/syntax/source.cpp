#include "common/scene/load/pbrt/syntax/source.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <memory>
#include <new>

#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/scene/load/files/inflater.h"
#include "common/scene/load/files/whole_file.h"

namespace pt::pbrt {
namespace {

constexpr std::size_t step = 1 << 20;  // bytes decompressed at once

struct End {
  void operator()(z_stream* stream) const { inflateEnd(stream); }
};

/// Several streams may follow each other.
std::string decompress(std::string_view bytes) {
  z_stream stream{};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  std::size_t left = bytes.size();
  if (inflateInit2(&stream, 15 + 16) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, End> end(&stream);
  std::string out;
  while (true) {
    const std::size_t before = out.size();
    if (before > most_unpacked_bytes(bytes.size())) throw unpacks_to_more(bytes.size());
    if (before + step > out.capacity()) check_host_memory(2 * before, "the unpacked file");
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
    const WholeFile file(path);
    if (file.bytes().starts_with("\x1f\x8b")) return decompress(file.bytes());
    return std::string(file.bytes());
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path.string(), error.what()));
  }
}

}  // namespace pt::pbrt
