#include "common/scene/mitsuba/surfaces.h"

#include <fmt/format.h>

#include <map>

#include "common/scene/mitsuba/surface_kinds.h"

namespace pt::mitsuba {
namespace {

using Reader = Surface (*)(Context&, const Object&);

const std::map<std::string_view, Reader>& readers() {
  static const std::map<std::string_view, Reader> table = {
      {"diffuse", read_diffuse},
      {"lambertian", read_diffuse},
      {"roughdiffuse", read_rough_diffuse},
      {"plastic", read_plastic},
      {"roughplastic", read_rough_plastic},
      {"phong", read_phong},
      {"ward", read_ward},
      {"dielectric", read_dielectric},
      {"roughdielectric", read_rough_dielectric},
      {"thindielectric", read_thin_dielectric},
      {"conductor", read_conductor},
      {"roughconductor", read_rough_conductor},
      {"principled", read_principled},
      {"principledthin", read_principled_thin},
      {"twosided", read_two_sided},
      {"mask", read_mask},
      {"opacity", read_mask},
      {"bumpmap", read_bump_map},
      {"bump", read_bump_map},
      {"normalmap", read_normal_map},
      {"coating", read_wrapper},
      {"roughcoating", read_wrapper},
      {"blendbsdf", read_blend},
      {"mixturebsdf", read_mixture},
      {"null", read_null},
  };
  return table;
}

}  // namespace

void report_replaced(Context& context, const Object& bsdf, std::string_view by) {
  context.warn_once("bsdf " + bsdf.type(), bsdf.element(),
                    fmt::format("bsdf '{}' is not supported: {}", bsdf.type(), by));
}

Surface read_surface(Context& context, const Object& bsdf) {
  const auto reader = readers().find(bsdf.type());
  if (reader != readers().end()) return reader->second(context, bsdf);
  report_replaced(context, bsdf, "diffuse grey is used");
  return diffuse_of({Color(0.5f)});
}

}  // namespace pt::mitsuba
