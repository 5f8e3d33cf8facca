// The addresses of a live render's page, and who may ask for them.
#pragma once

#include <mutex>

#include "view/http_server.h"
#include "view/live_render.h"
#include "view/viewers.h"

namespace pt {

/// 128 random bits in hexadecimal digits. Throws Error where the system has none.
std::string random_token();

/// All addresses lie below /TOKEN/, else nothing is there (404). Requests that name another host
/// are refused (403), since a foreign page whose name leads to 127.0.0.1 sends those, and so are
/// POST requests of foreign pages.
///
/// method, address | answer
/// GET             | the page
/// GET state       | JSON; `after=VERSION`: once it is another one, a second later at the latest;
///                 | `viewer=NAME`: who asks, and is taken for present until that name is silent
/// GET image       | `mode=MODE`: PNG; 404 while there is none
/// POST settings   | JSON: any of "orbit", "mode", "exposure"; 400 and a sentence for others
/// POST leave      | `viewer=NAME` is gone
class ViewSite : public HttpSite {
 public:
  /// `live` must outlive it. `clock`: seconds.
  ViewSite(LiveRender& live, std::string token, int port, std::function<double()> clock);

  std::optional<HttpReply> refuse(const HttpRequest& request) override;
  HttpReply answer(const HttpRequest& request) override;

  /// Has the render wait while nobody is there. To be called now and then.
  void look_for_viewers();

 private:
  /// A picture that several viewers want.
  struct Picture {
    std::uint64_t image_number = 0;
    float exposure = 0;
    std::string png;
  };

  std::string name_of(const HttpRequest& request) const;
  HttpReply page() const;
  HttpReply state(const HttpRequest& request);
  HttpReply image(const HttpRequest& request);
  HttpReply settings(const HttpRequest& request);
  HttpReply leave(const HttpRequest& request);

  LiveRender& live_;
  const std::string token_;
  const std::vector<std::string> hosts_;  ///< that a browser may call this machine
  const std::function<double()> clock_;
  std::mutex viewers_mutex_, pictures_mutex_, settings_mutex_;
  Viewers viewers_;
  std::map<Mode, Picture> pictures_;
};

}  // namespace pt
