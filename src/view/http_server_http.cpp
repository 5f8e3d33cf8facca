// HTTP by cpp-httplib.
#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <charconv>
#include <chrono>
#include <thread>
#include <utility>

#include "common/error/error.h"
#include "view/guarded_stream_http.h"
#include "view/http_server.h"

namespace pt {
namespace {

constexpr int threads = 32;  // a browser has six connections at most
constexpr auto asks_every = std::chrono::milliseconds(50);
constexpr auto goodbye = std::chrono::milliseconds(300);  // for answers on their way at the end

/// A header that stands there twice is none: others might believe the other one.
std::string header(const httplib::Request& request, const char* name) {
  return request.get_header_value_count(name) == 1 ? request.get_header_value(name) : "";
}

HttpRequest read(const httplib::Request& request) {
  HttpRequest read;
  read.method = request.method;
  read.path = request.target.substr(0, request.target.find_first_of("?#"));
  for (const auto& [name, value] : request.params) read.query.emplace(name, value);
  read.host = header(request, "Host");
  read.origin = request.has_header("Origin") ? header(request, "Origin") : "";
  if (request.get_header_value_count("Origin") > 1) read.origin = "several";
  read.body = request.body;
  return read;
}

void write(const HttpReply& reply, httplib::Response& response) {
  response.status = reply.status;
  for (const auto& [name, value] : reply.headers) {
    response.headers.erase(name);
    response.set_header(name.c_str(), value);
  }
  if (!reply.body.empty()) response.set_content(reply.body, reply.type.c_str());
}

/// The library would read bodies of any length to their ends, and unpack them.
std::optional<HttpReply> refuse_body(const httplib::Request& request) {
  const bool has_length = request.has_header("Content-Length");
  if (request.method != "POST") return std::nullopt;  // read from none else
  if (request.has_header("Transfer-Encoding") || !has_length)
    return text_reply(411, "a body: expected Content-Length");
  const std::string length = header(request, "Content-Length");
  std::size_t bytes = 0;
  const auto [end, error] = std::from_chars(length.data(), length.data() + length.size(), bytes);
  if (error == std::errc::invalid_argument || end != length.data() + length.size())
    return text_reply(400, "Content-Length: expected one number of bytes");
  if (error != std::errc() || bytes > HttpServer::most_body_bytes)
    return text_reply(
        413, fmt::format("a body: expected at most {} bytes", HttpServer::most_body_bytes));
  if (request.has_header("Content-Encoding") || request.is_multipart_form_data())
    return text_reply(415, "a body: expected JSON, neither compressed nor in several parts");
  return std::nullopt;
}

/// Has every connection answered by GuardedStream, in threads of which slow requests cannot hold
/// all.
class GuardedServer : public httplib::Server {
 public:
  GuardedServer() {
    new_task_queue = [this] { return new Threads(connections_); };
  }

  /// Ends: what was not read yet is not answered, the rest within a moment.
  void end() {
    stop();
    connections_.end_requests();
    const auto limit = std::chrono::steady_clock::now() + goodbye;
    while (is_running() && std::chrono::steady_clock::now() < limit)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    connections_.end_all();
  }

 private:
  /// Makes room among the threads for each connection that comes.
  class Threads : public httplib::TaskQueue {
   public:
    explicit Threads(Connections& connections) : connections_(connections), pool_(threads) {}

    /// Returns what the library's version wants.
    auto enqueue(std::function<void()> task)
        -> decltype(std::declval<httplib::TaskQueue&>().enqueue(nullptr)) override {
      connections_.arrives(threads);
      return pool_.enqueue([this, task = std::move(task)] {
        task();
        connections_.leaves();
      });
    }
    void shutdown() override { pool_.shutdown(); }

   private:
    Connections& connections_;
    httplib::ThreadPool pool_;
  };

  using Setup = std::function<void(httplib::Request&)>;
  using Strings = const std::string&;

  bool process_and_close_socket(socket_t socket) override {
    bool done = false;
    if (connections_.begins(socket)) {
      GuardedStream stream(socket, connections_);
      done = answer_by(&GuardedServer::process_request, stream);
      stream.finish();
      connections_.ends(socket);
    }
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    return done;
  }

  // process_request of 0.11 and of 0.18.
  bool answer_by(bool (Server::*process)(httplib::Stream&, bool, bool&, const Setup&),
                 GuardedStream& stream) {
    bool is_closed = false;
    return (this->*process)(stream, true, is_closed, ignore_ranges);
  }
  bool answer_by(bool (Server::*process)(httplib::Stream&, Strings, int, Strings, int, bool, bool&,
                                         const Setup&),
                 GuardedStream& stream) {
    bool is_closed = false;
    return (this->*process)(stream, "", 0, "", 0, true, is_closed, ignore_ranges);
  }

  /// The library would cut the body but leave the status 200.
  static void ignore_ranges(httplib::Request& request) {
    request.headers.erase("Range");
    request.ranges.clear();
  }

  Connections connections_;
};

}  // namespace

struct HttpServer::Library {
  GuardedServer server;
  int port = 0;
};

HttpServer::HttpServer(int port) : library_(std::make_unique<Library>()) {
  GuardedServer& server = library_->server;
  // The library's own options let two programs share a port, of which one hears nothing.
  server.set_socket_options([](int socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server.set_address_family(AF_INET);
  const char* const host = "127.0.0.1";
  const bool is_bound = port == 0 ? (library_->port = server.bind_to_any_port(host)) > 0
                                  : server.bind_to_port(host, port);
  if (!is_bound)
    throw Error(fmt::format(
        "--port {}: is in use, or not for you; expected a free one, or 0 for any", port));
  if (port != 0) library_->port = port;
}

HttpServer::~HttpServer() = default;

int HttpServer::port() const { return library_->port; }

void HttpServer::serve(HttpSite& site, const std::function<bool()>& goes_on) {
  using Answered = httplib::Server::HandlerResponse;
  GuardedServer& server = library_->server;
  const auto refuse = [&](const httplib::Request& request, httplib::Response& response) {
    std::optional<HttpReply> refusal = site.refuse(read(request));
    if (!refusal) refusal = refuse_body(request);
    if (refusal) write(*refusal, response);
    return refusal.has_value();
  };
  const auto answer = [&](const httplib::Request& request, httplib::Response& response) {
    write(site.answer(read(request)), response);
  };
  server.set_default_headers(careful_headers);
  server.set_tcp_nodelay(true);
  server.set_expect_100_continue_handler([&](const auto& request, auto& response) {
    return refuse(request, response) ? response.status : 100;
  });
  server.set_pre_routing_handler([&](const auto& request, auto& response) {
    if (refuse(request, response)) return Answered::Handled;
    if (request.method == "POST") return Answered::Unhandled;  // its body comes first
    answer(request, response);
    return Answered::Handled;
  });
  server.Post("/.*", answer);
  server.set_exception_handler([](const auto&, auto& response, std::exception_ptr) {
    write(text_reply(500, "ptexp could not answer"), response);
  });

  bool is_sound = true;
  std::atomic<bool> has_ended{false};
  std::thread listener([&] {
    is_sound = server.listen_after_bind();
    has_ended = true;
  });
  while (goes_on() && !has_ended) std::this_thread::sleep_for(asks_every);
  while (!has_ended && !server.is_running()) std::this_thread::sleep_for(asks_every);
  server.end();
  listener.join();
  if (!is_sound) throw Error(fmt::format("--port {}: no connection can be taken any more", port()));
}

}  // namespace pt
