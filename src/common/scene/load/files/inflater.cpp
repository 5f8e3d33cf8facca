#include "common/scene/load/files/inflater.h"

#include <algorithm>
#include <new>

#include "common/error/error.h"

namespace pt {
namespace {

constexpr std::size_t most = 1u << 30;  // bytes at once: zlib counts with 32 bits

}  // namespace

Inflater::Inflater(std::string_view bytes) {
  // zlib takes at most 4 GB of input at once: the rest of a larger file is never one stream's.
  stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream_.avail_in = static_cast<uInt>(std::min<std::size_t>(bytes.size(), 0xffffffffu));
  if (inflateInit(&stream_) != Z_OK) throw std::bad_alloc();
}

void Inflater::read(void* out, std::size_t size) {
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

}  // namespace pt
