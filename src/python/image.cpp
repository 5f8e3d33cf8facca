// Image in Python, and how far two images differ.
#include <fmt/format.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstring>
#include <map>
#include <tuple>

#include "app/options/option_values.h"
#include "common/error/error.h"
#include "common/image/codecs/image_codec.h"
#include "common/image/compare/flip.h"
#include "python/arrays.h"
#include "python/image_object.h"
#include "python/module.h"
#include "python/unlocked.h"

namespace pt::python {

Image& ImageObject::image() {
  const std::lock_guard lock(mutex_);
  if (result_.device_image && result_.image.rgb.empty())
    result_.image.rgb = result_.device_image->download();
  return result_.image;
}

RenderReport ImageObject::report() {
  const std::lock_guard lock(mutex_);
  return result_.report;
}

std::string ImageObject::statistics() {
  const RenderReport now = report();
  return now.runs.empty() ? "" : report_json(result_.options, now);
}

std::string ImageObject::table() {
  const RenderReport now = report();
  return now.runs.empty() ? "" : report_table(result_.options, now);
}

std::optional<Exposure> ImageObject::exposure_of(const std::string& path,
                                                 const std::string& exposure) {
  const ExposureChoice choice =
      exposure.empty() ? result_.options.exposure : parse_exposure("exposure", exposure);
  return exposure_for(path, choice, image(), result_.measures_exposure);
}

std::string ImageObject::srgb(const std::string& exposure) {
  return quantize(image(), {exposure_of("image.png", exposure)->stops}, srgb_curve);
}

std::string ImageObject::png(const std::string& exposure) {
  return encode_png_fast(image(), {exposure_of("image.png", exposure)->stops});
}

namespace {

constexpr const char* measured_by_default = "scene";  // by the scene, which is not kept

}  // namespace

std::string ImageObject::default_exposure() const {
  const std::string text = exposure_text(result_.options.exposure);
  return text.empty() && result_.measures_exposure ? measured_by_default : text;
}

void ImageObject::set_default_exposure(const std::string& text) {
  result_.measures_exposure = text == measured_by_default;
  if (!text.empty() && !result_.measures_exposure)
    result_.options.exposure = parse_exposure("exposure", text);
}

void ImageObject::save(const std::string& path, const std::string& exposure) {
  check_image_path(path);
  const auto chosen = exposure_of(path, exposure);
  if (chosen) {
    const std::lock_guard lock(mutex_);
    result_.report.exposure = chosen->stops;
  }
  write_image(path, image(), result_.header, {chosen ? chosen->stops : 0.0f});
}

void ImageObject::write_statistics() {
  Attempts attempts;
  pt::write_statistics(result_.options, report(), attempts);
  attempts.check();
}

namespace {

namespace nb = nanobind;

/// (height, width, 3), in memory of a device type.
ArrayOut pixels_of(ImageObject& self, float* rgb, int device_type, int device) {
  const std::size_t shape[] = {static_cast<std::size_t>(self.frame().height),
                               static_cast<std::size_t>(self.frame().width), 3};
  return ArrayOut(rgb, 3, shape, nb::find(self), nullptr, nb::dtype<float>(), device_type, device);
}

ArrayOut pixels(ImageObject& self) {
  return pixels_of(self, self.image().rgb.data(), nb::device::cpu::value, 0);
}

/// In the memory of the device that rendered them.
ArrayOut device_pixels(ImageObject& self) {
  const DeviceImage* const image = self.device_image();
  if (image == nullptr) return pixels(self);
  return pixels_of(self, image->rgb(), nb::device::cuda::value, image->device());
}

/// 0 if the image is in the host's memory.
std::uintptr_t device_pointer(const ImageObject& self) {
  const DeviceImage* const image = self.device_image();
  return image == nullptr ? 0 : reinterpret_cast<std::uintptr_t>(image->rgb());
}

ArrayOut layer(ImageObject& self, const std::string& name) {
  Image& image = self.frame();
  for (ImageLayer& one : image.layers) {
    if (one.name != name) continue;
    const std::size_t shape[] = {static_cast<std::size_t>(image.height),
                                 static_cast<std::size_t>(image.width), one.channels.size()};
    const std::size_t dimensions = one.channels.size() == 1 ? 2 : 3;
    if (!one.numbers.empty())
      return ArrayOut(one.numbers.data(), dimensions, shape, nb::find(self), nullptr,
                      nb::dtype<std::uint32_t>());
    return ArrayOut(one.values.data(), dimensions, shape, nb::find(self), nullptr,
                    nb::dtype<float>());
  }
  throw nb::key_error(name.c_str());
}

std::vector<std::string> layer_names(const ImageObject& self) {
  std::vector<std::string> names;
  for (const ImageLayer& one : self.frame().layers) names.push_back(one.name);
  return names;
}

ImageObject* read(const std::string& path) {
  ImageMetadata header;
  Image image = [&] {
    const Unlocked unlocked;
    Image read = read_image_with_layers(path, header);
    // A checkpoint's sums, which would be wrong beside other pixels.
    std::erase_if(read.layers, [](const ImageLayer& one) { return one.name.starts_with("film."); });
    return read;
  }();
  return new ImageObject(std::move(image), std::move(header));
}

nb::bytes bytes_of(const std::string& text) { return nb::bytes(text.data(), text.size()); }

template <class T>
std::vector<T> values_of(const nb::bytes& bytes, std::size_t count) {
  if (bytes.size() != count * sizeof(T))
    throw Error(fmt::format("{} bytes of an image; expected {}", bytes.size(), count * sizeof(T)));
  std::vector<T> values(count);
  std::memcpy(values.data(), bytes.c_str(), bytes.size());
  return values;
}

/// (name, channels, whether of whole numbers, values) of each.
using LayerStates = std::vector<std::tuple<std::string, std::string, bool, nb::bytes>>;
/// All of an image but its statistics: width, height, pixels, layers, header, exposure.
using ImageState =
    std::tuple<int, int, nb::bytes, LayerStates, std::map<std::string, std::string>, std::string>;

ImageState state_of(ImageObject& self) {
  const auto bytes = [](const auto& values) {
    return nb::bytes(values.data(), values.size() * sizeof(values[0]));
  };
  const Image& image = self.image();
  LayerStates layers;
  for (const ImageLayer& one : image.layers)
    layers.emplace_back(one.name, one.channels, !one.numbers.empty(),
                        one.numbers.empty() ? bytes(one.values) : bytes(one.numbers));
  return {image.width,       image.height,         bytes(image.rgb),
          std::move(layers), self.result().header, self.default_exposure()};
}

ImageObject* image_of_state(const ImageState& state) {
  const auto& [width, height, pixels, layers, header, exposure] = state;
  Image image{width, height, {}};
  const std::size_t count = std::size_t{1} * width * height;
  image.rgb = values_of<float>(pixels, 3 * count);
  for (const auto& [name, channels, has_numbers, bytes] : layers) {
    ImageLayer& one = image.layers.emplace_back(ImageLayer{name, channels, {}, {}});
    if (has_numbers)
      one.numbers = values_of<std::uint32_t>(bytes, count * channels.size());
    else
      one.values = values_of<float>(bytes, count * channels.size());
  }
  auto* const made = new ImageObject(std::move(image), header);
  made->set_default_exposure(exposure);
  return made;
}

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

void add_image(nb::module_& m) {
  nb::class_<ImageObject>(m, "Image")
      .def_prop_ro("width", [](const ImageObject& self) { return self.frame().width; })
      .def_prop_ro("height", [](const ImageObject& self) { return self.frame().height; })
      .def("pixels", pixels)
      .def("device_pixels", device_pixels)
      .def("device_pointer", device_pointer)
      .def("layer", layer)
      .def("layer_names", layer_names)
      .def("statistics", &ImageObject::statistics)
      .def("table", [](ImageObject& self) { return text(self.table()); })
      .def("header",
           [](const ImageObject& self) {
             nb::dict header;
             for (const auto& [name, value] : self.result().header)
               header[text(name)] = text(value);
             return header;
           })
      .def_prop_ro("has_image", [](const ImageObject& self) { return self.result().has_image; })
      .def_prop_ro("has_report",
                   [](const ImageObject& self) { return !self.result().report.runs.empty(); })
      .def("srgb", [](ImageObject& self, const std::string& e) { return bytes_of(self.srgb(e)); })
      .def("png", [](ImageObject& self, const std::string& e) { return bytes_of(self.png(e)); })
      .def("exposure", &ImageObject::default_exposure)
      .def("state", state_of)
      .def("write_statistics", &ImageObject::write_statistics, nb::call_guard<Unlocked>())
      .def("save", &ImageObject::save, nb::arg("path"), nb::arg("exposure"),
           nb::call_guard<Unlocked>());
  m.def("read_image", read, nb::arg("path"));
  m.def("image_of_state", image_of_state, nb::arg("state"));
}

void add_compare(nb::module_& m) {
  m.def("compare", compare, nb::arg("a"), nb::arg("b"), nb::arg("tolerance"), nb::arg("is_hdr"));
}

}  // namespace pt::python
