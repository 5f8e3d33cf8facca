#include "common/scene/load/pbrt/syntax/read_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/scene/load/files/meshes/text_number.h"

namespace pt::pbrt {
namespace {

constexpr std::array<std::string_view, 19> known_types = {
    "integer", "float",    "point2",    "vector2", "point3", "vector3", "normal",
    "normal3", "point",    "vector",    "bool",    "string", "texture", "rgb",
    "color",   "spectrum", "blackbody", "xyz",     "int"};

/// "type name" as two words.
Parameter declared(const Token& token, ColorSpace space) {
  Parameter parameter;
  std::string_view text = token.text;
  parameter.type = next_word(text);
  parameter.name = next_word(text);
  parameter.place = token.place;
  parameter.space = space;
  if (parameter.type == "int") parameter.type = "integer";
  if (parameter.name.empty() || !next_word(text).empty()) {
    fail(token.place,
         fmt::format("\"{}\"; expected a parameter, \"type name\"", token.text.substr(0, 40)));
  }
  if (std::ranges::find(known_types, parameter.type) == known_types.end()) {
    fail(token.place, fmt::format("parameter '{}' has the unknown type '{}'; expected integer, "
                                  "float, bool, string, rgb, spectrum, point3, ...",
                                  parameter.name, parameter.type));
  }
  return parameter;
}

bool is_of_words(const std::string& type) {
  return type == "string" || type == "texture" || type == "bool";
}

void add_value(Parameter& parameter, const Token& token) {
  const bool is_string = token.kind == TokenKind::string;
  const bool truth = parameter.type == "bool" && token.kind == TokenKind::word;
  if (truth || (is_string && (is_of_words(parameter.type) || parameter.type == "spectrum"))) {
    parameter.strings.push_back(token.text);
    return;
  }
  if (is_of_words(parameter.type) || is_string) {
    fail(token.place, fmt::format("'{}' as a value of '{} {}'; expected {}",
                                  token.text.substr(0, 40), parameter.type, parameter.name,
                                  is_of_words(parameter.type) ? "a \"string\"" : "a number"));
  }
  parameter.numbers.push_back(number_of(token));
}

void read_values(TokenStream& tokens, Parameter& parameter) {
  const auto next = [&] {
    const std::string what = fmt::format("a value of '{}'", parameter.name);
    std::optional<Token> token = tokens.next();
    if (!token) fail(parameter.place, "the file ends here; expected " + what);
    return std::move(*token);
  };
  Token token = next();
  if (token.kind != TokenKind::open) return add_value(parameter, token);
  for (token = next(); token.kind != TokenKind::close; token = next()) add_value(parameter, token);
}

}  // namespace

std::vector<Parameter> read_parameters(TokenStream& tokens, ColorSpace space, Reporter& reporter) {
  std::vector<Parameter> list;
  while (const Token* token = tokens.peek()) {
    if (token->kind != TokenKind::string) break;
    Parameter parameter = declared(*tokens.next(), space);
    read_values(tokens, parameter);
    if (std::ranges::find(list, parameter.name, &Parameter::name) != list.end()) {
      reporter.warn_once(
          "twice " + parameter.name, parameter.place,
          fmt::format("parameter '{}' is given twice: the first holds", parameter.name));
      continue;
    }
    list.push_back(std::move(parameter));
  }
  return list;
}

}  // namespace pt::pbrt
