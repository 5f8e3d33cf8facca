// <transform>: a sequence of maps.
#pragma once

#include "common/math/transform.h"
#include "common/scene/load/mitsuba/xml/element.h"

namespace pt::mitsuba {

/// The maps of a <transform>, the first applied first: translate, rotate, scale, matrix (16 or 9
/// numbers), lookat. Composed in double precision. Throws Error for what is not one of these, not
/// affine or not finite.
Affine read_transform(const Element& element);

/// The same; a map that cannot be inverted is an Error.
Affine read_invertible_transform(const Element& element);

/// True where the linear part of `map` flattens space, within the precision of its numbers.
bool is_singular(const Affine& map);

}  // namespace pt::mitsuba
