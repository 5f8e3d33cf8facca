#include "common/scene/load/mitsuba/xml/values.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace pt::mitsuba {
namespace {

bool is_separator(char c) { return c == ',' || c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_separator(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_separator(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  text = trimmed(text);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || text.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    const bool tiny =
        text.find("e-") != text.npos || text.find("E-") != text.npos || text.find("0.") == 0;
    return tiny ? std::optional(0.0) : std::nullopt;
  }
  if (error != std::errc() || !(std::abs(value) <= 3.4e38)) return std::nullopt;
  return value;
}

std::vector<double> parse_numbers(const Element& element, std::string_view text) {
  std::vector<double> numbers;
  for (std::size_t at = 0; at < text.size();) {
    if (is_separator(text[at])) {
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < text.size() && !is_separator(text[end])) ++end;
    const std::optional<double> number = parse_number(text.substr(at, end - at));
    if (!number) {
      fail(element,
           fmt::format("'{}' in <{}>; expected a number", text.substr(at, end - at), element.tag));
    }
    numbers.push_back(*number);
    at = end;
  }
  return numbers;
}

double number_attribute(const Element& element, std::string_view name, double fallback) {
  const std::string* text = element.attribute(name);
  if (!text) return fallback;
  const std::optional<double> number = parse_number(*text);
  if (!number) {
    fail(element, fmt::format("{}=\"{}\" of <{}>; expected a number", name, *text, element.tag));
  }
  return *number;
}

Vec3 vector_attributes(const Element& element, double fallback) {
  if (const std::string* value = element.attribute("value")) {
    const std::vector<double> v = parse_numbers(element, *value);
    if (v.size() == 1) return Vec3(static_cast<float>(v[0]));
    if (v.size() != 3) {
      fail(element,
           fmt::format("value=\"{}\" of <{}>; expected one or three numbers", *value, element.tag));
    }
    return {v[0], v[1], v[2]};
  }
  return {number_attribute(element, "x", fallback), number_attribute(element, "y", fallback),
          number_attribute(element, "z", fallback)};
}

Vec3 vector_attribute(const Element& element, std::string_view name) {
  const std::string& text = element.required(name);
  const std::vector<double> v = parse_numbers(element, text);
  if (v.size() != 3) {
    fail(element,
         fmt::format("{}=\"{}\" of <{}>; expected three numbers", name, text, element.tag));
  }
  return {v[0], v[1], v[2]};
}

}  // namespace pt::mitsuba
