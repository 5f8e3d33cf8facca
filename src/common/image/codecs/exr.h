// OpenEXR: its streams to and from memory, and a look at a header before OpenEXR reads it.
#pragma once

#include <Iex.h>
#include <ImfIO.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace pt {

class ExrWriter : public Imf::OStream {
 public:
  ExrWriter() : OStream("") {}

  void write(const char data[], int count) override {
    const auto size = static_cast<std::size_t>(count);
    bytes.replace(position_, std::min(size, bytes.size() - position_), data, size);
    position_ += size;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override {
    if (position > bytes.size()) bytes.resize(position);
    position_ = position;
  }

  std::string bytes;

 private:
  std::size_t position_ = 0;
};

class ExrReader : public Imf::IStream {
 public:
  explicit ExrReader(std::string_view bytes) : IStream(""), bytes_(bytes) {}

  bool read(char data[], int count) override {
    if (position_ > bytes_.size() || count < 0 ||
        static_cast<std::size_t>(count) > bytes_.size() - position_) {
      throw Iex::InputExc("truncated or corrupted");
    }
    std::memcpy(data, bytes_.data() + position_, static_cast<std::size_t>(count));
    position_ += static_cast<std::size_t>(count);
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }

 private:
  std::string_view bytes_;
  std::uint64_t position_ = 0;
};

/// What a header announces; OpenEXR would allocate that. The sides are those of the data window,
/// and may be any numbers.
struct ExrSize {
  std::int64_t width = 0, height = 0;
  std::int64_t tile_width = 0, tile_height = 0;  ///< 0: the file has lines
  std::size_t bytes_per_pixel = 0;               ///< of all channels, decompressed
};

/// Throws Error unless `bytes` begin with the header of a flat, single-part OpenEXR file whose
/// attributes have the sizes of their types and lie within the file, which must be large enough for
/// the offsets of its tiles (https://openexr.com/en/latest/OpenEXRFileLayout.html).
ExrSize check_exr_header(std::string_view bytes);

}  // namespace pt
