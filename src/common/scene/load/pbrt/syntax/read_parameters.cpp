#include "common/scene/load/pbrt/syntax/read_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>
#include <limits>
#include <map>

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
    fail(token.place, fmt::format("'{}'; expected a parameter, \"type name\"", token.text));
  }
  if (std::ranges::find(known_types, parameter.type) == known_types.end()) {
    fail(token.place, fmt::format("parameter '{}' has the unknown type '{}'; expected integer, "
                                  "float, bool, string, rgb, spectrum, point3, ...",
                                  parameter.name, parameter.type));
  }
  return parameter;
}

/// What C writes for numbers that are none; the element that has such a value is left out.
bool is_not_finite(const Token& token) {
  std::string_view text = token.text;
  if (token.kind != TokenKind::word) return false;
  if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
  std::string first(text.substr(0, 3));
  std::ranges::transform(first, first.begin(), [](unsigned char c) { return std::tolower(c); });
  return first == "nan" || first == "inf";
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
    fail(token.place,
         fmt::format("'{}' as a value of '{} {}'; expected {}", token.text, parameter.type,
                     parameter.name, is_of_words(parameter.type) ? "a \"string\"" : "a number"));
  }
  parameter.numbers.push_back(is_not_finite(token) ? std::numeric_limits<double>::quiet_NaN()
                                                   : number_of(token));
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
  std::map<std::string, std::size_t, std::less<>> places;
  while (const Token* token = tokens.peek()) {
    if (token->kind != TokenKind::string) break;
    Parameter parameter = declared(*tokens.next(), space);
    read_values(tokens, parameter);
    const auto [entry, is_new] = places.try_emplace(parameter.name, list.size());
    if (is_new) {
      list.push_back(std::move(parameter));
      continue;
    }
    reporter.warn_once(
        "twice " + parameter.name, parameter.place,
        fmt::format("parameter '{}' is given twice: the last holds", parameter.name));
    list[entry->second] = std::move(parameter);
  }
  return list;
}

}  // namespace pt::pbrt
