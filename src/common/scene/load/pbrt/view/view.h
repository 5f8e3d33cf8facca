// Camera, film, filter, sampler and integrator: the camera and the defaults of a scene.
#pragma once

#include "common/scene/load/pbrt/colors/context.h"

namespace pt::pbrt {

/// Before lights and shapes, as the film's imaging ratio multiplies all light. Without a camera the
/// scene's is left as it is.
void read_view(Context& context);

// Defaults of the scene.
void read_filter(Context& context, const Entity& filter);
void read_sampler(Context& context, const Entity& sampler);
void read_integrator(Context& context, const Entity& integrator);

/// The camera, into the scene; its shutter's time, which exposes the film.
void read_camera(Context& context, const Entity& camera);

}  // namespace pt::pbrt
