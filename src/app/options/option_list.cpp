#include "app/options/option_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "app/options/option_entry.h"
#include "app/options/option_values.h"

namespace pt {
namespace {

using namespace option_entry;

constexpr std::uint64_t max_int = INT32_MAX;
// Some room below the largest int: a scene adds its own primitives to the random ones.
constexpr std::uint64_t max_spheres = 100'000'000;

using Kind = DeviceChoice::Kind;

constexpr Mode parallel[] = {Mode::megakernel, Mode::wavefront};
constexpr Mode megakernel[] = {Mode::megakernel}, wavefront[] = {Mode::wavefront};
constexpr Kind cpu[] = {Kind::cpu}, cuda[] = {Kind::cuda}, any_device[] = {Kind::cpu, Kind::cuda};

/// Breaks a text that a table has made into lines of the help.
std::string in_lines(const std::string& text) {
  constexpr std::size_t columns = 60;
  std::string lines, line;
  for (const std::string& word : split(text, ' ')) {
    if (!line.empty() && line.size() + 1 + word.size() > columns) {
      lines += line + '\n';
      line.clear();
    }
    line.append(line.empty() ? "" : " ").append(word);
  }
  return lines + line;
}

/// Adds the options of a group to the list.
class Group {
 public:
  Group(std::vector<OptionEntry>& list, OptionGroup group) : list_(list), group_(group) {}

  Group& add(OptionEntry entry, std::string help, std::string short_flag = "") {
    entry.group = group_;
    entry.help = std::move(help);
    entry.short_flag = std::move(short_flag);
    list_.push_back(std::move(entry));
    return *this;
  }

  /// Restricts the option added last, or this value of it, to these modes and devices.
  Group& only(std::span<const Mode> modes, std::span<const Kind> devices, std::string value = "",
              std::string instead = "") {
    list_.back().rules.push_back({std::move(value), modes, devices, std::move(instead)});
    return *this;
  }

  /// Leaves the option added last to --help-all.
  Group& expert() {
    list_.back().is_expert = true;
    return *this;
  }

 private:
  std::vector<OptionEntry>& list_;
  OptionGroup group_;
};

void add_image(std::vector<OptionEntry>& list) {
  Group(list, OptionGroup::image)
      .add(integer("width", &Options::width, 1, 65535), "Width in pixels, 1 to 65,535")
      .add(integer("height", &Options::height, 1, 65535), "Height in pixels, 1 to 65,535")
      .add(integer("spp", &Options::spp, 1, max_int), "Samples (paths) per pixel")
      .add(choice("integrator", &Options::integrator),
           "path: path tracing; mlt: Metropolis light transport, Markov\n"
           "chains of mutated paths (docs/design/metropolis.md)")
      .add(integer("max-depth", &Options::max_depth, 1, 65535),
           "Longest path, in rays, the camera ray included")
      .add(integer("rr", &Options::rr_depth, 0, 65535),
           "Russian roulette may end paths of this many rays or more;\n0: never")
      .add(on_off("nee", &Options::nee),
           "Next-event estimation: surfaces sample a light and cast a\n"
           "shadow ray; off: BSDF samples alone hit emitters")
      .add(choice("light-selection", &Options::light_selection),
           "Probability of a light: uniform, proportional to its power, or\n"
           "to its estimated contribution at the shading point, by a light\n"
           "tree; auto: uniform in scenes of quads and spheres alone, else\n"
           "tree with more than 16 emitters, power with fewer")
      .add(choice("mis", &Options::mis),
           "Multiple importance sampling of light and BSDF samples: weights\n"
           "by the power or the balance heuristic; none: emitters that can\n"
           "be sampled count only after a delta bounce")
      .expert()
      .add(choice("sampling", &Options::sampling),
           "How directions are sampled at surfaces: uniform or cosine-\n"
           "weighted over the hemisphere, or by the BSDF")
      .expert()
      .add(choice("sampler", &Options::sampler),
           "A pixel's samples: independent, stratified, or Owen-scrambled\n"
           "Sobol points (best if --spp is a power of two)")
      .add(on_off("multiple-scattering", &Options::multiple_scattering),
           "Multiple scattering between the microfacets of rough\n"
           "conductors, whose energy is lost otherwise. Other materials\n"
           "do not change")
      .add(value(
               "seed", OptionForm::number, "N", &Options::seed,
               [](const std::string& name, const std::string& s) {
                 return parse_integer(name, s, 0, UINT64_MAX);
               },
               [](std::uint64_t seed) { return std::to_string(seed); }),
           "Seed of the random numbers, 64 bits")
      .add(text("output", "FILE", &Options::output),
           "Image to write: .exr (linear float), .png (8-bit sRGB) or\n.ppm (8-bit, gamma 2)", "-o")
      .add(value("exposure", OptionForm::number, "auto|STOPS", &Options::exposure, parse_exposure,
                 exposure_text),
           "Multiplies a .png or .ppm by 2^STOPS; auto: so that its mean\n"
           "is middle grey. Default: 0; auto for the .png of a scene file\n"
           "in photometric units or in default lighting. No effect on .exr")
      .add(value("crop", OptionForm::text, "X0,Y0,X1,Y1", &Options::crop, parse_crop, crop_text),
           "Renders the pixels with X0 <= x < X1 and Y0 <= y < Y1 (0,0 is\n"
           "the upper left), equal to those of the whole image. The data\n"
           "window of an .exr has their position")
      .add(value("filter", OptionForm::text, "KIND[:A[:B]]", &Options::filter, parse_filter,
                 filter_text),
           in_lines("Reconstruction filter: " + filter_forms(", ") +
                    "; lengths in pixels. Default: the scene file's, else a box of one pixel"))
      .add(value("aov", OptionForm::text, "NAME,...", &Options::aovs, parse_aovs, aovs_text),
           in_lines("Further layers of the .exr, of the first hit and of the samples: " +
                    aov_names(", ")));
}

/// Also takes the old name `sort`, which means `atomic` with --order-surfaces on.
OptionEntry compaction_entry() {
  OptionEntry entry = choice("compaction", &Options::compaction);
  entry.set = [set = entry.set](Options& o, const std::string& value) {
    set(o, value == "sort" ? "atomic" : value);
    if (value == "sort") o.order_surfaces = SurfaceOrdering::on;
  };
  return entry;
}

OptionEntry path_bytes_entry() {
  const auto parse = [](const std::string& name, const std::string& text) {
    const auto bytes = static_cast<int>(parse_integer(name, text, 0, path_bytes_max));
    if (bytes % path_bytes_step != 0)
      refuse_value(
          name, text,
          fmt::format("expected a multiple of {} up to {}", path_bytes_step, path_bytes_max));
    return bytes;
  };
  return value("path-bytes", OptionForm::number, "N", &Options::path_bytes, parse,
               [](int x) { return std::to_string(x); });
}

/// 0 stands for an option that is not given.
OptionEntry limit(std::string name, int DeviceLimits::*field) {
  return value(
      std::move(name), OptionForm::number,
      "N", [field](auto& options) -> auto& { return options.limits.*field; },
      [](const std::string& n, const std::string& s) {
        return static_cast<int>(parse_integer(n, s, 0, 65535));
      },
      [](int x) { return x == 0 ? std::string() : std::to_string(x); });
}

/// Adds a definition to those given before.
OptionEntry define_entry() {
  OptionEntry entry{.name = "define", .form = OptionForm::list, .placeholder = "NAME=VALUE"};
  entry.set = [](Options& o, const std::string& s) {
    parse_definition("define", s, o.definitions);
  };
  entry.text = [](const Options& o) { return definitions_text(o.definitions); };
  return entry;
}

void add_metropolis(std::vector<OptionEntry>& list) {
  Group(list, OptionGroup::metropolis)
      .add(size_or_auto("chains", &Options::chains, "chains", 1 << 27),
           "Number of Markov chains, one path in flight each; auto: enough\n"
           "to fill the device. It changes the noise")
      .expert()
      .add(number("large-step-probability", "P", &Options::large_step_probability,
                  "a number above 0, at most 1", [](float x) { return x > 0 && x <= 1; }),
           "Probability of a large step, an independent path")
      .expert()
      .add(number("mutation-size", "SIZE", &Options::mutation_size, "a number above 0, at most 0.5",
                  [](float x) { return x > 0 && x <= 0.5f; }),
           "Largest change of a random number by a small step; the\n"
           "smallest is a sixteenth of it")
      .expert()
      .add(size_or_auto("bootstrap", &Options::bootstrap, "paths", 1 << 30),
           "Bootstrap paths, from which the chains' first states are\n"
           "drawn; auto: twice the mutations, within 2^20 to 2^30 on CUDA\n"
           "and 2^17 to 2^25 on the CPU, or half of --time-limit")
      .expert();
}

void add_stops(std::vector<OptionEntry>& list) {
  Group(list, OptionGroup::stops)
      .add(number("time-limit", "SECONDS", &Options::time_limit, "seconds above 0",
                  [](float x) { return x > 0; }),
           "Seconds of rendering, without scene preparation")
      .add(number("target-error", "X", &Options::target_error, "a number above 0",
                  [](float x) { return x > 0; }),
           "Relative standard error of the image: square root of the\n"
           "pixels' mean variance, over their mean, of luminance");
}

void add_parts(std::vector<OptionEntry>& list) {
  Group(list, OptionGroup::parts)
      .add(value("checkpoint", OptionForm::text, "FILE[,SECONDS]", &Options::checkpoint,
                 parse_checkpoint, checkpoint_text),
           "Saves the render so far as an .exr, every 300 seconds or as\n"
           "often as said, at its end, and at SIGINT, SIGTERM or SIGUSR1;\n"
           "ptexp resume FILE goes on")
      .add(value("part", OptionForm::text, "I/N", &Options::part, parse_part, part_text),
           "Renders the part I of N disjoint parts of the image into\n"
           "--checkpoint FILE; ptexp merge joins them");
}

void add_scene(std::vector<OptionEntry>& list) {
  Group(list, OptionGroup::scene)
      .add(text("scene", "NAME|FILE", &Options::scene),
           "A scene of --list-scenes, or a file: Mitsuba .xml, .gltf,\n"
           ".glb, .pbrt (version 4), .obj, .ply. Options override a\n"
           "file's size, spp, depth and camera")
      .add(define_entry(), "Sets a parameter of a Mitsuba file; may be repeated", "-D")
      .add(flag("strict", &Options::strict),
           "Unsupported features of a scene file are errors, not warnings")
      .add(choice("default-lighting", &Options::default_lighting),
           "A soft light from behind and above the camera. auto: where a\n"
           "scene file has no light, or a .gltf, .glb or .obj has none\n"
           "that reaches what its camera sees")
      .add(choice("volume", &Options::volume),
           "How sparse grids lie in memory: the same image. auto: sparse\n"
           "where that takes less than half of more than 64 MiB")
      .add(value(
               "time", OptionForm::number, "SECONDS", &Options::time,
               [](const std::string& name, const std::string& s) {
                 return parse_number(name, s, "a number of seconds", [](float) { return true; });
               },
               [](const std::optional<float>& x) { return x ? number_text(*x) : ""; }),
           "Evaluates the animations of a .gltf or .glb at this time:\n"
           "nodes, morph targets and skins are as they are then. By\n"
           "default animations are ignored")
      .add(value(
               "shutter", OptionForm::number, "SECONDS", &Options::shutter,
               [](const std::string& name, const std::string& s) {
                 return parse_number(name, s, "seconds above 0", [](float x) { return x > 0; });
               },
               [](const std::optional<float>& x) { return x ? number_text(*x) : ""; }),
           "With --time: so long the shutter of a .gltf or .glb is open,\n"
           "from that time on. What moves is blurred")
      .add(value(
               "animation", OptionForm::number, "N|NAME", &Options::animation,
               [](const std::string& name, const std::string& s) {
                 if (s.empty()) refuse_value(name, s, "expected a number or a name");
                 return s;
               },
               [](const std::string& x) { return x; }),
           "With --time: only this animation, by its name or number. By\n"
           "default all, but for those that move what one before moves")
      .add(flag("scene-from-disk", &Options::scene_from_disk),
           "In an MPI job each rank reads the scene's files; by default the\n"
           "first one does, and sends them to the others")
      .add(integer("spheres", &Options::spheres, 0, max_spheres),
           "Random spheres of the scene 'spheres', besides the ground")
      .add(choice("create-world", &Options::create_world),
           "Where a random scene is made: on the host or by a CUDA kernel;\n"
           "the scene is the same")
      .expert()
      .only(parallel, cuda, "device");
}

void add_camera(std::vector<OptionEntry>& list) {
  Group(list, OptionGroup::camera)
      .add(vector("look-from", &CameraOverrides::look_from), "Position of the camera; also X,Y,Z")
      .add(vector("look-at", &CameraOverrides::look_at), "The point in the image's centre")
      .add(vector("up", &CameraOverrides::up), "The direction that is up in the image")
      .add(number("fov", "DEGREES", &CameraOverrides::vertical_fov_degrees,
                  "an angle above 0 and below 180 degrees",
                  [](float x) { return x > 0 && x < 180; }),
           "Vertical field of view, between 0 and 180 degrees")
      .add(number("aperture", "LENGTH", &CameraOverrides::aperture, "a length of 0 or more",
                  [](float x) { return x >= 0; }),
           "Diameter of the lens; 0: pinhole camera")
      .add(number("focus-distance", "LENGTH", &CameraOverrides::focus_distance, "a length above 0",
                  [](float x) { return x > 0; }),
           "Distance from the lens to the plane in focus");
}

void add_execution(std::vector<OptionEntry>& list) {
  Group(list, OptionGroup::execution)
      .add(choice("mode", &Options::mode),
           "auto: megakernel or wavefront, whichever is expected to be\n"
           "faster; they give the same image.\n"
           "serial: one CPU thread, one path after the other.\n"
           "megakernel: each thread traces whole paths.\n"
           "wavefront: one kernel per stage over a pool of paths")
      .add(value("device", OptionForm::text, "auto|cpu[:N]|cuda[:N,..|:all]", &Options::device,
                 parse_devices, [](const DeviceChoice& device) { return to_string(device); }),
           "Where to render; auto: the first GPU if there is one, else the\n"
           "CPU; cuda:0,2 or cuda:all: several GPUs, to the same image;\n"
           "cpu:N: N devices that share the threads. See --list-devices")
      .only(parallel, cuda, "cuda")
      .add(integer("threads", &Options::threads, 0, 65535), "CPU threads; 0: one per core")
      .only(parallel, cpu)
      .add(limit("sms", &DeviceLimits::sms),
           "CUDA: multiprocessors of each GPU to render on, by a green\n"
           "context (CUDA 12.4); memory and L2 cache stay whole. 0: all")
      .expert()
      .only(parallel, cuda, "", "on a CPU, --threads sets the size")
      .add(limit("shared-memory-max", &DeviceLimits::shared_memory_max),
           "CUDA: KiB of shared memory that a block may have, as on a\n"
           "smaller GPU (99 on GeForce); 0: what the GPU has")
      .expert()
      .only(parallel, cuda)
      .add(choice("accel", &Options::accel),
           "Acceleration structure: none (every primitive is tested), a\n"
           "binary BVH, a compressed 8-wide BVH (triangles only), or\n"
           "Embree's (CPU, triangles only); optix: NVIDIA's OptiX (CUDA,\n"
           "no motion); auto: by scene and device, never optix")
      .add(choice("optix-hits", &Options::optix_hits),
           "--accel optix: who decides what a ray hits. custom: OptiX\n"
           "finds boxes, our test decides; any-hit: it finds triangles,\n"
           "our test decides; built-in: OptiX decides, bits may differ")
      .expert()
      .only(parallel, cuda)
      .add(on_off("reorder", &Options::reorder),
           "--accel optix, megakernel: threads are reordered by what their\n"
           "rays hit, before they shade (GPUs with RT cores, from Ada on)")
      .expert()
      .only(megakernel, cuda)
      .add(choice("builder", &Options::builder),
           "Builder of BVHs over triangles: on the CPU binned SAH, also\n"
           "with reinsertion, SBVH, or the best of these by trial rays; on\n"
           "the GPU LBVH or H-PLOC; auto: the one with which building and\n"
           "rendering end first. BVHs over instances and spheres are\n"
           "always built on the CPU")
      .add(choice("work", &Options::work),
           "megakernel: work of a thread: a pixel, a sample, or samples\n"
           "that it fetches from a global counter (persistent threads)")
      .expert()
      .only(megakernel, any_device)
      .add(value("block", OptionForm::text, "WxH", &Options::block, parse_block, block_text),
           "megakernel on CUDA: thread block, at most 1,024 threads")
      .expert()
      .only(megakernel, cuda)
      .add(choice("kernel-set", &Options::kernel_set),
           "lean: for the paper's spheres, quads and materials alone, with\n"
           "the default ways to sample; general: for every scene; auto:\n"
           "lean where it can")
      .expert()
      .add(choice("kernel", &Options::kernel),
           "megakernel on CUDA. loop: each iteration traces one ray per\n"
           "lane to its end. vote: warp-level phase voting between\n"
           "traversal, triangle tests and shading. sort: block-local\n"
           "wavefront that sorts paths by BSDF. auto: sort in scenes of\n"
           "triangles alone; vote there if --block is given and all BSDFs\n"
           "are of one kind; else loop")
      .expert()
      .only(megakernel, cuda)
      .add(compaction_entry(),
           "wavefront: compaction of the paths that wait for a stage.\n"
           "cub: CUB's ordered selection; scan: the same by our own\n"
           "kernel; atomic: unordered appends; none: every stage visits\n"
           "the whole pool")
      .expert()
      .only(wavefront, any_device)
      .add(size_or_auto("pool-size", &Options::pool_size, "paths", INT32_MAX),
           "wavefront: slots of the pool, the most paths in flight; K and\nM mean 2^10 and 2^20")
      .expert()
      .only(wavefront, any_device)
      .add(choice("layout", &Options::layout),
           "wavefront: the pool's memory layout: structure of arrays, the\n"
           "same with a ray's two records in one 32-byte sector, or array\n"
           "of structures")
      .expert()
      .only(wavefront, any_device)
      .add(choice("order-surfaces", &Options::order_surfaces),
           "wavefront: the queue of surfaces is sorted by BSDF type; auto:\n"
           "on CUDA, if the scene has many types or expensive ones")
      .expert()
      .only(wavefront, any_device)
      .add(choice("stages", &Options::stages),
           "wavefront: split: a stage traces and others shade; fused: one\n"
           "kernel does both and no hit is stored; auto: fused where\n"
           "rays are cheap, in scenes of spheres and quads with --accel\n"
           "brute")
      .expert()
      .only(wavefront, any_device)
      .add(integer("wave-collisions", &Options::wave_collisions, 0, 65535),
           "wavefront, in media with grids: suspends delta tracking after N\n"
           "null collisions until the next wave; 0: a flight is never\n"
           "suspended")
      .expert()
      .only(wavefront, any_device)
      .add(integer("wave-rays", &Options::wave_rays, 1, 65535),
           "wavefront with --stages fused: rays per path and wave; with\n"
           "--max-depth rays it is nearly the megakernel")
      .expert()
      .only(wavefront, any_device)
      .add(path_bytes_entry(),
           "More state of every path, a multiple of 16 to 256, that each\n"
           "ray reads, changes and stores where the path's state is; it\n"
           "stands for spectra, derivatives or guiding. On CUDA only in a\n"
           "build with PTEXP_PATH_STATE, see --list-kernels")
      .expert()
      .add(on_off("regenerate", &Options::regenerate),
           "wavefront: a path that ends gives its slot to a new one;\n"
           "off: the pool runs empty before it is filled again")
      .expert()
      .only(wavefront, any_device)
      .add(on_off("persistent", &Options::persistent),
           "wavefront on CUDA: persistent threads trace appended ray\n"
           "queues through a wide BVH, in scenes without spheres; off: a\n"
           "thread per ray")
      .expert()
      .only(wavefront, cuda)
      .add(value("finish-paths", OptionForm::number, "N|auto", &Options::finish_paths,
                 parse_finish_paths,
                 [](const auto& paths) { return paths ? std::to_string(*paths) : "auto"; }),
           "wavefront: when no sample is left to start and at most this\n"
           "many paths are alive, a thread traces each to its end; 0:\n"
           "waves to the last ray; auto: fewer where paths cost more")
      .expert()
      .only(wavefront, any_device)
      .add(choice("schedule", &Options::schedule),
           "wavefront: the host launches every stage, or one CUDA graph\n"
           "loops on the device; auto: graph on CUDA, host on the CPU")
      .expert()
      .only(wavefront, any_device)
      .only(wavefront, cuda, "graph")
      .add(value(
               "stage-block", OptionForm::text, "[N,][STAGE=N,...]", &Options::stage_block,
               [](const std::string& name, const std::string& s) {
                 return parse_stage_blocks(name, s, Options().stage_block);
               },
               stage_blocks_text),
           "wavefront on CUDA: threads per block, for all stages, by name\n"
           "or both: generate, intersect, shade_miss, shade_surface,\n"
           "shadow, bounce (of fused stages), finish, accumulate; e.g.\n"
           "intersect=128,shadow=64")
      .expert()
      .only(wavefront, cuda)
      .add(text("calibration", "auto|none|FILE", &Options::calibration),
           "Numbers by which auto decides. auto: those that ptexp calibrate\n"
           "has measured on this device, or none: an H200's; a file: its")
      .expert();
}

void add_toggles(std::vector<OptionEntry>& list) {
  Group(list, OptionGroup::toggles)
      .add(choice("scene-memory", &Options::scene_memory),
           "CUDA: memory from which kernels read the spheres; constant\n"
           "memory is refused if they do not fit")
      .expert()
      .only(parallel, cuda, "shared")
      .only(parallel, cuda, "constant")
      .add(choice("branching", &Options::branching),
           "reduced: a miss is shaded as a surface that reflects nothing,\n"
           "so that hits and misses share one branch; on CUDA only with\n"
           "--accel brute, --rng philox and global memory")
      .expert()
      .only(parallel, any_device, "reduced")
      .add(choice("rng", &Options::rng),
           "philox: counter-based. xorwow: a stored state per path,\n"
           "initialised by render_init as in the paper; on CUDA only with\n"
           "--accel brute")
      .expert();
}

void add_measurement(std::vector<OptionEntry>& list) {
  Group(list, OptionGroup::measurement)
      .add(integer("repeat", &Options::repeat, 1, 1'000'000), "Measured renders of the image")
      .add(integer("warmup", &Options::warmup, 0, 1'000'000),
           "Renders before them that are not measured")
      .add(flag("counters", &Options::counters),
           "Reads the GPU's counters of each kernel (SIMT efficiency,\n"
           "occupancy, cache hits, bytes), in renders after the measured\n"
           "ones; docs/experiments.md explains them")
      .only(
          parallel, cuda, "",
          "on a CPU `perf stat -d ptexp ...` counts, and without --quiet the wavefront prints the "
          "time of each stage")
      .add(text("stats", "FILE", &Options::stats_file),
           "Writes all options, times, counts and kernels as JSON;\n"
           "docs/statistics.md explains the fields")
      .add(text("csv", "FILE", &Options::csv_file),
           "Appends the same as one row, below a header if the file is\n"
           "new; a file with other columns is refused")
      .add(flag("explain", &Options::explain),
           "Prints how the render would be executed, and why, instead\nof rendering")
      .add(flag("quiet", &Options::quiet),
           "No progress, no table and no warnings of the scene's file", "-q");
}

}  // namespace

const std::vector<OptionEntry>& option_list() {
  static const std::vector<OptionEntry> list = [] {
    std::vector<OptionEntry> entries;
    add_image(entries);
    add_metropolis(entries);
    add_stops(entries);
    add_parts(entries);
    add_scene(entries);
    add_camera(entries);
    add_execution(entries);
    add_toggles(entries);
    add_measurement(entries);
    return entries;
  }();
  return list;
}

bool is_of_one_render(const OptionEntry& entry) {
  const bool measures_or_parts =
      entry.group == OptionGroup::measurement || entry.group == OptionGroup::parts;
  return entry.name == "output" || (measures_or_parts && entry.name != "quiet");
}

const OptionEntry& find_option(std::string_view name) {
  const auto& list = option_list();
  const auto found = std::ranges::find(list, name, &OptionEntry::name);
  if (found == list.end()) throw std::logic_error("no option is named " + std::string(name));
  return *found;
}

std::string heading(OptionGroup group) {
  switch (group) {
    case OptionGroup::image:
      return "Image";
    case OptionGroup::metropolis:
      return "Metropolis light transport (--integrator mlt; --spp is the mutations per pixel)";
    case OptionGroup::stops:
      return "Stops (the first that is reached ends the render; without --spp they alone do)";
    case OptionGroup::parts:
      return "Parts of a render (ptexp resume, ptexp merge and ptexp verify read their files)";
    case OptionGroup::scene:
      return "Scene";
    case OptionGroup::camera:
      return "Camera (in scene units; by default the scene's own)";
    case OptionGroup::execution:
      return "Execution (how the image is made, not what it shows)";
    case OptionGroup::toggles:
      return "The paper's toggles (of these xorwow alone changes the image)";
    case OptionGroup::measurement:
      break;
  }
  return "Measurement";
}

bool determines_image(const OptionEntry& entry) {
  const auto is_one_of = [](const std::string& text, std::initializer_list<const char*> list) {
    return std::ranges::any_of(list, [&](const char* one) { return text == one; });
  };
  if (is_one_of(entry.name, {"output", "exposure", "spp", "strict", "scene-from-disk", "volume"}))
    return false;
  if (is_one_of(entry.name, {"rng", "kernel-set"})) return true;
  return entry.group == OptionGroup::image || entry.group == OptionGroup::scene ||
         entry.group == OptionGroup::camera || entry.group == OptionGroup::metropolis;
}

std::string option_key(const OptionEntry& entry) {
  std::string key = entry.name;
  std::ranges::replace(key, '-', '_');
  return key;
}

}  // namespace pt
