// Directives that change the graphics state.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/math/transform.h"
#include "common/scene/load/pbrt/syntax/interpreter.h"
#include "common/scene/load/pbrt/syntax/parameters.h"
#include "common/scene/load/pbrt/syntax/tokens.h"

namespace pt::pbrt {
namespace {

using DVec3 = glm::dvec3;

DVec3 read_vector(TokenStream& tokens) {
  DVec3 v;
  for (int i = 0; i < 3; ++i) v[i] = tokens.expect_number("a number");
  return v;
}

// Each reads what follows its directive. None: the numbers are no map.
Affine read_translate(TokenStream& tokens) { return translate(Vec3(read_vector(tokens))); }
Affine read_scale(TokenStream& tokens) { return scale(Vec3(read_vector(tokens))); }

std::optional<Affine> read_rotate(TokenStream& tokens) {
  const auto degrees = static_cast<float>(tokens.expect_number("an angle in degrees"));
  const DVec3 axis = read_vector(tokens);
  const double length = glm::length(axis);
  if (!(length > 0)) return std::nullopt;
  return rotate(Vec3(axis / length), degrees);
}

/// From the world to a camera that looks along +z, with +x to its right and +y up: pbrt's space is
/// left-handed.
std::optional<Affine> read_look_at(TokenStream& tokens, std::optional<LookAt>& look) {
  const DVec3 eye = read_vector(tokens), target = read_vector(tokens), up = read_vector(tokens);
  const DVec3 z = glm::normalize(target - eye);
  const DVec3 side = glm::cross(glm::normalize(up), z);
  if (!(glm::length(side) > 1e-9)) return std::nullopt;
  const DVec3 x = glm::normalize(side), y = glm::cross(z, x);
  look = {Vec3(eye), Vec3(target), Vec3(up)};
  const auto row = [&](const DVec3& axis) { return Vec4(Vec3(axis), -glm::dot(axis, eye)); };
  return Affine{{row(x), row(y), row(z)}};
}

/// 16 numbers, column by column, of which the last row is 0 0 0 1.
std::optional<Affine> read_matrix(TokenStream& tokens) {
  tokens.expect(TokenKind::open, "[ and 16 numbers");
  Affine map;
  bool is_affine = true;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      const double value = tokens.expect_number("a number of a matrix of 16");
      if (row < 3) map.row[row][column] = static_cast<float>(value);
      if (row == 3) is_affine = is_affine && std::abs(value - (column == 3 ? 1 : 0)) <= 1e-5;
    }
  }
  tokens.expect(TokenKind::close, "] after 16 numbers");
  return is_affine ? std::optional(map) : std::nullopt;
}

constexpr std::array<std::string_view, 5> attribute_targets = {"shape", "light", "material",
                                                               "medium", "texture"};

constexpr std::size_t most_attributes = 100;  // each block may have its own list

/// `look`: what the last LookAt has written.
std::optional<Affine> read_map(const Interpreter::Directive& directive,
                               std::optional<LookAt>& look) {
  TokenStream& tokens = directive.tokens;
  const std::string& name = directive.name;
  if (name == "Translate") return read_translate(tokens);
  if (name == "Scale") return read_scale(tokens);
  if (name == "Rotate") return read_rotate(tokens);
  if (name == "LookAt") return read_look_at(tokens, look);
  return name == "Identity" ? Affine() : read_matrix(tokens);
}

/// Throws Error for what is no map.
void check_map(const std::optional<Affine>& map, const Interpreter::Directive& directive) {
  if (map) return;
  const std::string_view expected =
      directive.name == "Rotate"   ? "an axis that is longer than 0"
      : directive.name == "LookAt" ? "two different points and an up direction across their line"
                                   : "0 0 0 1 in the last row of the matrix";
  fail(directive.place, "{}: expected {}", directive.name, expected);
}

void check_finite(const Affine& map, const FileLocation& place) {
  for (const Vec4& row : map.row) {
    for (int i = 0; i < 4; ++i) {
      if (!std::isfinite(row[i])) fail(place, "a transformation with numbers that are not finite");
    }
  }
}

}  // namespace

void Interpreter::transform(const Directive& directive) {
  std::optional<LookAt> look = state_.look_at;
  const std::optional<Affine> map = read_map(directive, look);
  if (state_.moves_begin) state_.look_at = look;
  const bool replaces = directive.name == "Identity" || directive.name == "Transform";
  reporter_.attempt(directive.name, "is ignored", [&] {
    check_map(map, directive);
    const auto moved = [&](const Affine& before) {
      const Affine after = replaces ? *map : before * *map;
      check_finite(after, directive.place);
      return after;
    };
    const auto& [begin, end] = state_.to_world;
    state_.to_world = {state_.moves_begin ? moved(begin) : begin,
                       state_.moves_end ? moved(end) : end};
  });
}

void Interpreter::coordinate_system(const Directive& directive) {
  const std::string name = name_after(directive);
  if (directive.name == "CoordinateSystem") {
    coordinate_systems_[name] = state_.to_world;
    return;
  }
  const auto found = coordinate_systems_.find(name);
  if (found == coordinate_systems_.end()) {
    return reporter_.warn_once(
        "coordinates " + name, directive.place,
        "there is no coordinate system '{}': the transformation stays as it is", name);
  }
  state_.to_world = found->second;
}

void Interpreter::attribute(const Directive& directive) {
  const std::string target = name_after(directive);
  if (std::ranges::find(attribute_targets, target) == attribute_targets.end()) {
    report_bad(
        directive,
        fmt::format("Attribute '{}'; expected shape, light, material, medium or texture", target));
    read_parameters(directive.tokens, state_.space, reporter_);
    return;
  }
  auto all = std::make_shared<SharedParameters>();
  std::shared_ptr<const SharedParameters>& before = state_.attributes[target];
  if (before) *all = *before;
  for (Parameter& own : read_parameters(directive.tokens, state_.space, reporter_)) {
    // The last of a name holds.
    std::erase_if(*all, [&](const auto& other) { return other->name == own.name; });
    if (all->size() == most_attributes) {
      fail(own.place, "more than {} parameters by Attribute '{}'", most_attributes, target);
    }
    all->push_back(std::make_shared<const Parameter>(std::move(own)));
  }
  before = std::move(all);
}

void Interpreter::push(const Directive& directive) {
  const bool object = directive.name == "ObjectBegin";
  if (object) {
    const std::string name = name_after(directive);
    if (group_ != 0) fail(directive.place, "ObjectBegin inside of another object");
    group_ = ++groups_;
    if (!description_.groups.insert_or_assign(name, group_).second) {
      reporter_.warn_once(
          "object " + name, directive.place,
          "an object '{}' was defined before: instances that follow are of the new one", name);
    }
  }
  stack_.emplace_back(state_, object);
}

void Interpreter::pop(const Directive& directive) {
  const bool object = directive.name == "ObjectEnd";
  if (stack_.empty() || stack_.back().second != object) {
    fail(directive.place, "{} without its Begin", directive.name);
  }
  state_ = std::move(stack_.back().first);
  stack_.pop_back();
  if (object) group_ = 0;
}

/// pbrt's camera is where the world's origin has been brought.
void Interpreter::world_begin(const Directive& directive) {
  if (directive.name == "WorldEnd") {
    if (description_.is_earlier) return;
    return reporter_.note(directive.place, "WorldEnd is of pbrt's earlier versions: ignored");
  }
  in_world_ = true;
  state_.to_world = {};
  state_.moves_begin = state_.moves_end = true;
  coordinate_systems_["world"] = {};
}

void Interpreter::color_space(const Directive& directive) {
  const std::string name = name_after(directive);
  const std::optional<ColorSpace> space = color_space_named(name);
  if (!space) {
    return report_bad(directive,
                      fmt::format("ColorSpace '{}'; expected {}", name, color_space_names));
  }
  state_.space = *space;
}

void Interpreter::reverse(const Directive&) { state_.reverse = !state_.reverse; }

void Interpreter::animation(const Directive& directive) {
  if (directive.name == "TransformTimes") {
    const auto begin = static_cast<float>(directive.tokens.expect_number("a time"));
    const auto end = static_cast<float>(directive.tokens.expect_number("a time"));
    reporter_.attempt("TransformTimes", "is ignored", [&] {
      if (!(end > begin))
        fail(directive.place, "TransformTimes {} {}; expected the end after the beginning", begin,
             end);
      description_.begin_s = begin, description_.end_s = end;
    });
    return;
  }
  const std::string which =
      directive.tokens.expect(TokenKind::word, "All, StartTime or EndTime").text;
  if (which != "All" && which != "StartTime" && which != "EndTime") {
    fail(directive.place, "ActiveTransform {}; expected All, StartTime or EndTime", which);
  }
  state_.moves_begin = which != "EndTime", state_.moves_end = which != "StartTime";
}

}  // namespace pt::pbrt
