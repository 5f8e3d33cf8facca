#include "app/options/subcommand_options.h"

#include "app/options/option_values.h"

namespace pt {

template <>
inline constexpr auto enum_names<TraceVariant> =
    std::to_array<EnumName<TraceVariant>>({{TraceVariant::automatic, "auto"},
                                           {TraceVariant::threads, "threads"},
                                           {TraceVariant::persistent, "persistent"},
                                           {TraceVariant::beam, "beam"}});
template <>
inline constexpr auto enum_names<RayKind> =
    std::to_array<EnumName<RayKind>>({{RayKind::primary, "primary"},
                                      {RayKind::ao, "ao"},
                                      {RayKind::diffuse, "diffuse"},
                                      {RayKind::bounce, "bounce:K"}});

namespace {

using S = const std::string&;

AccelKind parse_accel(const std::string& text) {
  const auto accel = parse_name<AccelKind>("accel", text);
  if (accel == AccelKind::embree || accel == AccelKind::optix)
    refuse_name("accel", text, {"auto", "brute", "bvh2", "cwbvh"});
  return accel;
}

int parse_image_size(const std::string& text) {
  const auto size = static_cast<int>(parse_integer("size", text, 1, 8192));
  if ((size & (size - 1)) != 0) refuse_value("size", text, "expected a power of two");
  return size;
}

void parse_kind(const std::string& text, RaysCommand& command) {
  const std::string prefix = "bounce:";
  if (text.starts_with(prefix)) {
    command.kind = RayKind::bounce;
    command.bounces = static_cast<int>(parse_integer("kind", text.substr(prefix.size()), 0, 1000));
  } else {
    command.kind = parse_name<RayKind>("kind", text);
  }
}

void set_scene(const std::string& text, RaysCommand& command) {
  if (!command.scene.empty())
    refuse_value("scene", text, "expected either --scene or --mesh " + command.scene);
  command.scene = text;
}

float parse_fov(const std::string& text) {
  return parse_number("vfov", text, "degrees between 0 and 180",
                      [](float x) { return x > 0.0f && x < 180.0f; });
}

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

int parse_sms(const std::string& text) {
  return static_cast<int>(parse_integer("sms", text, 0, 65535));
}

bool parse_cold(const std::string& text) {
  if (text != "cold" && text != "warm") refuse_value("cache", text, "expected cold or warm");
  return text == "cold";
}

}  // namespace

std::vector<SubcommandOption<TraceCommand>> trace_options() {
  using C = TraceCommand;
  return {
      {"mesh", "FILE|SCENE", "Triangles: a TRBMESH1 file or a scene", [](C& c, S v) { c.mesh = v; },
       true},
      {"rays", "FILE", "Rays, a TRBRAYS1 file", [](C& c, S v) { c.rays = v; }, true},
      {"hits", "FILE", "Reference hits, a TRBHITS1 file", [](C& c, S v) { c.hits = v; }},
      {"output", "FILE", "Writes the hits as a TRBHITS1 file", [](C& c, S v) { c.output = v; }},
      {"accel", "KIND [auto]", "auto, brute, bvh2, cwbvh",
       [](C& c, S v) { c.accel = parse_accel(v); }},
      {"builder", "KIND [auto]",
       "auto (best), sah, sah-reinsert, sbvh, best; on CUDA lbvh, hploc, hploc-reinsert",
       [](C& c, S v) { c.builder = parse_name<TreeBuilder>("builder", v); }},
      {"device", "D [auto]", "auto, cpu, cuda, cuda:N",
       [](C& c, S v) { c.device = parse_device("device", v); }},
      {"sms", "N [0]", "On CUDA: multiprocessors to use, by a green context; 0: all",
       [](C& c, S v) { c.limits.sms = parse_sms(v); }},
      {"variant", "KIND [auto]", "On CUDA: auto, threads, persistent, beam",
       [](C& c, S v) { c.runs.variant = parse_name<TraceVariant>("variant", v); }},
      {"repeat", "N [1]", "Measured runs",
       [](C& c, S v) { c.runs.repeat = parse_runs("repeat", v, 1); }},
      {"warmup", "N [0]", "Warm-up runs, not measured",
       [](C& c, S v) { c.runs.warmup = parse_runs("warmup", v, 0); }},
      {"csv", "FILE", "Appends a row", [](C& c, S v) { c.csv = v; }},
      {"quiet", nullptr, "Prints nothing but errors", [](C& c, S) { c.quiet = true; }},
  };
}

std::vector<SubcommandOption<RaysCommand>> rays_options() {
  using C = RaysCommand;
  return {
      {"mesh", "FILE", "Triangles, a TRBMESH1 file; or --scene", [](C& c, S v) { c.scene = v; }},
      {"scene", "NAME|FILE", "A scene, with its own camera", [](C& c, S v) { set_scene(v, c); }},
      {"output", "FILE", "Rays to write, a TRBRAYS1 file", [](C& c, S v) { c.output = v; }, true},
      {"kind", "KIND [primary]", "primary, ao, diffuse; bounce:K, rays of paths after K bounces",
       [](C& c, S v) { parse_kind(v, c); }},
      {"size", "N [2048]", "Rays of N x N pixels, N a power of two",
       [](C& c, S v) { c.size = parse_image_size(v); }},
      {"look-from", "X,Y,Z", "Camera's position [a mesh: inside the bounding box]",
       [](C& c, S v) { c.camera.look_from = parse_vector("look-from", v); }},
      {"look-at", "X,Y,Z", "Point in the image's centre [the other end of the box]",
       [](C& c, S v) { c.camera.look_at = parse_vector("look-at", v); }},
      {"up", "X,Y,Z [0,1,0]", "Up direction",
       [](C& c, S v) { c.camera.up = parse_vector("up", v); }},
      {"vfov", "DEGREES [40]", "Vertical field of view",
       [](C& c, S v) { c.camera.vertical_fov_degrees = parse_fov(v); }},
  };
}

std::vector<SubcommandOption<CompactCommand>> compact_options() {
  using C = CompactCommand;
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
      {"sms", "N [0]", "On CUDA: multiprocessors to use, by a green context; 0: all",
       [](C& c, S v) { c.limits.sms = parse_sms(v); }},
      {"repeat", "N [10]", "Measured runs, each of many passes",
       [](C& c, S v) { c.runs.repeat = parse_runs("repeat", v, 1); }},
      {"warmup", "N [3]", "Warm-up runs, not measured",
       [](C& c, S v) { c.runs.warmup = parse_runs("warmup", v, 0); }},
      {"csv", "FILE", "Appends a row for each measurement", [](C& c, S v) { c.csv = v; }},
      {"quiet", nullptr, "Prints nothing but errors", [](C& c, S) { c.quiet = true; }},
  };
}

std::vector<SubcommandOption<DoctorCommand>> doctor_options() {
  return {{"json", nullptr, "Prints it as JSON", [](DoctorCommand& c, S) { c.as_json = true; }}};
}

std::vector<SubcommandOption<CalibrateCommand>> calibrate_options() {
  using C = CalibrateCommand;
  return {
      {"device", "D [auto]", "auto, cpu, cuda, cuda:N",
       [](C& c, S v) {
         c.settings.push_back({&find_option("device"), v});
       }},
      {"threads", "N [0]", "CPU threads; 0: one per core",
       [](C& c, S v) {
         c.settings.push_back({&find_option("threads"), v});
       }},
      {"sms", "N [0]", "On CUDA: multiprocessors to use, by a green context; 0: all",
       [](C& c, S v) {
         c.settings.push_back({&find_option("sms"), v});
       }},
      {"quiet", nullptr, "Prints the file's name alone", [](C& c, S) { c.is_quiet = true; }},
  };
}

}  // namespace pt
