// A connection with limits of memory and time, for http_server_http.cpp.
#pragma once

#include <httplib.h>

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

}  // namespace pt
