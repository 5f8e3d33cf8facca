#include "app/display/tev.h"

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <memory>

#include "common/error/error.h"

namespace pt {
namespace {

/// Connects, or returns why not.
int connect_within(int socket, const addrinfo& to, int timeout_ms) {
  const int flags = fcntl(socket, F_GETFL);
  fcntl(socket, F_SETFL, flags | O_NONBLOCK);
  if (connect(socket, to.ai_addr, to.ai_addrlen) != 0) {
    if (errno != EINPROGRESS) return errno;
    pollfd ready{socket, POLLOUT, 0};
    if (poll(&ready, 1, timeout_ms) <= 0) return ETIMEDOUT;
    int problem = 0;
    socklen_t size = sizeof problem;
    getsockopt(socket, SOL_SOCKET, SO_ERROR, &problem, &size);
    if (problem != 0) return problem;
  }
  fcntl(socket, F_SETFL, flags);
  return 0;
}

}  // namespace

Connection::Connection(const DisplayAddress& address, double timeout_s) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int failure =
      getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &found);
  if (failure != 0) throw Error(gai_strerror(failure));
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> list(found, freeaddrinfo);
  int problem = EHOSTUNREACH;
  for (const addrinfo* to = found; to != nullptr; to = to->ai_next) {
    socket_ = socket(to->ai_family, to->ai_socktype | SOCK_CLOEXEC, to->ai_protocol);
    if (socket_ < 0) {
      problem = errno;
      continue;
    }
    problem = connect_within(socket_, *to, static_cast<int>(1e3 * timeout_s));
    if (problem == 0) return;
    close(socket_);
    socket_ = -1;
  }
  throw Error(std::strerror(problem));
}

Connection::~Connection() {
  if (socket_ >= 0) close(socket_);
}

void Connection::send(const std::string& bytes) {
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t count = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw Error(std::strerror(errno));
    sent += static_cast<std::size_t>(count);
  }
}

void Connection::end() { shutdown(socket_, SHUT_RDWR); }

}  // namespace pt

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
