#include "common/scene/load/mitsuba/surfaces/surfaces.h"

#include <fmt/format.h>

#include <map>

#include "common/scene/load/mitsuba/surfaces/surface_kinds.h"

namespace pt::mitsuba {
namespace {

using Reader = Surface (*)(Context&, const Object&);

const std::map<std::string_view, Reader>& readers() {
#define PT_MITSUBA_SURFACE(name, read) {name, read},
  static const std::map<std::string_view, Reader> table = {PT_MITSUBA_SURFACES(PT_MITSUBA_SURFACE)};
#undef PT_MITSUBA_SURFACE
  return table;
}

}  // namespace

void report_replaced(Context& context, const Object& bsdf, std::string_view by) {
  context.warn_once("bsdf " + bsdf.type(), bsdf.element(),
                    fmt::format("bsdf '{}' is not supported: {}", bsdf.type(), by));
}

// Each once, although others may hold it 2^n times.
Surface read_surface(Context& context, const Object& bsdf) {
  if (const auto found = context.surfaces.find(&bsdf); found != context.surfaces.end()) {
    return *found->second;
  }
  const auto reader = readers().find(bsdf.type());
  if (reader == readers().end()) report_replaced(context, bsdf, "diffuse grey is used");
  const Surface surface =
      reader == readers().end() ? diffuse_of({Color(0.5f)}) : reader->second(context, bsdf);
  context.surfaces.emplace(&bsdf, std::make_shared<const Surface>(surface));
  return surface;
}

std::vector<std::string> surface_types() {
  std::vector<std::string> types;
  for (const auto& entry : readers()) types.emplace_back(entry.first);
  return types;
}

}  // namespace pt::mitsuba
