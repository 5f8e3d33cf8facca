// Camera, film, filter, sampler and integrator: the camera and the defaults of a scene.
#pragma once

#include "common/scene/load/pbrt/syntax/context.h"

namespace pt::pbrt {

/// Before lights and shapes, as the film's imaging ratio multiplies all light. Without a camera the
/// scene's is left as it is.
void read_view(Context& context);

/// The camera, into the scene; its shutter's time, which exposes the film.
void read_camera(Context& context, const Entity& camera);

}  // namespace pt::pbrt
