// Directives that change the graphics state.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/scene/load/pbrt/description/interpreter.h"
#include "common/scene/load/pbrt/description/transforms.h"
#include "common/scene/load/pbrt/syntax/read_parameters.h"

namespace pt::pbrt {
namespace {

constexpr std::array<std::string_view, 5> attribute_targets = {"shape", "light", "material",
                                                               "medium", "texture"};

constexpr std::size_t most_attributes = 100;  // each block may have its own list

std::optional<Affine> read_map(const Interpreter::Directive& directive) {
  TokenStream& tokens = directive.tokens;
  const std::string& name = directive.name;
  if (name == "Translate") return read_translate(tokens);
  if (name == "Scale") return read_scale(tokens);
  if (name == "Rotate") return read_rotate(tokens);
  if (name == "LookAt") return read_look_at(tokens);
  return name == "Identity" ? Affine() : read_matrix(tokens);
}

/// Throws Error for what is no map.
void check_map(const std::optional<Affine>& map, const Interpreter::Directive& directive) {
  if (map) return;
  const std::string_view expected =
      directive.name == "Rotate"   ? "an axis that is longer than 0"
      : directive.name == "LookAt" ? "two different points and an up direction across their line"
                                   : "0 0 0 1 in the last row of the matrix";
  fail(directive.place, fmt::format("{}: expected {}", directive.name, expected));
}

void check_finite(const Affine& map, const Place& place) {
  for (const Vec4& row : map.row) {
    for (int i = 0; i < 4; ++i) {
      if (!std::isfinite(row[i])) fail(place, "a transformation with numbers that are not finite");
    }
  }
}

}  // namespace

void Interpreter::transform(const Directive& directive) {
  const std::optional<Affine> map = read_map(directive);
  if (!state_.moves_start) return;
  const bool replaces = directive.name == "Identity" || directive.name == "Transform";
  reporter_.attempt(directive.name, "is ignored", [&] {
    check_map(map, directive);
    const Affine moved = replaces ? *map : state_.to_world * *map;
    check_finite(moved, directive.place);
    state_.to_world = moved;
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
    return reporter_.warn_once("coordinates " + name, directive.place,
                               fmt::format("there is no coordinate system '{}': the "
                                           "transformation stays as it is",
                                           name));
  }
  state_.to_world = found->second;
}

void Interpreter::attribute(const Directive& directive) {
  const std::string target = name_after(directive);
  if (std::ranges::find(attribute_targets, target) == attribute_targets.end()) {
    report_bad(directive, fmt::format("Attribute '{}'; expected shape, light, material, medium or "
                                      "texture",
                                      target));
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
      fail(own.place,
           fmt::format("more than {} parameters by Attribute '{}'", most_attributes, target));
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
      reporter_.warn_once("object " + name, directive.place,
                          fmt::format("an object '{}' was defined before: instances that follow "
                                      "are of the new one",
                                      name));
    }
  }
  stack_.emplace_back(state_, object);
}

void Interpreter::pop(const Directive& directive) {
  const bool object = directive.name == "ObjectEnd";
  if (stack_.empty() || stack_.back().second != object) {
    fail(directive.place, fmt::format("{} without its Begin", directive.name));
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
  state_.moves_start = true;
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
    for (int i = 0; i < 2; ++i) directive.tokens.expect_number("a time");
    return;
  }
  const std::string which =
      directive.tokens.expect(TokenKind::word, "All, StartTime or EndTime").text;
  if (which != "All" && which != "StartTime" && which != "EndTime") {
    fail(directive.place,
         fmt::format("ActiveTransform {}; expected All, StartTime or EndTime", which));
  }
  state_.moves_start = which != "EndTime";
  if (which != "All") {
    reporter_.warn_once("motion", directive.place,
                        "motion is not supported: everything stays where it begins");
  }
}

}  // namespace pt::pbrt
