// Reconstruction filters: what --filter and scene files name becomes a table to draw from.
#pragma once

#include <cmath>
#include <numbers>

#include "common/options/options.h"
#include "common/scene/data/scene_data.h"

namespace pt {

struct FilterInfo {
  FilterKind kind;
  int parameter_count;  ///< 1: `a`; 2: `b` as well
  float lowest, highest;
  bool is_whole;                   ///< parameters are whole numbers
  float a, b;                      ///< unless others are given
  const char *parameters, *range;  ///< for the command line
  double (*radius)(const FilterChoice& filter);
  /// f(x) for x from 0 to the radius, in pixels from the centre, not normalised.
  double (*value)(const FilterChoice& filter, double x);
};

namespace filters {

inline double sinc(double x) {
  const double angle = std::numbers::pi * x;
  return std::abs(angle) < 1e-6 ? 1.0 - angle * angle / 6.0 : std::sin(angle) / angle;
}

inline double mitchell(double x, double b, double c) {
  if (x < 1) {
    return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6;
  }
  return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x +
          (8 * b + 24 * c)) /
         6;
}

inline double first_parameter(const FilterChoice& filter) { return filter.a; }

}  // namespace filters

/// The gaussian is cut off at 4 sigma and lowered so that it is 0 there. Mitchell: the cubic with B
/// and C of Mitchell and Netravali, Reconstruction Filters in Computer Graphics, 1988.
inline constexpr FilterInfo filter_table[] = {
    {FilterKind::box, 1, 0.01f, 32.0f, false, 0.5f, 0.0f, ":RADIUS", "0.01 to 32 pixels",
     filters::first_parameter, [](const FilterChoice&, double) { return 1.0; }},
    {FilterKind::tent, 1, 0.01f, 32.0f, false, 1.0f, 0.0f, ":RADIUS", "0.01 to 32 pixels",
     filters::first_parameter, [](const FilterChoice& f, double x) { return 1.0 - x / f.a; }},
    {FilterKind::gaussian, 1, 0.01f, 8.0f, false, 0.5f, 0.0f, ":DEVIATION", "0.01 to 8 pixels",
     [](const FilterChoice& f) { return 4.0 * f.a; },
     [](const FilterChoice& f, double x) {
       return std::exp(-0.5 * x * x / (double{f.a} * f.a)) - std::exp(-8.0);
     }},
    {FilterKind::mitchell, 2, -3.0f, 3.0f, false, 1.0f / 3.0f, 1.0f / 3.0f, ":B:C", "-3 to 3 each",
     [](const FilterChoice&) { return 2.0; },
     [](const FilterChoice& f, double x) { return filters::mitchell(x, f.a, f.b); }},
    {FilterKind::lanczos, 1, 1.0f, 8.0f, true, 3.0f, 0.0f, ":LOBES", "a whole number from 1 to 8",
     filters::first_parameter,
     [](const FilterChoice& f, double x) { return filters::sinc(x) * filters::sinc(x / f.a); }}};

constexpr const FilterInfo& filter_info(FilterKind kind) {
  return filter_table[static_cast<int>(kind)];
}

static_assert([] {
  for (const FilterInfo& info : filter_table) {
    if (&filter_info(info.kind) != &info) return false;
  }
  return true;
}());

/// f(x), x in pixels from the centre, not normalised (filters.h). 0 beyond filter_radius.
double filter_value(const FilterChoice& filter, double x);
double filter_radius(const FilterChoice& filter);

/// The parameters that a filter has unless others are given.
FilterChoice default_filter(FilterKind kind);

/// The options' choice, else the scene file's, else a box of one pixel.
FilterChoice filter_of(const Options& options, const SceneData& scene);

/// Fills in `filter` and its table. Throws Error for a filter whose negative part outweighs the
/// positive one.
void prepare_filter(SceneData& scene, const FilterChoice& filter);

}  // namespace pt
