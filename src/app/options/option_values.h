// Values of options, to and from the text of the command line. Every parse_ function throws Error
// with one line that names the option, the value and what was expected.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/options/option_names.h"
#include "common/options/options.h"

namespace pt {

/// Throws Error "--name value: problem".
[[noreturn]] void refuse_value(const std::string& name, const std::string& value,
                               const std::string& problem);

/// The one of `names` that a misspelt `text` stands for: the most similar, else the only one that
/// begins so; empty if there is none.
std::string nearest_name(const std::string& text, const std::vector<std::string>& names);

/// "; did you mean NAME?", or nothing for no name.
std::string meaning(const std::string& name);

/// refuse_value with the names that were expected, and the nearest.
[[noreturn]] void refuse_name(const std::string& name, const std::string& value,
                              const std::vector<std::string>& names);

/// The parts between separators.
std::vector<std::string> split(const std::string& text, char separator);

std::uint64_t parse_integer(const std::string& name, const std::string& text, std::uint64_t lowest,
                            std::uint64_t highest);
/// A finite number; `expected` and `holds` state a further condition, e.g. "a number above 0".
float parse_number(const std::string& name, const std::string& text, const char* expected,
                   bool (*holds)(float));
std::array<float, 3> parse_vector(const std::string& name, const std::string& text);  ///< "x,y,z"
bool parse_switch(const std::string& name, const std::string& text);  ///< "on" or "off"
/// One device: "auto", "cpu", "cuda" or "cuda:N".
DeviceChoice parse_device(const std::string& name, const std::string& text);
/// One or several devices: also "cpu:N", "cuda:N,M,..." or "cuda:all".
DeviceChoice parse_devices(const std::string& name, const std::string& text);
/// "FILE" or "FILE,SECONDS".
CheckpointChoice parse_checkpoint(const std::string& name, const std::string& text);
std::string checkpoint_text(const CheckpointChoice& checkpoint);
/// "I/N" with 1 <= I <= N.
PartChoice parse_part(const std::string& name, const std::string& text);
std::string part_text(const PartChoice& part);  ///< empty for the whole image
BlockSize parse_block(const std::string& name, const std::string& text);  ///< "16x8"
/// "256" for all stages, or "intersect=128,shadow=64" over `blocks`.
StageBlocks parse_stage_blocks(const std::string& name, const std::string& text,
                               StageBlocks blocks);
/// A number from 1 to `most`; K and M mean 2^10 and 2^20. `what` names what it counts.
std::uint64_t parse_size(const std::string& name, const std::string& text, const std::string& what,
                         std::uint64_t most);
/// Absent for "auto".
std::optional<std::uint32_t> parse_finish_paths(const std::string& name, const std::string& text);

template <NamedEnum E>
E parse_name(const std::string& name, const std::string& text) {
  for (const EnumName<E>& entry : enum_names<E>)
    if (entry.name == text) return entry.value;
  for (const EnumName<E>& entry : old_enum_names<E>)
    if (entry.name == text) return entry.value;
  std::vector<std::string> names;
  for (const EnumName<E>& entry : enum_names<E>) names.emplace_back(entry.name);
  refuse_name(name, text, names);
}

// The inverse: text that the functions above parse to the same value.
std::string number_text(float value);
std::string vector_text(const std::array<float, 3>& value);
std::string block_text(const BlockSize& block);
std::string stage_blocks_text(const StageBlocks& blocks);

/// A number of runs, from `least` to a million.
int parse_runs(const std::string& name, const std::string& text, std::uint64_t least);

std::string grouped(std::uint64_t value);  ///< for reading: 1234567 -> "1,234,567"

/// "x0,y0,x1,y1" in pixels, x0 < x1, y0 < y1.
CropWindow parse_crop(const std::string& name, const std::string& text);
std::string crop_text(const std::optional<CropWindow>& crop);

/// "KIND", "KIND:A" or "KIND:A:B"; the filter has defaults for A and B.
FilterChoice parse_filter(const std::string& name, const std::string& text);
std::string filter_text(const std::optional<FilterChoice>& filter);
std::string filter_forms(const char* separator);  ///< of all filters: "box[:RADIUS]"

/// "albedo,depth": bits of Options::aovs.
std::uint32_t parse_aovs(const std::string& name, const std::string& text);
std::string aovs_text(std::uint32_t aovs);
std::string aov_names(const char* separator);  ///< all names

/// "auto" or stops.
ExposureChoice parse_exposure(const std::string& name, const std::string& text);
/// Empty if the scene decides.
std::string exposure_text(const ExposureChoice& exposure);

/// Adds NAME=VALUE to `definitions`.
void parse_definition(const std::string& name, const std::string& text,
                      std::map<std::string, std::string>& definitions);
/// "a=1 b=2".
std::string definitions_text(const std::map<std::string, std::string>& definitions);
/// Splits a text of definitions_text into NAME=VALUE.
std::vector<std::string> split_definitions(const std::string& text);

}  // namespace pt
