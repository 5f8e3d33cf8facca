// Directives that add things to the description.
#include <fmt/format.h>

#include <set>

#include "common/scene/load/pbrt/description/interpreter.h"
#include "common/scene/load/pbrt/description/transforms.h"

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

EntityPointer shared(Entity entity) { return std::make_shared<const Entity>(std::move(entity)); }

}  // namespace

void Interpreter::option(const Directive& directive) {
  EntityPointer entity = shared(read_entity(directive));
  if (directive.name == "Camera") {
    if (!is_invertible(state_.to_world)) {
      fail(directive.place, "Camera: the transformation has no inverse");
    }
    coordinate_systems_["camera"] = inverse(state_.to_world);
    description_.camera = entity;
    description_.camera_medium = state_.media.outside;
  } else if (directive.name == "Film") {
    description_.film = entity;
  } else if (directive.name == "Sampler") {
    description_.sampler = entity;
  } else if (directive.name == "Integrator") {
    description_.integrator = entity;
  } else if (directive.name == "PixelFilter") {
    description_.filter = entity;
  }
}

void Interpreter::object(const Directive& directive) {
  const std::string name = name_after(directive);
  if (group_ != 0) fail(directive.place, "ObjectInstance inside of an object");
  description_.instances.push_back({name, directive.place, state_.to_world});
}

void Interpreter::material(const Directive& directive) {
  if (directive.name == "NamedMaterial") {
    state_.material = name_after(directive);
  } else if (directive.name == "Material") {
    state_.material = shared(read_entity(directive, "material"));
  } else {
    // The "type" stands among the parameters.
    EntityPointer entity = shared(read_entity(directive, "material"));
    const std::string name = entity->type;
    if (!description_.materials.try_emplace(name, entity).second) {
      reporter_.warn_once("material " + name, directive.place,
                          fmt::format("a material '{}' was defined before: that holds", name));
    }
  }
}

/// Texture "name" "float" "type" ...
void Interpreter::texture(const Directive& directive) {
  const std::string name = name_after(directive);
  const std::string of = name_after(directive);
  if (of != "float" && of != "spectrum") {
    fail(directive.place,
         fmt::format("Texture '{}' of '{}'; expected float or spectrum", name, of));
  }
  auto& textures = of == "float" ? description_.float_textures : description_.spectrum_textures;
  EntityPointer entity = shared(read_entity(directive, "texture"));
  if (!textures.try_emplace(name, entity).second) {
    reporter_.warn_once("texture " + name, directive.place,
                        fmt::format("a texture '{}' was defined before: that holds", name));
  }
}

void Interpreter::shape(const Directive& directive) {
  description_.shapes.push_back({read_entity(directive, "shape"), state_.material,
                                 state_.area_light, state_.reverse, state_.media, group_});
}

void Interpreter::light(const Directive& directive) {
  description_.lights.push_back(shared(read_entity(directive, "light")));
}

void Interpreter::area_light(const Directive& directive) {
  state_.area_light = shared(read_entity(directive, "light"));
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
                        fmt::format("a medium '{}' was defined before: that holds", name));
  }
}

/// Option "type name" value, as pbrt's documentation has it, or Option "name" value.
void Interpreter::render_option(const Directive& directive) {
  const std::string declaration = name_after(directive);
  const std::string name = declaration.substr(declaration.find_last_of(' ') + 1);
  std::optional<Token> value = directive.tokens.next();
  if (!value || value->kind == TokenKind::close) {
    fail(directive.place, fmt::format("Option '{}' has no value", declaration));
  }
  while (value && value->kind == TokenKind::open) {
    do value = directive.tokens.next();
    while (value && value->kind != TokenKind::close);
  }
  if (idle_options.contains(name)) return;
  reporter_.warn_once("option " + name, directive.place,
                      fmt::format("Option '{}' is not supported and ignored", name));
}

}  // namespace pt::pbrt
