#include "common/scene/load/mitsuba/xml/object.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "common/scene/load/files/text.h"
#include "common/scene/load/mitsuba/xml/elements.h"

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
  if (!number) fail(*at, "{} is '{}'; expected a number", name, text);
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
    fail(*find(name), "{} is {}; expected an integer", name, *value);
  }
  return static_cast<int>(*value);
}

bool Object::boolean(std::string_view name, bool fallback) const {
  const Element* at = find(name);
  if (!at) return fallback;
  const std::string& text = at->required("value");
  const std::string lower = lower_case(text);
  if (lower != "true" && lower != "false") {
    fail(*at, "{} is '{}'; expected true or false", name, text);
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
    fail(*at, "{} is a <{}>; expected a <transform>", name, at->tag);
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

namespace {

// Elements to objects: ids, references, cycles.

bool is_object(const Element& element) {
  static const std::set<std::string_view> tags = {
      "scene", "integrator", "sensor",  "camera",    "sampler", "film",       "rfilter", "bsdf",
      "shape", "texture",    "emitter", "luminaire", "medium",  "subsurface", "volume",  "phase"};
  return tags.count(element.tag) || (element.tag == "spectrum" && element.attribute("type"));
}

bool is_property(const Element& element) {
  static const std::set<std::string_view> tags = {"float",     "integer", "boolean",  "string",
                                                  "rgb",       "srgb",    "spectrum", "blackbody",
                                                  "transform", "vector",  "point",    "animation"};
  return tags.count(element.tag);
}

// So many objects inside each other, through references as well.
constexpr int max_object_depth = 128;

constexpr int open = -1;  ///< in place of a height

/// How many objects are inside of each other in `object`; `depth` is how many it is inside of.
int height_of(const Object& object, std::map<const Object*, int>& heights, int depth) {
  const auto [entry, is_new] = heights.try_emplace(&object, open);
  int height = is_new ? 0 : entry->second;
  if (height == open) {
    fail(object.element(), "this <{}> contains itself through references", object.tag());
  }
  if (depth + height > max_object_depth) {
    fail(object.element(), "objects are nested deeper than {}", max_object_depth);
  }
  if (!is_new) return height;
  for (const Object::Nested& nested : object.nested()) {
    height = std::max(height, 1 + height_of(*nested.object, heights, depth + 1));
  }
  return entry->second = height;
}

}  // namespace

ObjectGraph::ObjectGraph(const Element& root, const LoadOptions& options)
    : search_path_(root.file->parent_path()) {
  add(root, options);
  resolve_references();
  check_cycles();
}

Object* ObjectGraph::add(const Element& element, const LoadOptions& options) {
  Object* object = objects_.emplace_back(std::make_unique<Object>(element)).get();
  if (const std::string* id = element.attribute("id")) {
    if (!by_id_.try_emplace(*id, object).second) {
      fail(element, "the id '{}' is used twice, first at {}", *id, by_id_[*id]->place());
    }
  }
  for (const Element& child : element.children) add_child(*object, child, options);
  return object;
}

void ObjectGraph::add_child(Object& object, const Element& child, const LoadOptions& options) {
  const std::string* name = child.attribute("name");
  if (child.tag == "ref") {
    object.nested().push_back({name ? snake_case(*name) : "", child.required("id"), &child});
  } else if (is_object(child)) {
    const Object* nested = add(child, options);
    object.nested().push_back({name ? snake_case(*name) : "", "", &child, nested});
  } else if (child.tag == "null") {
    return;  // 0.6: nothing under a name
  } else if (child.tag == "alias") {
    aliases_.push_back(&child);
  } else if (child.tag == "path") {
    if (search_path_.add(child)) return;
    const std::string& folder = child.required("value");
    report_once("path " + folder, child,
                fmt::format("<path>: there is no folder '{}': it is ignored", folder), options);
  } else if (is_property(child)) {
    if (child.tag == "animation") {
      report_once("animation", child, "<animation> is not supported: its first <transform> is used",
                  options);
    }
    if (object.add_property(child)) return;
    report_once("twice " + child.required("name") + " " + object.tag(), child,
                fmt::format("'{}' is given twice in the same <{}>: this one is used",
                            child.required("name"), object.tag()),
                options);
  } else {
    report_once("unknown " + child.tag, child,
                fmt::format("<{}> in <{}> is not known: it is ignored", child.tag, object.tag()),
                options);
  }
}

void ObjectGraph::report_once(const std::string& kind, const Element& at,
                              const std::string& message, const LoadOptions& options) {
  if (reported_.size() < max_reports && reported_.insert(kind).second) {
    options.report(at.place() + ": " + shortened(message));
  }
}

void ObjectGraph::resolve_references() {
  for (const Element* alias : aliases_) {
    const auto object = by_id_.find(alias->required("id"));
    if (object == by_id_.end()) {
      fail(*alias, "there is no object with the id '{}'", alias->required("id"));
    }
    if (!by_id_.try_emplace(alias->required("as"), object->second).second) {
      fail(*alias, "the id '{}' is used twice", alias->required("as"));
    }
  }
  for (const auto& object : objects_) {
    for (Object::Nested& nested : object->nested()) {
      if (nested.object) continue;
      const auto found = by_id_.find(nested.reference);
      if (found == by_id_.end()) {
        fail(*nested.element, "there is no object with the id '{}'", nested.reference);
      }
      nested.object = found->second;
    }
  }
}

void ObjectGraph::check_cycles() const {
  std::map<const Object*, int> heights;
  height_of(scene(), heights, 0);
}

}  // namespace pt::mitsuba
