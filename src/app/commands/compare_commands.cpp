// Images compared: `ptexp compare` with a reference, `ptexp verify` with what is rendered again.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "app/commands/commands.h"
#include "app/render/make_renderer.h"
#include "app/report/film_header.h"
#include "common/error/error.h"
#include "common/error/terminal.h"
#include "common/film/develop.h"
#include "common/image/atomic_file.h"
#include "common/image/codecs/image_io.h"
#include "common/image/compare/compare.h"
#include "common/image/compare/flip.h"
#include "common/options/option_names.h"
#include "common/render/batches.h"
#include "common/scene/prepare/prepare_scene.h"

namespace pt {
namespace {

/// Windows of the image in random order, which together have at least this share of it.
std::vector<Window> choose_windows(const Window& image, double share) {
  constexpr std::uint32_t side = 16;
  std::vector<Window> windows;
  for (std::uint32_t y = 0; y < image.height; y += side) {
    for (std::uint32_t x = 0; x < image.width; x += side) {
      windows.push_back({image.x + x, image.y + y, std::min(side, image.width - x),
                         std::min(side, image.height - y)});
    }
  }
  std::random_device seed;  // others than the last time
  std::ranges::shuffle(windows, std::mt19937(seed()));
  const double wanted = share * static_cast<double>(image.pixel_count());
  double chosen = 0;
  std::size_t count = 0;
  while (chosen < wanted && count < windows.size()) {
    chosen += static_cast<double>(windows[count++].pixel_count());
  }
  windows.resize(count);
  return windows;
}

/// How many of the window's pixels differ in any bit, and the first of them.
struct Difference {
  std::uint64_t count = 0;
  std::uint32_t x = 0, y = 0;
};

void compare(const Image& image, const Image& again, const Window& window, const Window& whole,
             Difference& difference) {
  for (std::uint32_t y = 0; y < window.height; ++y) {
    for (std::uint32_t x = 0; x < window.width; ++x) {
      const int column = static_cast<int>(window.x - whole.x + x);
      const int row = static_cast<int>(window.y - whole.y + y);
      const float* const a = image.pixel(column, row);
      const float* const b = again.pixel(static_cast<int>(x), static_cast<int>(y));
      if (std::memcmp(a, b, 3 * sizeof(float)) == 0) continue;
      if (difference.count++ == 0) difference.x = window.x + x, difference.y = window.y + y;
    }
  }
}

int samples_of(const ImageMetadata& header, const std::string& file) {
  const auto found = header.find("ptexp.samples_done");
  const int samples = found == header.end() ? 0 : std::atoi(found->second.c_str());
  if (samples > 0) return samples;
  throw Error(file + ": no attribute ptexp.samples_done; expected an image that ptexp finished");
}

ImageDifference compare_files(const std::string& a, const Image& image_a, const std::string& b,
                              const Image& image_b, double tolerance) {
  try {
    return compare_images(image_a, image_b, tolerance);
  } catch (const Error& error) {
    throw Error(fmt::format("cannot compare {} with {}: {}", a, b, error.what()));
  }
}

}  // namespace

int verify_command(const VerifyCommand& command) {
  const std::string& file = command.image;
  if (image_ending(file) != ".exr") {
    throw Error(file + ": its pixels are rounded; expected an .exr, which has all bits");
  }
  ImageMetadata header;
  const Image image = read_image(file, &header);
  Options options = options_in_header(header, file);
  const int samples = samples_of(header, file);
  // Any device of the kind will do.
  if (options.device.kind == DeviceChoice::Kind::cuda) options.device = {options.device.kind, 0};
  if (options.device.kind == DeviceChoice::Kind::cpu) options.device = {options.device.kind, 0};
  options.checkpoint = {}, options.part = {};
  options.time_limit = 0;
  apply_settings(command.settings, file, options);
  if (options.integrator == IntegratorKind::mlt) {
    throw Error(file + ": is of --integrator mlt, whose pixels cannot be rendered one by one");
  }
  const Window whole = window_of(options);
  if (image.width != static_cast<int>(whole.width) ||
      image.height != static_cast<int>(whole.height)) {
    throw Error(fmt::format("{}: has {}x{} pixels, its options say {}x{}", file, image.width,
                            image.height, whole.width, whole.height));
  }
  const DeviceInfo device = choose_devices(options.device, options.threads).front();
  SceneData scene = load_scene(options, device);
  resolve_scene_for(scene, options, device);
  const ExecutionPlan plan = plan_render(options, scene, {device}).front();
  prepare_scene(scene, plan);
  check_same_render(header, file,
                    film_header(options, scene.source_hash, to_string(device.choice.kind)),
                    "this render");
  const std::unique_ptr<Renderer> renderer = make_renderer(plan, scene, device);
  Difference difference;
  std::uint64_t pixels = 0;
  for (const Window& window : choose_windows(whole, command.share)) {
    Film film;
    film.window = window;
    renderer->render(film, samples, {});
    compare(image, renderer->image(), window, whole, difference);
    pixels += window.pixel_count();
  }
  const double percent =
      100.0 * static_cast<double>(pixels) / static_cast<double>(whole.pixel_count());
  print("{}: {} pixels ({:.3g} %) of {} samples rendered again on {}: ", file, pixels, percent,
        samples, device.name);
  if (difference.count == 0) {
    print("all bits are equal\n");
    return 0;
  }
  print("{} differ, the first at {},{}\n", difference.count, difference.x, difference.y);
  return 1;
}

int compare_command(const CompareCommand& command) {
  const auto& [a, b, tolerance, difference_file] = command;
  if (!(tolerance >= 0)) {
    throw Error(fmt::format("tolerance {} of the comparison: expected 0 or more", tolerance));
  }
  if (!difference_file.empty()) check_image_path(difference_file);
  for (const std::string& read : {a, b}) check_not_read("--difference", difference_file, read);
  const Image image_a = read_image(a);
  const Image image_b = read_image(b);
  const ImageDifference difference = compare_files(a, image_a, b, image_b, tolerance);
  const bool is_hdr = image_ending(a) == ".exr" || image_ending(b) == ".exr";
  const std::vector<float> flip = flip_of(image_a, image_b, is_hdr, difference);
  // {} prints a double with the digits that reproduce it.
  print("size                   {}x{}\n", image_b.width, image_b.height);
  print("RMSE                   {}\n", difference.rmse);
  print("relMSE                 {}\n", difference.relative_mse);
  print("{}               {:.6f}\n", is_hdr ? "HDR-FLIP" : "LDR-FLIP", mean_of(flip));
  print("largest difference     {}\n", difference.largest);
  print("differing pixels       {}\n", difference.differing_pixels);
  print("pixels past tolerance  {}\n", difference.pixels_past_tolerance);
  if (!difference_file.empty()) write_difference(difference_file, image_a, image_b, flip);
  return difference.largest > tolerance ? 1 : 0;
}

}  // namespace pt
