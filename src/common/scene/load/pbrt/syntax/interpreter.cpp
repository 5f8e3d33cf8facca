#include "common/scene/load/pbrt/syntax/interpreter.h"

#include <fmt/format.h>

#include "common/scene/load/files/whole_file.h"
#include "common/scene/load/pbrt/syntax/description.h"
#include "common/scene/load/pbrt/syntax/parameters.h"

namespace pt::pbrt {
namespace {

constexpr int most_inclusions = 20'000;  // of files that include others twice there are soon many

using Method = void (Interpreter::*)(const Interpreter::Directive&);

/// Where a directive may stand.
enum class Block { anywhere, options, world };

struct Entry {
  Method method;
  Block block = Block::anywhere;
};

const std::map<std::string_view, Entry>& directives() {
  using I = Interpreter;
  static const std::map<std::string_view, Entry> table = {
      {"Identity", {&I::transform}},
      {"Translate", {&I::transform}},
      {"Scale", {&I::transform}},
      {"Rotate", {&I::transform}},
      {"LookAt", {&I::transform}},
      {"Transform", {&I::transform}},
      {"ConcatTransform", {&I::transform}},
      {"CoordinateSystem", {&I::coordinate_system}},
      {"CoordSysTransform", {&I::coordinate_system}},
      {"Attribute", {&I::attribute}},
      {"AttributeBegin", {&I::push, Block::world}},
      {"AttributeEnd", {&I::pop, Block::world}},
      {"TransformBegin", {&I::push, Block::world}},
      {"TransformEnd", {&I::pop, Block::world}},
      {"ObjectBegin", {&I::push, Block::world}},
      {"ObjectEnd", {&I::pop, Block::world}},
      {"ObjectInstance", {&I::object, Block::world}},
      {"Camera", {&I::option, Block::options}},
      {"Film", {&I::option, Block::options}},
      {"Sampler", {&I::option, Block::options}},
      {"Integrator", {&I::option, Block::options}},
      {"PixelFilter", {&I::option, Block::options}},
      {"SurfaceIntegrator", {&I::option, Block::options}},
      {"VolumeIntegrator", {&I::earlier, Block::options}},
      {"Renderer", {&I::earlier, Block::options}},
      {"Volume", {&I::earlier, Block::world}},
      {"Accelerator", {&I::option, Block::options}},
      {"WorldBegin", {&I::world_begin, Block::options}},
      {"Include", {&I::include}},
      {"Import", {&I::import, Block::world}},
      {"Material", {&I::material, Block::world}},
      {"MakeNamedMaterial", {&I::material}},
      {"NamedMaterial", {&I::material, Block::world}},
      {"Texture", {&I::texture, Block::world}},
      {"Shape", {&I::shape, Block::world}},
      {"LightSource", {&I::light, Block::world}},
      {"AreaLightSource", {&I::area_light, Block::world}},
      {"ColorSpace", {&I::color_space}},
      {"MediumInterface", {&I::medium}},
      {"MakeNamedMedium", {&I::medium}},
      {"ReverseOrientation", {&I::reverse}},
      {"Option", {&I::render_option}},
      {"ActiveTransform", {&I::animation}},
      {"TransformTimes", {&I::animation}},
      {"WorldEnd", {&I::world_begin, Block::world}},
  };
  return table;
}

}  // namespace

void Interpreter::run(TokenStream& tokens) {
  const std::size_t depth = stack_.size();
  while (std::optional<Token> token = tokens.next()) {
    const auto found = directives().find(token->text);
    if (token->kind != TokenKind::word || found == directives().end()) {
      fail(token->place, "'{}'; expected a directive, such as Shape or AttributeEnd", token->text);
    }
    const auto& [method, block] = found->second;
    if (block != Block::anywhere && (block == Block::world) != in_world_) {
      fail(token->place, "{} {} WorldBegin; expected it {}", token->text,
           in_world_ ? "after" : "before", in_world_ ? "before" : "after that");
    }
    (this->*method)({tokens, token->place, token->text});
    if (stack_.size() < depth) fail(token->place, token->text + " without its Begin in this file");
  }
  if (stack_.size() > depth) {
    fail(description_.place, "a block without its end; expected AttributeEnd or ObjectEnd");
  }
}

void Interpreter::report_bad(const Directive& directive, const std::string& message) {
  reporter_.attempt(directive.name, "is ignored", [&] { fail(directive.place, message); });
}

std::string Interpreter::name_after(const Directive& directive) const {
  return directive.tokens
      .expect(TokenKind::string, fmt::format("a \"name\" after {}", directive.name))
      .text;
}

Entity Interpreter::read_entity(const Directive& directive, std::string_view target) {
  const std::string type = name_after(directive);
  std::vector<Parameter> own = read_parameters(directive.tokens, state_.space, reporter_);
  note_earlier_parameters(own);
  refer_to_newest(own);
  const auto inherited = state_.attributes.find(target);
  return {type,
          Parameters(directive.place, fmt::format("{} '{}'", directive.name, type), std::move(own),
                     inherited == state_.attributes.end() ? nullptr : inherited->second),
          state_.to_world.begin, state_.space, end_of_motion()};
}

std::optional<Affine> Interpreter::end_of_motion() const {
  const auto& [begin, end] = state_.to_world;
  return begin == end ? std::nullopt : std::optional(end);
}

std::filesystem::path Interpreter::find(const std::string& name, const Directive& directive) {
  if (++inclusions_ > most_inclusions) {
    fail(directive.place, "more than {} files are included", most_inclusions);
  }
  std::error_code ignored;
  const std::filesystem::path folders[] = {description_.folder, directive.tokens.folder()};
  for (const std::filesystem::path& folder : folders) {
    if (std::filesystem::exists(folder / name, ignored)) return folder / name;
  }
  const auto warn = [&](const std::string& line) {
    reporter_.warn_once("case " + name, directive.place, line);
  };
  const std::filesystem::path found = find_file(description_.folder, name, warn);
  if (!found.empty()) return found;
  if (reporter_.options().strict) fail(directive.place, "there is no file '{}'", name);
  reporter_.warn_once("include " + name, directive.place, "there is no file '{}': {} is left out",
                      name, directive.name);
  return {};
}

void Interpreter::include(const Directive& directive) {
  const std::filesystem::path path = find(name_after(directive), directive);
  if (!path.empty()) directive.tokens.include(path, directive.place);
}

/// The state of an imported file is its own.
void Interpreter::import(const Directive& directive) {
  const std::filesystem::path path = find(name_after(directive), directive);
  if (path.empty()) return;
  TokenStream tokens(path, directive.place, directive.tokens);
  const GraphicsState before = state_;
  run(tokens);
  state_ = before;
}

Description read_description(const std::filesystem::path& path, Reporter& reporter) {
  Description description;
  description.folder = path.parent_path();
  description.place = {std::make_shared<const std::string>(path.string()), 1, 1};
  TokenStream tokens(path);
  Interpreter(description, reporter).run(tokens);
  return description;
}

}  // namespace pt::pbrt
