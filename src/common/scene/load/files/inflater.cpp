#include "common/scene/load/files/inflater.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "common/error/error.h"
#include "common/error/host_memory.h"

namespace pt {
namespace {

constexpr std::size_t most = 1u << 30;  // bytes at once: zlib counts with 32 bits

}  // namespace

Error unpacks_to_more(std::size_t packed_bytes) {
  return Error(
      fmt::format("{} bytes unpack to more than {} MiB; expected at most 256 MiB, or 100 "
                  "bytes for each",
                  packed_bytes, most_unpacked_bytes(packed_bytes) >> 20));
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
