// The parameters of a directive: "type name" [values].
#pragma once

#include <initializer_list>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "common/math/vec.h"
#include "common/scene/load/pbrt/syntax/color_space.h"
#include "common/scene/load/pbrt/syntax/reporter.h"

namespace pt::pbrt {

struct Parameter {
  std::string type, name;
  Place place;
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
  Parameters(const Place& place, std::string what, std::vector<Parameter> own,
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

  const Place& place() const { return place_; }
  const std::string& what() const { return what_; }

 private:
  Place place_;
  std::string what_;
  std::vector<Parameter> own_;
  std::shared_ptr<const SharedParameters> inherited_;  ///< null: none
  mutable std::set<std::string, std::less<>> asked_;
};

}  // namespace pt::pbrt
