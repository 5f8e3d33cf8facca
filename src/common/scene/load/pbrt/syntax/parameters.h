// The parameters of a directive, "type name" [values], and what the user is told about them.
#pragma once

#include <fmt/format.h>

#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/math/vec.h"
#include "common/scene/load/files/load_options.h"
#include "common/scene/load/pbrt/syntax/tokens.h"

namespace pt::pbrt {

enum class ColorSpace { srgb, dci_p3, rec2020, aces };

inline constexpr const char* color_space_names = "srgb, dci-p3, rec2020 or aces2065-1";

/// None for a name that pbrt does not know.
std::optional<ColorSpace> color_space_named(std::string_view name);

/// Linear sRGB to CIE XYZ, white with Y = 1.
glm::dmat3 xyz_from_srgb();

/// Linear colour of the space as linear sRGB; components outside of its gamut become 0.
Color to_srgb(const Color& color, ColorSpace space);

/// CIE xyY with Y = 1 as linear sRGB, likewise.
Color srgb_of_chromaticity(double x, double y);

// Spectra that pbrt knows by name.

/// "stdillum-D65" and the like, as linear sRGB of luminance 1.
std::optional<Color> named_illuminant(std::string_view name);

/// "metal-Cu-eta", "metal-Cu-k" and the like, as linear sRGB in daylight.
std::optional<Color> named_metal(std::string_view name);

/// "glass-BK7" and the like: the index of refraction at 587.6 nm.
std::optional<float> named_glass(std::string_view name);

// The parameters of a directive, "type name" [values], and what the user is told about them.

class Reporter {
 public:
  /// `load_options` outlive it.
  explicit Reporter(const LoadOptions& load_options) : options_(load_options) {}

  /// Reports what is replaced or ignored, once for each `kind`. Of kinds that begin with the same
  /// word there are at most ten: files may have any number of names.
  void warn_once(const std::string& kind, const FileLocation& place, const std::string& message) {
    int& family = families_[kind.substr(0, kind.find(' '))];
    if (family > most_of_a_family || !warned_.insert(kind).second) return;
    const bool is_last = ++family > most_of_a_family;
    options_.report(message_at(place, is_last ? "more warnings like the one before are not shown"
                                              : std::string_view(message)));
  }

  /// The same of a message with values in it.
  template <class First, class... Rest>
  void warn_once(const std::string& kind, const FileLocation& place,
                 fmt::format_string<First, Rest...> text, First&& first, Rest&&... rest) {
    warn_once(kind, place,
              fmt::format(text, std::forward<First>(first), std::forward<Rest>(rest)...));
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
  void note(const FileLocation& place, const std::string& message) const {
    if (options_.warn) options_.warn(message_at(place, message));
  }

  const LoadOptions& options() const { return options_; }

 private:
  static constexpr int most_of_a_family = 10;

  const LoadOptions& options_;
  std::set<std::string> warned_;
  std::map<std::string, int> families_;  ///< how many warnings, by the first word of their kinds
};

// The parameters of a directive: "type name" [values].

struct Parameter {
  std::string type, name;
  FileLocation place;
  ColorSpace space = ColorSpace::srgb;  ///< of colours in it
  std::vector<double> numbers;          ///< of all types but string, texture and bool
  std::vector<std::string> strings;     ///< of those, and of a spectrum that has a name
};

/// Those that Attribute gives to all that follow. Shared: blocks and shapes may be many.
using SharedParameters = std::vector<std::shared_ptr<const Parameter>>;

/// Knows which of its parameters were asked for, so that the others can be reported.
class Parameters {
 public:
  /// `what` names the directive in messages. Where both have a parameter, that of `own` holds;
  /// those of `inherited` may be of no use.
  Parameters(const FileLocation& place, std::string what, std::vector<Parameter> own,
             std::shared_ptr<const SharedParameters> inherited = {});

  /// The parameter of one of these types, or null. Throws Error for one of another type.
  const Parameter* find(std::string_view name, std::initializer_list<std::string_view> types) const;
  /// The same of any type.
  const Parameter* find(std::string_view name) const;
  bool has(std::string_view name, std::string_view type) const;

  // One value. Throw Error for more, for none, and for another type.
  float number(std::string_view name, float fallback) const;
  int integer(std::string_view name, int fallback) const;
  bool boolean(std::string_view name, bool fallback) const;
  std::string text(std::string_view name, std::string_view fallback) const;
  Vec3 point(std::string_view name, const Vec3& fallback) const;

  // All of its values; empty where it is absent.
  std::vector<float> numbers(std::string_view name) const;
  std::vector<int> integers(std::string_view name) const;
  std::vector<std::string> texts(std::string_view name) const;
  std::vector<Vec3> points(std::string_view name) const;
  std::vector<Vec2> points2(std::string_view name) const;

  /// These change nothing that we do.
  void ignore(std::initializer_list<std::string_view> names) const;
  void ignore_all() const;

  /// Warns of each parameter that nothing asked for.
  void report_unused(Reporter& reporter) const;

  const FileLocation& place() const { return place_; }
  const std::string& what() const { return what_; }

 private:
  FileLocation place_;
  std::string what_;
  std::vector<Parameter> own_;
  std::shared_ptr<const SharedParameters> inherited_;  ///< null: none
  mutable std::set<std::string, std::less<>> asked_;
};

// Reading the parameters of a directive.

/// As many as follow; colours are those of `space`. Throws Error for bad syntax. Of two of the
/// same name the last holds, which is reported.
std::vector<Parameter> read_parameters(TokenStream& tokens, ColorSpace space, Reporter& reporter);

}  // namespace pt::pbrt
