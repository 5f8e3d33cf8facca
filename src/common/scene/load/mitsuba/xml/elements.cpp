#include "common/scene/load/mitsuba/xml/elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <system_error>

#include "common/error/error.h"

namespace pt::mitsuba {

const std::string* Element::attribute(std::string_view name) const {
  for (const auto& [key, value] : attributes) {
    if (key == name) return &value;
  }
  return nullptr;
}

const std::string& Element::required(std::string_view name) const {
  if (const std::string* value = attribute(name)) return *value;
  fail(*this, "<{}> has no attribute '{}'", tag, name);
}

std::string Element::place() const {
  return line == 0 ? file->string() : fmt::format("{}:{}", file->string(), line);
}

std::string shortened(const std::string& message) {
  constexpr std::size_t head = 150, tail = 150, limit = 320;  // bytes
  if (message.size() <= limit) return clipped(message, limit);
  std::size_t begin = message.size() - tail;
  for (int i = 0; i < 3 && (message[begin] & 0xc0) == 0x80; ++i) ++begin;
  return clipped(message, head) + " " + clipped(message.substr(begin), tail);
}

void fail(const Element& element, const std::string& message) {
  throw Error(element.place() + ": " + shortened(message));
}

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
      fail(element, "'{}' in <{}>; expected a number", text.substr(at, end - at), element.tag);
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
    fail(element, "{}=\"{}\" of <{}>; expected a number", name, *text, element.tag);
  }
  return *number;
}

Vec3 vector_attributes(const Element& element, double fallback) {
  if (const std::string* value = element.attribute("value")) {
    const std::vector<double> v = parse_numbers(element, *value);
    if (v.size() == 1) return Vec3(static_cast<float>(v[0]));
    if (v.size() != 3) {
      fail(element, "value=\"{}\" of <{}>; expected one or three numbers", *value, element.tag);
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
    fail(element, "{}=\"{}\" of <{}>; expected three numbers", name, text, element.tag);
  }
  return {v[0], v[1], v[2]};
}

namespace {

using DVec3 = glm::dvec3;
using Map = glm::dmat4;  // column by column

Map map_of_columns(const DVec3& x, const DVec3& y, const DVec3& z, const DVec3& moved) {
  return {glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(z, 0), glm::dvec4(moved, 1)};
}

Map matrix_of(const Element& element) {
  const std::string& text = element.required("value");
  const std::vector<double> v = parse_numbers(element, text);
  if (v.size() != 16 && v.size() != 9) {
    fail(element, "<matrix> of {} numbers; expected 16 or 9", v.size());
  }
  const std::size_t n = v.size() == 16 ? 4 : 3;
  Map map(1.0);
  for (std::size_t i = 0; i < v.size(); ++i) {
    map[static_cast<int>(i % n)][static_cast<int>(i / n)] = v[i];
  }
  constexpr double rounding = 1e-4;
  const glm::dvec4 last(map[0][3], map[1][3], map[2][3], map[3][3] - 1);
  if (!glm::all(glm::lessThanEqual(glm::abs(last), glm::dvec4(rounding)))) {
    fail(element, "<matrix> is not affine; expected 0 0 0 1 as its last row");
  }
  for (int i = 0; i < 4; ++i) map[i][3] = i == 3 ? 1 : 0;
  return map;
}

Map rotation_of(const Element& element) {
  const DVec3 axis = vector_attributes(element, 0.0);
  const double length = glm::length(axis);
  if (!(length > 0)) fail(element, "<rotate> about an axis of length zero");
  const double angle = number_attribute(element, "angle", 0.0) * (std::acos(-1.0) / 180.0);
  const double c = std::cos(angle), s = std::sin(angle);
  const DVec3 k = axis / length;
  // Rodrigues' formula, column by column. (Mitsuba 3.9.1 leaves the axis as long as it is, and so
  // does not rotate where that is not 1; 0.6 normalised it.)
  const auto turned = [&](const DVec3& v) {
    return c * v + s * glm::cross(k, v) + (1.0 - c) * glm::dot(k, v) * k;
  };
  return map_of_columns(turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1}), DVec3(0.0));
}

LookAt look_at_of(const Element& element) {
  LookAt look{vector_attribute(element, "origin"), vector_attribute(element, "target")};
  if (element.attribute("up")) look.up = vector_attribute(element, "up");
  return look;
}

bool is_look_at(const Element& step) { return step.tag == "lookat" || step.tag == "lookAt"; }

/// The map of a camera at `origin`: z forward, y up, x to the left.
Map map_of(const LookAt& look, const Element& element) {
  const DVec3 origin = look.origin;
  const DVec3 forward = DVec3(look.target) - origin;
  if (!(glm::length(forward) > 0)) fail(element, "<lookat>: target and origin are the same point");
  const DVec3 z = glm::normalize(forward);
  DVec3 up = look.up;
  if (glm::length(up) == 0) up = std::abs(z.y) < 0.9 ? DVec3(0, 1, 0) : DVec3(1, 0, 0);
  const DVec3 left = glm::cross(glm::normalize(up), z);
  if (!(glm::length(left) > 1e-10)) fail(element, "<lookat>: up is parallel to the view");
  const DVec3 x = glm::normalize(left);
  return map_of_columns(x, glm::cross(z, x), z, origin);
}

Map step_of(const Element& element) {
  if (element.tag == "matrix") return matrix_of(element);
  if (element.tag == "rotate") return rotation_of(element);
  if (is_look_at(element)) return map_of(look_at_of(element), element);
  Map map(1.0);
  if (element.tag == "translate") {
    map[3] = glm::dvec4(DVec3(vector_attributes(element, 0.0)), 1);
  } else if (element.tag == "scale") {
    const Vec3 by = vector_attributes(element, 1.0);
    for (int i = 0; i < 3; ++i) map[i][i] = by[i];
  } else {
    fail(element, "<{}> in <transform>; expected translate, rotate, scale, matrix or lookat",
         element.tag);
  }
  return map;
}

}  // namespace

Affine read_transform(const Element& element) {
  Map map(1.0);
  for (const Element& step : element.children) map = step_of(step) * map;
  Affine result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) {
      result.row[i][j] = static_cast<float>(map[j][i]);
      if (!std::isfinite(result.row[i][j])) {
        fail(element, "<transform> overflows; expected finite numbers");
      }
    }
  }
  return result;
}

std::optional<LookAt> read_look_at(const Element& transform) {
  const auto last =
      std::ranges::find_if(transform.children.rbegin(), transform.children.rend(), is_look_at);
  if (last == transform.children.rend()) return {};
  return look_at_of(*last);
}

bool is_singular(const Affine& map) {
  double columns[3][3], lengths = 1;
  for (int j = 0; j < 3; ++j) {
    double squared = 0;
    for (int i = 0; i < 3; ++i) {
      columns[j][i] = map.row[i][j];
      squared += columns[j][i] * columns[j][i];
    }
    lengths *= std::sqrt(squared);
  }
  const DVec3 a(columns[0][0], columns[0][1], columns[0][2]);
  const DVec3 b(columns[1][0], columns[1][1], columns[1][2]);
  const DVec3 c(columns[2][0], columns[2][1], columns[2][2]);
  return !(std::abs(glm::dot(a, glm::cross(b, c))) > 1e-7 * lengths);
}

Affine read_invertible_transform(const Element& element) {
  const Affine map = read_transform(element);
  if (is_singular(map)) {
    fail(element, "<transform> is singular (it flattens the shape); expected one with an inverse");
  }
  return map;
}

namespace {

namespace fs = std::filesystem;

fs::path find_exactly(const Folders& folders, const std::string& name) {
  std::error_code ignored;
  for (const fs::path& folder : folders) {
    if (fs::exists(folder / name, ignored)) return folder / name;
  }
  return fs::exists(name, ignored) ? fs::path(name) : fs::path();
}

fs::path find_in_any_case(const Folders& folders, const std::string& name, const WarnOfName& warn) {
  for (const fs::path& folder : folders) {
    if (const fs::path found = find_file(folder, name, warn); !found.empty()) return found;
  }
  return {};
}

bool has_drive(const std::string& name) {
  return name.size() > 2 && std::isalpha(static_cast<unsigned char>(name[0])) && name[1] == ':';
}

/// Finds an absolute name of another machine by as many of its last parts as exist here.
fs::path find_last_parts(const Folders& folders, const fs::path& name, const WarnOfName& warn) {
  constexpr std::ptrdiff_t most_parts = 8;
  const std::vector<fs::path> parts(name.begin(), name.end());
  const auto first = std::max<std::ptrdiff_t>(1, std::ssize(parts) - most_parts);
  for (auto part = parts.begin() + first; part < parts.end(); ++part) {
    fs::path tail;
    for (auto next = part; next != parts.end(); ++next) tail /= *next;
    if (tail.is_absolute()) continue;
    fs::path found = find_exactly(folders, tail.string());
    if (found.empty()) found = find_in_any_case(folders, tail.string(), {});
    if (found.empty()) continue;
    if (warn) {
      warn(fmt::format("'{}' does not exist: {} is used", name.string(), found.string()));
    }
    return found;
  }
  return {};
}

}  // namespace

bool SearchPath::add(const Element& path) {
  const std::string& name = path.required("value");
  std::error_code ignored;
  for (const fs::path& folder : {path.file->parent_path(), scene_, fs::path()}) {
    if (!fs::is_directory(folder / name, ignored)) continue;
    folders_.insert(folders_.begin(), folder / name);
    return true;
  }
  return false;
}

fs::path find_in(const Folders& folders, const std::string& name, const WarnOfName& warn) {
  if (name.empty()) return {};
  if (const fs::path found = find_exactly(folders, name); !found.empty()) return found;
  if (const fs::path found = find_in_any_case(folders, name, warn); !found.empty()) return found;
  std::string slashed = name;
  std::ranges::replace(slashed, '\\', '/');
  if (has_drive(name) || fs::path(slashed).is_absolute()) {
    return find_last_parts(folders, slashed, warn);
  }
  return slashed == name ? fs::path() : find_in(folders, slashed, warn);
}

}  // namespace pt::mitsuba
