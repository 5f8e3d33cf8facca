// What AttributeBegin remembers and AttributeEnd brings back.
#pragma once

#include <functional>

#include "common/scene/load/pbrt/syntax/description.h"
#include "common/scene/load/pbrt/syntax/tokens.h"

namespace pt::pbrt {

/// Current transformations: where a motion begins and where it ends.
struct Placement {
  Affine begin, end;
};

struct GraphicsState {
  Placement to_world;
  std::optional<LookAt> look_at;  ///< the last one at the beginning
  // Which of the two ActiveTransform has chosen.
  bool moves_begin = true, moves_end = true;
  bool reverse = false;
  ColorSpace space = ColorSpace::srgb;
  MaterialReference material;
  EntityPointer area_light;
  MediumNames media;
  /// By target; what follows shares them.
  std::map<std::string, std::shared_ptr<const SharedParameters>, std::less<>> attributes;
};

// Obeys the directives of pbrt files one after the other.

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
    const FileLocation& place;
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
  void earlier(const Directive& directive);  ///< of pbrt-v2

 private:
  /// Says, once, that the file is one of pbrt-v3, as `what` shows.
  void note_earlier(const FileLocation& place, const std::string& what);
  void note_earlier_parameters(const std::vector<Parameter>& parameters);
  /// The name under which what is defined now is kept; that of a second one differs, and is what
  /// its name refers to from here on.
  template <class Table>
  std::string name_for(const Directive& directive, const char* what, const std::string& name,
                       const Table& table);
  void refer_to_newest(std::vector<Parameter>& parameters) const;
  /// Reports a directive that is ignored.
  void report_bad(const Directive& directive, const std::string& message);
  std::string name_after(const Directive& directive) const;
  /// Where what stands here ends, if it moves.
  std::optional<Affine> end_of_motion() const;
  /// A type in quotes and parameters; those of the attribute `target` too.
  Entity read_entity(const Directive& directive, std::string_view target = {});
  /// The path of a file to include; empty, and reported, where it does not exist.
  std::filesystem::path find(const std::string& name, const Directive& directive);

  Description& description_;
  Reporter& reporter_;
  GraphicsState state_;
  std::vector<std::pair<GraphicsState, bool>> stack_;    ///< whether by ObjectBegin
  std::map<std::string, Placement> coordinate_systems_;  ///< to the world
  std::map<std::string, std::string> newest_;  ///< "material x", "texture x" defined again
  std::uint32_t group_ = 0;                    ///< of the object that is being defined
  std::uint32_t groups_ = 0;                   ///< how many there were
  bool in_world_ = false;
  int inclusions_ = 0;
};

}  // namespace pt::pbrt
