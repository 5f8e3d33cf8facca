#include "common/scene/load/pbrt/syntax/parameters.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include "common/scene/load/files/text.h"

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
    fail(token.place, "'{}'; expected a parameter, \"type name\"", token.text);
  }
  if (std::ranges::find(known_types, parameter.type) == known_types.end()) {
    fail(token.place,
         "parameter '{}' has the unknown type '{}'; expected integer, float, bool, string, rgb, "
         "spectrum, point3, ...",
         parameter.name, parameter.type);
  }
  return parameter;
}

/// What C writes for numbers that are none; the element that has such a value is left out.
bool is_not_finite(const Token& token) {
  std::string_view text = token.text;
  if (token.kind != TokenKind::word) return false;
  if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
  const std::string first = lower_case(text.substr(0, 3));
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
    fail(token.place, "'{}' as a value of '{} {}'; expected {}", token.text, parameter.type,
         parameter.name, is_of_words(parameter.type) ? "a \"string\"" : "a number");
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
    reporter.warn_once("twice " + parameter.name, parameter.place,
                       "parameter '{}' is given twice: the last holds", parameter.name);
    list[entry->second] = std::move(parameter);
  }
  return list;
}

namespace {

// Old files say point for point3, and so on.
const Parameter* find_vector3(const Parameters& list, std::string_view name) {
  return list.find(name, {"point3", "vector3", "normal", "point", "vector", "normal3"});
}

const Parameter& single(const Parameter& parameter, std::size_t count, std::size_t expected = 1) {
  if (count == expected) return parameter;
  fail(parameter.place, "'{} {}' has {} values; expected {}", parameter.type, parameter.name, count,
       expected);
}

void check_groups(const Parameter& parameter, std::size_t size) {
  if (parameter.numbers.size() % size == 0) return;
  fail(parameter.place, "'{} {}' has {} numbers; expected a multiple of {}", parameter.type,
       parameter.name, parameter.numbers.size(), size);
}

void check_finite(const Parameter& parameter) {
  const auto is_finite = [](double number) { return std::isfinite(number); };
  if (std::ranges::all_of(parameter.numbers, is_finite)) return;
  fail(parameter.place, "'{} {}' has a number that is not finite", parameter.type, parameter.name);
}

int whole(const Parameter& parameter, double number) {
  constexpr double most = std::numeric_limits<int>::max();
  if (number == std::floor(number) && std::abs(number) <= most) return static_cast<int>(number);
  fail(parameter.place, "'{} {}': {}; expected an integer", parameter.type, parameter.name, number);
}

}  // namespace

Parameters::Parameters(const FileLocation& place, std::string what, std::vector<Parameter> own,
                       std::shared_ptr<const SharedParameters> inherited)
    : place_(place),
      what_(std::move(what)),
      own_(std::move(own)),
      inherited_(std::move(inherited)) {}

const Parameter* Parameters::find(std::string_view name) const {
  asked_.emplace(name);
  const auto found = std::ranges::find(own_, name, &Parameter::name);
  if (found != own_.end()) return &*found;
  if (!inherited_) return nullptr;
  for (const auto& parameter : *inherited_) {
    if (parameter->name == name) return parameter.get();
  }
  return nullptr;
}

const Parameter* Parameters::find(std::string_view name,
                                  std::initializer_list<std::string_view> types) const {
  const Parameter* parameter = find(name);
  if (parameter) check_finite(*parameter);
  if (!parameter || std::ranges::find(types, parameter->type) != types.end()) return parameter;
  fail(parameter->place, "parameter '{}' of {} is of type '{}'; expected {}", name, what_,
       parameter->type, fmt::join(types, " or "));
}

bool Parameters::has(std::string_view name, std::string_view type) const {
  const Parameter* parameter = find(name);
  return parameter && parameter->type == type;
}

float Parameters::number(std::string_view name, float fallback) const {
  const Parameter* p = find(name, {"float", "integer"});
  return p ? static_cast<float>(single(*p, p->numbers.size()).numbers[0]) : fallback;
}

int Parameters::integer(std::string_view name, int fallback) const {
  const Parameter* p = find(name, {"integer", "float"});
  return p ? whole(*p, single(*p, p->numbers.size()).numbers[0]) : fallback;
}

bool Parameters::boolean(std::string_view name, bool fallback) const {
  const Parameter* p = find(name, {"bool"});
  if (!p) return fallback;
  const std::string& word = single(*p, p->strings.size()).strings[0];
  if (word == "true" || word == "false") return word == "true";
  fail(p->place, "'bool {}': '{}'; expected true or false", name, word);
}

std::string Parameters::text(std::string_view name, std::string_view fallback) const {
  const Parameter* p = find(name, {"string"});
  return p ? single(*p, p->strings.size()).strings[0] : std::string(fallback);
}

Vec3 Parameters::point(std::string_view name, const Vec3& fallback) const {
  const Parameter* p = find_vector3(*this, name);
  if (!p) return fallback;
  const std::vector<double>& v = single(*p, p->numbers.size(), 3).numbers;
  return {v[0], v[1], v[2]};
}

std::vector<float> Parameters::numbers(std::string_view name) const {
  const Parameter* p = find(name, {"float", "integer"});
  return p ? std::vector<float>(p->numbers.begin(), p->numbers.end()) : std::vector<float>();
}

std::vector<int> Parameters::integers(std::string_view name) const {
  const Parameter* p = find(name, {"integer"});
  std::vector<int> result;
  if (!p) return result;
  result.reserve(p->numbers.size());
  for (const double number : p->numbers) result.push_back(whole(*p, number));
  return result;
}

std::vector<std::string> Parameters::texts(std::string_view name) const {
  const Parameter* p = find(name, {"string"});
  return p ? p->strings : std::vector<std::string>();
}

std::vector<Vec3> Parameters::points(std::string_view name) const {
  const Parameter* p = find_vector3(*this, name);
  std::vector<Vec3> result;
  if (!p) return result;
  check_groups(*p, 3);
  for (std::size_t i = 0; i < p->numbers.size(); i += 3) {
    result.emplace_back(p->numbers[i], p->numbers[i + 1], p->numbers[i + 2]);
  }
  return result;
}

std::vector<Vec2> Parameters::points2(std::string_view name) const {
  const Parameter* p = find(name, {"point2", "vector2", "float"});
  std::vector<Vec2> result;
  if (!p) return result;
  check_groups(*p, 2);
  for (std::size_t i = 0; i < p->numbers.size(); i += 2) {
    result.emplace_back(p->numbers[i], p->numbers[i + 1]);
  }
  return result;
}

void Parameters::ignore(std::initializer_list<std::string_view> names) const {
  for (const std::string_view name : names) asked_.emplace(name);
}

void Parameters::ignore_all() const {
  for (const Parameter& parameter : own_) asked_.insert(parameter.name);
}

void Parameters::report_unused(Reporter& reporter) const {
  for (const Parameter& p : own_) {
    if (asked_.contains(p.name)) continue;
    reporter.warn_once(fmt::format("unused {} {}", what_, p.name), p.place,
                       "parameter '{} {}' of {} is not supported and ignored; expected one of {}",
                       p.type, p.name, what_, fmt::join(asked_, ", "));
  }
}

}  // namespace pt::pbrt
