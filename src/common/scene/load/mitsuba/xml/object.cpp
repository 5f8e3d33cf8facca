#include "common/scene/load/mitsuba/xml/object.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "common/scene/load/mitsuba/xml/transforms.h"
#include "common/scene/load/mitsuba/xml/values.h"

namespace pt::mitsuba {

std::string snake_case(std::string_view name) {
  std::string result;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto c = static_cast<unsigned char>(name[i]);
    const bool starts_word =
        i > 0 && std::isupper(c) && !std::isupper(static_cast<unsigned char>(name[i - 1]));
    if (starts_word && name[i - 1] != '_') result += '_';
    result += static_cast<char>(std::tolower(c));
  }
  return result;
}

Object::Object(const Element& element) : element_(&element) {}

std::string Object::type() const {
  const std::string* type = element_->attribute("type");
  return type ? *type : std::string();
}

std::string Object::id() const {
  const std::string* id = element_->attribute("id");
  return id ? *id : std::string();
}

bool Object::add_property(const Element& element) {
  const std::string name = snake_case(element.required("name"));
  return properties_.insert_or_assign(name, Property{&element}).second;
}

const Element* Object::find(std::string_view name) const {
  touched_ = true;
  const auto property = properties_.find(name);
  if (property == properties_.end()) return nullptr;
  property->second.used = true;
  return property->second.element;
}

std::optional<double> Object::number(std::string_view name) const {
  const Element* at = find(name);
  if (!at) return std::nullopt;
  const std::string& text = at->required("value");
  const std::optional<double> number = parse_number(text);
  if (!number) fail(*at, fmt::format("{} is '{}'; expected a number", name, text));
  return number;
}

float Object::number(std::string_view name, float fallback) const {
  const std::optional<double> value = number(name);
  return value ? static_cast<float>(*value) : fallback;
}

std::optional<int> Object::integer(std::string_view name) const {
  const std::optional<double> value = number(name);
  if (!value) return std::nullopt;
  if (*value != std::trunc(*value) || !(std::abs(*value) <= 2147483647.0)) {
    fail(*find(name), fmt::format("{} is {}; expected an integer", name, *value));
  }
  return static_cast<int>(*value);
}

bool Object::boolean(std::string_view name, bool fallback) const {
  const Element* at = find(name);
  if (!at) return fallback;
  const std::string& text = at->required("value");
  std::string lower = text;
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  if (lower != "true" && lower != "false") {
    fail(*at, fmt::format("{} is '{}'; expected true or false", name, text));
  }
  return lower == "true";
}

std::string Object::text(std::string_view name, const std::string& fallback) const {
  const Element* at = find(name);
  return at ? at->required("value") : fallback;
}

Vec3 Object::vector(std::string_view name, const Vec3& fallback) const {
  const Element* at = find(name);
  return at ? vector_attributes(*at, 0.0) : fallback;
}

const Element* Object::find_transform(std::string_view name) const {
  const Element* at = find(name);
  if (at && at->tag == "animation" && !at->children.empty()) at = &at->children.front();
  if (at && at->tag != "transform")
    fail(*at, fmt::format("{} is a <{}>; expected a <transform>", name, at->tag));
  return at;
}

Affine Object::transform(std::string_view name) const {
  const Element* at = find_transform(name);
  return at ? read_invertible_transform(*at) : Affine();
}

void Object::ignore(std::initializer_list<std::string_view> names) const {
  for (const std::string_view name : names) find(name);
}

void Object::ignore_all() const {
  for (const auto& [name, property] : properties_) property.used = true;
  for (const Nested& nested : nested_) nested.used = true;
}

const Object* Object::child(std::string_view tag) const {
  const std::vector<const Object*> all = children(tag);
  return all.empty() ? nullptr : all.front();
}

const Object* Object::child_named(std::string_view name) const {
  touched_ = true;
  const auto nested = std::find_if(nested_.rbegin(), nested_.rend(),
                                   [&](const Nested& one) { return one.name == name; });
  if (nested == nested_.rend()) return nullptr;
  nested->used = true;
  return nested->object;
}

std::vector<const Object*> Object::children(std::string_view tag) const {
  touched_ = true;
  std::vector<const Object*> result;
  for (const Nested& nested : nested_) {
    if (nested.object->tag() != tag) continue;
    nested.used = true;
    result.push_back(nested.object);
  }
  return result;
}

}  // namespace pt::mitsuba
