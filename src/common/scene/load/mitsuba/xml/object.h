// A plugin of a scene (shape, bsdf, emitter, ...): its properties by name, and the objects in it.
//
// Names are in Mitsuba 3's style; the camelCase of 0.x becomes it: toWorld is to_world, intIOR is
// int_ior. An object notes which properties were asked for: the rest is reported as unused.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/math/transform.h"
#include "common/scene/load/mitsuba/xml/elements.h"

namespace pt::mitsuba {

/// camelCase to snake_case.
std::string snake_case(std::string_view name);

class Object {
 public:
  /// An object inside of this one, or one to which it refers.
  struct Nested {
    std::string name;       ///< snake_case; may be empty
    std::string reference;  ///< <ref>: the id; else empty
    const Element* element = nullptr;
    const Object* object = nullptr;
    mutable bool used = false;
  };
  struct Property {
    const Element* element = nullptr;
    mutable bool used = false;
  };

  explicit Object(const Element& element);

  const Element& element() const { return *element_; }
  const std::string& tag() const { return element_->tag; }
  std::string type() const;  ///< empty where the element says none
  std::string id() const;    ///< likewise
  std::string place() const { return element_->place(); }

  // Properties. All throw Error for a value that is not of the kind asked for.
  const Element* find(std::string_view name) const;  ///< nullptr: none
  std::optional<double> number(std::string_view name) const;
  float number(std::string_view name, float fallback) const;
  std::optional<int> integer(std::string_view name) const;
  bool boolean(std::string_view name, bool fallback) const;
  std::string text(std::string_view name, const std::string& fallback) const;
  Vec3 vector(std::string_view name, const Vec3& fallback) const;
  /// Invertible; the identity where absent; of an <animation> its first one.
  Affine transform(std::string_view name) const;
  /// The <transform> itself, which may be singular.
  const Element* find_transform(std::string_view name) const;
  void ignore(std::initializer_list<std::string_view> names) const;
  void ignore_all() const;  ///< properties and objects inside: nothing is reported as unused

  // Objects inside.
  const Object* child(std::string_view tag) const;         ///< the first of this tag, or nullptr
  const Object* child_named(std::string_view name) const;  ///< the last of this name
  std::vector<const Object*> children(std::string_view tag) const;

  bool touched() const { return touched_; }  ///< has been asked for anything
  const std::map<std::string, Property, std::less<>>& properties() const { return properties_; }
  std::vector<Nested>& nested() { return nested_; }
  const std::vector<Nested>& nested() const { return nested_; }
  /// False where it replaces one of the same name.
  bool add_property(const Element& element);

 private:
  const Element* element_;
  std::map<std::string, Property, std::less<>> properties_;
  std::vector<Nested> nested_;
  mutable bool touched_ = false;
};

/// All objects of a scene. `root` must outlive it.
class ObjectGraph {
 public:
  /// Throws Error for a reference to an id that does not exist, an id that is used twice and
  /// objects that contain themselves.
  ObjectGraph(const Element& root, const LoadOptions& options);

  const Object& scene() const { return *objects_.front(); }
  const std::vector<std::unique_ptr<Object>>& objects() const { return objects_; }
  const SearchPath& search_path() const { return search_path_; }

 private:
  Object* add(const Element& element, const LoadOptions& options);
  void add_child(Object& object, const Element& child, const LoadOptions& options);
  void report_once(const std::string& kind, const Element& at, const std::string& message,
                   const LoadOptions& options);
  void resolve_references();
  void check_cycles() const;

  std::vector<std::unique_ptr<Object>> objects_;
  std::map<std::string, const Object*> by_id_;
  std::vector<const Element*> aliases_;
  std::set<std::string> reported_;
  SearchPath search_path_;
};

}  // namespace pt::mitsuba
