#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/scene/load/files/importer.h"
#include "common/scene/load/obj/mtl.h"

namespace pt::obj {
namespace {

constexpr float usual_index = 1.5f;  // of refraction
constexpr float usual_roughness = 0.5f;

bool is_one_of(std::optional<int> illum, std::initializer_list<int> models) {
  return illum && std::ranges::count(models, *illum) > 0;
}

bool is_grey(const Color& c) { return c.y == c.x && c.z == c.x; }

float mean(const Color& c) { return (c.x + c.y + c.z) / 3.0f; }

/// Exporters write 0 or 1 where they know none.
float index_of(const MtlMaterial& m) {
  const float ni = m.Ni.value_or(usual_index);
  return ni > 1.0f && ni < 5.0f ? ni : usual_index;
}

/// d, or what Tr leaves.
float opacity_of(const MtlMaterial& m) {
  if (m.d) return *m.d;
  if (m.Tr) return 1.0f - *m.Tr;
  // Maya writes illum 4 and Ni 1 for whatever does not bend light, and in Tf what it keeps.
  const bool is_mayas = m.illum == 4 && m.Ni && *m.Ni <= 1.0f;
  const float kept = is_mayas && m.Tf ? mean(*m.Tf) : 1.0f;
  return kept > 0.0f ? kept : 1.0f;
}

bool is_glass(const MtlMaterial& m) {
  if (m.map_d || m.map_Tr) return false;
  // Cinema 4D and others write illum 7 for whatever they have.
  if ((m.map_Kd || m.exporter == Exporter::cinema4d) && !m.Ni && !m.Tf) return false;
  if (is_one_of(m.illum, {6, 7})) return true;
  const bool bends = m.Ni && *m.Ni > 1.0f;
  if (m.illum == 4) return bends || !m.Ni;
  // Blender writes illum 9 for an alpha below 1.
  if (m.illum == 9) return (bends || !m.Ni) && opacity_of(m) == 1.0f;
  if (!bends || !m.Tf || is_black(*m.Tf)) return false;
  // Where illum says that nothing passes, 3ds Max writes Tf 1 1 1 or d 1 nevertheless.
  return !m.illum || (*m.Tf != Color(1.0f) && m.d != 1.0f && m.Tr != 0.0f);
}

bool is_physical(const MtlMaterial& m) {
  return m.Pr || m.Pm || m.Ps || m.Pc || m.aniso || m.map_Pr || m.map_Pm || m.map_Ps;
}

/// The slope of Blinn's lobe with this exponent, sqrt(2 / (Ns + 2)), is the radius of ours.
float fuzz_of(const MtlMaterial& m) {
  if (m.Pr) return *m.Pr * *m.Pr;
  return std::min(std::sqrt(2.0f / (m.Ns.value_or(1.0f) + 2.0f)), 1.0f);
}

/// That of Blender's importer and exporter.
float roughness_of(const MtlMaterial& m) {
  if (m.Pr) return *m.Pr;
  if (m.map_Pr) return 1.0f;
  return m.Ns ? 1.0f - std::sqrt(std::min(*m.Ns, 1000.0f) / 1000.0f) : usual_roughness;
}

/// Tf, where it is given, filters what passes.
MaterialDescription glass_of(const MtlMaterial& m) {
  const float eta = index_of(m), alpha = m.Pr ? *m.Pr * *m.Pr : 0.0f;
  const Color filter = m.Tf && !is_black(*m.Tf) ? *m.Tf : Color(1.0f);
  if (filter == Color(1.0f) && alpha == 0.0f) return make_dielectric(Color(1.0f), eta);
  return make_material<RoughDielectric>(1.0f, filter, eta, alpha, alpha, 0.0f);
}

class Conversion {
 public:
  Conversion(const MtlMaterial& source, MtlTextures& textures, SceneData& scene,
             CountedWarnings& warnings)
      : m_(source), textures_(textures), scene_(scene), warnings_(warnings) {}

  std::uint32_t add() {
    MaterialDescription surface = is_glass(m_) ? glass() : opaque();
    set_emission(surface);
    set_opacity(surface);
    return add_norm(add_bump(surface));
  }

 private:
  void warn(std::string_view message) {
    warnings_.add(message, fmt::format("{}: {}", m_.place, message));
  }
  MapUse use(const MtlMap& map, const char* key, const char* instead) const {
    return {map, m_.place, key, instead};
  }

  MaterialDescription glass() {
    if (m_.map_Kd || m_.map_Ks) warn("glass: map_Kd and map_Ks are ignored");
    return glass_of(m_);
  }

  /// The colour without a picture is that which a missing picture leaves.
  Parameter diffuse() {
    Parameter kd{m_.Kd.value_or(Color(0.5f)), no_texture};
    if (!m_.map_Kd) return kd;
    kd.texture = textures_.add_color(
        use(m_.map_Kd, "map_Kd", m_.Kd ? "Kd alone is used" : "grey is used"), 1.0f);
    if (kd.texture != no_texture) kd.value = m_.Kd.value_or(Color(1.0f));
    return kd;
  }

  Color specular() const { return m_.Ks.value_or(m_.map_Ks ? Color(1.0f) : Color(0.0f)); }

  std::uint32_t specular_map() {
    if (!m_.map_Ks) return no_texture;
    return textures_.add_color(use(m_.map_Ks, "map_Ks", "Ks alone is used"), 1.0f);
  }

  MaterialDescription opaque() {
    const Parameter kd = diffuse();
    const Color ks = specular();
    const bool reflects = is_one_of(m_.illum, {3, 5, 8}), physical = is_physical(m_);
    if (reflects && !physical && max_abs(ks) > max_abs(kd.value)) return metal(ks, kd);
    // Blender writes illum 3 for metals, and in Ka how metallic they are.
    const bool is_metallic =
        reflects && m_.exporter == Exporter::blender && m_.Ka && !is_black(*m_.Ka);
    if (physical || is_metallic) return principled(kd, is_metallic ? mean(*m_.Ka) : 0.0f);
    const bool shines = m_.illum && *m_.illum >= 2 && *m_.illum < 10;
    if (!shines || is_black(ks)) {
      if (m_.illum != 1 && max_abs(ks) > 0.1f) warn("no highlights (Ks) without illum 2 or more");
      MaterialDescription result = make_diffuse(kd.value);
      result.parameters[color_parameter].texture = kd.texture;
      return result;
    }
    // A highlight in grey is that of a dielectric; one in colour, or brighter than the rest where
    // no index is given, is what it says.
    const bool is_bright =
        !m_.Ni && m_.exporter != Exporter::cinema4d && max_abs(ks) > max_abs(kd.value);
    return is_grey(ks) && !is_bright ? principled(kd, 0.0f) : phong(kd, ks);
  }

  MaterialDescription metal(const Color& ks, const Parameter& kd) {
    MaterialDescription result = make_metal(ks, fuzz_of(m_));
    const std::uint32_t map = specular_map();
    result.parameters[color_parameter].texture = map != no_texture ? map : kd.texture;
    return result;
  }

  /// Ns is the exponent of the cosine to the half vector, which turns half as far as the mirrored
  /// ray: a quarter of it gives a lobe as wide. Ks, the height of the highlight, is taken for its
  /// reflectance, as the height itself would say how bright lamps look and not what is reflected.
  MaterialDescription phong(const Parameter& kd, const Color& ks) {
    const float exponent = m_.Ns.value_or(1.0f);
    auto result = make_material<Phong>(kd.value, ks, exponent / 4.0f);
    result[&Phong::diffuse].texture = kd.texture;
    result[&Phong::specular].texture = specular_map();
    return result;
  }

  /// The index of refraction whose reflectance is 2 Ks times that of Ni: as in Blender, Ks 0.5 is
  /// the index itself.
  float index_of_highlight() const {
    float reflectance = normal_reflectance(index_of(m_));
    if (m_.Ks || m_.map_Ks) reflectance *= 2.0f * mean(specular());
    // At 1 nothing would be reflected by metals, too.
    return std::max(index_of_reflectance(std::min(reflectance, 0.99f)), 1.001f);
  }

  Parameter number(float value, const MtlMap& map, const char* key, float missing) {
    Parameter result{Color(value), no_texture};
    if (!map) return result;
    result.texture = textures_.add_number(use(map, key, "the number alone is used"));
    if (result.texture == no_texture) result.value = Color(missing);
    return result;
  }

  MaterialDescription principled(const Parameter& kd, float metallic) {
    MaterialDescription result = make_material<Principled>(0);
    result[&Principled::base_color] = kd;
    result[&Principled::roughness] =
        number(roughness_of(m_), m_.map_Pr, "map_Pr", m_.Pr.value_or(usual_roughness));
    result[&Principled::metallic] = number(m_.Pm.value_or(m_.map_Pm ? 1.0f : metallic), m_.map_Pm,
                                           "map_Pm", m_.Pm.value_or(metallic));
    result[&Principled::eta].value = Color(index_of_highlight());
    result[&Principled::anisotropic].value = Color(m_.aniso.value_or(0.0f));
    result[&Principled::sheen] =
        number(m_.Ps.value_or(m_.map_Ps ? 1.0f : 0.0f), m_.map_Ps, "map_Ps", m_.Ps.value_or(0.0f));
    result[&Principled::clearcoat].value = Color(m_.Pc.value_or(0.0f));
    result[&Principled::clearcoat_gloss].value = Color(gloss_of_coat(m_.Pcr.value_or(0.03f)));
    return m_.map_Ks ? with_specular_map(result) : result;
  }

  /// A blend, by the map, of the material without and with its highlight.
  MaterialDescription with_specular_map(const MaterialDescription& shiny) {
    if (shiny[&Principled::metallic].value.x > 0.0f) {
      warn("map_Ks of a metal is ignored");
      return shiny;
    }
    const std::uint32_t map = specular_map();
    if (map == no_texture) return shiny;
    MaterialDescription matte = shiny;
    matte[&Principled::eta].value = Color(1.0f);
    const std::uint32_t first = scene_.add_material(matte);
    return make_blend({Color(1.0f), map}, first, scene_.add_material(shiny));
  }

  /// A map alone means the map itself.
  void set_emission(MaterialDescription& surface) {
    surface.emission.radiance = m_.Ke.value_or(Color(0.0f));
    if (!m_.map_Ke) return;
    surface.emission.texture = textures_.add_color(
        use(m_.map_Ke, "map_Ke", m_.Ke ? "Ke alone is used" : "nothing is emitted"), 1e30f);
    if (surface.emission.texture != no_texture && is_black(surface.emission.radiance)) {
      surface.emission.radiance = Color(1.0f);
    }
  }

  void set_opacity(MaterialDescription& surface) {
    const float d = opacity_of(m_);
    if (m_.d && m_.Tr && std::abs(*m_.d + *m_.Tr - 1.0f) > 0.01f) {
      warn("d and Tr contradict each other: d is used");
    }
    if (is_glass(m_)) {
      if (d < 1.0f) warn("glass lets light pass by itself: d and Tr are ignored");
      return;
    }
    surface.opacity = constant_opacity(d);
    if (m_.map_d && m_.map_Tr) warn("map_d beside map_Tr: map_d is used");
    const bool masks = static_cast<bool>(m_.map_d);
    const MtlMap& map = masks ? m_.map_d : m_.map_Tr;
    if (!map) return;
    // Exporters write d 0 or Tr 0 beside a map that replaces it.
    const float factor = masks ? (d > 0.0f ? d : 1.0f) : (d < 1.0f ? 1.0f - d : 1.0f);
    bool is_opaque = false;
    const std::uint32_t texture =
        textures_.add_opacity(use(map, masks ? "map_d" : "map_Tr", "d alone is used"), is_opaque);
    if (texture == no_texture) {
      surface.opacity = constant_opacity(d > 0.0f ? d : 1.0f);
      return;
    }
    Opacity o{factor * map.base, factor * map.gain, texture, 0.0f};
    if (is_opaque) o = {o.offset + o.scale, 0.0f, no_texture, 0.0f};
    surface.opacity = masks ? o : Opacity{1.0f - o.offset, -o.scale, o.texture, 0.0f};
  }

  /// A map of heights or, where its picture looks like that, of normals.
  MaterialDescription add_bump(MaterialDescription& surface) {
    if (!m_.bump || (m_.norm && textures_.path_of(m_.norm) == textures_.path_of(m_.bump))) {
      return surface;
    }
    const std::uint32_t map =
        textures_.add_plain(use(m_.bump, "map_Bump", "the surface is smooth"));
    if (map == no_texture) return surface;
    const bool normals = m_.bump.channel == '\0' && textures_.is_normal_map(map);
    if (normals) return mapped(MaterialNode::gltf_normal_map, m_.bump.bump, map, surface);
    return mapped(MaterialNode::bump_map, m_.bump.bump * m_.bump.gain, map, surface);
  }

  std::uint32_t add_norm(MaterialDescription surface) {
    if (!m_.norm) return scene_.add_material(surface);
    const std::uint32_t map = textures_.add_plain(use(m_.norm, "norm", "the surface is smooth"));
    if (map == no_texture) return scene_.add_material(surface);
    return scene_.add_material(mapped(MaterialNode::gltf_normal_map, m_.norm.bump, map, surface));
  }

  MaterialDescription mapped(MaterialNode node, float scale, std::uint32_t map,
                             MaterialDescription inside) {
    return under_map(node, {{scale, 0.0f, 0.0f}, map}, std::move(inside),
                     [&](const MaterialDescription& under) { return scene_.add_material(under); });
  }

  const MtlMaterial& m_;
  MtlTextures& textures_;
  SceneData& scene_;
  CountedWarnings& warnings_;
};

}  // namespace

std::uint32_t add_material(const MtlMaterial& source, MtlTextures& textures, SceneData& scene,
                           CountedWarnings& warnings) {
  return Conversion(source, textures, scene, warnings).add();
}

}  // namespace pt::obj
