// Images that must be equal bit for bit: how to render them, vary their options and compare them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "app/options/option_list.h"
#include "app/options/option_values.h"
#include "app/render/make_renderer.h"
#include "common/error/error.h"
#include "common/options/option_names.h"
#include "common/plan/execution_plan.h"
#include "common/scene/builtin/builtin_scenes.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/scene/prepare/prepare_steps.h"
#include "make_render.h"
#include "statistics.h"

namespace pt {

/// Values of options as on the command line: {"spp", "5"}.
using Settings = std::vector<std::pair<std::string, std::string>>;

inline void apply(Options& options, const Settings& settings) {
  for (const auto& [name, value] : settings) find_option(name).set(options, value);
}

inline Options with(Options options, const Settings& settings) {
  apply(options, settings);
  return options;
}

/// What differs from the defaults, as a command line.
inline std::string command_of(const Options& options) {
  std::string command = "ptexp";
  for (const OptionEntry& entry : option_list()) {
    const std::string value = entry.text(options);
    if (value != entry.text(Options())) command += " --" + entry.name + " " + value;
  }
  return command;
}

inline Options cuda_options(const std::string& mode, const Settings& settings = {}) {
  Options options = with(Options(), settings);
  apply(options, {{"device", "cuda"}, {"mode", mode}});
  return options;
}

/// Whether a plan accepts the options: what it refuses has tests of its own (tests/plan).
inline bool has_plan(const Options& options, SceneData scene) {
  const DeviceInfo device = choose_device(options.device);
  try {
    resolve_scene(scene, options);
    plan_execution(options, scene.properties, device.properties);
  } catch (const Error&) {
    return false;
  }
  return true;
}

inline bool has_plan(const Options& options) { return has_plan(options, build_scene(options)); }

/// The variations of the options that a plan accepts.
inline std::vector<Settings> planned(const Options& options, std::vector<Settings> variations) {
  std::erase_if(variations, [&](const Settings& more) { return !has_plan(with(options, more)); });
  EXPECT_FALSE(variations.empty());
  return variations;
}

struct Rendered {
  Image image;
  PathCounts counts;
  RenderRun run;
};

inline RenderReport report_of(const Renderer& renderer) {
  RenderReport report;
  renderer.describe(report);
  return report;
}

/// Of a render with these options.
inline RenderReport report_of(const Options& options) {
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  const auto renderer = make_renderer(options, scene, device);
  renderer->render({});
  return report_of(*renderer);
}

inline Rendered take_image(Renderer& renderer, const RenderHooks& hooks = {}) {
  Rendered result;
  result.run = renderer.render(hooks);
  result.image = renderer.image();
  result.counts = report_of(renderer).counts;
  return result;
}

inline Rendered render_options(const Options& options, const RenderHooks& hooks = {}) {
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  return take_image(*make_renderer(options, scene, device), hooks);
}

/// What an option's or a scene's error says.
inline std::string refusal_of(const Settings& settings) {
  try {
    render_options(with(Options(), settings));
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

inline void expect_same_counts(const PathCounts& found, const PathCounts& expected) {
  EXPECT_EQ(found.paths, expected.paths);
  EXPECT_EQ(found.rays, expected.rays);
  EXPECT_EQ(found.shadow_rays, expected.shadow_rays);
  EXPECT_EQ(found.nonfinite_samples, expected.nonfinite_samples);
  EXPECT_EQ(found.live_paths, expected.live_paths);
}

/// Pixels of which any bit differs; with images of different sizes, all of them.
inline std::size_t differing_pixels(const Image& a, const Image& b) {
  const std::size_t pixels = static_cast<std::size_t>(a.width) * static_cast<std::size_t>(a.height);
  if (a.width != b.width || a.height != b.height) return pixels;
  std::size_t count = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    count += std::memcmp(&a.rgb[3 * i], &b.rgb[3 * i], 3 * sizeof(float)) != 0;
  }
  return count;
}

inline void expect_same(const Rendered& found, const Rendered& expected) {
  EXPECT_EQ(differing_pixels(found.image, expected.image), 0u) << "pixels differ";
  EXPECT_EQ(found.run.samples_done, expected.run.samples_done);
  expect_same_counts(found.counts, expected.counts);
}

/// Nothing is counted twice or forgotten, and there is something in the image.
inline void expect_plausible(const Rendered& rendered, const Options& options) {
  const PathCounts& counts = rendered.counts;
  const auto paths = static_cast<std::uint64_t>(options.width) *
                     static_cast<std::uint64_t>(options.height) *
                     static_cast<std::uint64_t>(options.spp);
  EXPECT_EQ(counts.paths, paths);
  EXPECT_EQ(counts.nonfinite_samples, 0u);
  ASSERT_FALSE(counts.live_paths.empty());
  EXPECT_EQ(counts.live_paths[0], paths);
  std::uint64_t rays = 0;
  for (const std::uint64_t live : counts.live_paths) rays += live;
  EXPECT_EQ(counts.rays, rays);
  double sum = 0;
  for (const float value : rendered.image.rgb) sum += value;
  EXPECT_GT(sum, 0.04 * static_cast<double>(rendered.image.rgb.size()));
}

/// An option that must not change the image, with values of all kinds; the first is usual.
struct Choice {
  std::string option;
  std::vector<std::string> values;
};

/// The names of all values for which takes(value), the usual one first: whatever an option's table
/// has is tested unasked.
template <NamedEnum E, class Takes>
std::vector<std::string> names_where(E usual, const Takes& takes) {
  std::vector<std::string> names{to_string(usual)};
  for (const EnumName<E>& entry : enum_names<E>) {
    if (entry.value != usual && takes(entry.value)) names.emplace_back(entry.name);
  }
  return names;
}

/// Likewise, of all values but some.
template <NamedEnum E>
std::vector<std::string> names_of(E usual, std::initializer_list<E> without = {}) {
  return names_where(usual, [&](E value) {
    return std::find(without.begin(), without.end(), value) == without.end();
  });
}

/// The names of all values but the usual one.
template <NamedEnum E>
std::vector<std::string> names_besides(E usual) {
  std::vector<std::string> names = names_of(usual);
  names.erase(names.begin());
  return names;
}

/// Structures of ours, all of which give the same hits; Embree rounds in its own way, and OptiX has
/// tests of its own.
inline std::vector<std::string> structures(AccelKind usual,
                                           std::initializer_list<AccelKind> without = {}) {
  return names_where(usual, [&](AccelKind accel) {
    return accel != AccelKind::automatic && accel != AccelKind::embree &&
           accel != AccelKind::optix &&
           std::find(without.begin(), without.end(), accel) == without.end();
  });
}

/// Each choice varied alone, then `combinations` random ones of all.
inline std::vector<Settings> variations(const std::vector<Choice>& choices, int combinations,
                                        std::uint64_t seed) {
  Settings usual;
  for (const Choice& choice : choices) usual.emplace_back(choice.option, choice.values.front());
  std::vector<Settings> all{usual};
  for (std::size_t i = 0; i < choices.size(); ++i) {
    for (std::size_t k = 1; k < choices[i].values.size(); ++k) {
      all.push_back(usual);
      all.back()[i].second = choices[i].values[k];
    }
  }
  TestRandom random(seed);
  for (int i = 0; i < combinations; ++i) {
    all.emplace_back();
    for (const Choice& choice : choices) {
      const auto n = static_cast<std::uint32_t>(choice.values.size());
      all.back().emplace_back(choice.option, choice.values[random.below(n)]);
    }
  }
  return all;
}

/// Renders each variation of `options` and compares it with `reference`, which is rendered as it
/// stands. Two seeds take turns: a sample that nobody writes would else keep its right value from
/// the render before, whose memory the next one gets.
inline void expect_all_same(const Options& options, const std::vector<Settings>& settings,
                            Options reference) {
  std::vector<Rendered> expected;
  for (std::size_t i = 0; i < settings.size(); ++i) {
    if (i < 2) {
      expected.push_back(render_options(reference));
      expect_plausible(expected.back(), reference);
      ++reference.seed;
    }
    Options varied = with(options, settings[i]);
    varied.seed += i % 2;
    SCOPED_TRACE(command_of(varied));
    expect_same(render_options(varied), expected[i % 2]);
    if (testing::Test::HasFailure()) return;
  }
}

/// Values that change the image: each is compared with a reference of its own.
struct ImageKind {
  std::string name;  ///< of a test
  Settings settings;
};

inline void PrintTo(const ImageKind& kind, std::ostream* out) { *out << kind.name; }

}  // namespace pt
