// Image in Python.
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <filesystem>

#include "common/error/error.h"
#include "python/image_object.h"
#include "python/module.h"
#include "python/unlocked.h"

namespace pt::python {
namespace {

namespace nb = nanobind;

/// (height, width, 3), in memory of that kind.
ArrayOut array_of(ImageObject& self, float* rgb, int device_type, int device) {
  const std::size_t shape[] = {static_cast<std::size_t>(self.frame().height),
                               static_cast<std::size_t>(self.frame().width), 3};
  return ArrayOut(rgb, 3, shape, nb::find(self), nullptr, nb::dtype<float>(), device_type, device);
}

ArrayOut pixels(ImageObject& self) {
  return array_of(self, self.image().rgb.data(), nb::device::cpu::value, 0);
}

/// Where they were rendered.
ArrayOut device_pixels(ImageObject& self) {
  const DeviceImage* const image = self.device_image();
  if (image == nullptr) return pixels(self);
  return array_of(self, image->rgb(), nb::device::cuda::value, image->device());
}

/// 0: in the host's memory.
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
    return read_image(path, &header);
  }();
  return new ImageObject(std::move(image), std::move(header));
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
      .def("write_statistics", &ImageObject::write_statistics, nb::call_guard<Unlocked>())
      .def("save", &ImageObject::save, nb::arg("path"), nb::arg("exposure"),
           nb::call_guard<Unlocked>());
  m.def("read_image", read, nb::arg("path"));
}

}  // namespace pt::python
