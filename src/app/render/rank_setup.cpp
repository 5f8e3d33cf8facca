#include "app/render/rank_setup.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <filesystem>

#include "app/options/option_list.h"
#include "common/distribute/bytes.h"
#include "common/error/error.h"
#include "common/mpi/processors.h"
#include "common/options/option_names.h"
#include "common/platform/build_info.h"
#include "common/scene/load/files/scene_files.h"

namespace pt {
namespace {

namespace fs = std::filesystem;

/// A folder that goes with its contents; in memory where the system has such a file system.
class MemoryFolder {
 public:
  MemoryFolder() {
    const fs::path memory("/dev/shm");
    std::string name =
        ((fs::is_directory(memory) ? memory : fs::temp_directory_path()) / "ptexp-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw Error(fmt::format("{}: no folder for the scene's files could be made", name));
    }
    path_ = name;
  }
  MemoryFolder(const MemoryFolder&) = delete;
  MemoryFolder& operator=(const MemoryFolder&) = delete;
  ~MemoryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// All options that the ranks must share: not what each has for itself, nor what the first one
/// writes.
std::string shared_text(const Options& options) {
  std::string text;
  for (const OptionEntry& entry : option_list()) {
    if (entry.name == "device" || entry.name == "threads" || entry.name == "quiet") continue;
    if (const std::string value = entry.text(options); !value.empty()) {
      text += fmt::format("--{} {}\n", entry.name, value);
    }
  }
  return text;
}

}  // namespace

std::vector<DeviceInfo> choose_rank_devices(Options& options, const RankInfo& rank) {
  using Kind = DeviceChoice::Kind;
  DeviceChoice& choice = options.device;
  const int gpus = static_cast<int>(list_devices().size()) - 1;
  const bool wants_gpus = choice.kind == Kind::cuda || (choice.kind == Kind::automatic && gpus > 0);
  if (!wants_gpus) {
    if (options.threads == 0) options.threads = rank.threads;
    return choose_devices(choice, options.threads);
  }
  const bool is_listed = choice.kind == Kind::cuda && (choice.index > 0 || !choice.more.empty());
  if (!is_listed && gpus > 0) {
    const std::vector<int> own = local_devices(rank.local_rank, rank.local_ranks, gpus);
    choice = {Kind::cuda, own.front(), {own.begin() + 1, own.end()}};
  }
  return choose_devices(choice, options.threads);
}

std::string binding_warning(const RankInfo& rank) {
  const int used = rank.local_ranks * rank.threads;
  if (rank.idle_processors < used) return "";
  return fmt::format(
      "the launcher has bound the {} ranks of this machine to {} of its {} processors: render "
      "with 'mpirun --bind-to none', or the like, to use all",
      rank.local_ranks, used, used + rank.idle_processors);
}

void check_ranks(Ranks& ranks, const Options& options, const DeviceInfo& device) {
  const BuildInfo& build = build_info();
  ranks.agree({{"ptexp", build.version},
               {"commit", build.commit},
               {"device kind", to_string(device.choice.kind)},
               {"options", shared_text(options)}});
}

SceneData load_shared_scene(Ranks& ranks, const Options& options, const DeviceInfo& device,
                            const Warn& warn) {
  if (ranks.count() == 1) return load_scene(options, device, warn);
  if (options.scene_from_disk) {
    SceneData scene = load_scene(options, device, warn);
    ranks.agree({{"scene hash", scene.source_hash}});
    return scene;
  }
  if (ranks.is_first()) {
    SceneData scene = load_scene(options, device, warn);
    const std::vector<fs::path> paths(scene.source_files.begin(), scene.source_files.end());
    ByteWriter writer;
    writer.text(scene.source_files.empty() ? "" : fs::absolute(options.scene).string());
    std::string bytes = writer.take() + (paths.empty() ? "" : pack_files(paths));
    ranks.broadcast(bytes);
    ranks.agree({{"scene hash", scene.source_hash}});
    return scene;
  }
  std::string bytes;
  ranks.broadcast(bytes);
  ByteReader reader(bytes);
  Options own = options;
  const std::string scene_path = reader.text();
  const MemoryFolder folder;
  if (!scene_path.empty()) {
    unpack_files(reader.rest(), folder.path());
    own.scene = (folder.path() / fs::path(scene_path).relative_path()).string();
  }
  bytes.clear(), bytes.shrink_to_fit();
  SceneData scene = load_scene(own, device, warn);
  ranks.agree({{"scene hash", scene.source_hash}});
  return scene;
}

std::vector<DeviceInfo> choose_render_devices(Options& options, const GivenOptions& given,
                                              const Ranks* ranks) {
  using Kind = DeviceChoice::Kind;
  if (options.mode == Mode::serial) options.device = {Kind::cpu, 0};  // one CPU thread, GPU or not
  const bool is_shared = ranks != nullptr && ranks->count() > 1;
  const std::vector<DeviceInfo> devices = is_shared
                                              ? choose_rank_devices(options, ranks->own())
                                              : choose_devices(options.device, options.threads);
  check_applicable(options, given, devices.front().choice.kind);
  options.device = devices.front().choice;
  for (std::size_t i = 1; i < devices.size(); ++i) {
    options.device.more.push_back(devices[i].choice.index);
  }
  return devices;
}

}  // namespace pt
