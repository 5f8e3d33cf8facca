// Small images through the serial renderer.
#pragma once

#include <gtest/gtest.h>

#include "make_render.h"

namespace pt {

struct Render {
  Image image;
  PathCounts counts;
};

/// Also checks that every path was taken and that all samples are finite.
inline Render render(const SceneData& scene, const Options& options) {
  Options own = options;
  own.mode = Mode::serial;
  const auto renderer = make_renderer(own, scene, choose_device({DeviceChoice::Kind::cpu, 0}));
  renderer->render({});
  RenderReport report;
  renderer->describe(report);
  EXPECT_EQ(report.counts.nonfinite_samples, 0u) << scene.name;
  EXPECT_EQ(report.counts.paths,
            static_cast<std::uint64_t>(options.width) * options.height * options.spp);
  return {renderer->image(), report.counts};
}

inline Options image_options(int width, int height, int spp, int max_depth = 50) {
  Options options;
  options.width = width, options.height = height, options.spp = spp, options.max_depth = max_depth;
  return options;
}

}  // namespace pt
