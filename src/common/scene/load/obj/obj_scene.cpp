#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "common/error/error.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/meshes/obj.h"
#include "common/scene/load/files/meshes/vertex_colors.h"
#include "common/scene/load/files/read_ahead.h"
#include "common/scene/load/files/text.h"
#include "common/scene/load/files/whole_file.h"
#include "common/scene/load/load_scene.h"
#include "common/scene/load/obj/mtl.h"

namespace pt {

namespace obj {
namespace {

namespace fs = std::filesystem;

/// Without quotes around it.
std::string_view unquoted(std::string_view name) {
  const bool quotes = name.size() > 1 && name.starts_with('"') && name.ends_with('"');
  return quotes ? trim(name.substr(1, name.size() - 2)) : name;
}

bool ends_with_mtl(std::string_view text) {
  return text.size() >= 4 && lower_case(text.substr(text.size() - 4)) == ".mtl";
}

/// The MTL files of an OBJ file, and where their pictures lie.
class Libraries {
 public:
  Libraries(const fs::path& obj, SceneData& scene, CountedWarnings& warnings)
      : obj_(obj),
        folder_(obj.parent_path()),
        scene_(scene),
        warnings_(warnings),
        files_(warnings) {}

  /// Reads what a line names: one file, also with spaces, or several. Each is read once.
  void read_line(std::string_view names) {
    if (!lines_.emplace(names).second || read_found(unquoted(names))) return;
    while (!names.empty()) {
      const std::string_view name = next_name(names);
      if (read_found(unquoted(name))) continue;
      std::string_view words = unquoted(name);
      while (!words.empty()) read_word(next_word(words));
    }
  }

  /// The number of a material; `fallback` where no file defines it, which is warned of.
  std::uint32_t find(std::string_view name, std::uint32_t fallback, std::size_t line_number) {
    auto found = defined_.find(name);
    if (found == defined_.end()) found = defined_.find(unquoted(name));
    if (found == defined_.end()) {
      warnings_.add("unknown material",
                    fmt::format("{}: line {}: material {} is not defined: grey is used",
                                obj_.string(), line_number, in_quotes(name)),
                    name);
      return fallback;
    }
    Entry& entry = found->second;
    if (!entry.number) {
      entry.number = add_material(entry.material, *entry.textures, scene_, warnings_);
      if (!name.empty()) scene_.names.materials[*entry.number] = found->first;
    }
    return *entry.number;
  }

 private:
  struct Entry {
    MtlMaterial material;
    std::shared_ptr<MtlTextures> textures;
    std::optional<std::uint32_t> number;  ///< in the scene, once it is used
  };

  /// Takes the next name off the front: in quotes, or words up to one that ends with .mtl.
  static std::string_view next_name(std::string_view& names) {
    names = trim(names);
    std::size_t end = names.size();
    if (names.starts_with('"')) {
      end = std::min(names.find('"', 1), names.size() - 1) + 1;
    } else {
      std::string_view rest = names;
      while (!rest.empty()) {
        const std::string_view word = next_word(rest);
        if (ends_with_mtl(word)) {
          end = names.size() - rest.size();
          break;
        }
      }
    }
    const std::string_view name = names.substr(0, end);
    names = trim(names.substr(end));
    return name;
  }

  /// False where there is no such file.
  bool read_found(std::string_view name) {
    const fs::path path = files_.find({folder_}, name);
    if (path.empty()) return false;
    std::error_code ignored;
    const fs::path canonical = fs::weakly_canonical(path, ignored);
    if (!read_.insert(ignored ? path : canonical).second) return true;
    try {
      define(path);
    } catch (const Error& error) {
      warnings_.add("unreadable library", fmt::format("{}: {}", path.string(), error.what()), name);
    }
    return true;
  }

  /// A file that has the name of the OBJ file stands in for one that is missing.
  void read_word(std::string_view word) {
    if (word.empty() || read_found(word)) return;
    fs::path beside = obj_.filename();
    beside.replace_extension(".mtl");
    const bool stands_in = read_found(beside.string());
    warnings_.add("missing library",
                  fmt::format("{}: {}: No such file or directory{}", obj_.string(), clipped(word),
                              stands_in ? ": " + beside.string() + " is used" : ""),
                  word);
  }

  /// The first file that defines a material counts; within a file, the last definition.
  void define(const fs::path& path) {
    std::vector<fs::path> folders = {path.parent_path()};
    if (folder_ != folders[0]) folders.push_back(folder_);
    const auto textures = std::make_shared<MtlTextures>(folders, files_, scene_, warnings_);
    std::map<std::string, Entry, std::less<>> defined;
    for (MtlMaterial& material : parse_mtl(WholeFile(path).bytes(), path.string(), warnings_)) {
      Entry& entry = defined[material.name];
      if (entry.textures) {
        warnings_.add("material twice", material.place + ": defined twice: the last one is used");
      }
      textures->read_ahead(material);
      entry = {std::move(material), textures, {}};
    }
    defined_.merge(defined);
  }

  fs::path obj_, folder_;
  SceneData& scene_;
  CountedWarnings& warnings_;
  NamedFiles files_;
  std::set<std::string, std::less<>> lines_;
  std::set<fs::path> read_;
  std::map<std::string, Entry, std::less<>> defined_;
};

/// A mesh for each material.
class MeshesByMaterial : public ObjSink {
 public:
  MeshesByMaterial(Libraries& libraries, std::uint32_t grey)
      : libraries_(libraries), grey_(grey), material_(grey) {}

  void add_face(const std::vector<ObjCorner>& corners, const ObjVertices& vertices) override {
    builders_[material_].add_face(corners, vertices);
  }
  void use_material(std::string_view name, std::size_t line_number) override {
    const auto [entry, is_new] = numbers_.try_emplace(std::string(name), grey_);
    if (is_new) entry->second = libraries_.find(name, grey_, line_number);
    material_ = entry->second;
  }
  void read_library(std::string_view names) override { libraries_.read_line(names); }

  std::vector<Mesh> finish(std::vector<std::string>& warnings) {
    std::vector<Mesh> meshes;
    for (auto& [material, builder] : builders_) {
      Mesh mesh = std::move(builder).finish(&warnings);
      mesh.material = material;
      finish_mesh(mesh, {}, &warnings);
      meshes.push_back(std::move(mesh));
    }
    return meshes;
  }

 private:
  Libraries& libraries_;
  std::uint32_t grey_, material_;
  std::map<std::string, std::uint32_t, std::less<>> numbers_;  ///< by name
  std::map<std::uint32_t, ObjMeshBuilder> builders_;           ///< by material
};

/// Libraries may be named behind their first use.
void read_libraries(std::string_view text, Libraries& libraries) {
  constexpr std::string_view keyword = "mtllib";
  for (std::size_t at = 0; (at = text.find(keyword, at)) != text.npos; at += keyword.size()) {
    std::size_t begin = at;
    while (begin > 0 && (text[begin - 1] == ' ' || text[begin - 1] == '\t')) --begin;
    if (begin > 0 && text[begin - 1] != '\n' && text[begin - 1] != '\r') continue;
    const std::string_view rest = text.substr(at + keyword.size());
    const std::string_view line = rest.substr(0, rest.find_first_of("\r\n"));
    if (!line.empty() && is_text_space(line[0]) && !line.ends_with('\\')) {
      libraries.read_line(trim(line));
    }
  }
}

SceneData load(const fs::path& path, CountedWarnings& warnings) {
  SceneData scene;
  const WholeFile file(path);
  const std::string_view text = without_byte_order_mark(file.bytes());
  const ReadAhead ahead;
  Libraries libraries(path, scene, warnings);
  read_libraries(text, libraries);
  MeshesByMaterial sink(libraries, scene.add_material(make_diffuse(Color(0.5f))));
  CountedWarnings of_lines;
  parse_obj(text, sink, of_lines);
  std::vector<std::string> of_meshes;
  scene.meshes = sink.finish(of_meshes);
  for (const auto& lines : {of_lines.lines(), of_meshes}) {
    for (const std::string& line : lines) {
      warnings.add(line, fmt::format("{}: {}", path.string(), line));
    }
  }
  return scene;
}

}  // namespace

}  // namespace obj

SceneData load_obj(const std::filesystem::path& path, const LoadOptions& options) {
  CountedWarnings warnings;
  SceneData scene =
      explaining("cannot read " + path.string(), [&] { return obj::load(path, warnings); });
  for (const std::string& warning : warnings.lines()) options.report(warning);
  VertexColors colors(scene, options);
  for (Mesh& mesh : scene.meshes) colors.tint(mesh, false, path.string());
  colors.finish();
  return scene;
}

}  // namespace pt
