// Polynomials through measured values.
#pragma once

#include <array>
#include <vector>

#include "common/material/rough_plastic.h"

namespace pt {

inline constexpr std::size_t polynomial_terms = RoughPlastic::terms;

using Polynomial = std::array<double, polynomial_terms>;  ///< the constant first

/// y(x), with the largest relative error as small as 40 rounds of least squares make it, whose
/// weights grow where the error is large (Lawson 1961). Values below 0.05 count as that much.
Polynomial fit_polynomial(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace pt
