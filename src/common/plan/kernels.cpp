#include "common/plan/kernels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

#include "common/options/option_names.h"

namespace pt {
namespace {

/// A body as the list and as the command line name it.
struct BodyName {
  KernelBody body;
  Mode mode;
  const char *name, *option;
};
constexpr BodyName body_names[] = {
    {KernelBody::serial, Mode::serial, "serial", "--mode serial"},
    {KernelBody::loop, Mode::megakernel, "megakernel loop", "--kernel loop"},
    {KernelBody::vote, Mode::megakernel, "megakernel vote", "--kernel vote"},
    {KernelBody::blocks, Mode::megakernel, "megakernel sort", "--kernel sort"},
    {KernelBody::stages, Mode::wavefront, "wavefront split", "--stages split"},
    {KernelBody::warps, Mode::wavefront, "wavefront warps", "--persistent on"},
    {KernelBody::fused, Mode::wavefront, "wavefront fused", "--stages fused"},
    {KernelBody::optix, Mode::megakernel, "megakernel OptiX", "--accel optix"},
    {KernelBody::queues, Mode::wavefront, "wavefront OptiX", "--accel optix"},
};
constexpr const char* source_names[] = {"philox", "xorwow", "any sampler"};
constexpr const char* geometry_names[] = {"spheres, quads", "triangles", "all primitives"};
constexpr const char* lighting_names[] = {"sky", "sky, emitters", "all lights"};
constexpr const char* content_names[] = {"spheres", "instances", "boundaries without a BSDF",
                                         "deforming meshes"};

const BodyName& name_of(KernelBody body) { return body_names[static_cast<int>(body)]; }

std::string accel_option(Accel accel) { return std::string("--accel ") + accel_name(accel); }
std::string memory_option(SceneMemory memory) { return "--scene-memory " + to_string(memory); }
std::string branching_option(Branching branching) { return "--branching " + to_string(branching); }
std::string source_option(NumberSource source) {
  return std::string("--rng ") + (source == NumberSource::xorwow ? "xorwow" : "philox");
}

/// The first enumerator of a set, of `count`.
template <class E>
E first_of(EnumSet<E> set, int count) {
  for (int i = 0; i < count; ++i)
    if (set.contains(E{i})) return E{i};
  return E{};
}

constexpr int body_count = std::size(body_names);

/// One of the row's, of the same mode if there is one.
KernelBody nearest_body(const KernelRow& row, KernelBody body) {
  for (const BodyName& other : body_names)
    if (row.bodies.contains(other.body) && other.mode == name_of(body).mode) return other.body;
  return first_of(row.bodies, body_count);
}

template <class E, class Name>
std::string names_of(EnumSet<E> set, int count, Name&& name, const char* separator = ", ") {
  std::string text;
  for (int i = 0; i < count; ++i) {
    if (!set.contains(E{i})) continue;
    const std::string one = name(E{i});
    if (text.find(one) == std::string::npos) text += (text.empty() ? "" : separator) + one;
  }
  return text;
}

std::string structures_of(const KernelRow& row, const char* separator) {
  return names_of(row.accels, accel_count, accel_name, separator);
}

std::string bytes_of(EnumSet<ExtraRecords> records, const char* separator) {
  constexpr int count = static_cast<int>(ExtraRecords::most) + 1;
  if (records.contains(ExtraRecords{1})) return "16 to 256";
  return names_of(
      records, count,
      [](ExtraRecords r) { return std::to_string(static_cast<int>(r) * path_bytes_step); },
      separator);
}
std::string path_bytes_option(EnumSet<ExtraRecords> records) {
  return "--path-bytes " + bytes_of(records, " or ");
}

/// What would change if a row served a need, and what that costs.
class Change {
 public:
  Change(const KernelNeed& need, EnumSet<KernelChoice> asked, const KernelRow& row)
      : asked_(asked) {
    using enum KernelChoice;
    SceneTraits scene = need.scene;
    if (!row.accels.contains(scene.accel)) {
      const Accel other = first_of(row.accels, accel_count);
      add(accel, 2, accel_option(scene.accel), "--accel " + structures_of(row, " or "));
      if (scene.geometry != Geometry::spheres_and_quads)
        scene = general_traits(other, need.contents, scene.has_masks, scene.has_media,
                               scene.has_sparse, scene.has_motion);
      scene.accel = other;
    }
    is_possible_ = row.on_cuda == need.on_cuda && is_of_scene(row, scene) &&
                   !row.without.intersects(need.contents);
    if (!row.memories.contains(need.memory))
      add(memory, 2, memory_option(need.memory), memory_option(first_of(row.memories, 4)));
    if (!row.bodies.intersects(need.bodies)) {
      const KernelBody from = first_of(need.bodies, body_count), to = nearest_body(row, from);
      const bool is_same_mode = name_of(from).mode == name_of(to).mode;
      add(body, is_same_mode ? 4 : 6, name_of(from).option, name_of(to).option);
    }
    if (!row.branchings.contains(need.branching))
      add(branching, 8, branching_option(need.branching),
          branching_option(first_of(row.branchings, 2)));
    if (!row.sources.intersects(need.sources))
      add(rng, 8, source_option(first_of(need.sources, 3)),
          source_option(first_of(row.sources, 3)));
    if (row.on_cuda && !row.extra.intersects(need.extra)) {
      is_possible_ = is_possible_ && row.extra != EnumSet<ExtraRecords>();
      add(path_bytes, row.extra.contains(ExtraRecords::none) ? 9 : 3, path_bytes_option(need.extra),
          path_bytes_option(row.extra));
    }
  }

  /// Whether it is another kernel for the same scene.
  bool is_possible() const { return is_possible_; }
  int cost() const { return cost_; }
  NearestKernel options() const { return {refused_.empty() ? chosen_ : refused_, expected_}; }

 private:
  /// What the plan chose gives way at a lower cost.
  void add(KernelChoice choice, int cost, const std::string& from, const std::string& to) {
    const auto append = [](std::string& list, const std::string& option) {
      list += (list.empty() ? "" : ", ") + option;
    };
    const bool is_asked = asked_.contains(choice);
    cost_ += is_asked ? cost : cost - 1;
    append(is_asked ? refused_ : chosen_, from), append(expected_, to);
  }

  EnumSet<KernelChoice> asked_;
  std::string refused_, chosen_, expected_;
  int cost_ = 0;
  bool is_possible_ = false;
};

using Cells = std::array<std::string, 9>;

Cells cells_of(const KernelRow& row) {
  std::string scene = geometry_names[static_cast<int>(row.geometry)];
  const SceneTraits traits = traits_of(row.extras);
  if (traits.has_motion) scene += ", motion";
  if (traits.has_masks) scene += ", masks";
  if (traits.has_media) scene += ", media";
  if (traits.has_sparse) scene += ", sparse grids";
  const std::string without = names_of(row.without, std::size(content_names), [](Content c) {
    return content_names[static_cast<int>(c)];
  });
  return {
      row.on_cuda ? "cuda" : "cpu",
      names_of(row.bodies, body_count, [](KernelBody b) { return name_of(b).name; }),
      structures_of(row, ", "),
      without.empty() ? scene : scene + "; no " + without,
      lighting_names[row.lighting.contains(Lighting::full)       ? 2
                     : row.lighting.contains(Lighting::emitters) ? 1
                                                                 : 0],
      names_of(row.sources, 3, [](NumberSource s) { return source_names[static_cast<int>(s)]; }),
      names_of(row.memories, 4, [](SceneMemory m) { return to_string(m); }),
      names_of(row.branchings, 2, [](Branching b) { return to_string(b); }),
      !row.on_cuda                           ? "0 to 256"
      : row.extra == EnumSet<ExtraRecords>() ? "not in this build"
                                             : bytes_of(row.extra, ", ")};
}

}  // namespace

NearestKernel nearest_kernel(const KernelNeed& need, EnumSet<KernelChoice> asked) {
  constexpr EnumSet<KernelBody> of_optix{KernelBody::optix, KernelBody::queues};
  std::vector<Change> changes;
  for (const KernelRow& row : kernel_table) {
    // Not every driver has OptiX.
    if (row.bodies.intersects(of_optix) && !need.bodies.intersects(of_optix)) continue;
    const Change change(need, asked, row);
    if (change.is_possible()) changes.push_back(change);
  }
  // bvh2 has kernels for every scene.
  return std::ranges::min_element(changes, {}, &Change::cost)->options();
}

std::string kernel_list() {
  std::vector<Cells> lines{{"device", "code", "--accel", "scenes", "lights", "random numbers",
                            "scene memory", "branching", "path bytes"}};
  for (const KernelRow& row : kernel_table) lines.push_back(cells_of(row));
  std::array<std::size_t, std::tuple_size_v<Cells>> widths{};
  for (const Cells& line : lines)
    for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
  std::string text;
  for (const Cells& line : lines) {
    std::string row;
    for (std::size_t i = 0; i < line.size(); ++i)
      row += fmt::format("{:<{}}  ", line[i], widths[i]);
    text += row.substr(0, row.find_last_not_of(' ') + 1) + '\n';
  }
  return text;
}

}  // namespace pt
