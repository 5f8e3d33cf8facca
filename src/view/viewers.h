// Who looks at a page: those whose browsers keep asking for news.
#pragma once

#include <map>
#include <string>

namespace pt {

/// Times are seconds of any one clock.
class Viewers {
 public:
  /// A page that is silent for longer has been closed, or its machine sleeps.
  static constexpr double patience_s = 2.5;
  /// More are not counted: pages that call themselves otherwise each time.
  static constexpr std::size_t most = 100;

  void saw(const std::string& viewer, double now_s) {
    if (last_.size() < most || last_.contains(viewer)) last_[viewer] = now_s;
  }
  void left(const std::string& viewer) { last_.erase(viewer); }

  /// Whether there are any, after those that have been silent for too long are forgotten.
  bool any(double now_s) {
    std::erase_if(last_, [&](const auto& one) { return now_s - one.second > patience_s; });
    return !last_.empty();
  }

 private:
  std::map<std::string, double> last_;  ///< when each was seen
};

}  // namespace pt
