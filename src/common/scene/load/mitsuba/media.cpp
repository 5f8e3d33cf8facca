// <medium>s to ours, and which lie on the sides of a shape.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/bounds.h"
#include "common/scene/load/files/volumes/volume_files.h"
#include "common/scene/load/mitsuba/scene_parts.h"
#include "common/scene/load/mitsuba/surfaces/textures.h"

namespace pt::mitsuba {
namespace {

/// A quantity of a medium: `value`, times the grid where it has one.
struct VolumeQuantity {
  Color value = Color(1.0f);
  const Object* grid = nullptr;  ///< in Context::volumes
  Affine to_world{};             ///< of what has no grid: from the cube in which it is
};

/// From the cube [0, 1]^3 to the box of the file.
Affine file_box(const Element& at, const VolFile& file) {
  for (int axis = 0; axis < 3; ++axis) {
    const float length = file.high[axis] - file.low[axis];
    if (!(length > 0) || !std::isfinite(length)) {
      fail(at,
           "use_grid_bbox: the file's box goes from {} to {} along axis {}; expected a positive "
           "length",
           file.low[axis], file.high[axis], axis);
    }
  }
  return translate(file.low) * scale(file.high - file.low);
}

void read_look(Context& context, const Object& volume, VolumeData& grid) {
  const std::string filter = volume.text("filter_type", "trilinear");
  grid.interpolates = filter != "nearest";
  if (filter != "nearest" && filter != "trilinear") {
    context.warn_once("volume filter " + filter, volume.element(),
                      "volume filter '{}' is not supported: trilinear is used", filter);
  }
  const std::string wrap = volume.text("wrap_mode", "clamp");
  if (wrap != "clamp") {
    context.warn_once("volume wrap " + wrap, volume.element(),
                      "wrap mode '{}' of a volume is not supported: clamp is used", wrap);
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
VolumeData read_nanovdb_grid(Context& context, const Object& volume,
                             const std::filesystem::path& path) {
  volume.ignore({"use_grid_bbox"});
  return read_nanovdb(path, volume.text("grid", ""), context.volume_storage());
}

VolumeData read_grid_file(Context& context, const Object& volume) {
  const Element* filename = volume.find("filename");
  if (!filename) fail(volume.element(), "volume 'gridvolume' has no filename");
  const auto path = context.resolve(*filename, filename->required("value"));
  try {
    const bool is_nanovdb = path.extension() == ".nvdb";
    return is_nanovdb ? read_nanovdb_grid(context, volume, path) : read_vol_grid(volume, path);
  } catch (const Error& error) {
    fail(*filename, error.what());
  }
}

VolumeData read_grid(Context& context, const Object& volume) {
  VolumeData grid;
  if (const VolumeData* data = context.memory_volume(volume)) {
    volume.ignore({"use_grid_bbox"});
    grid = *data;
  } else {
    grid = read_grid_file(context, volume);
  }
  grid.to_world = volume.transform("to_world") * grid.to_world;
  read_look(context, volume, grid);
  return grid;
}

/// A number, a colour or a <volume> of `medium`, or `fallback` where it has none. None where it is
/// of a kind that is not supported.
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

constexpr std::size_t media_max = no_medium - 1u;

bool has_coefficient(const Object& medium, std::string_view name) {
  return medium.find(name) || medium.child_named(name);
}

void read_phase(Context& context, const Object& medium, Medium& result) {
  result.phase = phase_kind_of<Isotropic>;
  const Object* phase = medium.child("phase");
  if (!phase) return;
  if (phase->type() == HenyeyGreenstein::name) {
    const float g = phase->number("g", 0.8f);
    if (!(std::abs(g) < 1)) {
      fail(phase->element(), "g {}; expected more than -1 and less than 1", g);
    }
    result.phase = phase_kind_of<HenyeyGreenstein>;
    result.phase_parameter = g;
  } else if (phase->type() == Rayleigh::name) {
    result.phase = phase_kind_of<Rayleigh>;
  } else if (phase->type() != Isotropic::name) {
    phase->ignore_all();
    context.warn_once("phase " + phase->type(), phase->element(),
                      "phase function '{}' is not supported: isotropic is used", phase->type());
  }
}

void expect_coefficients(const Object& medium, const Medium& result) {
  for (int c = 0; c < 3; ++c) {
    const float t = result.extinction[c], albedo = result.albedo[c];
    if (!(t >= 0 && std::isfinite(t) && albedo >= 0 && albedo <= 1)) {
      fail(medium.element(),
           "extinction {} and albedo {} of a channel; expected a finite coefficient, at least 0, "
           "and an albedo in [0, 1]",
           t, albedo);
    }
  }
}

void read_phase_and_check(Context& context, const Object& object, Medium& medium) {
  object.ignore({"sample_emitters", "has_spectral_extinction", "strategy"});
  medium.priority = object.integer("priority").value_or(0);
  read_phase(context, object, medium);
  expect_coefficients(object, medium);
}

/// Coefficients as sigma_t and albedo, or, in 0.x, as sigma_a and sigma_s.
std::optional<Medium> read_homogeneous(Context& context, const Object& medium) {
  const float scale = medium.number("scale", 1.0f);
  Medium result;
  const auto constant = [&](std::string_view name, float fallback, Quantity quantity) {
    const auto read = read_volume_quantity(context, medium, name, Color(fallback), quantity);
    return read && !read->grid ? std::optional(read->value) : std::nullopt;
  };
  if (has_coefficient(medium, "sigma_s") || has_coefficient(medium, "sigma_a")) {
    const auto scattering = constant("sigma_s", 0, Quantity::plain);
    const auto absorption = constant("sigma_a", 0, Quantity::plain);
    if (!scattering || !absorption) return std::nullopt;
    result.extinction = scale * (*scattering + *absorption);
    for (int c = 0; c < 3; ++c) {
      const float sum = (*scattering)[c] + (*absorption)[c];
      result.albedo[c] = sum > 0 ? (*scattering)[c] / sum : 0.0f;
    }
  } else {
    const auto extinction = constant("sigma_t", 1, Quantity::plain);
    const auto albedo = constant("albedo", 0.75f, Quantity::reflectance);
    if (!extinction || !albedo) return std::nullopt;
    result.extinction = scale * *extinction;
    result.albedo = *albedo;
  }
  read_phase_and_check(context, medium, result);
  return result;
}

/// A grid of one voxel, for what is the same in all of a box.
VolumeData box_of(const VolumeQuantity& constant) {
  Bounds bounds;
  for (int i = 0; i < 8; ++i) bounds.grow(constant.to_world.point({i & 1, i >> 1 & 1, i >> 2}));
  VolumeData grid;
  std::fill(std::begin(grid.size), std::end(grid.size), 1u);
  grid.channels = 3;
  grid.interpolates = false;
  grid.values = {constant.value.x, constant.value.y, constant.value.z};
  grid.to_world = translate(bounds.min) * scale(bounds.max - bounds.min);
  return grid;
}

/// The extinction is that of a grid, or the same in the box of a <volume>: outside is nothing.
std::optional<Medium> read_heterogeneous(Context& context, const Object& medium,
                                         Context::MediumGrids& grids) {
  const auto density =
      read_volume_quantity(context, medium, "sigma_t", Color(1.0f), Quantity::plain);
  const auto albedo =
      read_volume_quantity(context, medium, "albedo", Color(0.75f), Quantity::reflectance);
  if (!density || !albedo) return std::nullopt;
  if (!density->grid) context.volumes.emplace(&medium, box_of(*density));
  grids = {&medium, density->grid ? density->grid : &medium, albedo->grid};
  Medium result;
  result.extinction = Color(medium.number("scale", 1.0f));
  result.albedo = albedo->value;
  read_phase_and_check(context, medium, result);
  return result;
}

void warn_unsupported(Context& context, const Object& medium, const std::string& what) {
  medium.ignore_all();
  context.warn_once("medium " + what, medium.element(),
                    "{} is not supported: there is no medium instead", what);
}

}  // namespace

std::optional<std::uint16_t> read_medium(Context& context, const Object& medium) {
  const auto [entry, is_new] = context.media.try_emplace(&medium, std::nullopt);
  if (!is_new) return entry->second;
  std::optional<Medium> result;
  Context::MediumGrids grids;
  if (medium.find("material")) {
    warn_unsupported(context, medium, "a medium by the name of its material");
  } else if (medium.type() == "homogeneous") {
    result = read_homogeneous(context, medium);
    if (!result) warn_unsupported(context, medium, "a homogeneous medium of textures or grids");
  } else if (medium.type() == "heterogeneous" && context.modern) {
    result = read_heterogeneous(context, medium, grids);
    if (!result) {
      warn_unsupported(context, medium,
                       "a heterogeneous medium of other things than gridvolume and constvolume");
    }
  } else {
    warn_unsupported(context, medium, fmt::format("medium '{}'", medium.type()));
  }
  if (!result) return std::nullopt;
  auto& media = context.scene.media;
  if (media.size() == media_max) {
    fail(medium.element(), "a scene of more than {} media", media_max);
  }
  media.push_back(*result);
  const auto number = static_cast<std::uint16_t>(media.size() - 1);
  if (grids.medium) context.medium_grids.emplace(number, grids);
  return entry->second = number;
}

ShapeMedia media_of(Context& context, const Object& shape) {
  ShapeMedia result;
  const auto read = [&](const char* side, std::uint16_t& medium) {
    const Object* const object = shape.child_named(side);
    if (!object || object->tag() != "medium") return;
    if (const auto number = read_medium(context, *object)) {
      medium = *number;
      result.any = true;
    }
  };
  read("interior", result.boundary.inside);
  read("exterior", result.boundary.outside);
  return result;
}

}  // namespace pt::mitsuba
