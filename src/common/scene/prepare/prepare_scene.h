// From what a loader or generator made to what a renderer takes: resolve_scene, then a plan
// (plan/execution_plan.h), then prepare_scene.
#pragma once

#include "common/plan/execution_plan.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Leaves everything where its motion begins; before resolve_scene.
void hold_still(SceneData& scene);

/// Leaves everything where it is at a time, in seconds; before resolve_scene. Throws Error for a
/// motion that is none.
void hold_still_at(SceneData& scene, float time);

/// Applies what the options say of the scene (camera, filter, multiple scattering), packs materials
/// and media, and fills in SceneData::properties, on which a plan depends. Throws Error for an
/// empty scene and for a camera, a medium or a material that cannot be rendered.
void resolve_scene(SceneData& scene, const Options& options);

/// Leaves everything where its motion begins, in a resolved scene.
void hold_still(SceneData& scene, const Options& options);

/// Builds a resolved scene's acceleration structure (unless the plan's builder runs on the device)
/// and lists its lights. Throws Error for what cannot be built.
void prepare_scene(SceneData& scene, const ExecutionPlan& plan);

/// Whether a scene that is prepared for one of the plans has the tree and kernels of the other.
bool has_same_structure(const ExecutionPlan& a, const ExecutionPlan& b);
/// The same, and its lists of lights.
bool prepares_alike(const ExecutionPlan& a, const ExecutionPlan& b);

/// Both, with a plan for the kind of device that the options name, of the usual properties.
void prepare_scene(SceneData& scene, const Options& options = {});

/// Gives a prepared scene this camera, by these options. Returns false where the scene has to be
/// resolved and prepared anew, since its structure was chosen for cameras of another kind; it is of
/// no use then. Throws Error as resolve_scene does.
bool move_camera(SceneData& scene, const CameraParameters& camera, const Options& options);

/// Takes over what has changed of `source`, which `scene` is a prepared copy of, as far as
/// resolve_scene would. `changes.camera`: also by options. Returns false where the scene has to be
/// resolved and prepared anew, since its structure was chosen for other materials, or spheres or
/// media depend on what has moved; it is of no use then. Throws Error as resolve_scene does.
bool resolve_changes(SceneData& scene, const SceneData& source, const SceneChanges& changes,
                     const Options& options);

/// Prepares again what depends on the changes that were resolved, for a plan that
/// has_same_structure: the lists of lights, the tree over instances, or, refitted, that over
/// triangles. It is built anew where its cost has grown by a third from `built_cost`, its
/// TreeFacts::sah_cost when it was built. `tree` and `built_cost` become those of the scene as it
/// is now. The image's bits are those of a scene that is prepared anew.
void prepare_changes(SceneData& scene, const SceneChanges& changes, const ExecutionPlan& plan,
                     TreeFacts& tree, double& built_cost);

/// A view of `scene` in host memory, valid while `scene` is neither changed nor destroyed.
Scene host_view(const SceneData& scene, int width, int height);

/// The properties of a scene whose materials and media are prepared. `structure` is for
/// prepare_scene() to fill in.
SceneProperties properties_of(const SceneData& scene);

/// Whether the scene has nothing that the paper's have not.
bool has_primitives_only(const SceneData& scene);

}  // namespace pt
