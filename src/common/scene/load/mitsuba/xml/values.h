// Numbers in attributes.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "common/math/vec.h"
#include "common/scene/load/mitsuba/xml/element.h"

namespace pt::mitsuba {

/// A finite number that a float can hold, or none. Too small a one becomes 0.
std::optional<double> parse_number(std::string_view text);

/// Numbers apart by commas or white space. Throws Error with the element's place.
std::vector<double> parse_numbers(const Element& element, std::string_view text);

/// The number in attribute `name`, or `fallback` where there is none. Throws Error.
double number_attribute(const Element& element, std::string_view name, double fallback);

/// x, y and z, or the three numbers of `value`, of which one stands for all. Throws Error.
Vec3 vector_attributes(const Element& element, double fallback);

/// The three numbers in attribute `name`. Throws Error.
Vec3 vector_attribute(const Element& element, std::string_view name);

}  // namespace pt::mitsuba
