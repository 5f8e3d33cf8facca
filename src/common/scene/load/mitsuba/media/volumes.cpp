#include "common/scene/load/mitsuba/media/volumes.h"

#include <fmt/format.h>

#include <cmath>

#include "common/scene/load/files/volumes/nanovdb_file.h"
#include "common/scene/load/files/volumes/vol_file.h"

namespace pt::mitsuba {
namespace {

/// From the cube [0, 1]^3 to the box of the file.
Affine file_box(const Element& at, const VolFile& file) {
  for (int axis = 0; axis < 3; ++axis) {
    const float length = file.high[axis] - file.low[axis];
    if (!(length > 0) || !std::isfinite(length)) {
      fail(at, fmt::format("use_grid_bbox: the file's box goes from {} to {} along axis {}; "
                           "expected a positive length",
                           file.low[axis], file.high[axis], axis));
    }
  }
  return translate(file.low) * scale(file.high - file.low);
}

void read_look(Context& context, const Object& volume, VolumeData& grid) {
  const std::string filter = volume.text("filter_type", "trilinear");
  grid.interpolates = filter != "nearest";
  if (filter != "nearest" && filter != "trilinear") {
    context.warn_once(
        "volume filter " + filter, volume.element(),
        fmt::format("volume filter '{}' is not supported: trilinear is used", filter));
  }
  const std::string wrap = volume.text("wrap_mode", "clamp");
  if (wrap != "clamp") {
    context.warn_once(
        "volume wrap " + wrap, volume.element(),
        fmt::format("wrap mode '{}' of a volume is not supported: clamp is used", wrap));
  }
  volume.ignore({"raw", "accel"});  // three channels are linear RGB in either case
}

VolumeData read_vol_grid(const Object& volume, const std::filesystem::path& path) {
  VolFile file = read_vol(path);
  if (volume.boolean("use_grid_bbox", false)) {
    file.grid.to_world = file_box(volume.element(), file);
  }
  return std::move(file.grid);
}

/// An extension of ours. Its place is the file's, with or without use_grid_bbox.
VolumeData read_nanovdb_grid(const Object& volume, const std::filesystem::path& path) {
  volume.ignore({"use_grid_bbox"});
  return read_nanovdb(path, volume.text("grid", ""));
}

VolumeData read_grid(Context& context, const Object& volume) {
  const Element* filename = volume.find("filename");
  if (!filename) fail(volume.element(), "volume 'gridvolume' has no filename");
  const auto path = context.resolve(*filename, filename->required("value"));
  VolumeData grid;
  try {
    const bool is_nanovdb = path.extension() == ".nvdb";
    grid = is_nanovdb ? read_nanovdb_grid(volume, path) : read_vol_grid(volume, path);
  } catch (const Error& error) {
    fail(*filename, error.what());
  }
  grid.to_world = volume.transform("to_world") * grid.to_world;
  read_look(context, volume, grid);
  return grid;
}

}  // namespace

std::optional<VolumeQuantity> read_volume_quantity(Context& context, const Object& medium,
                                                   std::string_view name, const Color& fallback,
                                                   Quantity quantity) {
  if (const Element* element = medium.find(name)) {
    return VolumeQuantity{read_color(context, *element, quantity, fallback)};
  }
  const Object* nested = medium.child_named(name);
  if (!nested) return VolumeQuantity{fallback};
  if (is_spectrum(*nested)) {
    return VolumeQuantity{read_spectrum_object(context, *nested, quantity, fallback)};
  }
  if (nested->tag() != "volume") return std::nullopt;
  if (nested->type() == "constvolume") {
    auto constant = read_volume_quantity(context, *nested, "value", fallback, quantity);
    if (constant) constant->to_world = nested->transform("to_world");
    return constant;
  }
  if (nested->type() != "gridvolume") return std::nullopt;
  if (!context.volumes.contains(nested)) {
    context.volumes.emplace(nested, read_grid(context, *nested));
  }
  return VolumeQuantity{Color(1.0f), nested};
}

}  // namespace pt::mitsuba
