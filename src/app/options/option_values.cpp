#include "app/options/option_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "common/error/error.h"

namespace pt {
namespace {

constexpr int max_block_threads = 1024;  // CUDA's limit on every device since 2010
constexpr std::size_t devices_max = 64;  // of one machine

/// The whole of `text` as a T, or nothing. Unlike strtol: no blanks, no sign of an unsigned value.
template <typename T>
std::optional<T> whole(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

int parse_stage_threads(const std::string& name, const std::string& text) {
  const auto threads = whole<std::uint64_t>(text);
  if (!threads || *threads < 1 || *threads > max_block_threads)
    refuse_value(name, text, "expected a whole number of threads from 1 to 1,024");
  return static_cast<int>(*threads);
}

}  // namespace

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

void refuse_value(const std::string& name, const std::string& value, const std::string& problem) {
  throw Error(fmt::format("--{} {}: {}", name, value.empty() ? "''" : value, problem));
}

namespace {

/// Letters that are missing, too many, wrong or swapped with their neighbour.
std::size_t edits_between(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, last, row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = std::exchange(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool is_equal = a[i - 1] == b[j - 1];
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (is_equal ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_name(const std::string& text, const std::vector<std::string>& names) {
  constexpr std::size_t longest = 40;
  std::string wanted;
  for (const char c : text)
    wanted += c == '_' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (wanted.empty() || wanted.size() > longest) return "";
  std::string nearest, begun;
  std::size_t least = wanted.size() / 3 + 1, begins = 0;
  for (const std::string& name : names) {
    const std::size_t edits = edits_between(wanted, name);
    if (edits < least) least = edits, nearest = name;
    if (name.starts_with(wanted)) ++begins, begun = name;
  }
  return !nearest.empty() || begins != 1 ? nearest : begun;
}

std::string meaning(const std::string& name) {
  return name.empty() ? "" : "; did you mean " + name + "?";
}

void refuse_name(const std::string& name, const std::string& value,
                 const std::vector<std::string>& names) {
  refuse_value(name, value,
               fmt::format("expected one of {}{}", fmt::join(names, ", "),
                           meaning(nearest_name(value, names))));
}

std::uint64_t parse_integer(const std::string& name, const std::string& text, std::uint64_t lowest,
                            std::uint64_t highest) {
  const auto value = whole<std::uint64_t>(text);
  if (!value || *value < lowest || *value > highest)
    refuse_value(name, text,
                 fmt::format("expected a whole number from {} to {}", lowest, grouped(highest)));
  return *value;
}

float parse_number(const std::string& name, const std::string& text, const char* expected,
                   bool (*holds)(float)) {
  const auto value = whole<float>(text);
  if (!value || !std::isfinite(*value) || !holds(*value))
    refuse_value(name, text, std::string("expected ") + expected);
  return *value;
}

ExposureChoice parse_exposure(const std::string& name, const std::string& text) {
  using Kind = ExposureChoice::Kind;
  if (text == "auto") return {Kind::measured, 0.0f};
  return {Kind::fixed, parse_number(name, text, "auto or a number from -100 to 100",
                                    [](float x) { return x >= -100 && x <= 100; })};
}

std::string exposure_text(const ExposureChoice& exposure) {
  using Kind = ExposureChoice::Kind;
  if (exposure.kind == Kind::scene) return "";
  return exposure.kind == Kind::measured ? "auto" : number_text(exposure.stops);
}

std::array<float, 3> parse_vector(const std::string& name, const std::string& text) {
  const std::vector<std::string> parts = split(text, ',');
  std::array<float, 3> vector{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto value = parts.size() == 3 ? whole<float>(parts[i]) : std::nullopt;
    if (!value || !std::isfinite(*value))
      refuse_value(name, text, "expected three finite numbers, X Y Z or X,Y,Z");
    vector[i] = *value;
  }
  return vector;
}

bool parse_switch(const std::string& name, const std::string& text) {
  if (text != "on" && text != "off") refuse_value(name, text, "expected on or off");
  return text == "on";
}

DeviceChoice parse_device(const std::string& name, const std::string& text) {
  for (const auto& [kind, kind_name] : enum_names<DeviceChoice::Kind>)
    if (kind_name == text) return {kind, 0};
  const auto index = text.starts_with("cuda:") ? whole<unsigned>(text.substr(5)) : std::nullopt;
  if (!index || *index > INT32_MAX)
    refuse_value(name, text, "expected auto, cpu, cuda or cuda:N with N from 0");
  return {DeviceChoice::Kind::cuda, static_cast<int>(*index)};
}

DeviceChoice parse_devices(const std::string& name, const std::string& text) {
  using Kind = DeviceChoice::Kind;
  const auto check = [&](bool holds) {
    if (holds) return;
    refuse_value(
        name, text,
        "expected auto, cpu, cpu:N for N devices that share its threads, cuda, cuda:all, or "
        "cuda:N,M,... with ordinals from 0");
  };
  const std::vector<std::string> words = split(text, ':');
  DeviceChoice choice;
  bool is_known = false;
  for (const auto& [kind, kind_name] : enum_names<Kind>) {
    if (kind_name == words[0]) choice.kind = kind, is_known = true;
  }
  check(is_known && words.size() <= 2);
  if (words.size() == 1) return choice;
  choice.wants_all = choice.kind == Kind::cuda && words[1] == "all";
  if (choice.wants_all) return choice;
  std::vector<int> numbers;
  for (const std::string& word : split(words[1], ',')) {
    const auto number = whole<unsigned>(word);
    check(number && *number <= INT32_MAX && numbers.size() < devices_max);
    numbers.push_back(static_cast<int>(number.value_or(0)));
  }
  if (choice.kind == Kind::cuda) {
    choice.index = numbers[0];
    choice.more.assign(numbers.begin() + 1, numbers.end());
    return choice;
  }
  const int count = numbers[0];
  check(choice.kind == Kind::cpu && numbers.size() == 1 && count >= 1 &&
        count <= static_cast<int>(devices_max));
  for (int i = 1; i < count; ++i) choice.more.push_back(i);
  return choice;
}

CheckpointChoice parse_checkpoint(const std::string& name, const std::string& text) {
  CheckpointChoice choice;
  const std::size_t comma = text.rfind(',');
  choice.file = text.substr(0, comma);
  if (comma != std::string::npos) {
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + comma + 1, end, choice.interval_s);
    if (error != std::errc() || stop != end || !(choice.interval_s > 0) ||
        !std::isfinite(choice.interval_s)) {
      refuse_value(name, text, "expected FILE or FILE,SECONDS with seconds above 0");
    }
  }
  if (!choice.file.ends_with(".exr")) {
    refuse_value(name, text, "expected the name of an .exr file, and perhaps ,SECONDS");
  }
  return choice;
}

std::string checkpoint_text(const CheckpointChoice& checkpoint) {
  if (checkpoint.file.empty()) return "";
  return fmt::format("{},{}", checkpoint.file, checkpoint.interval_s);
}

PartChoice parse_part(const std::string& name, const std::string& text) {
  const std::vector<std::string> numbers = split(text, '/');
  const auto index = numbers.size() == 2 ? whole<std::uint16_t>(numbers[0]) : std::nullopt;
  const auto count = numbers.size() == 2 ? whole<std::uint16_t>(numbers[1]) : std::nullopt;
  if (!index || !count || *index < 1 || *index > *count) {
    refuse_value(name, text, "expected I/N, the part I of N, with 1 <= I <= N, e.g. 3/16");
  }
  return {*index, *count};
}

std::string part_text(const PartChoice& part) {
  return part.count == 1 ? "" : fmt::format("{}/{}", part.index, part.count);
}

BlockSize parse_block(const std::string& name, const std::string& text) {
  const std::vector<std::string> sides = split(text, 'x');
  const auto x = sides.size() == 2 ? whole<std::uint16_t>(sides[0]) : std::nullopt;
  const auto y = sides.size() == 2 ? whole<std::uint16_t>(sides[1]) : std::nullopt;
  if (!x || !y || *x < 1 || *y < 1)
    refuse_value(name, text, "expected WIDTHxHEIGHT in threads, e.g. 16x16");
  const std::uint64_t threads = std::uint64_t{*x} * *y;
  if (threads > max_block_threads)
    refuse_value(name, text,
                 fmt::format("a block has at most {} threads, {}x{} has {}",
                             grouped(max_block_threads), *x, *y, grouped(threads)));
  return {*x, *y};
}

StageBlocks parse_stage_blocks(const std::string& name, const std::string& text,
                               StageBlocks blocks) {
  const std::vector<std::string> parts = split(text, ',');
  std::set<StageId> seen;
  for (const std::string& part : parts) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos) {
      if (&part != &parts.front())
        refuse_value(name, text, "expected a number of threads, STAGE=THREADS,... or both");
      blocks.fill(parse_stage_threads(name, part));
      continue;
    }
    const auto stage = parse_name<StageId>(name, part.substr(0, equals));
    if (!seen.insert(stage).second)
      refuse_value(name, text, "names " + to_string(stage) + " twice");
    blocks[static_cast<std::size_t>(stage)] = parse_stage_threads(name, part.substr(equals + 1));
  }
  return blocks;
}

std::uint64_t parse_size(const std::string& name, const std::string& text, const std::string& what,
                         std::uint64_t most) {
  std::string digits = text;
  int shift = 0;
  if (text.ends_with('K') || text.ends_with('M')) {
    shift = text.back() == 'K' ? 10 : 20;
    digits.pop_back();
  }
  const auto value = whole<std::uint64_t>(digits);
  if (!value || *value < 1 || *value > most >> shift)
    refuse_value(name, text,
                 fmt::format("expected {} from 1 to {}, e.g. 512K or 2M (times 2^10, 2^20)", what,
                             grouped(most)));
  return *value << shift;
}

std::optional<std::uint32_t> parse_finish_paths(const std::string& name, const std::string& text) {
  if (text == "auto") return std::nullopt;
  return static_cast<std::uint32_t>(parse_integer(name, text, 0, std::uint64_t{1} << 30));
}

int parse_runs(const std::string& name, const std::string& text, std::uint64_t least) {
  return static_cast<int>(parse_integer(name, text, least, 1'000'000));
}

std::string grouped(std::uint64_t value) {
  std::string text = std::to_string(value);
  for (int i = static_cast<int>(text.size()) - 3; i > 0; i -= 3) text.insert(i, ",");
  return text;
}

std::string number_text(float value) { return fmt::format("{}", value); }

std::string vector_text(const std::array<float, 3>& value) {
  return fmt::format("{},{},{}", value[0], value[1], value[2]);
}

std::string block_text(const BlockSize& block) { return fmt::format("{}x{}", block.x, block.y); }

std::string stage_blocks_text(const StageBlocks& blocks) {
  std::map<int, int> stages;
  for (const auto& named : enum_names<StageId>) {
    ++stages[blocks[static_cast<std::size_t>(named.value)]];
  }
  const int usual = std::ranges::max_element(stages, {}, [](auto& s) { return s.second; })->first;
  std::string text = std::to_string(usual);
  for (const auto& [stage, stage_name] : enum_names<StageId>) {
    const int block = blocks[static_cast<std::size_t>(stage)];
    if (block != usual) text += fmt::format(",{}={}", stage_name, block);
  }
  return text;
}

void parse_definition(const std::string& name, const std::string& text,
                      std::map<std::string, std::string>& definitions) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos) {
    refuse_value(name, text, "expected NAME=VALUE");
  }
  if (!definitions.emplace(text.substr(0, equals), text.substr(equals + 1)).second) {
    refuse_value(name, text, "expected each name once");
  }
}

std::string definitions_text(const std::map<std::string, std::string>& definitions) {
  std::string text;
  for (const auto& [name, value] : definitions) {
    if (!text.empty()) text += ' ';
    for (const char c : name + '=' + value) {
      const auto byte = static_cast<unsigned char>(c);
      text += byte <= ' ' || byte == 0x7f || c == '%' ? fmt::format("%{:02X}", byte)
                                                      : std::string(1, c);
    }
  }
  return text;
}

std::vector<std::string> split_definitions(const std::string& text) {
  std::vector<std::string> definitions;
  for (const std::string& part : split(text, ' ')) {
    if (part.empty()) continue;
    std::string& definition = definitions.emplace_back();
    for (std::size_t i = 0; i < part.size(); ++i) {
      unsigned byte = 0;
      const char* const digits = part.data() + i + 1;
      const bool is_code = part[i] == '%' && i + 2 < part.size() &&
                           std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2;
      definition += is_code ? static_cast<char>(byte) : part[i];
      if (is_code) i += 2;
    }
  }
  return definitions;
}

}  // namespace pt
