// The built-in scenes that are made of quads and spheres, and scenes whose light few paths find:
// what Metropolis light transport is for.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// Goral et al. 1984, with the measured reflectances rounded as in the Cornell Box of most papers.
SceneData make_cornell_scene();

/// The Cornell Box filled with fog, a homogeneous medium that ends at its open side.
SceneData make_fog_scene();

/// Everything here emits e and reflects 1 - e of what arrives, so every ray carries radiance 1.
SceneData make_furnace_scene();

/// Where the rooms of make_ajar_scene() meet; lengths in metres. The wall between them is the plane
/// z = 0, the camera's room is where z > 0.
struct AjarDoorway {
  static constexpr float left = -0.45f, right = 0.45f, height = 2.0f;
  static constexpr float lamp_height = 2.1f;  ///< of a lamp that shines upward
};

/// A room that gets its light through the gap of a door alone, as in the scene of Veach and Guibas
/// 1997. The lamp stands in the room behind. It shines upward and higher than the doorway, so that
/// no point of the camera's room sees its bright side: whatever arrives there was reflected in the
/// other room.
SceneData make_ajar_scene();

/// A glass ball above a floor and a ring of mirrors on it, under one small lamp. The light that
/// both focus on the floor, within the ball's shadow and within the ring, comes by specular paths,
/// which end at the lamp only by chance.
SceneData make_caustic_scene();

}  // namespace pt
