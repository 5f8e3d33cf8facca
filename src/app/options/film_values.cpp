// Values of the options that say what the film sums.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <vector>

#include "app/options/option_values.h"
#include "common/film/aov.h"
#include "common/scene/prepare/prepare_filter.h"

namespace pt {
CropWindow parse_crop(const std::string& name, const std::string& text) {
  const std::vector<std::string> parts = split(text, ',');
  std::array<int, 4> values{};
  bool valid = parts.size() == 4;
  for (std::size_t i = 0; valid && i < 4; ++i) {
    const char* end = parts[i].data() + parts[i].size();
    const auto [stop, error] = std::from_chars(parts[i].data(), end, values[i]);
    valid = error == std::errc() && stop == end && values[i] >= 0;
  }
  const CropWindow crop{values[0], values[1], values[2], values[3]};
  if (!valid || crop.x0 >= crop.x1 || crop.y0 >= crop.y1) {
    refuse_value(name, text, "expected pixels x0,y0,x1,y1 with x0 < x1 and y0 < y1");
  }
  return crop;
}

std::string crop_text(const std::optional<CropWindow>& crop) {
  return crop ? fmt::format("{},{},{},{}", crop->x0, crop->y0, crop->x1, crop->y1) : "";
}

FilterChoice parse_filter(const std::string& name, const std::string& text) {
  const std::vector<std::string> parts = split(text, ':');
  FilterChoice filter = default_filter(parse_name<FilterKind>(name, parts[0]));
  const FilterInfo& allowed = filter_info(filter.kind);
  float* const values[] = {&filter.a, &filter.b};
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const char* end = parts[i].data() + parts[i].size();
    float value = NAN;
    const auto [stop, error] = std::from_chars(parts[i].data(), end, value);
    const bool whole = !allowed.is_whole || value == std::floor(value);
    if (static_cast<int>(i) > allowed.parameter_count || error != std::errc() || stop != end ||
        !(value >= allowed.lowest && value <= allowed.highest) || !whole) {
      refuse_value(name, text,
                   fmt::format("expected {}{}, {}", parts[0], allowed.parameters, allowed.range));
    }
    *values[i - 1] = value;
  }
  return filter;
}

std::string filter_text(const std::optional<FilterChoice>& filter) {
  if (!filter) return "";
  const std::string kind = to_string(filter->kind);
  if (*filter == default_filter(filter->kind)) return kind;
  const bool has_two = filter_info(filter->kind).parameter_count == 2;
  return fmt::format("{}:{}{}", kind, filter->a, has_two ? fmt::format(":{}", filter->b) : "");
}

std::string filter_forms(const char* separator) {
  std::string text;
  for (const FilterInfo& info : filter_table) {
    text += fmt::format("{}{}[{}]", text.empty() ? "" : separator, to_string(info.kind),
                        info.parameters);
  }
  return text;
}

std::uint32_t parse_aovs(const std::string& name, const std::string& text) {
  std::uint32_t aovs = 0;
  for (const std::string& part : split(text, ',')) {
    std::uint32_t bit = 0;
    for (const AovInfo& info : aov_table) bit |= info.name == part ? info.bit : 0;
    if (bit == 0)
      refuse_value(name, text,
                   "expected a list of " + aov_names(", ") +
                       meaning(nearest_name(part, split(aov_names(","), ','))));
    if ((aovs & bit) != 0) refuse_value(name, text, "names " + part + " twice");
    aovs |= bit;
  }
  return aovs;
}

std::string aovs_text(std::uint32_t aovs) {
  std::string text;
  for (const AovInfo& info : aov_table) {
    if ((aovs & info.bit) == 0) continue;
    text.append(text.empty() ? "" : ",").append(info.name);
  }
  return text;
}

std::string aov_names(const char* separator) {
  std::string text;
  for (const AovInfo& info : aov_table) {
    text.append(text.empty() ? "" : separator).append(info.name);
  }
  return text;
}

}  // namespace pt
