// How far two images are apart, in Python: `ptexp compare`.
#include "common/error/error.h"
#include "common/image/compare/flip.h"
#include "python/arrays.h"
#include "python/module.h"
#include "python/unlocked.h"

namespace pt::python {
namespace {

namespace nb = nanobind;

using PixelsIn = nb::ndarray<const float, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>;

Image image_of(const PixelsIn& pixels) {
  Image image{static_cast<int>(pixels.shape(1)), static_cast<int>(pixels.shape(0)), {}};
  image.rgb.assign(pixels.data(), pixels.data() + pixels.size());
  return image;
}

nb::dict compare(const PixelsIn& a, const PixelsIn& b, double tolerance, bool is_hdr) {
  ImageDifference difference;
  double flip = 0;
  {
    const Unlocked unlocked;
    const Image test = image_of(a), reference = image_of(b);
    difference = compare_images(test, reference, tolerance);
    flip = mean_of(flip_of(test, reference, is_hdr, difference));
  }
  nb::dict result;
  result["rmse"] = difference.rmse;
  result["relative_mse"] = difference.relative_mse;
  result["flip"] = flip;
  result["largest"] = difference.largest;
  result["differing_pixels"] = difference.differing_pixels;
  result["pixels_past_tolerance"] = difference.pixels_past_tolerance;
  return result;
}

}  // namespace

void add_compare(nb::module_& m) {
  m.def("compare", compare, nb::arg("a"), nb::arg("b"), nb::arg("tolerance"), nb::arg("is_hdr"));
}

}  // namespace pt::python
