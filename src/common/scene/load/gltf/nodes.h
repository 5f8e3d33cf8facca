// The hierarchy of nodes: animations, where everything is, cameras and lights
// (KHR_lights_punctual).
#pragma once

#include <unordered_map>
#include <vector>

#include "common/geometry/bounds.h"
#include "common/math/transform.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/load/gltf/document.h"

namespace pt::gltf {

struct PlacedNode {
  int node = 0;  ///< number in the file
  Affine to_world;
  std::vector<TransformKey> keys = {};  ///< while the shutter is open, if it moves
};

/// "nodes[7]"
std::string node_place(int node);

/// Evaluates the animations that the options choose, at their time plus `after_s`: translation,
/// rotation, scale and weights of the file's nodes become what they are then. A channel that cannot
/// be used is left out; so are, without a time, all of them. Both are reported. Throws Error for
/// accessors that are malformed and for an animation that the file lacks.
void pose_nodes(File& file, const LoadOptions& options, float after_s = 0.0f);

/// All nodes of the default scene, parents before their children, in the order of the file. A node
/// that is its own ancestor or has two parents is placed once, a part of a transformation that
/// cannot be used is left out, and a node that no number can place is lost with its children; each
/// is reported.
std::vector<PlacedNode> place_nodes(File& file);

/// Steps between the times of keys while the shutter is open.
inline constexpr std::size_t shutter_steps = 16;

/// Nodes while the shutter is open.
struct MovingNodes {
  struct Then {
    std::unordered_map<int, Affine> places;                ///< by number of a node
    std::unordered_map<int, std::vector<double>> weights;  ///< of morph targets, likewise
  };

  std::vector<PlacedNode> nodes;
  std::vector<Then> later;  ///< at the times of keys but the first; empty without --shutter
};

/// pose_nodes() and place_nodes() at the options' time; with --shutter also at times until it
/// closes, of which those nodes that move get keys.
MovingNodes place_moving_nodes(File& file, const LoadOptions& options);

// Cameras.

/// Sets the scene's camera and the image's shape from the first node with a camera; false if there
/// is none. `bounds` are the scene's: the camera is focused on their middle.
bool set_camera(File& file, const std::vector<PlacedNode>& nodes, const Bounds& bounds,
                SceneData& scene);

// KHR_lights_punctual.

/// Adds the lights of the nodes to the scene. Their units are photometric, so that the exposure
/// must be measured.
void add_lights(File& file, const std::vector<PlacedNode>& nodes, SceneData& scene);

}  // namespace pt::gltf
