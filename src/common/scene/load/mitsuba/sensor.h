// <sensor>, with its film and sampler, and <integrator>: camera and defaults of a scene.
#pragma once

#include "common/scene/load/mitsuba/xml/context.h"

namespace pt::mitsuba {

/// `perspective`, `thinlens` or `orthographic` as the scene's camera; other sensors become a
/// pinhole with a warning. Width, height and samples per pixel become defaults.
void read_sensor(Context& context, const Object& sensor);

/// The angle of view of a sensor or a projector, along the axis that the file fixes, whatever the
/// image's final size.
void read_fov(const Object& sensor, CameraParameters& camera);

/// max_depth, rr_depth and hide_emitters; every integrator becomes a path tracer.
void read_integrator(Context& context, const Object& integrator);

}  // namespace pt::mitsuba
