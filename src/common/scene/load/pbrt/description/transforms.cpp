#include "common/scene/load/pbrt/description/transforms.h"

#include <cmath>

namespace pt::pbrt {
namespace {

using DVec3 = glm::dvec3;

DVec3 read_vector(TokenStream& tokens) {
  DVec3 v;
  for (int i = 0; i < 3; ++i) v[i] = tokens.expect_number("a number");
  return v;
}

}  // namespace

bool is_invertible(const Affine& map) {
  const float determinant = map.determinant();
  return std::isfinite(determinant) && determinant != 0.0f;
}

Affine read_translate(TokenStream& tokens) { return translate(Vec3(read_vector(tokens))); }
Affine read_scale(TokenStream& tokens) { return scale(Vec3(read_vector(tokens))); }

std::optional<Affine> read_rotate(TokenStream& tokens) {
  const auto degrees = static_cast<float>(tokens.expect_number("an angle in degrees"));
  const DVec3 axis = read_vector(tokens);
  const double length = glm::length(axis);
  if (!(length > 0)) return std::nullopt;
  return rotate(Vec3(axis / length), degrees);
}

std::optional<Affine> read_look_at(TokenStream& tokens) {
  const DVec3 eye = read_vector(tokens), target = read_vector(tokens), up = read_vector(tokens);
  const DVec3 z = glm::normalize(target - eye);
  const DVec3 side = glm::cross(glm::normalize(up), z);
  if (!(glm::length(side) > 1e-9)) return std::nullopt;
  const DVec3 x = glm::normalize(side), y = glm::cross(z, x);
  const auto row = [&](const DVec3& axis) { return Vec4(Vec3(axis), -glm::dot(axis, eye)); };
  return Affine{{row(x), row(y), row(z)}};
}

std::optional<Affine> read_matrix(TokenStream& tokens) {
  tokens.expect(TokenKind::open, "[ and 16 numbers");
  Affine map;
  bool is_affine = true;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      const double value = tokens.expect_number("a number of a matrix of 16");
      if (row < 3) map.row[row][column] = static_cast<float>(value);
      if (row == 3) is_affine = is_affine && std::abs(value - (column == 3 ? 1 : 0)) <= 1e-5;
    }
  }
  tokens.expect(TokenKind::close, "] after 16 numbers");
  return is_affine ? std::optional(map) : std::nullopt;
}

}  // namespace pt::pbrt
