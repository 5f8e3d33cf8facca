#include "app/display/tev_packets.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace pt::tev {
namespace {

static_assert(std::endian::native == std::endian::little);

enum class Operation : std::uint8_t { create_image = 4, update_image_strided = 6 };

const char* const channels[] = {"R", "G", "B"};
constexpr std::int32_t channel_count = 3;

class Packet {
 public:
  explicit Packet(Operation operation) {
    add(std::uint32_t{0});  // the length, once it is known
    add(operation);
  }

  template <class T>
  void add(T value) {
    const char* const bytes = reinterpret_cast<const char*>(&value);
    bytes_.append(bytes, sizeof value);
  }
  void add(const std::string& text) { bytes_.append(text.c_str(), text.size() + 1); }
  void add(const float* values, std::size_t count) {
    bytes_.append(reinterpret_cast<const char*>(values), count * sizeof *values);
  }
  void add_channels() {
    add(channel_count);
    for (const char* const channel : channels) add(std::string(channel));
  }

  std::string take() {
    const auto length = static_cast<std::uint32_t>(bytes_.size());
    std::memcpy(bytes_.data(), &length, sizeof length);
    return std::move(bytes_);
  }

 private:
  std::string bytes_;
};

bool differ(const Image& a, const Image& b, const CropWindow& part) {
  const auto count = 3 * static_cast<std::size_t>(part.x1 - part.x0);
  for (int y = part.y0; y < part.y1; ++y) {
    const std::size_t first = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(a.width) +
                                   static_cast<std::size_t>(part.x0));
    if (std::memcmp(&a.rgb[first], &b.rgb[first], count * sizeof(float)) != 0) return true;
  }
  return false;
}

}  // namespace

std::string create_image(const std::string& name, int width, int height) {
  Packet packet(Operation::create_image);
  packet.add(std::uint8_t{1});
  packet.add(name);
  packet.add(static_cast<std::int32_t>(width));
  packet.add(static_cast<std::int32_t>(height));
  packet.add_channels();
  return packet.take();
}

std::string update_image(const std::string& name, const Image& image, const CropWindow& part) {
  Packet packet(Operation::update_image_strided);
  packet.add(std::uint8_t{0});
  packet.add(name);
  packet.add_channels();
  packet.add(static_cast<std::int32_t>(image.place.x + part.x0));
  packet.add(static_cast<std::int32_t>(image.place.y + part.y0));
  packet.add(static_cast<std::int32_t>(part.x1 - part.x0));
  packet.add(static_cast<std::int32_t>(part.y1 - part.y0));
  for (std::int64_t channel = 0; channel < channel_count; ++channel) packet.add(channel);
  for (std::int64_t channel = 0; channel < channel_count; ++channel)
    packet.add(std::int64_t{channel_count});
  for (int y = part.y0; y < part.y1; ++y) {
    const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                       static_cast<std::size_t>(part.x0);
    packet.add(&image.rgb[3 * pixel], 3 * static_cast<std::size_t>(part.x1 - part.x0));
  }
  return packet.take();
}

std::vector<CropWindow> changed_parts(const Image& before, const Image& after, int tile) {
  std::vector<CropWindow> parts;
  for (int y = 0; y < after.height; y += tile) {
    for (int x = 0; x < after.width; x += tile) {
      const CropWindow part{x, y, std::min(x + tile, after.width),
                            std::min(y + tile, after.height)};
      if (!before.rgb.empty() && !differ(before, after, part)) continue;
      if (!parts.empty() && parts.back().y0 == y && parts.back().x1 == x) {
        parts.back().x1 = part.x1;
      } else {
        parts.push_back(part);
      }
    }
  }
  return parts;
}

}  // namespace pt::tev
