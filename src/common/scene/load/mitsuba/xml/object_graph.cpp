// Elements to objects: ids, references, cycles.
#include <fmt/format.h>

#include <set>

#include "common/scene/load/mitsuba/xml/object.h"

namespace pt::mitsuba {
namespace {

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

enum class Visit { none, open, done };

void visit_object(const Object& object, std::map<const Object*, Visit>& state, int depth) {
  Visit& here = state[&object];
  if (here == Visit::done) return;
  if (here == Visit::open) {
    fail(object.element(),
         fmt::format("this <{}> contains itself through references", object.tag()));
  }
  if (depth > max_object_depth) {
    fail(object.element(), fmt::format("objects are nested deeper than {}", max_object_depth));
  }
  here = Visit::open;
  for (const Object::Nested& nested : object.nested()) {
    visit_object(*nested.object, state, depth + 1);
  }
  state[&object] = Visit::done;
}

}  // namespace

ObjectGraph::ObjectGraph(const Element& root, const LoadOptions& options) {
  add(root, options);
  resolve_references();
  check_cycles();
}

Object* ObjectGraph::add(const Element& element, const LoadOptions& options) {
  Object* object = objects_.emplace_back(std::make_unique<Object>(element)).get();
  if (const std::string* id = element.attribute("id")) {
    if (!by_id_.try_emplace(*id, object).second) {
      fail(element,
           fmt::format("the id '{}' is used twice, first at {}", *id, by_id_[*id]->place()));
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
  } else if (child.tag == "alias") {
    aliases_.push_back(&child);
  } else if (child.tag == "path") {
    search_paths_.push_back(child.required("value"));
  } else if (is_property(child)) {
    if (!object.add_property(child)) {
      options.report(fmt::format("{}: '{}' is given twice in the same <{}>: this one is used",
                                 child.place(), child.required("name"), object.tag()));
    }
  } else {
    options.report(fmt::format("{}: <{}> in <{}> is not known: it is ignored", child.place(),
                               child.tag, object.tag()));
  }
}

void ObjectGraph::resolve_references() {
  for (const Element* alias : aliases_) {
    const auto object = by_id_.find(alias->required("id"));
    if (object == by_id_.end()) {
      fail(*alias, fmt::format("there is no object with the id '{}'", alias->required("id")));
    }
    if (!by_id_.try_emplace(alias->required("as"), object->second).second) {
      fail(*alias, fmt::format("the id '{}' is used twice", alias->required("as")));
    }
  }
  for (const auto& object : objects_) {
    for (Object::Nested& nested : object->nested()) {
      if (nested.object) continue;
      const auto found = by_id_.find(nested.reference);
      if (found == by_id_.end()) {
        fail(*nested.element, fmt::format("there is no object with the id '{}'", nested.reference));
      }
      nested.object = found->second;
    }
  }
}

void ObjectGraph::check_cycles() const {
  std::map<const Object*, Visit> state;
  visit_object(scene(), state, 0);
}

}  // namespace pt::mitsuba
