// Small images of loaded scenes.
#pragma once

#include <vector>

#include "common/scene/prepare/prepare_scene.h"
#include "render_serial.h"
#include "statistics.h"

namespace pt {

/// Means of the image's channels and their standard errors, by its pixels.
struct ChannelMeans {
  MeanEstimate of[3];
};

inline ChannelMeans channel_means(SceneData scene, int side, int spp, int max_depth = 1000) {
  Options options = image_options(side, side, spp, max_depth);
  options.filter = FilterChoice();
  prepare_scene(scene, options);
  const Image image = render(scene, options).image;
  ChannelMeans means;
  for (std::size_t i = 0; i < image.rgb.size(); ++i) means.of[i % 3].add(double{image.rgb[i]});
  return means;
}

}  // namespace pt
