#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/options/option_values.h"
#include "app/render/render_outputs.h"
#include "app/report/csv_file.h"
#include "app/report/report.h"
#include "common/accel/build/build_triangle_tree.h"
#include "common/device/devices.h"
#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/error/terminal.h"
#include "common/image/atomic_file.h"
#include "common/rays/trace_rays.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/scene/prepare/prepare_steps.h"

namespace pt {
namespace {

/// The results of `ptexp trace`.
struct TraceReport {
  DeviceInfo device;
  std::uint64_t triangles = 0, rays = 0;
  RayType type = RayType::closest;
  TreeSummary tree;
  Spread time_ms;
  TraceVariant variant = TraceVariant::automatic;
  int threads = 0;

  double mrays_per_s() const {
    return time_ms.median > 0 ? static_cast<double>(rays) / time_ms.median / 1e3 : 0;
  }
  double bytes_per_triangle() const {
    return static_cast<double>(tree.size_bytes) / static_cast<double>(triangles);
  }
};

/// By the builder's cost of a triangle.
double sah_cost(const TraceCommand& command, const TraceReport& report) {
  const bool is_wide = command.accel == AccelKind::cwbvh;
  return report.tree.quality.sah_cost(
      static_cast<double>((is_wide ? default_cwbvh_costs : default_bvh2_costs).triangle));
}

/// The builder that was used: `auto` chooses one per group, and the device replaces a tree that is
/// too deep.
std::string builder_name(const TraceCommand& command, const TraceReport& report) {
  return report.tree.builder.empty() ? to_string(command.builder) : report.tree.builder;
}

const char* variant_name(TraceVariant variant) {
  constexpr const char* names[] = {"cpu", "threads", "persistent", "beam"};
  return names[static_cast<int>(variant)];
}

CsvRow csv_row(const TraceCommand& command, const TraceReport& report) {
  const auto number = [](double x) { return fmt::format("{:.6g}", x); };
  CsvRow row = origin_columns(command.command_line, report.device, report.threads);
  const CsvRow own{{"mesh", command.mesh},
                   {"triangles", std::to_string(report.triangles)},
                   {"ray_file", command.rays},
                   {"type", report.type == RayType::any ? "any" : "closest"},
                   {"rays", std::to_string(report.rays)},
                   {"accel", to_string(command.accel)},
                   {"builder", builder_name(command, report)},
                   {"variant", variant_name(report.variant)},
                   {"nodes", std::to_string(report.tree.quality.nodes)},
                   {"sah_cost", number(sah_cost(command, report))},
                   {"bytes_per_triangle", number(report.bytes_per_triangle())},
                   {"build_ms", number(report.tree.build_ms)},
                   {"repeat", std::to_string(command.runs.repeat)},
                   {"warmup", std::to_string(command.runs.warmup)},
                   {"time_ms", number(report.time_ms.median)},
                   {"time_min_ms", number(report.time_ms.min)},
                   {"time_max_ms", number(report.time_ms.max)},
                   {"mrays_per_s", number(report.mrays_per_s())}};
  row.insert(row.end(), own.begin(), own.end());
  return row;
}

void print_report(const TraceCommand& command, const TraceReport& report) {
  const Spread& t = report.time_ms;
  print("device     {}: {}\n", to_string(report.device.choice), report.device.name);
  print("tree       {} by {}: {} triangles, {} nodes, {:.1f} bytes per triangle\n",
        to_string(command.accel), builder_name(command, report), grouped(report.triangles),
        grouped(report.tree.quality.nodes), report.bytes_per_triangle());
  print("built in   {:.1f} ms, SAH cost {:.2f}\n", report.tree.build_ms, sah_cost(command, report));
  print("rays       {}, {} hit, {}\n", grouped(report.rays),
        report.type == RayType::any ? "any" : "closest", variant_name(report.variant));
  print("time       {:.4f} ms, {:.4f} to {:.4f} in {} runs\n", t.median, t.min, t.max,
        command.runs.repeat);
  print("rate       {:.1f} Mrays/s\n", report.mrays_per_s());
}

int print_comparison(const TraceCommand& command, const HitComparison& c) {
  if (!command.quiet) {
    print("agreement  {} the same, {} ties, {} at another distance, {} missed, {} invented\n",
          c.same, c.ties, c.other, c.missed, c.invented);
    if (!c.first.empty()) print("first      {}\n", c.first);
  }
  return c.agrees() ? 0 : 1;
}

TreeOptions tree_options_of(const TraceCommand& command) {
  TreeOptions options;
  options.accel = command.accel;
  options.builder = command.builder;
  return options;
}

void check_command(const TraceCommand& command, const DeviceInfo& device) {
  if (!command.output.empty()) check_writable(command.output);
  for (const std::string& read : {command.mesh, command.rays, command.hits}) {
    check_not_read("--output", command.output, read);
    check_not_read("--csv", command.csv, read);
  }
  check_not_read("--csv", command.csv, command.output);
  if (!command.csv.empty()) check_csv(command.csv, csv_row(command, {}));
  check_tracing(tree_options_of(command), command.runs, device);
}

HitSet read_reference(const TraceCommand& command, const RaySet& rays) {
  HitSet hits = read_hits(command.hits);
  if (hits.hits.size() != rays.rays.size() || hits.type != rays.type)
    throw Error(fmt::format("{}: is not of the rays in {}", command.hits, command.rays));
  return hits;
}

/// Inside the box near its +z side, looking down along it, which sees something in most meshes.
CameraParameters default_camera(const Bounds& bounds) {
  const Vec3 size = bounds.max - bounds.min;
  CameraParameters camera;
  camera.look_from = bounds.center() + Vec3(0.1434f, 0.0107f, 0.4422f) * size;
  camera.look_at = bounds.center() + Vec3(0.0045f, -0.1575f, -0.2407f) * size;
  return camera;
}

/// Ray files are large: prints the size and checks disk and memory before the scene is prepared.
void check_size(const RaysCommand& command) {
  const std::uint64_t size_bytes = ray_bytes_max(command.kind, command.size);
  check_writable(command.output);
  check_not_read("--output", command.output, command.scene);
  check_room(command.output, size_bytes);
  check_host_memory(2 * size_bytes, fmt::format("--size {}: the rays", command.size));
  print_notice(fmt::format("rays: up to {} MB will be written to {}",
                           grouped((size_bytes + 999'999) / 1'000'000), command.output));
}

}  // namespace

int trace_command(const TraceCommand& given) {
  TraceCommand command = given;
  if (command.accel == AccelKind::automatic) command.accel = AccelKind::cwbvh;
  const DeviceInfo device = limited(choose_device(command.device), command.limits);
  check_command(command, device);
  const SceneData scene = load_triangles(command.mesh);
  const RaySet rays = read_rays(command.rays);
  HitSet reference;
  if (!command.hits.empty()) reference = read_reference(command, rays);
  const auto [result, tree] =
      build_and_trace(scene, tree_options_of(command), rays, command.runs, device);
  TraceReport report;
  report.device = device;
  report.triangles = scene.triangle_count();
  report.rays = rays.rays.size();
  report.type = rays.type;
  report.tree = tree;
  report.threads = result.threads;
  report.time_ms = spread(result.times_ms);
  report.variant = result.variant;
  if (!command.quiet) print_report(command, report);
  Attempts attempts;
  if (!command.output.empty())
    attempts.make([&, &hits = result.hits] { write_hits(command.output, {rays.type, hits}); });
  if (!command.csv.empty())
    attempts.make([&] { append_csv_row(command.csv, csv_row(command, report)); });
  int code = 0;
  if (!command.hits.empty())
    code = print_comparison(
        command, compare_hits(result.hits, reference.hits, position_resolution(rays.rays)));
  attempts.check();
  return code;
}

int rays_command(const RaysCommand& command) {
  if (command.scene.empty()) throw Error("rays: expected --scene NAME|FILE or --mesh FILE");
  check_size(command);
  SceneData scene = load_traced_scene(command.scene);
  if (command.scene.ends_with(".mesh")) scene.camera = default_camera(scene_bounds(scene));
  override_camera(scene.camera, command.camera);
  prepare_scene(scene);
  const RaySet rays = generate_rays(command.kind, scene, command.size, command.bounces);
  write_rays(command.output, rays);
  print("wrote {}: {} rays\n", command.output, grouped(rays.rays.size()));
  return 0;
}

}  // namespace pt
