#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

#include "common/error/error.h"
#include "common/light/light.h"
#include "common/scene/prepare/prepare_steps.h"
#include "common/texture/sample_texture.h"

namespace pt {

namespace {

/// The mean luminance of (image, factor), kept since many materials share both.
using Means = std::map<std::tuple<std::uint32_t, float, float, float>, double>;

double mean_of_image(const Texture& texture, const std::byte* texels, const Color& color) {
  // Deterministic: the sum must not depend on the number of threads.
  const double sum = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::uint32_t>(0, texture.height, 64), 0.0,
      [&](const tbb::blocked_range<std::uint32_t>& rows, double part) {
        for (std::uint32_t y = rows.begin(); y != rows.end(); ++y) {
          for (std::uint32_t x = 0; x < texture.width; ++x)
            part += std::fmax(0.0f, luminance(color * load_texel(texture, texels, x, y)));
        }
        return part;
      },
      std::plus<>());
  return sum / (static_cast<double>(texture.width) * static_cast<double>(texture.height));
}

/// Each texture once for each factor, although checkerboards may hold it 2^n times.
double mean_of_texture(const Texture* textures, std::uint32_t texture_index,
                       const std::byte* texels, const Color& factor, Means& means) {
  const std::tuple key(texture_index, factor.x, factor.y, factor.z);
  if (const auto known = means.find(key); known != means.end()) return known->second;
  const Texture& texture = textures[texture_index];
  double mean = 0;
  if (texture.kind == TextureKind::checkerboard) {
    const auto mean_of = [&](int square, const Color& color) {
      const std::uint32_t nested = texture.nested[square];
      return nested == no_texture
                 ? double{luminance(factor * color)}
                 : mean_of_texture(textures, nested, texels, factor * color, means);
    };
    mean = 0.5 * (mean_of(0, texture.color0) + mean_of(1, texture.color1));
  } else {
    mean = mean_of_image(texture, texels, factor * texture.color0);
  }
  return means[key] = mean;
}

}  // namespace

double mean_luminance(const Texture* textures, std::uint32_t texture_index, const std::byte* texels,
                      const Color& factor) {
  Means means;
  return mean_of_texture(textures, texture_index, texels, factor, means);
}

void weigh_emission_textures(SceneData& scene) {
  for (MaterialDescription& material : scene.materials) {
    Emission& emission = material.emission;
    if (emission.texture == no_texture || is_black(emission.radiance)) continue;
    const auto mean = static_cast<float>(
        mean_luminance(scene.textures.data(), emission.texture, scene.texels.data()));
    emission.texture_mean = std::isfinite(mean) ? mean : 1.0f;
    if (emission.texture_mean == 0.0f) emission.radiance = Color(0.0f);  // a black texture
  }
}
namespace {

/// How many of the description's parameters its BSDF has.
int parameter_count(const MaterialDescription& material) {
  return visit(material.kind, material,
               []<class Bsdf>(const Bsdf&) { return pt::parameter_count<Bsdf>; });
}

bool is_delta(const MaterialDescription& material) {
  return visit(material.kind, material, [](const auto& bsdf) { return bsdf.is_delta(); });
}

std::uint32_t size32(const auto& values) { return static_cast<std::uint32_t>(values.size()); }

/// Its children are packed already. It needs of a surface what they need.
void pack_node(const MaterialDescription& source, const SceneData& scene, Material& material) {
  constexpr std::uint8_t inherited = Material::textured | Material::tangents;
  material.flags = static_cast<std::uint8_t>(material.flags | Material::nested);
  if (source.node >= MaterialNode::normal_map) material.flags |= Material::tangents;
  for (const std::uint32_t child : source.children) {
    if (child >= scene.material_records.size()) {
      throw Error(
          fmt::format("scene '{}': material {} is made of material {}, expected earlier ones",
                      scene.name, scene.material_records.size(), child));
    }
    material.flags |= scene.material_records[child].flags & inherited;
  }
  material.node = source.node;
  material.parameters = source.children[0], material.second = source.children[1];
  material.kind = scene.material_records[source.children[0]].kind;
  const MaterialKind second = scene.material_records[source.children[1]].kind;
  if (material.kind != second) material.kind = several_kinds;
}

void pack_bsdf(const MaterialDescription& source, bool multiple_scattering, SceneData& scene,
               Material& material) {
  const Parameter* end = source.parameters + parameter_count(source);
  const bool compensated = multiple_scattering && is_rough_conductor(source);
  material.kind = compensated ? kind_of<CompensatedConductor> : source.kind;
  material.flags |= static_cast<std::uint8_t>((is_delta(source) ? Material::delta : 0) |
                                              (uses_tangent(source) ? Material::tangents : 0));
  material.parameters = size32(scene.parameters);
  scene.parameters.insert(scene.parameters.end(), source.parameters + 1, end);
}

bool is_pane(const MaterialDescription& material) {
  return material.passes && material.kind == kind_of<ThinDielectric>;
}

Material pack(const MaterialDescription& source, bool multiple_scattering, bool panes_pass,
              SceneData& scene) {
  Material material;
  const bool passes = source.passes && (panes_pass || !is_pane(source));
  material.flags = static_cast<std::uint8_t>((source.one_sided ? Material::one_sided : 0) |
                                             (source.is_textured() ? Material::textured : 0) |
                                             (source.is_boundary ? Material::boundary : 0) |
                                             (passes ? Material::passes : 0));
  if (source.node == MaterialNode::none) {
    pack_bsdf(source, multiple_scattering, scene, material);
  } else {
    pack_node(source, scene, material);
  }
  if (!is_black(source.emission.radiance)) {
    material.emission = size32(scene.emissions);
    scene.emissions.push_back(source.emission);
  }
  return material;
}

/// With a camera that does not see all, masks' kernels are those that ask which ray it is.
void list_opacities(SceneData& scene) {
  scene.opacities.clear();
  bool any = is_limited(scene.camera) || needs_media(scene);
  for (const MaterialDescription& m : scene.materials) any = any || !m.opacity.is_opaque();
  for (Mesh& mesh : scene.meshes) {
    mesh.masked = is_masked(scene, scene.materials[mesh.material]);
  }
  if (!any) return;
  for (const MaterialDescription& m : scene.materials) {
    Opacity& opacity = scene.opacities.emplace_back(m.opacity);
    if (is_hidden_light(scene, m)) opacity.cutoff = Opacity::light_hidden;
  }
  for (const std::uint32_t material : scene.sphere_material) {
    if (!scene.materials[material].opacity.is_opaque()) {
      throw Error(
          fmt::format("scene '{}' has a sphere of material {}, which is masked; expected "
                      "masks on triangles alone",
                      scene.name, material));
    }
  }
}

}  // namespace

bool is_hidden_light(const SceneData& scene, const MaterialDescription& material) {
  return scene.camera.hides_emitters && !is_black(material.emission.radiance);
}

bool is_masked(const SceneData& scene, const MaterialDescription& material) {
  return !material.opacity.is_opaque() || is_hidden_light(scene, material);
}

bool is_rough_conductor(const MaterialDescription& material) {
  return material.node == MaterialNode::none && material.kind == kind_of<Conductor> &&
         !is_delta(material);
}

std::uint32_t kinds_of(const SceneData& scene) {
  static_assert(kind_count <= 32);
  std::uint32_t kinds = 0;
  const auto add = [&](std::uint32_t material) {
    kinds |= 1u << static_cast<int>(scene.material_records[material].kind);
  };
  for (const Mesh& mesh : scene.meshes) add(mesh.material);
  for (const std::uint32_t material : scene.sphere_material) add(material);
  for (const std::uint32_t material : scene.quad_material) add(material);
  return kinds;
}

bool needs_media(const SceneData& scene) {
  return !scene.media.empty() || std::ranges::any_of(scene.material_records, [](const Material& m) {
    return m.is(Material::passes);
  });
}

void prepare_materials(SceneData& scene, bool multiple_scattering, bool panes_pass) {
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    scene.textures[i].index = static_cast<std::uint32_t>(i);
  }
  weigh_emission_textures(scene);
  scene.material_records.clear(), scene.parameters.clear(), scene.emissions.clear();
  for (const MaterialDescription& m : scene.materials) scene.parameters.push_back(m.parameters[0]);
  for (const MaterialDescription& m : scene.materials) {
    scene.material_records.push_back(pack(m, multiple_scattering, panes_pass, scene));
  }
  list_opacities(scene);
}

}  // namespace pt
