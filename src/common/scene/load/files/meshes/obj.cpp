#include <map>
#include <memory>

#include "common/error/error_context.h"
#include "common/scene/load/files/find_file.h"
#include "common/scene/load/files/mapped_file.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/meshes/mesh_finish.h"
#include "common/scene/load/files/meshes/obj_material.h"
#include "common/scene/load/files/meshes/obj_parser.h"

namespace pt {
namespace {

/// All faces in one mesh.
class OneMesh : public ObjSink {
 public:
  void add_face(const std::vector<ObjCorner>& corners, const ObjVertices& vertices) override {
    builder.add_face(corners, vertices);
  }

  ObjMeshBuilder builder;
};

/// A mesh for each material.
class MeshesByMaterial : public ObjSink {
 public:
  MeshesByMaterial(std::filesystem::path folder, ObjFile& file)
      : folder_(std::move(folder)), file_(file) {
    file_.materials.push_back({"", make_diffuse(Color(0.5f)), {}, {}});
    numbers_.emplace("", 0);
  }

  void add_face(const std::vector<ObjCorner>& corners, const ObjVertices& vertices) override {
    builders_[material_].add_face(corners, vertices);
  }

  void use_material(std::string_view name) override {
    const auto found = numbers_.find(name);
    material_ = found == numbers_.end() ? 0 : found->second;
    if (found != numbers_.end()) return;
    file_.warnings.push_back("material " + std::string(name) + " is not defined: grey instead");
    numbers_.emplace(name, 0);  // warned once
  }

  /// The names are one with spaces or several without.
  void read_library(std::string_view names) override {
    std::error_code ignored;
    const std::filesystem::path whole = find_file(folder_, names, {});
    if (std::filesystem::is_regular_file(whole, ignored)) return read(names);
    std::size_t begin = 0;
    while ((begin = names.find_first_not_of(" \t", begin)) != names.npos) {
      const std::size_t end = std::min(names.find_first_of(" \t", begin), names.size());
      read(names.substr(begin, end - begin));
      begin = end;
    }
  }

  void finish(const MeshFileOptions& options) {
    for (auto& [material, builder] : builders_) {
      Mesh mesh = std::move(builder).finish(&file_.warnings);
      mesh.material = material;
      finish_mesh(mesh, options, &file_.warnings);
      file_.meshes.push_back(std::move(mesh));
    }
  }

 private:
  void read(std::string_view name) {
    const std::size_t before = file_.materials.size();
    const auto warn = [&](const std::string& line) { file_.warnings.push_back(line); };
    const std::filesystem::path found = find_file(folder_, name, warn);
    try {
      read_mtl(found.empty() ? folder_ / name : found, file_);
    } catch (const Error& error) {
      file_.warnings.push_back(std::string(name) + ": " + error.what());
    }
    for (std::size_t i = before; i < file_.materials.size(); ++i) {
      numbers_.insert_or_assign(file_.materials[i].name, static_cast<std::uint32_t>(i));
    }
  }

  std::filesystem::path folder_;
  ObjFile& file_;
  std::map<std::string, std::uint32_t, std::less<>> numbers_;  ///< by name
  std::map<std::uint32_t, ObjMeshBuilder> builders_;           ///< by material
  std::uint32_t material_ = 0;
};

Mesh decode(std::string_view bytes, const MeshFileOptions& options) {
  OneMesh sink;
  parse_obj(bytes, sink);
  Mesh mesh = std::move(sink.builder).finish(options.warnings);
  finish_mesh(mesh, options, options.warnings);
  return mesh;
}

}  // namespace

Mesh decode_obj(std::string_view bytes, const std::string& name, const MeshFileOptions& options) {
  return explaining("cannot read " + name, [&] { return decode(bytes, options); });
}

Mesh read_obj(const std::filesystem::path& path, const MeshFileOptions& options) {
  return explaining("cannot read " + path.string(),
                    [&] { return decode(MappedFile(path).bytes(), options); });
}

ObjFile read_obj_with_materials(const std::filesystem::path& path, const MeshFileOptions& options) {
  return explaining("cannot read " + path.string(), [&] {
    ObjFile file;
    MeshesByMaterial sink(path.parent_path(), file);
    parse_obj(MappedFile(path).bytes(), sink);
    sink.finish(options);
    return file;
  });
}

}  // namespace pt
