// Files that other threads decode ahead are those that the loader would read itself, in its order.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

#include "common/error/error.h"
#include "common/scene/load/files/read_ahead.h"
#include "common/scene/load/files/whole_file.h"
#include "common/scene/load/load_scene.h"
#include "shared_file.h"
#include "temp_folder.h"
#include "test_data.h"

namespace pt {
namespace {

namespace fs = std::filesystem;

constexpr int threads = 4;

template <class Work>
void with_threads(int count, const Work& work) {
  tbb::task_arena(count).execute(work);
}

/// Announces it and returns the key.
std::string announce(int i, std::atomic<int>& calls) {
  const std::string key = "file " + std::to_string(i);
  ReadAhead::announce(key, [i, &calls] {
    std::this_thread::sleep_for(std::chrono::microseconds(37 * i % 400));
    ++calls;
    if (i % 7 == 0) throw Error("of " + std::to_string(i));
    return std::any(i);
  });
  return key;
}

/// What a loader gets: the number, or that of the Error. `calls` counts its own reading, too.
int take(int i, const std::string& key, std::atomic<int>& calls) {
  const auto read = [&] {
    ++calls;
    if (i % 7 == 0) throw Error("of " + std::to_string(i));
    return i;
  };
  try {
    return ReadAhead::take(key, read);
  } catch (const Error& error) {
    return -std::stoi(std::string(error.what()).substr(3));
  }
}

TEST(ReadAhead, EachFileIsDecodedOnceWhateverTheOrder) {
  constexpr int files = 300;
  for (const int step : {1, 7, files - 1}) {
    std::atomic<int> calls = 0;
    with_threads(threads, [&] {
      const ReadAhead ahead;
      std::vector<std::string> keys;
      for (int i = 0; i < files; ++i) keys.push_back(announce(i, calls));
      for (int k = 0; k < files; ++k) {
        const int i = k * step % files;
        const int wanted = i % 7 == 0 ? -i : i;
        ASSERT_EQ(take(i, keys[static_cast<std::size_t>(i)], calls), wanted);
      }
    });
    EXPECT_EQ(calls, files);
  }
}

TEST(ReadAhead, OtherThreadsDecode) {
  std::set<std::thread::id> readers;
  std::mutex mutex;
  with_threads(threads, [&] {
    const ReadAhead ahead;
    for (int i = 0; i < 50; ++i) {
      ReadAhead::announce(std::to_string(i), [&, i] {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        const std::lock_guard lock(mutex);
        readers.insert(std::this_thread::get_id());
        return std::any(i);
      });
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    for (int i = 0; i < 50; ++i) ReadAhead::take(std::to_string(i), [i] { return i; });
  });
  readers.erase(std::this_thread::get_id());
  EXPECT_GT(readers.size() + (std::thread::hardware_concurrency() < 2), 0u);
}

TEST(ReadAhead, ATaskThatWaitsForOthersAndAsksForItsOwnKeyIsNoDeadlock) {
  with_threads(threads, [] {
    const ReadAhead ahead;
    const auto read = [](int i) {
      // Waiting threads take other files, those of this loader's thread as well.
      tbb::parallel_for(0, 64,
                        [](int) { std::this_thread::sleep_for(std::chrono::microseconds(50)); });
      return ReadAhead::take(std::to_string(i), [i] { return i; });
    };
    for (int i = 0; i < 60; ++i)
      ReadAhead::announce(std::to_string(i), [=] { return std::any(read(i)); });
    for (int i = 0; i < 60; ++i) {
      EXPECT_EQ(ReadAhead::take(std::to_string(i), [&] { return read(i); }), i);
    }
  });
}

TEST(ReadAhead, FewFilesWaitDecoded) {
  std::atomic<int> decoded = 0;
  with_threads(threads, [&] {
    const ReadAhead ahead;
    for (int i = 0; i < 100; ++i)
      ReadAhead::announce(std::to_string(i), [&decoded] { return std::any(++decoded); });
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_LE(decoded, static_cast<int>(ReadAhead::most_untaken));
  });
  EXPECT_LE(decoded, static_cast<int>(ReadAhead::most_untaken));  // nor at the end
}

TEST(ReadAhead, WithoutAnnouncementOrOnOneThreadTheLoaderReads) {
  EXPECT_EQ(ReadAhead::take("file", [] { return 3; }), 3);
  with_threads(1, [] {
    const ReadAhead ahead;
    ReadAhead::announce("file", [] { return std::any(4); });
    EXPECT_FALSE(ReadAhead::is_announced("file"));
    EXPECT_EQ(ReadAhead::take("file", [] { return 3; }), 3);
  });
}

// Whole scenes.

template <class Value>
void add_bytes(std::string& bytes, const std::vector<Value>& values) {
  static_assert(std::is_trivially_copyable_v<Value>);
  bytes += std::to_string(values.size()) + ":";
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
}

/// All that files bring, and what was said about them; or the error.
struct Loaded {
  std::string bytes;
  std::vector<std::string> warnings;
  std::vector<fs::path> files;
  std::string hash, error;

  bool operator==(const Loaded&) const = default;
};

Loaded load(const fs::path& path, int count, bool strict) {
  Loaded loaded;
  LoadOptions options;
  options.strict = strict;
  options.warn = [&](const std::string& line) { loaded.warnings.push_back(line); };
  with_threads(count, [&] {
    const SceneFiles files;
    try {
      const SceneData scene = load_scene_file(path, options);
      for (const Mesh& mesh : scene.meshes) {
        add_bytes(loaded.bytes, mesh.positions);
        add_bytes(loaded.bytes, mesh.normals);
        add_bytes(loaded.bytes, mesh.uvs);
        add_bytes(loaded.bytes, mesh.triangles);
        loaded.bytes += std::to_string(mesh.material) + " " + std::to_string(mesh.group);
      }
      add_bytes(loaded.bytes, scene.texels);
      add_bytes(loaded.bytes, scene.environment.pixels);
      loaded.bytes += std::to_string(scene.materials.size());
    } catch (const Error& error) {
      loaded.error = error.what();
    }
    loaded.files = files.paths();
    loaded.hash = files.hash(path.parent_path());
  });
  return loaded;
}

void expect_same_on_all_threads(const fs::path& path) {
  for (const bool strict : {false, true}) {
    const Loaded alone = load(path, 1, strict), together = load(path, threads, strict);
    EXPECT_EQ(alone.warnings, together.warnings) << path;
    EXPECT_EQ(alone.error, together.error) << path;
    EXPECT_EQ(alone.files, together.files) << path;
    EXPECT_TRUE(alone == together) << path;
  }
}

void expect_all_below(const fs::path& folder) {
  int count = 0;
  const std::set<std::string> endings = {".xml", ".gltf", ".glb", ".obj", ".pbrt"};
  for (const fs::path& path : fs::recursive_directory_iterator(folder)) {
    if (!endings.contains(path.extension().string())) continue;
    expect_same_on_all_threads(path);
    ++count;
  }
  EXPECT_GT(count, 5) << folder;
}

TEST(ReadAhead, ScenesAreThoseOfOneThread) {
  expect_all_below(test_data("exporters"));
  expect_all_below(test_data("mitsuba_exporters"));
}

TEST(ReadAhead, OneFileIsReadInSeveralWays) {
  const TempFolder folder;
  std::ofstream(folder.file("a.obj"))
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n";
  std::ofstream scene(folder.file("scene.xml"));
  scene << "<scene version='3.0.0'>";
  for (const char* way : {"", "<boolean name='flip_tex_coords' value='false'/>",
                          "<boolean name='face_normals' value='true'/>", ""}) {
    scene << "<shape type='obj'><string name='filename' value='a.obj'/>" << way
          << "<bsdf type='diffuse'/></shape>";
  }
  scene << "<emitter type='constant'/></scene>";
  scene.close();
  expect_same_on_all_threads(folder.file("scene.xml"));
  LoadOptions options;
  with_threads(threads, [&] {
    const SceneData loaded = load_scene_file(folder.file("scene.xml"), options);
    ASSERT_EQ(loaded.meshes.size(), 4u);
    EXPECT_EQ(loaded.meshes[0].uvs[0].y, 0.25f);
    EXPECT_EQ(loaded.meshes[1].uvs[0].y, 0.75f);
    EXPECT_TRUE(loaded.meshes[2].normals.empty());
    EXPECT_FALSE(loaded.meshes[3].normals.empty());
  });
}

TEST(ReadAhead, RealScenesAreThoseOfOneThread) {
  if (!fs::exists(shared_file("scenes"))) GTEST_SKIP() << "no real scenes here";
  expect_all_below(shared_file("scenes"));
}

TEST(ReadAhead, FoundScenesAreThoseOfOneThread) {
  if (!fs::exists(shared_file("found"))) GTEST_SKIP() << "no such files here";
  expect_all_below(shared_file("found"));
}

}  // namespace
}  // namespace pt
