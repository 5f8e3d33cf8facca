// Scenes and renderers made at once from options, as tests want them.
#pragma once

#include "app/render/make_renderer.h"
#include "common/scene/prepare/prepare_scene.h"

namespace pt {

inline ExecutionPlan plan_for(const Options& options, const SceneData& scene,
                              const DeviceInfo& device) {
  DeviceChoice choice = device.choice;
  if (options.mode == Mode::serial) choice = {DeviceChoice::Kind::cpu, 0};
  return plan_render(options, scene, choose_devices(choice, options.threads)).front();
}

inline void prepare_scene_for(SceneData& scene, const Options& options, const DeviceInfo& device) {
  resolve_scene(scene, options);
  prepare_scene(scene, plan_for(options, scene, device));
}

inline SceneData make_scene_for(const Options& options, const DeviceInfo& device,
                                const Warn& warn = {}) {
  SceneData scene = load_scene(options, device, warn);
  resolve_scene_for(scene, options, device, warn);
  prepare_scene(scene, plan_for(options, scene, device));
  return scene;
}

/// By a new plan that keeps the structure of the prepared scene.
inline std::unique_ptr<Renderer> make_renderer(const Options& options, const SceneData& scene,
                                               const DeviceInfo& device) {
  return make_renderer(plan_for(options, scene, device), scene, device);
}

}  // namespace pt
