#include "common/render/dispatch.h"

#include <fmt/format.h>

#include "common/error/error.h"

namespace pt {
namespace {

const char* name_of(Geometry geometry) {
  switch (geometry) {
    case Geometry::spheres_and_quads:
      return "spheres and quads";
    case Geometry::triangles:
      return "triangles";
    case Geometry::mixed:
      return "triangles and others";
  }
  return "?";
}

const char* name_of(Lighting lighting) {
  switch (lighting) {
    case Lighting::sky:
      return "sky";
    case Lighting::emitters:
      return "emitters";
    case Lighting::full:
      return "all kinds";
  }
  return "?";
}

}  // namespace

void throw_no_kernel(const SceneTraits& traits) {
  throw Error(fmt::format(
      "no kernel for a scene with --accel {}, geometry: {}, lights: {}{}; expected a row of "
      "--list-kernels",
      accel_name(traits.accel), name_of(traits.geometry), name_of(traits.lighting),
      traits.has_motion   ? traits.has_media ? ", motion, masks, media" : ", motion"
      : traits.has_sparse ? ", media, sparse grids"
      : traits.has_media  ? ", media"
      : traits.has_masks  ? ", masks"
                          : ""));
}

}  // namespace pt
