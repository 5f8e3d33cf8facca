// In place of http_server_http.cpp in a build without cpp-httplib.
#include "common/error/error.h"
#include "view/http_server.h"

namespace pt {

struct HttpServer::Library {};

HttpServer::HttpServer(int) {
  throw Error(
      "view: this program was built without the library cpp-httplib, which serves the page: "
      "install libcpp-httplib-dev and build with PTEXP_HTTP=ON");
}

HttpServer::~HttpServer() = default;

int HttpServer::port() const { return 0; }

void HttpServer::serve(HttpSite&, const std::function<bool()>&) {}

}  // namespace pt
