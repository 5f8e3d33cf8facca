// What the loading of a file tells the user.
#pragma once

#include <fmt/format.h>

#include <map>
#include <set>
#include <string>

#include "common/scene/load/files/load_options.h"
#include "common/scene/load/pbrt/syntax/place.h"

namespace pt::pbrt {

class Reporter {
 public:
  /// `load_options` outlive it.
  explicit Reporter(const LoadOptions& load_options) : options_(load_options) {}

  /// Reports what is replaced or ignored, once for each `kind`. Of kinds that begin with the same
  /// word there are at most ten: files may have any number of names.
  void warn_once(const std::string& kind, const Place& place, const std::string& message) {
    int& family = families_[kind.substr(0, kind.find(' '))];
    if (family > most_of_a_family || !warned_.insert(kind).second) return;
    const bool is_last = ++family > most_of_a_family;
    options_.report(message_at(place, is_last ? "more warnings like the one before are not shown"
                                              : std::string_view(message)));
  }

  /// Does what makes a part of the scene. One that fails is left out, which a warning says, and
  /// false is returned; with --strict the Error goes on.
  template <class Action>
  bool attempt(const std::string& what, std::string_view instead, const Action& action) {
    try {
      action();
      return true;
    } catch (const Error& error) {
      if (options_.strict) throw;
      const std::string message = error.what();
      int& family = families_["part"];
      if (family > most_of_a_family || !warned_.insert("part " + message).second) return false;
      options_.report(
          ++family > most_of_a_family
              ? "more parts of the scene that cannot be read are not listed"
              : one_line(fmt::format("{}; {} {}", message, with_short_names(what), instead)));
      return false;
    }
  }

  /// Says what was chosen where the file leaves it open.
  void note(const Place& place, const std::string& message) const {
    if (options_.warn) options_.warn(message_at(place, message));
  }

  const LoadOptions& options() const { return options_; }

 private:
  static constexpr int most_of_a_family = 10;

  const LoadOptions& options_;
  std::set<std::string> warned_;
  std::map<std::string, int> families_;  ///< how many warnings, by the first word of their kinds
};

}  // namespace pt::pbrt
