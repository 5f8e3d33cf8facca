#include <fmt/format.h>

#include <iterator>
#include <set>

#include "common/scene/data/plastic_material.h"
#include "common/scene/edit/scene_parameters.h"

namespace pt {
namespace {

/// Whether a coat colours each internal reflection (see Plastic::coat).
PlasticCoat coat_of(const Color& coat, float eta) { return {eta, coat.z != 0.0f}; }

/// Computes the precomputed parameters again, for a coat with this index of refraction.
void remake_coat(MaterialDescription& m, float eta) {
  MaterialDescription made;
  if (m.kind == kind_of<Plastic>) {
    made = make_plastic(m[&Plastic::diffuse].value, m[&Plastic::specular].value,
                        coat_of(m[&Plastic::coat].value, eta));
  } else {
    made = make_rough_plastic(m[&RoughPlastic::diffuse].value, m[&RoughPlastic::specular].value,
                              coat_of(m[&RoughPlastic::coat].value, eta),
                              m[&RoughPlastic::alpha].value.x,
                              m[&RoughPlastic::is_beckmann].value.x != 0.0f);
  }
  int i = 0;
  for (const BsdfParameter& parameter : bsdf_parameters(m.kind)) {
    if (parameter.is_precomputed) m.parameters[i].value = made.parameters[i].value;
    ++i;
  }
}

/// The index of the coat; -1: the BSDF has none.
int coat_index(const MaterialDescription& material) {
  return visit(material.kind, material, []<class Bsdf>(const Bsdf&) {
    if constexpr (requires { &Bsdf::coat; }) return index_of(&Bsdf::coat);
    return -1;
  });
}

}  // namespace

std::vector<BsdfParameter> bsdf_parameters(MaterialKind kind) {
  return visit(kind, MaterialDescription{}, []<class Bsdf>(const Bsdf&) {
    return std::vector<BsdfParameter>(std::begin(Bsdf::fields), std::end(Bsdf::fields));
  });
}

std::vector<MaterialValue> material_values(const MaterialDescription& material) {
  std::vector<MaterialValue> values;
  const int coat = coat_index(material);
  int i = 0;
  for (const BsdfParameter& parameter : bsdf_parameters(material.kind)) {
    const int at = i++;
    if (parameter.is_precomputed) continue;
    values.push_back({parameter.name, parameter.is_color,
                      [at](const MaterialDescription& m) { return m.parameters[at].value; },
                      [at, coat](MaterialDescription& m, const Color& value) {
                        m.parameters[at].value = value;
                        if (coat >= 0) remake_coat(m, m.parameters[coat].value.x);
                      }});
  }
  if (coat >= 0) {
    values.push_back(
        {"eta", false,
         [coat](const MaterialDescription& m) { return Color(m.parameters[coat].value.x); },
         [](MaterialDescription& m, const Color& value) { remake_coat(m, value.x); }});
  }
  if (material.opacity.is_constant() && material.opacity.cutoff == 0.0f) {
    values.push_back({"opacity", false,
                      [](const MaterialDescription& m) { return Color(m.opacity.offset); },
                      [](MaterialDescription& m, const Color& value) {
                        m.opacity = constant_opacity(value.x);
                      }});
  }
  return values;
}

std::vector<std::string> material_names(const SceneData& scene) {
  std::vector<std::string> names(scene.materials.size());
  for (const auto& [material, name] : scene.names.materials) names[material] = name;
  for (std::size_t m = names.size(); m-- > 0;) {  // made of earlier materials
    const MaterialDescription& material = scene.materials[m];
    if (names[m].empty() || material.node == MaterialNode::none) continue;
    const bool has_two = material.children[0] != material.children[1];
    for (int i = 0; i <= static_cast<int>(has_two); ++i) {
      std::string& child = names[material.children[i]];
      if (child.empty()) child = has_two ? fmt::format("{}.{}", names[m], i) : names[m];
    }
  }
  std::set<std::string> taken;
  for (std::size_t m = 0; m < names.size(); ++m) {
    if (names[m].empty()) names[m] = fmt::format("material_{}", m);
    std::string name = names[m];
    const bool is_node = scene.materials[m].node != MaterialNode::none;  // has no parameters
    for (int n = 2; !is_node && !taken.insert(name).second; ++n)
      name = fmt::format("{}_{}", names[m], n);
    names[m] = name;
  }
  return names;
}

}  // namespace pt
