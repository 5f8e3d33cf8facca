// Colours that meshes bring by vertex or by face, as a texture.
//
// Each triangle gets 2 x 2 texels of its own and lies in them: its corners at three texels, and in
// the fourth the sum of two less the third, so that bilinear interpolation is linear over the
// triangle. Kernels know nothing of it. But a mesh cannot have other textures beside its colours,
// since there is one pair of texture coordinates: then their mean is used.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "common/scene/data/scene_data.h"
#include "common/scene/load/files/load_options.h"

namespace pt {

/// Lives while a scene is being loaded; what it is given outlives it.
class VertexColors {
 public:
  VertexColors(SceneData& scene, const LoadOptions& options) : scene_(scene), options_(options) {}

  /// Textures that stand for the colours of whatever mesh has them, in any parameter of a material.
  /// White where a mesh has none, which is reported.
  std::uint32_t by_vertex() { return texture_index_of(vertex_); }
  std::uint32_t by_face() { return texture_index_of(face_); }

  /// Multiplies the first parameter of the mesh's material, or what it emits, by the colours of the
  /// mesh's vertices. Other meshes keep the material. `place` is for a warning.
  void tint(Mesh& mesh, bool emits, const std::string& place);

  /// When all meshes are in the scene: gives those that show their colours texels, and coordinates
  /// for them in place of their own. Takes the colours away from all.
  void finish();

  /// Whether the material asks for colours of a mesh.
  bool are_in(std::uint32_t material) const { return use_of(material).colors(); }

  /// Whether the texture stands for such colours.
  bool is_ours(std::uint32_t texture) const { return texture == vertex_ || texture == face_; }

 private:
  static constexpr std::uint32_t none = no_texture - 1;  ///< stands for nothing yet

  /// What a material needs texture coordinates for.
  struct Use {
    bool by_vertex = false, by_face = false, others = false;
    bool colors() const { return by_vertex || by_face; }
  };
  using Change = std::function<void(MaterialDescription&)>;

  void report_mean(const std::string& place);
  std::uint32_t texture_index_of(std::uint32_t& texture);
  Use use_of(std::uint32_t material) const;
  std::uint32_t changed(std::uint32_t material, const Change& change);
  std::uint32_t changed(std::uint32_t material, const Change& change,
                        std::map<std::uint32_t, std::uint32_t>& copies);
  void report_lack(const char* attribute, bool lacks);
  /// Whether the mesh's colours are to have texels; else its material is without them.
  bool shows_texels(Mesh& mesh);
  void show_means(Mesh& mesh);

  SceneData& scene_;
  const LoadOptions& options_;
  bool reported_ = false;
  std::set<std::string> lacks_;  ///< attributes whose absence was reported
  std::uint32_t vertex_ = none, face_ = none;
  std::map<std::pair<std::uint32_t, bool>, std::uint32_t> tinted_;  ///< by material and `emits`
};

}  // namespace pt
