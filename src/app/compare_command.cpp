#include "app/compare_command.h"

#include <fmt/format.h>

#include <vector>

#include "common/error/error.h"
#include "common/error/terminal.h"
#include "common/image/atomic_file.h"
#include "common/image/codecs/image_io.h"
#include "common/image/compare/compare.h"
#include "common/image/compare/flip.h"

namespace pt {
namespace {

ImageDifference compare_files(const std::string& a, const Image& image_a, const std::string& b,
                              const Image& image_b, double tolerance) {
  try {
    return compare_images(image_a, image_b, tolerance);
  } catch (const Error& error) {
    throw Error(fmt::format("cannot compare {} with {}: {}", a, b, error.what()));
  }
}

}  // namespace

int compare_command(const std::string& a, const std::string& b, double tolerance,
                    const std::string& difference_file) {
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
