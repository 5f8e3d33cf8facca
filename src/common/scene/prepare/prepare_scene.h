// From what a loader or generator made to what a renderer takes.
#pragma once

#include "common/plan/execution_plan.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Applies the options' camera overrides, chooses the kind of scene and its acceleration structure,
/// builds it (unless --builder leaves the triangles' tree to the device), lists the lights. Throws
/// Error for a camera or a scene that cannot be rendered and for options that it cannot have.
/// Its structure is what a plan for this device says (plan/execution_plan.h).
void prepare_scene(SceneData& scene, const Options& options, const DeviceProperties& device);

/// Of a scene that is prepared: gives it this camera, by these options. False: the scene has to be
/// prepared anew, since its structure was chosen for cameras of another kind; it is of no use then.
/// Throws Error as prepare_scene does.
bool move_camera(SceneData& scene, const CameraParameters& camera, const Options& options);

/// For the kind of device that the options name, of the usual properties.
void prepare_scene(SceneData& scene, const Options& options);

/// A view of `scene` in host memory, valid while `scene` is neither changed nor destroyed.
Scene host_view(const SceneData& scene, int width, int height);

}  // namespace pt
