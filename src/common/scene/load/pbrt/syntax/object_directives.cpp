// Directives that add things to the description.
#include <fmt/format.h>

#include <set>
#include <utility>

#include "common/scene/load/pbrt/syntax/description.h"
#include "common/scene/load/pbrt/syntax/interpreter.h"

namespace pt::pbrt {
namespace {

/// About how pbrt works, which is not the scene's affair.
const std::set<std::string_view> idle_options = {"disablepixeljitter",
                                                 "disabletexturefiltering",
                                                 "disablewavelengthjitter",
                                                 "displacementedgescale",
                                                 "msereferenceimage",
                                                 "msereferenceout",
                                                 "rendercoordsys",
                                                 "seed",
                                                 "wavefront"};

bool is_earlier_material(std::string_view type) {
  static const std::set<std::string_view> types = {
      "disney", "fourier", "glass",     "kdsubsurface", "matte", "metal",
      "mirror", "plastic", "substrate", "translucent",  "uber"};
  return types.contains(type);
}

/// Parameters that pbrt-v4 does not know.
bool is_of_earlier_version(const Parameter& p) {
  static const std::set<std::string_view> names = {
      "mapname", "xwidth", "ywidth", "bumpmap", "namedmaterial1", "nlevels", "trilinear"};
  return names.contains(p.name) || p.type == "color" || p.type == "xyz" ||
         (p.type == "blackbody" && p.numbers.size() == 2);
}

EntityPointer shared(Entity entity) { return std::make_shared<const Entity>(std::move(entity)); }

}  // namespace

void Interpreter::note_earlier(const FileLocation& place, const std::string& what) {
  if (std::exchange(description_.is_earlier, true)) return;
  reporter_.note(
      place,
      fmt::format("{} is of pbrt-v3 or before: the file is read as one of that version; `pbrt "
                  "--upgrade` writes it for pbrt-v4",
                  what));
}

void Interpreter::note_earlier_parameters(const std::vector<Parameter>& parameters) {
  for (const Parameter& p : parameters) {
    if (is_of_earlier_version(p)) note_earlier(p.place, fmt::format("'{} {}'", p.type, p.name));
  }
}

template <class Table>
std::string Interpreter::name_for(const Directive& directive, const char* what,
                                  const std::string& name, const Table& table) {
  if (!table.contains(name)) return name;
  const std::string key = fmt::format("{} {}", what, name);
  reporter_.warn_once(key, directive.place,
                      "a {} '{}' was defined before: from here on the new one is used", what, name);
  return newest_[key] = fmt::format("{}{}{}", name, newest_mark, table.size());
}

void Interpreter::refer_to_newest(std::vector<Parameter>& parameters) const {
  if (newest_.empty()) return;
  for (Parameter& p : parameters) {
    const bool is_texture = p.type == "texture";
    const bool is_material =
        p.type == "string" && (p.name == "materials" || p.name.starts_with("namedmaterial"));
    if (!is_texture && !is_material) continue;
    for (std::string& name : p.strings) {
      const auto newest = newest_.find((is_texture ? "texture " : "material ") + name);
      if (newest != newest_.end()) name = newest->second;
    }
  }
}

void Interpreter::option(const Directive& directive) {
  EntityPointer entity = shared(read_entity(directive));
  if (directive.name == "Camera") {
    if (!is_invertible(state_.to_world.begin) || !is_invertible(state_.to_world.end)) {
      return report_bad(directive, "Camera: the transformation has no inverse");
    }
    coordinate_systems_["camera"] = {inverse(state_.to_world.begin), inverse(state_.to_world.end)};
    description_.camera = entity;
    description_.camera_look_at = state_.look_at;
    description_.camera_medium = state_.media.outside;
  } else if (directive.name == "Film") {
    if (entity->type == "image") note_earlier(directive.place, "Film 'image'");
    description_.film = entity;
  } else if (directive.name == "Sampler") {
    description_.sampler = entity;
  } else if (directive.name == "Integrator" || directive.name == "SurfaceIntegrator") {
    if (directive.name != "Integrator") note_earlier(directive.place, directive.name);
    description_.integrator = entity;
  } else if (directive.name == "PixelFilter") {
    description_.filter = entity;
  }
}

void Interpreter::object(const Directive& directive) {
  const std::string name = name_after(directive);
  if (group_ != 0) return report_bad(directive, "ObjectInstance inside of an object");
  const auto group = description_.groups.find(name);
  description_.instances.push_back({name, directive.place, state_.to_world.begin,
                                    group == description_.groups.end() ? 0 : group->second,
                                    end_of_motion()});
}

void Interpreter::material(const Directive& directive) {
  if (directive.name == "NamedMaterial") {
    const std::string name = name_after(directive);
    const auto newest = newest_.find("material " + name);
    state_.material = newest == newest_.end() ? name : newest->second;
    return;
  }
  EntityPointer entity = shared(read_entity(directive, "material"));
  const bool is_named = directive.name == "MakeNamedMaterial";  // the "type" is a parameter
  const Parameter* named = is_named ? entity->parameters.find("type") : nullptr;
  const std::string type = !is_named                          ? entity->type
                           : named && !named->strings.empty() ? named->strings.front()
                                                              : std::string();
  if (is_earlier_material(type)) {
    note_earlier(directive.place, fmt::format("material '{}'", type));
  }
  if (!is_named) {
    state_.material = entity;
    return;
  }
  const std::string name = name_for(directive, "material", entity->type, description_.materials);
  description_.materials.emplace(name, entity);
}

/// Texture "name" "float" "type" ...
void Interpreter::texture(const Directive& directive) {
  const std::string name = name_after(directive);
  const std::string of = name_after(directive);
  EntityPointer entity = shared(read_entity(directive, "texture"));
  if (of == "color") note_earlier(directive.place, "Texture of 'color'");
  if (of != "float" && of != "spectrum" && of != "color") {
    return report_bad(directive,
                      fmt::format("Texture '{}' of '{}'; expected float or spectrum", name, of));
  }
  const bool is_number = of == "float";
  auto& textures = is_number ? description_.float_textures : description_.spectrum_textures;
  textures.emplace(name_for(directive, "texture", name, textures), entity);
}

void Interpreter::shape(const Directive& directive) {
  description_.shapes.push_back({read_entity(directive, "shape"), state_.material,
                                 state_.area_light, state_.reverse, state_.media, group_});
  std::optional<Affine>& end = description_.shapes.back().shape.end_to_world;
  if (group_ == 0 || !end) return;
  end.reset();
  reporter_.warn_once("motion in objects", directive.place,
                      "shapes that move inside of an object are not supported: they stay where "
                      "they begin; expected a motion of the ObjectInstance");
}

void Interpreter::earlier(const Directive& directive) {
  const Entity entity = read_entity(directive);
  note_earlier(directive.place, directive.name);
  reporter_.warn_once("earlier " + directive.name, directive.place,
                      "{} '{}' is of pbrt-v2 and ignored", directive.name, entity.type);
}

void Interpreter::light(const Directive& directive) {
  description_.lights.push_back(shared(read_entity(directive, "light")));
  if (description_.lights.back()->end_to_world)
    reporter_.warn_once("motion of lights", directive.place,
                        "LightSources that move are not supported: they stay where they begin; "
                        "expected a shape with AreaLightSource");
}

void Interpreter::area_light(const Directive& directive) {
  state_.area_light = shared(read_entity(directive, "light"));
  if (state_.area_light->type == "area") note_earlier(directive.place, "AreaLightSource 'area'");
}

void Interpreter::medium(const Directive& directive) {
  if (directive.name == "MediumInterface") {
    // One name is for both sides; an empty one is no medium.
    state_.media.inside = state_.media.outside = name_after(directive);
    const Token* second = directive.tokens.peek();
    if (second && second->kind == TokenKind::string) {
      state_.media.outside = directive.tokens.next()->text;
    }
    return;
  }
  // The "type" stands among the parameters.
  EntityPointer entity = shared(read_entity(directive, "medium"));
  const std::string name = entity->type;
  if (!description_.media.try_emplace(name, entity).second) {
    reporter_.warn_once("medium named " + name, directive.place,
                        "a medium '{}' was defined before: the new one is ignored", name);
  }
}

/// Option "type name" value, as pbrt's documentation has it, or Option "name" value.
void Interpreter::render_option(const Directive& directive) {
  const std::string declaration = name_after(directive);
  const std::string name = declaration.substr(declaration.find_last_of(' ') + 1);
  std::optional<Token> value = directive.tokens.next();
  if (!value || value->kind == TokenKind::close) {
    fail(directive.place, "Option '{}' has no value", declaration);
  }
  while (value && value->kind == TokenKind::open) {
    do value = directive.tokens.next();
    while (value && value->kind != TokenKind::close);
  }
  if (idle_options.contains(name)) return;
  reporter_.warn_once("option " + name, directive.place, "Option '{}' is not supported and ignored",
                      name);
}

}  // namespace pt::pbrt
