#include "common/scene/load/mitsuba/xml/transforms.h"

#include <fmt/format.h>

#include <cmath>

#include "common/scene/load/mitsuba/xml/values.h"

namespace pt::mitsuba {
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
    fail(element, fmt::format("<matrix> of {} numbers; expected 16 or 9", v.size()));
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

/// The map of a camera at `origin`: z forward, y up, x to the left.
Map lookat_of(const Element& element) {
  const DVec3 origin = vector_attribute(element, "origin");
  const DVec3 forward = DVec3(vector_attribute(element, "target")) - origin;
  if (!(glm::length(forward) > 0)) fail(element, "<lookat>: target and origin are the same point");
  const DVec3 z = glm::normalize(forward);
  DVec3 up(0, 0, 0);
  if (element.attribute("up")) up = vector_attribute(element, "up");
  if (glm::length(up) == 0) up = std::abs(z.y) < 0.9 ? DVec3(0, 1, 0) : DVec3(1, 0, 0);
  const DVec3 left = glm::cross(glm::normalize(up), z);
  if (!(glm::length(left) > 1e-10)) fail(element, "<lookat>: up is parallel to the view");
  const DVec3 x = glm::normalize(left);
  return map_of_columns(x, glm::cross(z, x), z, origin);
}

Map step_of(const Element& element) {
  if (element.tag == "matrix") return matrix_of(element);
  if (element.tag == "rotate") return rotation_of(element);
  if (element.tag == "lookat" || element.tag == "lookAt") return lookat_of(element);
  Map map(1.0);
  if (element.tag == "translate") {
    map[3] = glm::dvec4(DVec3(vector_attributes(element, 0.0)), 1);
  } else if (element.tag == "scale") {
    const Vec3 by = vector_attributes(element, 1.0);
    for (int i = 0; i < 3; ++i) map[i][i] = by[i];
  } else {
    fail(element, fmt::format("<{}> in <transform>; expected translate, rotate, scale, matrix or "
                              "lookat",
                              element.tag));
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

}  // namespace pt::mitsuba
