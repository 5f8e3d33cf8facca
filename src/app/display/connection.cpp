#include "app/display/connection.h"

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

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
