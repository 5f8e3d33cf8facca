// `ptexp view SCENE`: the page of a live render, its addresses, and who may ask for them.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <string_view>

#include "view/http_server.h"
#include "view/live_render.h"

namespace pt {

/// Prints the page's address and serves it until a signal. Returns 130 or 143 (process.h). Throws
/// Error.
int view_command(const ViewCommand& command);

/// src/view/page.html with page.js, which the build makes a string of. NONCE stands in it where the
/// word of its Content-Security-Policy belongs.
std::string_view page_html();

/// Who looks at a page: those whose browsers keep asking for news. Times are seconds of any clock.
class Viewers {
 public:
  /// A page that is silent for longer is closed, or its machine sleeps.
  static constexpr double patience_s = 2.5;
  /// More are not counted: a page may use a new name each time.
  static constexpr std::size_t most = 100;

  void saw(const std::string& viewer, double now_s) {
    if (last_.size() < most || last_.contains(viewer)) last_[viewer] = now_s;
  }
  void left(const std::string& viewer) { last_.erase(viewer); }

  /// Forgets those that were silent for too long; returns whether any are left.
  bool any(double now_s) {
    std::erase_if(last_, [&](const auto& one) { return now_s - one.second > patience_s; });
    return !last_.empty();
  }

 private:
  std::map<std::string, double> last_;  ///< when each was seen
};

/// 128 random bits as hexadecimal digits. Throws Error if the system has none.
std::string random_token();

/// All addresses lie below /TOKEN/; others are not found (404). Refuses (403) requests that name
/// another host, which a foreign page sends whose name resolves to 127.0.0.1, and POST requests of
/// foreign pages.
///
/// method, address | answer
/// GET             | the page
/// GET state       | JSON; `after=VERSION`: waits up to a second for another version;
///                 | `viewer=NAME`: the viewer, who is present until the name is silent
/// GET image       | `mode=MODE`: PNG of what is shown, X-Range: what the colours of numbers begin
///                 | and end with; 204 while there is none
/// GET save        | `mode=MODE`, `form=png`: the same with a header; `form=exr`: radiance and
/// layers GET parameters  | JSON: names and values of materials and lights, as the scene was loaded
/// POST settings   | JSON as read_change takes it; 400 and a sentence for others
/// POST leave      | `viewer=NAME` is gone
class ViewSite : public HttpSite {
 public:
  /// `live` must outlive it. `clock`: seconds.
  ViewSite(LiveRender& live, std::string token, int port, std::function<double()> clock);

  std::optional<HttpReply> refuse(const HttpRequest& request) override;
  HttpReply answer(const HttpRequest& request) override;

  /// Pauses the render while nobody is there. To be called now and then.
  void look_for_viewers();

 private:
  /// The encoded image, for all viewers.
  struct Encoded {
    std::uint64_t image_number = 0;
    Display display;
    std::string png, range;
  };

  std::string name_of(const HttpRequest& request) const;
  HttpReply page() const;
  HttpReply state(const HttpRequest& request);
  HttpReply image(const HttpRequest& request);
  HttpReply save(const HttpRequest& request) const;
  HttpReply parameters() const;
  HttpReply settings(const HttpRequest& request);
  HttpReply leave(const HttpRequest& request);

  LiveRender& live_;
  const std::string token_;
  const std::vector<std::string> hosts_;  ///< that a browser may call this machine
  const std::function<double()> clock_;
  std::mutex viewers_mutex_, pictures_mutex_, settings_mutex_;
  Viewers viewers_;
  std::map<Mode, Encoded> pictures_;
};

}  // namespace pt
