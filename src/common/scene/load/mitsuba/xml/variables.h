// $name in a scene's attributes.
#pragma once

#include <map>
#include <set>
#include <string>

namespace pt::mitsuba {

/// The variables of a scene: those of the command line, then those of <default>.
class Variables {
 public:
  explicit Variables(const std::map<std::string, std::string>& definitions)
      : values_(definitions), definitions_(definitions) {}

  /// A <default>: it counts where nothing else defines the name.
  void add_default(const std::string& name, const std::string& value) {
    values_.try_emplace(name, value);
    used_.insert(name);
  }

  /// `text` with the value of the longest name that fits in the place of every $name. Throws Error
  /// (without a place) for a name that is not defined.
  std::string substitute(const std::string& text);

  /// Throws Error naming the definitions that the scene neither used nor declared.
  void check_used(const std::string& file) const;

 private:
  std::map<std::string, std::string> values_, definitions_;
  std::set<std::string> used_;
};

}  // namespace pt::mitsuba
