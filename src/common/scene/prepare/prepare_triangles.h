// Scenes with triangles made ready for tracing.
#pragma once

#include "common/accel/build/build_triangle_tree.h"
#include "common/plan/execution_plan.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Turns quads into triangles, builds the plan's structure over them, collects the vertices'
/// attributes, the lights, the environment, and sets the traits. Throws Error for what cannot be
/// built.
void prepare_triangles(SceneData& scene, const ExecutionPlan& plan);

/// What tree is to be built for a structure, on either device. Embree, which builds its own, wants
/// the triangles alone.
TreeOptions tree_options(Accel accel, TreeBuilder builder);

/// Replaces the scene's quads by meshes of two triangles each, one mesh per material.
void convert_quads(SceneData& scene);

}  // namespace pt
