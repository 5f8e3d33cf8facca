// A connection with limits of memory and time, for http_server_http.cpp.
#pragma once

#include <fmt/format.h>
#include <httplib.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <map>
#include <mutex>
#include <string>

namespace pt {

/// Headers of all answers: a browser stores nothing, shows nothing in other pages and tells no
/// address.
inline const httplib::Headers careful_headers{
    {"Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"Cache-Control", "no-store"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"}};

/// The sockets of a server. One whose request is not complete may be ended at any time.
class Connections {
 public:
  /// Another one has come. Where there are more than `most`, the one that has been sending its
  /// request for longest is ended.
  void arrives(std::size_t most);
  void leaves();

  /// Its request is read from now on. False: the server ends.
  bool begins(int socket);
  void has_sent(int socket);  ///< its request's head
  void ends(int socket);      ///< it is to be closed

  void end_requests();  ///< those that are not complete, now and in future
  void end_all();

 private:
  using Clock = std::chrono::steady_clock;

  std::mutex mutex_;
  std::size_t open_ = 0;
  bool is_ending_ = false;
  std::map<int, Clock::time_point> sending_;  ///< when each began
  std::map<int, Clock::time_point> others_;   ///< those that are being answered
};

/// A request of at most so many bytes and lines and so much time, else it is answered by 431 or 408
/// and nothing more is read; and an answer that takes no longer than its time.
class GuardedStream : public httplib::Stream {
 public:
  static constexpr std::size_t most_head_bytes = 16384, most_head_lines = 100;
  static constexpr std::size_t most_body_bytes = 8192;  ///< what is read of one; see HttpServer
  static constexpr std::chrono::seconds request_time{5}, answer_time{20};

  GuardedStream(int socket, Connections& connections);

  /// Lets the peer read the answer before the connection is closed: unread bytes would reset it.
  void finish();

  bool is_readable() const override;
  bool is_writable() const override;
  ssize_t read(char* to, std::size_t size) override;
  ssize_t write(const char* from, std::size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

 private:
  using Clock = std::chrono::steady_clock;

  bool fill();
  bool count_head(char byte);
  void refuse(const char* status, const char* line);
  bool send_all(const char* from, std::size_t size);

  const int socket_;
  Connections& connections_;
  const Clock::time_point begin_ = Clock::now();
  std::string buffer_;
  std::size_t at_ = 0;  ///< in the buffer
  std::size_t head_bytes_ = 0, head_lines_ = 0, line_bytes_ = 0, body_bytes_ = 0;
  bool is_in_head_ = true, is_refused_ = false;
  Clock::time_point answer_begin_{};
};

namespace detail {

using std::chrono::milliseconds;

/// Waits until the socket is ready for one of these events, or has ended.
inline bool wait_for(int socket, short events, milliseconds time) {
  pollfd one{socket, events, 0};
  return poll(&one, 1, static_cast<int>(std::max<long>(time.count(), 0))) > 0;
}

inline milliseconds left_of(std::chrono::steady_clock::time_point begin, milliseconds all) {
  const auto passed = std::chrono::steady_clock::now() - begin;
  return all - std::chrono::duration_cast<milliseconds>(passed);
}

}  // namespace detail

inline void Connections::arrives(std::size_t most) {
  const std::lock_guard lock(mutex_);
  ++open_;
  if (open_ <= most || sending_.empty()) return;
  const auto oldest = std::ranges::min_element(
      sending_, {}, [](const auto& connection) { return connection.second; });
  shutdown(oldest->first, SHUT_RDWR);
  others_.insert(sending_.extract(oldest));
}

inline void Connections::leaves() {
  const std::lock_guard lock(mutex_);
  --open_;
}

inline bool Connections::begins(int socket) {
  const std::lock_guard lock(mutex_);
  if (!is_ending_) sending_[socket] = Clock::now();
  return !is_ending_;
}

inline void Connections::has_sent(int socket) {
  const std::lock_guard lock(mutex_);
  if (auto node = sending_.extract(socket)) others_.insert(std::move(node));
}

inline void Connections::ends(int socket) {
  const std::lock_guard lock(mutex_);
  sending_.erase(socket), others_.erase(socket);
}

inline void Connections::end_requests() {
  const std::lock_guard lock(mutex_);
  is_ending_ = true;
  for (const auto& [socket, begin] : sending_) shutdown(socket, SHUT_RDWR);
}

inline void Connections::end_all() {
  const std::lock_guard lock(mutex_);
  for (const auto& [socket, begin] : others_) shutdown(socket, SHUT_RDWR);
}

inline GuardedStream::GuardedStream(int socket, Connections& connections)
    : socket_(socket), connections_(connections) {}

inline bool GuardedStream::is_readable() const {
  return at_ < buffer_.size() ||
         detail::wait_for(socket_, POLLIN, detail::left_of(begin_, request_time));
}

inline bool GuardedStream::is_writable() const { return !is_refused_; }

/// Reads what is there into the buffer.
inline bool GuardedStream::fill() {
  char bytes[4096];
  if (!detail::wait_for(socket_, POLLIN, detail::left_of(begin_, request_time))) {
    if (head_bytes_ > 0) refuse("408 Request Timeout", "a request: expected within 5 seconds");
    is_refused_ = true;
    return false;
  }
  const ssize_t count = recv(socket_, bytes, sizeof bytes, 0);
  if (count <= 0) return false;
  buffer_.assign(bytes, static_cast<std::size_t>(count));
  at_ = 0;
  return true;
}

/// Returns whether the head may go on after this byte of it.
inline bool GuardedStream::count_head(char byte) {
  ++head_bytes_;
  if (byte == '\n') {
    is_in_head_ = line_bytes_ > 0;
    line_bytes_ = 0, ++head_lines_;
  } else if (byte != '\r') {
    ++line_bytes_;
  }
  if (!is_in_head_) connections_.has_sent(socket_);
  if (head_bytes_ <= most_head_bytes && head_lines_ <= most_head_lines) return true;
  refuse("431 Request Header Fields Too Large",
         "a request's head: expected at most 16384 bytes and 100 lines");
  return false;
}

inline ssize_t GuardedStream::read(char* to, std::size_t size) {
  if (is_refused_ || (at_ == buffer_.size() && !fill())) return -1;
  std::size_t count = 0;
  for (; count < size && at_ < buffer_.size(); ++count, ++at_) {
    if (is_in_head_ ? !count_head(buffer_[at_]) : ++body_bytes_ > most_body_bytes) return -1;
    to[count] = buffer_[at_];
  }
  return static_cast<ssize_t>(count);
}

inline bool GuardedStream::send_all(const char* from, std::size_t size) {
  if (answer_begin_ == Clock::time_point{}) answer_begin_ = Clock::now();
  while (size > 0) {
    if (!detail::wait_for(socket_, POLLOUT, detail::left_of(answer_begin_, answer_time)))
      return false;
    const ssize_t count = send(socket_, from, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count < 0 && errno != EAGAIN && errno != EINTR) return false;
    from += std::max<ssize_t>(count, 0),
        size -= static_cast<std::size_t>(std::max<ssize_t>(count, 0));
  }
  return true;
}

/// The library's own answer to a request that ends in its midst is not sent.
inline ssize_t GuardedStream::write(const char* from, std::size_t size) {
  if (!is_refused_ && !send_all(from, size)) return -1;
  return static_cast<ssize_t>(size);
}

inline void GuardedStream::refuse(const char* status, const char* line) {
  std::string reply = fmt::format("HTTP/1.1 {}\r\nConnection: close\r\n", status);
  for (const auto& [name, value] : careful_headers) reply += fmt::format("{}: {}\r\n", name, value);
  reply += fmt::format("Content-Type: text/plain\r\nContent-Length: {}\r\n\r\n{}\n",
                       std::string_view(line).size() + 1, line);
  send_all(reply.data(), reply.size());
  is_refused_ = true;
}

inline void GuardedStream::finish() {
  constexpr int most_reads = 64;
  constexpr detail::milliseconds patience{200};
  const auto begin = Clock::now();
  shutdown(socket_, SHUT_WR);
  char bytes[4096];
  for (int i = 0;
       i < most_reads && detail::wait_for(socket_, POLLIN, detail::left_of(begin, patience)); ++i)
    if (recv(socket_, bytes, sizeof bytes, MSG_DONTWAIT) <= 0) break;
}

inline void GuardedStream::get_remote_ip_and_port(std::string& ip, int& port) const {
  ip.clear(), port = 0;
}
inline void GuardedStream::get_local_ip_and_port(std::string& ip, int& port) const {
  ip.clear(), port = 0;
}

}  // namespace pt
