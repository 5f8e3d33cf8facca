#include "common/scene/load/mitsuba/xml/context.h"

#include <fmt/format.h>

#include "common/scene/load/files/find_file.h"
#include "common/scene/load/files/studio.h"
#include "common/scene/load/mitsuba/xml/values.h"

namespace pt::mitsuba {
namespace {

// A scene without a version is read as one of today.
bool is_modern(const ObjectGraph& graph) {
  const std::string* version = graph.scene().element().attribute("version");
  if (!version) return true;
  const std::optional<double> major = parse_number(version->substr(0, version->find('.')));
  if (!major) {
    fail(graph.scene().element(),
         fmt::format("version '{}' of the scene; expected one like 3.0.0", *version));
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

void Context::warn_once(const std::string& kind, const Element& at, const std::string& message) {
  if (warned_.insert(kind).second) options_.report(at.place() + ": " + message);
}

const Mesh* Context::memory_mesh(const std::string& name) const {
  const auto found = options_.meshes.find(name);
  return found == options_.meshes.end() ? nullptr : &found->second;
}

void Context::note(const Element& at, const std::string& message) const {
  if (options_.warn) options_.warn(at.place() + ": " + message);
}

std::filesystem::path Context::resolve(const Element& at, const std::string& name) {
  const std::filesystem::path beside = at.file->parent_path();
  const std::filesystem::path folder = graph_.scene().element().file->parent_path();
  std::vector<std::filesystem::path> folders = {beside, folder};
  for (const std::string& path : graph_.search_paths()) folders.push_back(folder / path);
  std::error_code ignored;
  for (const std::filesystem::path& place : folders) {
    if (std::filesystem::exists(place / name, ignored)) return place / name;
  }
  const auto warn = [&](const std::string& line) { warn_once("case " + name, at, line); };
  for (const std::filesystem::path& place : folders) {
    const std::filesystem::path found = find_file(place, name, warn);
    if (!found.empty()) return found;
  }
  return beside / name;
}

void Context::add_studio_if_dark() {
  if (lit_ || options_.default_lighting == DefaultLighting::off) return;
  add_studio(scene);
  const Element& at = graph_.scene().element();
  if (left_out_.empty()) return note(at, fmt::format("no light: {} is used", studio_text));
  std::string names;
  for (const Object* emitter : left_out_) {
    names += fmt::format("{}'{}' of line {}", names.empty() ? "" : ", ", emitter->type(),
                         emitter->element().line);
  }
  options_.report(
      fmt::format("{}: NO LIGHT OF THE FILE IS LEFT: not supported: {}; {} is used "
                  "instead, so brightness and colours are not the file's",
                  at.place(), names, studio_text));
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
    options_.report(
        fmt::format("{}: not supported in {} and ignored: {}", first->place(), whose, names));
  }
}

}  // namespace pt::mitsuba
