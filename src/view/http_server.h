// Answers HTTP requests of this machine. A program that was built without the library for it has
// http_absent.cpp, and refuses.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace pt {

struct HttpRequest {
  std::string method;
  std::string path;                          ///< as it was sent, without the query
  std::map<std::string, std::string> query;  ///< decoded; of a name given twice the first
  std::string host, origin;                  ///< headers; empty where missing or given twice
  std::string body{};
};

struct HttpReply {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body{};
  std::map<std::string, std::string> headers{};  ///< besides those of the body
};

inline HttpReply text_reply(int status, const std::string& line) {
  return {.status = status, .body = line + "\n"};
}

/// What is asked, by several threads at once.
class HttpSite {
 public:
  virtual ~HttpSite() = default;

  /// Of a request whose body was not read yet: the answer where it is not wanted.
  virtual std::optional<HttpReply> refuse(const HttpRequest& request) = 0;
  virtual HttpReply answer(const HttpRequest& request) = 0;
};

/// Of 127.0.0.1 alone. The site gets GET and POST requests; bodies of more than 4 KiB or of unknown
/// length, compressed ones and those of several parts are refused unread. A request has 5 seconds,
/// its head 16 KiB and 100 lines, and of many connections the one that sends for longest makes room
/// for others. Ranges are ignored.
class HttpServer {
 public:
  static constexpr std::size_t most_body_bytes = 4096;

  /// Takes the port; 0: any that is free. Throws Error naming --port where it is taken, and in a
  /// program without HTTP.
  explicit HttpServer(int port);
  ~HttpServer();

  int port() const;

  /// Answers, by threads of its own, while `goes_on()`, which this thread asks 20 times a second.
  /// Waits a moment for answers that are on their way. Throws Error.
  void serve(HttpSite& site, const std::function<bool()>& goes_on);

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace pt
