// Obeys the directives of pbrt files one after the other.
#pragma once

#include <functional>

#include "common/scene/load/pbrt/description/graphics_state.h"
#include "common/scene/load/pbrt/syntax/token_stream.h"

namespace pt::pbrt {

class Interpreter {
 public:
  /// Both outlive it.
  Interpreter(Description& description, Reporter& reporter)
      : description_(description), reporter_(reporter) {}

  /// All directives to the end. Throws Error.
  void run(TokenStream& tokens);

  // What directives do; the tables in directives*.cpp name them.
  struct Directive {
    TokenStream& tokens;
    const Place& place;
    const std::string& name;
  };
  void transform(const Directive& directive);
  void coordinate_system(const Directive& directive);
  void attribute(const Directive& directive);
  void push(const Directive& directive);
  void pop(const Directive& directive);
  void object(const Directive& directive);
  void option(const Directive& directive);  ///< Camera, Film, ...
  void world_begin(const Directive& directive);
  void include(const Directive& directive);
  void import(const Directive& directive);
  void material(const Directive& directive);
  void texture(const Directive& directive);
  void shape(const Directive& directive);
  void light(const Directive& directive);
  void area_light(const Directive& directive);
  void color_space(const Directive& directive);
  void medium(const Directive& directive);
  void reverse(const Directive& directive);
  void render_option(const Directive& directive);
  void animation(const Directive& directive);

 private:
  std::string name_after(const Directive& directive) const;
  /// A type in quotes and parameters; those of the attribute `target` too.
  Entity read_entity(const Directive& directive, std::string_view target = {});
  std::filesystem::path find(const std::string& name, const Directive& directive);

  Description& description_;
  Reporter& reporter_;
  GraphicsState state_;
  std::vector<std::pair<GraphicsState, bool>> stack_;  ///< whether by ObjectBegin
  std::map<std::string, Affine> coordinate_systems_;   ///< to the world
  std::uint32_t group_ = 0;                            ///< of the object that is being defined
  bool in_world_ = false;
};

}  // namespace pt::pbrt
