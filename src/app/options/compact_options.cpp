#include "app/options/compact_options.h"

#include "app/options/option_values.h"

namespace pt {
namespace {

constexpr std::uint64_t most_items = std::uint64_t{1} << 30;

template <class Parse>
auto parse_list(const std::string& text, Parse&& parse) {
  std::vector<decltype(parse(text))> values;
  for (const std::string& part : split(text, ',')) values.push_back(parse(part));
  return values;
}

std::uint32_t parse_items(const std::string& name, const std::string& text) {
  return static_cast<std::uint32_t>(parse_size(name, text, "a number of slots", most_items));
}

float parse_density(const std::string& text) {
  return parse_number("density", text, "a number from 0 to 1",
                      [](float x) { return x >= 0 && x <= 1; });
}

Compaction parse_strategy(const std::string& text) {
  return parse_name<Compaction>("strategy", text);
}

bool parse_cold(const std::string& text) {
  if (text != "cold" && text != "warm") refuse_value("cache", text, "expected cold or warm");
  return text == "cold";
}

}  // namespace

std::vector<SubcommandOption<CompactCommand>> compact_options() {
  using C = CompactCommand;
  using S = const std::string&;
  return {
      {"items", "N,... [1M,4M,16M]", "Number of slots; K and M mean 2^10 and 2^20",
       [](C& c, S v) { c.items = parse_list(v, [](S one) { return parse_items("items", one); }); }},
      {"density", "A,... [0.1,0.5,0.9]", "Fraction of the slots that wait, 0 to 1",
       [](C& c, S v) { c.densities = parse_list(v, parse_density); }},
      {"run", "N [1]", "Length of runs of slots that wait, or do not, together",
       [](C& c, S v) { c.run_length = parse_items("run", v); }},
      {"queues", "N,... [1,2]", "Queues that a pass fills: 1, 2",
       [](C& c, S v) {
         c.queues = parse_list(v, [](S one) {
           return static_cast<int>(parse_integer("queues", one, 1, measured_queues_max));
         });
       }},
      {"strategy", "NAME,... [cub,scan,atomic,none]",
       "cub, scan, atomic, none, as --compaction has them",
       [](C& c, S v) { c.strategies = parse_list(v, parse_strategy); }},
      {"cache", "cold|warm [cold]", "cold: passes cycle through uncached memory; warm: reuse it",
       [](C& c, S v) { c.runs.cold = parse_cold(v); }},
      {"device", "D [auto]", "auto, cpu, cuda, cuda:N",
       [](C& c, S v) { c.device = parse_device("device", v); }},
      {"repeat", "N [10]", "Measured runs, each of many passes",
       [](C& c, S v) { c.runs.repeat = parse_runs("repeat", v, 1); }},
      {"warmup", "N [3]", "Warm-up runs, not measured",
       [](C& c, S v) { c.runs.warmup = parse_runs("warmup", v, 0); }},
      {"csv", "FILE", "Appends a row for each measurement", [](C& c, S v) { c.csv = v; }},
      {"quiet", nullptr, "Prints nothing but errors", [](C& c, S) { c.quiet = true; }},
  };
}

}  // namespace pt
