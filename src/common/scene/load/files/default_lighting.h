// Light for files that bring none, and a small picture that tells whether they need it.
#pragma once

#include <string>

#include "common/image/image.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/load_options.h"

namespace pt {

/// For warnings: what is used where a file has no light.
inline constexpr const char* default_lighting_text =
    "default lighting (bright behind and above the camera; --default-lighting off leaves it out)";

/// Radiance from `direction` (a unit vector) in the lighting's own space, where the camera looks
/// towards -z and +y is up in the image: grey, a little darker below, and a broad, soft light from
/// above on the camera's left side and behind it. So white stands out from what is behind it, and
/// so does black.
float default_radiance(const Vec3& direction);

/// Makes it the scene's environment, rotated with the camera, and asks for a measured
/// exposure.
void add_default_lighting(SceneData& scene);

/// Gives a model (glTF, OBJ, PLY), which has its camera, default lighting where it needs that or
/// `options` want it. A model needs it where nothing lights it or, by a small picture through its
/// camera and through the one that `options` make of it, its own lights leave black what is seen:
/// emission alone where less than half of the surfaces get any, lights of KHR_lights_punctual where
/// none does. Returns what is to be said about it; empty: nothing. `is_framed`: the file has no
/// camera.
std::string light_model(const LoadOptions& options, bool is_framed, SceneData& scene);

/// What is to be said about the light of a file in another format, to which default lighting is
/// added where `options` want it.
std::string light_scene(const LoadOptions& options, SceneData& scene);

// What light a scene gets: a small picture of it, traced on the CPU before anything is rendered.

/// Incident radiance, as a surface weighs it, that counts as light.
struct LitRule {
  float least = 0;         ///< W / (m^2 sr)
  float part_of_mean = 0;  ///< and this part of the mean over the picture
};

struct Glimpse {
  Image picture;         ///< radiance, emission included
  double lit_share = 1;  ///< of the pixels of surfaces that reflect and do not shine themselves:
                         ///< those that are lit; 1 where no such surface is seen

  bool is_luminous = false;  ///< no such surface is seen
};

/// Estimates the light in a scene that no renderer has prepared, with the same result on every
/// machine: 32 x 32 pixels, 32 Sobol samples each, paths of 5 rays.
class LightEstimate {
 public:
  /// Prepares a copy of the scene. Throws Error where it cannot be rendered.
  explicit LightEstimate(const SceneData& scene);

  /// `camera` describes one (check_camera) and has the far plane of the scene's own.
  Glimpse look(const CameraParameters& camera, const LitRule& rule);

 private:
  SceneData scene_;
};

}  // namespace pt
