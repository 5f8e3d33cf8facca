#include "common/scene/load/mitsuba/xml/context.h"

#include <fmt/format.h>

#include "common/scene/load/files/default_lighting.h"
#include "common/scene/load/mitsuba/xml/elements.h"

namespace pt::mitsuba {
namespace {

// A scene without a version is read as one of today.
bool is_modern(const ObjectGraph& graph) {
  const std::string* version = graph.scene().element().attribute("version");
  if (!version) return true;
  const std::optional<double> major = parse_number(version->substr(0, version->find('.')));
  if (!major) {
    fail(graph.scene().element(), "version '{}' of the scene; expected one like 3.0.0", *version);
  }
  return *major >= 2;
}

}  // namespace

Context::Context(SceneData& scene_data, const LoadOptions& load_options, const ObjectGraph& graph)
    : scene(scene_data),
      textures(scene_data.textures, scene_data.texels),
      colors(scene_data, load_options),
      modern(is_modern(graph)),
      options_(load_options),
      graph_(graph) {}

void Context::report(const Element& at, const std::string& message) const {
  options_.report(at.place() + ": " + shortened(message));
}

void Context::warn_once(const std::string& kind, const Element& at, const std::string& message) {
  if (warned_.size() < max_reports && warned_.insert(kind).second) report(at, message);
}

void Context::warn_unreadable(const Element& at, const std::string& why,
                              const std::string& instead) {
  warn_once("unreadable " + why, at, why + ": " + instead);
}

void Context::leave_out(const Object& shape, const Element& at, const std::string& why) {
  shape.ignore_all();
  warn_once("left out " + why, at, why + ": the shape is left out");
  if (why_no_shape_.empty()) why_no_shape_ = at.place() + ": " + shortened(why);
}

void Context::expect_some_shape() const {
  const bool none = scene.spheres.empty() && scene.quads.empty() && scene.meshes.empty();
  if (none && !why_no_shape_.empty()) throw Error(why_no_shape_ + "; no shape is left");
}

namespace {

template <class Values>
const typename Values::mapped_type* data_of(const Object& object, const Values& values) {
  const auto found = values.find(object.text("data", ""));
  return found == values.end() ? nullptr : &found->second;
}

}  // namespace

const Mesh* Context::memory_mesh(const Object& object) const {
  return data_of(object, options_.meshes);
}
const TextureImage* Context::memory_image(const Object& object) const {
  const auto* const found = data_of(object, options_.images);
  return found ? found->get() : nullptr;
}
const VolumeData* Context::memory_volume(const Object& object) const {
  return data_of(object, options_.volumes);
}

void Context::note(const Element& at, const std::string& message) const {
  if (options_.warn) options_.warn(at.place() + ": " + shortened(message));
}

std::filesystem::path Context::resolve(const Element& at, const std::string& name) {
  return find(at, name, [&](const std::string& line) { warn_once("case " + name, at, line); });
}

std::filesystem::path Context::find(const Element& at, const std::string& name,
                                    const WarnOfName& warn) const {
  const std::filesystem::path beside = at.file->parent_path();
  const SearchPath& path = graph_.search_path();
  Folders folders = path.folders();
  folders.push_back(path.scene());
  folders.insert(at.tag == "spectrum" ? folders.begin() : folders.end(), beside);
  const std::filesystem::path found = find_in(folders, name, warn);
  return found.empty() ? beside / name : found;
}

void Context::add_default_lighting_if_dark() {
  if (lit_ || options_.default_lighting == DefaultLighting::off) return;
  add_default_lighting(scene);
  const Element& at = graph_.scene().element();
  if (left_out_.empty())
    return note(at, fmt::format("no light: {} is used", default_lighting_text));
  std::string names;
  for (const Object* emitter : left_out_) {
    names += fmt::format("{}'{}' of line {}", names.empty() ? "" : ", ", emitter->type(),
                         emitter->element().line);
  }
  report(
      at,
      fmt::format(
          "NO LIGHT OF THE FILE IS LEFT: not supported: {}; {} is used instead, so brightness and "
          "colours are not the file's",
          names, default_lighting_text));
}

void Context::report_unused() {
  for (const auto& object : graph_.objects()) {
    if (object->touched() && object->tag() != "scene") report_unused(*object);
  }
}

void Context::report_unused(const Object& object) {
  const std::string whose = fmt::format("{} '{}'", object.tag(), object.type());
  const Element* first = nullptr;
  std::string names;
  const auto add = [&](const std::string& name, const Element* at) {
    if (warned_.size() >= max_reports) return;
    if (!warned_.insert(fmt::format("unused {} {}", whose, name)).second) return;
    names += (first ? ", " : "") + name;
    if (!first || at->line < first->line) first = at;
  };
  for (const auto& [name, property] : object.properties()) {
    if (!property.used) add(name, property.element);
  }
  for (const Object::Nested& nested : object.nested()) {
    if (nested.used) continue;
    add(fmt::format("{} '{}'", nested.object->tag(), nested.object->type()), nested.element);
  }
  if (first) {
    report(*first, fmt::format("not supported in {} and ignored: {}", whose, names));
  }
}

}  // namespace pt::mitsuba
