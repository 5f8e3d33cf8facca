#include "common/scene/load/pbrt/media/media.h"

#include <fmt/format.h>

#include "common/scene/load/pbrt/media/medium_kinds.h"

namespace pt::pbrt {
namespace {

constexpr std::size_t media_max = no_medium - 1u;

using MediumReader = Medium (*)(Context&, const Entity&);

const std::map<std::string_view, MediumReader>& medium_readers() {
  static const std::map<std::string_view, MediumReader> table = {
      {"homogeneous", read_homogeneous}, {"uniformgrid", read_uniform_grid},
      {"rgbgrid", read_rgb_grid},        {"cloud", read_cloud},
      {"nanovdb", read_nanovdb_grids},   {"heterogeneous", read_uniform_grid},
  };
  return table;
}

std::uint16_t add_medium(Context& context, const std::string& name, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  if (!parameters.find("type", {"string"})) {
    fail(parameters.place(), fmt::format("medium '{}' has no 'string type'", name));
  }
  const std::string type = parameters.text("type", "");
  const auto reader = medium_readers().find(type);
  if (reader == medium_readers().end()) {
    context.reporter.warn_once("medium " + type, parameters.place(),
                               fmt::format("medium '{}' is not supported: there is none instead; "
                                           "expected homogeneous, uniformgrid, rgbgrid, cloud "
                                           "or nanovdb",
                                           type));
    return no_medium;
  }
  Medium medium = reader->second(context, entity);
  medium.priority = parameters.integer("priority", 0);
  parameters.report_unused(context.reporter);
  std::vector<Medium>& media = context.scene.media;
  if (media.size() == media_max) {
    fail(parameters.place(), fmt::format("a scene of more than {} media", media_max));
  }
  media.push_back(medium);
  return static_cast<std::uint16_t>(media.size() - 1);
}

std::uint16_t read_medium(Context& context, const std::string& name, const Place& place) {
  const auto found = context.description.media.find(name);
  if (found == context.description.media.end()) {
    fail(place,
         fmt::format("there is no medium '{}'; expected one that MakeNamedMedium defines", name));
  }
  return add_medium(context, name, *found->second);
}

}  // namespace

std::uint16_t medium_named(Context& context, const std::string& name, const Place& place) {
  if (name.empty()) return no_medium;
  const auto known = context.media.find(name);
  if (known != context.media.end()) return known->second;
  std::uint16_t& number = context.media[name] = no_medium;
  context.reporter.attempt(fmt::format("medium '{}'", name), "is left out",
                           [&] { number = read_medium(context, name, place); });
  return number;
}

MediumBoundary media_of(Context& context, const ShapeEntity& shape) {
  const Place& place = shape.shape.parameters.place();
  MediumBoundary boundary;
  boundary.inside = medium_named(context, shape.media.inside, place);
  boundary.outside = medium_named(context, shape.media.outside, place);
  return boundary;
}

}  // namespace pt::pbrt
