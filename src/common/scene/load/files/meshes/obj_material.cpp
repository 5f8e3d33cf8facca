#include "common/scene/load/files/meshes/obj_material.h"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "common/error/error.h"
#include "common/scene/load/files/find_file.h"
#include "common/scene/load/files/mapped_file.h"
#include "common/scene/load/files/meshes/text_number.h"

namespace pt {
namespace {

/// Finite and within [0, largest].
Color limited(const float (&rgb)[3], float largest) {
  Color color;
  for (int c = 0; c < 3; ++c) {
    color[c] = std::isfinite(rgb[c]) ? std::clamp(rgb[c], 0.0f, largest) : 0.0f;
  }
  return color;
}

Color reflectance(const float (&rgb)[3]) { return limited(rgb, 1.0f); }

bool is_one_of(int illum, std::initializer_list<int> models) {
  return std::ranges::count(models, illum) > 0;
}

/// The slope of Blinn's lobe with this exponent, sqrt(2 / (Ns + 2)), is the radius of ours.
float fuzz_of(const tinyobj::material_t& mtl) {
  if (mtl.roughness > 0.0f) return std::min(mtl.roughness * mtl.roughness, 1.0f);
  return std::clamp(std::sqrt(2.0f / (std::max(mtl.shininess, 0.0f) + 2.0f)), 0.0f, 1.0f);
}

bool is_glass(const tinyobj::material_t& mtl) {
  return mtl.alpha_texname.empty() && (is_one_of(mtl.illum, {4, 6, 7, 9}) || mtl.dissolve < 0.5f);
}

/// Tf, where it is given, filters what passes.
MaterialDescription glass_of(const tinyobj::material_t& mtl) {
  const bool plausible = mtl.ior > 1.0f && mtl.ior < 5.0f;
  const float eta = plausible ? mtl.ior : 1.5f;
  const Color filter = reflectance(mtl.transmittance);
  if (is_black(filter) || filter == Color(1.0f)) return make_dielectric(Color(1.0f), eta);
  return describe_all<RoughDielectric>(1.0f, filter, eta, 0.0f, 0.0f, 0.0f);
}

/// Ns is the exponent of the cosine to the half vector, which turns half as far as the mirrored
/// ray: a quarter of it gives a lobe as wide. Ks, the height of the highlight, is taken for its
/// reflectance, as the height itself would say how bright lamps look and not what is reflected.
MaterialDescription phong_of(const tinyobj::material_t& mtl) {
  const float exponent = std::isfinite(mtl.shininess) ? std::max(mtl.shininess, 0.0f) : 0.0f;
  return describe_all<Phong>(reflectance(mtl.diffuse), reflectance(mtl.specular), exponent / 4.0f);
}

MaterialDescription nearest_material(const tinyobj::material_t& mtl) {
  const Color kd = reflectance(mtl.diffuse), ks = reflectance(mtl.specular);
  if (is_glass(mtl)) return glass_of(mtl);
  if (mtl.metallic > 0.5f) return make_metal(kd, fuzz_of(mtl));
  if (is_one_of(mtl.illum, {3, 5, 8}) && max_abs(ks) > max_abs(kd)) {
    return make_metal(ks, fuzz_of(mtl));
  }
  if (mtl.illum == 2 && !is_black(ks)) return phong_of(mtl);
  return make_diffuse(kd);
}

/// `name` of a texture, beside the MTL file, with the separators of any system.
std::filesystem::path map_path(const std::filesystem::path& mtl_path, std::string name,
                               std::vector<std::string>& warnings) {
  if (name.empty()) return {};
  std::ranges::replace(name, '\\', '/');
  const auto warn = [&](const std::string& line) { warnings.push_back(line); };
  const std::filesystem::path found = find_file(mtl_path.parent_path(), name, warn);
  return found.empty() ? mtl_path.parent_path() / name : found;
}

void warn_of_losses(const tinyobj::material_t& mtl, const MaterialDescription& material,
                    std::vector<std::string>& warnings) {
  std::string lost;
  const auto check = [&](bool present, const char* what) {
    if (present) lost += (lost.empty() ? "" : ", ") + std::string(what);
  };
  const bool diffuse = material.kind == kind_of<Diffuse>;
  check(diffuse && mtl.illum != 1 && max_abs(reflectance(mtl.specular)) > 0.1f, "highlights (Ks)");
  check(!mtl.displacement_texname.empty(), "disp");
  check(!mtl.specular_texname.empty() && material.kind != kind_of<Phong>, "map_Ks");
  if (!lost.empty()) warnings.push_back(fmt::format("material {}: no {}", mtl.name, lost));
}

ObjMaterial convert(const tinyobj::material_t& mtl, const std::filesystem::path& mtl_path,
                    std::vector<std::string>& warnings) {
  ObjMaterial result{mtl.name, nearest_material(mtl), {}, {}};
  warn_of_losses(mtl, result.material, warnings);
  result.bump_map = map_path(
      mtl_path, mtl.normal_texname.empty() ? mtl.bump_texname : mtl.normal_texname, warnings);
  result.bump_scale = mtl.bump_texopt.bump_multiplier;
  if (!is_glass(mtl)) {
    result.opacity_map = map_path(mtl_path, mtl.alpha_texname, warnings);
    const float d = std::isfinite(mtl.dissolve) ? std::clamp(mtl.dissolve, 0.0f, 1.0f) : 1.0f;
    if (result.opacity_map.empty()) result.material.opacity = constant_opacity(d);
    result.albedo_map = map_path(mtl_path, mtl.diffuse_texname, warnings);
  }
  if (result.material.kind == kind_of<Phong>) {
    result.specular_map = map_path(mtl_path, mtl.specular_texname, warnings);
  }
  if (!is_glass(mtl) && result.material.kind != kind_of<Metal>) {
    result.emission_map = map_path(mtl_path, mtl.emissive_texname, warnings);
    result.material.emission.radiance = limited(mtl.emission, 1e30f);
    if (!result.emission_map.empty() && is_black(result.material.emission.radiance)) {
      result.material.emission.radiance = Color(1.0f);  // a map alone means the map itself
    }
  }
  return result;
}

/// The text with the number of each material in place of its name, which goes to `names`: after
/// 2.0.0rc10 tinyobjloader ends a name at its first space.
std::string number_materials(std::string_view text, std::vector<std::string>& names) {
  std::string result;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    std::string_view rest = line;
    const bool begins_material = next_word(rest) == "newmtl";
    const std::string_view name = trim(rest);
    if (begins_material && !name.empty()) {
      result += fmt::format("newmtl {}\n", names.size());
      names.emplace_back(name);
    } else {
      result.append(line) += '\n';
    }
  }
  return result;
}

}  // namespace

void decode_mtl(std::string_view bytes, const std::filesystem::path& path, ObjFile& file) {
  std::vector<std::string> names;
  std::istringstream stream{number_materials(without_byte_order_mark(bytes), names)};
  std::map<std::string, int> numbers;
  std::vector<tinyobj::material_t> materials;
  std::string warnings, errors;
  tinyobj::LoadMtl(&numbers, &materials, &stream, &warnings, &errors);
  if (!errors.empty()) throw Error(errors);
  for (tinyobj::material_t& material : materials) {
    if (material.name.empty()) continue;
    material.name = names.at(std::stoul(material.name));
    file.materials.push_back(convert(material, path, file.warnings));
  }
}

void read_mtl(const std::filesystem::path& path, ObjFile& file) {
  decode_mtl(MappedFile(path).bytes(), path, file);
}

}  // namespace pt
