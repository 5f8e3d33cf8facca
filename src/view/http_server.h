// Answers HTTP requests from this machine. A program that was built without cpp-httplib refuses
// (http_absent.cpp).
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace pt {

struct HttpRequest {
  std::string method;
  std::string path;                          ///< as sent, without the query
  std::map<std::string, std::string> query;  ///< decoded; the first of equal names
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

/// Answers requests; called by several threads at once.
class HttpSite {
 public:
  virtual ~HttpSite() = default;

  /// The answer to a request that is refused before its body is read.
  virtual std::optional<HttpReply> refuse(const HttpRequest& request) = 0;
  virtual HttpReply answer(const HttpRequest& request) = 0;
};

/// Listens on 127.0.0.1 alone. The site gets GET and POST requests. Bodies of more than 4 KiB or of
/// unknown length, compressed ones and those of several parts are refused unread. A request may
/// take 5 seconds, its head 16 KiB and 100 lines. Of too many connections the one that has been
/// sending for longest is closed. Ranges are ignored.
class HttpServer {
 public:
  static constexpr std::size_t most_body_bytes = 4096;

  /// Takes the port; 0: any free one. Throws Error naming --port if it is taken, and in a program
  /// without HTTP.
  explicit HttpServer(int port);
  ~HttpServer();

  int port() const;

  /// Answers, in threads of its own, while `goes_on()`, which this thread calls 20 times a second.
  /// At the end waits a moment for answers that are being sent. Throws Error.
  void serve(HttpSite& site, const std::function<bool()>& goes_on);

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace pt
