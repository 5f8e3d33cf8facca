// From what a loader or generator made to what a renderer takes.
#pragma once

#include "common/render/options.h"
#include "common/scene/scene_data.h"

namespace pt {

/// Applies the options' camera overrides, chooses the kind of scene and its acceleration structure,
/// builds it (unless --builder leaves the triangles' tree to the device), lists the lights. Throws
/// Error for a camera or a scene that cannot be rendered and for options that it cannot have.
void prepare_scene(SceneData& scene, const Options& options);

/// A view of `scene` in host memory, valid while `scene` is neither changed nor destroyed.
Scene host_view(const SceneData& scene, int width, int height);

}  // namespace pt
