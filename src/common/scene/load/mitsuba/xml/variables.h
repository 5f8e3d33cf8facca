// $name in a scene's attributes.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>

namespace pt::mitsuba {

/// The variables of a scene: those of the command line, then those of <default>.
class Variables {
 public:
  explicit Variables(const std::map<std::string, std::string>& definitions)
      : values_(definitions.begin(), definitions.end()), definitions_(definitions) {}

  /// A <default>: it counts where nothing else defines the name.
  void add_default(const std::string& name, const std::string& value) {
    values_.try_emplace(name, value);
    used_.insert(name);
  }

  /// `text` with the value of the longest name that fits in the place of every $name, and \$ for a
  /// dollar. Throws Error (without a place) for a name that is not defined, and where all values
  /// together become too long.
  std::string substitute(const std::string& text);

  /// Throws Error naming the definitions that the scene neither used nor declared.
  void check_used(const std::string& file) const;

 private:
  using Values = std::map<std::string, std::string, std::less<>>;

  Values::const_iterator longest_prefix_of(std::string_view name) const;

  Values values_;
  std::map<std::string, std::string> definitions_;
  std::size_t expanded_ = 0;  ///< bytes of values put in so far
  std::set<std::string> used_;
};

}  // namespace pt::mitsuba
