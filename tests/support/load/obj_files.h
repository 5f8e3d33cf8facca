// For tests of OBJ and MTL files: texts in a folder, what they load as, warnings as a list.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "common/scene/load/load_scene.h"
#include "common/texture/sample_texture.h"
#include "temp_folder.h"

namespace pt {

struct LoadedObj {
  SceneData scene;
  std::vector<std::string> warnings;

  explicit LoadedObj(const std::string& path) {
    LoadOptions options;
    options.warn = [this](const std::string& message) { warnings.push_back(message); };
    scene = load_obj(path, options);
  }

  /// How many warnings contain `part`.
  int count(const std::string& part) const {
    int n = 0;
    for (const std::string& warning : warnings) n += warning.find(part) != std::string::npos;
    return n;
  }

  const MaterialDescription& material(const std::string& name) const {
    for (const auto& [number, known] : scene.names.materials) {
      if (known == name) return scene.materials.at(number);
    }
    throw Error("no material " + name);
  }

  Color texture_at(std::uint32_t texture, const Vec2& uv) const {
    return texture == no_texture
               ? Color(1.0f)
               : sample_texture(scene.textures.data(), texture, scene.texels.data(), uv);
  }
};

/// A triangle for the material m of a.mtl.
inline const std::string triangle_of_m =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";

class ObjFolder : public TempFolder {
 public:
  void write(const std::string& name, std::string_view text) const {
    std::filesystem::create_directories(std::filesystem::path(file(name)).parent_path());
    write_text(file(name), text);
  }
  LoadedObj load(const std::string& obj) const {
    write("a.obj", obj);
    return LoadedObj(file("a.obj"));
  }
  /// With the statements of the material m.
  LoadedObj load_m(const std::string& statements) const {
    write("a.mtl", "newmtl m\n" + statements);
    return load(triangle_of_m);
  }
};

/// 2 x 2 texels: red, green above blue, white.
inline const std::string four_colors("P6 2 2 255\n\xff\0\0\0\xff\0\0\0\xff\xff\xff\xff", 23);

inline std::string text_of(const Color& c) {
  return c == Color(c.x) ? fmt::format("{:.4g}", c.x)
                         : fmt::format("{:.4g},{:.4g},{:.4g}", c.x, c.y, c.z);
}

/// A material in one line: its BSDF with all parameters, `*` behind those with a texture; then
/// what it emits and its opacity unless these are nothing and 1; of a node, what it is made of.
inline std::string text_of(const SceneData& scene, const MaterialDescription& m) {
  const auto parameter = [&](const Parameter& p) {
    return " " + text_of(p.value) + (p.texture == no_texture ? "" : "*");
  };
  std::string text;
  if (m.node == MaterialNode::none) {
    visit(m.kind, m, [&](const auto& bsdf) {
      using Bsdf = std::decay_t<decltype(bsdf)>;
      text = Bsdf::name;
      for (int i = 0; i < parameter_count<Bsdf>; ++i) text += parameter(m.parameters[i]);
    });
  } else {
    text = m.node == MaterialNode::blend      ? "blend"
           : m.node == MaterialNode::bump_map ? "bump"
                                              : "normals";
    text += parameter(m.parameters[0]);
    text += " (" + text_of(scene, scene.materials.at(m.children[0])) + ")";
    if (m.children[1] != m.children[0]) {
      text += " (" + text_of(scene, scene.materials.at(m.children[1])) + ")";
    }
  }
  if (!is_black(m.emission.radiance)) {
    text +=
        " emits " + text_of(m.emission.radiance) + (m.emission.texture == no_texture ? "" : "*");
  }
  if (m.opacity.is_opaque()) return text;
  text += fmt::format(" opacity {:.4g}", m.opacity.offset);
  return m.opacity.is_constant() ? text : text + fmt::format("{:+.4g}*", m.opacity.scale);
}

}  // namespace pt
