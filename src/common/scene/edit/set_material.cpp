#include "common/scene/edit/set_material.h"

#include "common/scene/data/plastic_material.h"
#include "common/scene/edit/bsdf_parameters.h"

namespace pt {
namespace {

/// Whether a coat colours each internal reflection (CoatedBody::coat).
PlasticCoat coat_of(const Color& coat, float eta) { return {eta, coat.z != 0.0f}; }

/// What was precomputed from the others, of a coat with this index of refraction.
void remake_coat(MaterialDescription& m, float eta) {
  MaterialDescription made;
  int first = 0, last = 0;  // parameters that are not the user's
  if (m.kind == kind_of<Plastic>) {
    using Index = Plastic::Index;
    made = make_plastic(m.color(Index::diffuse), m.color(Index::specular),
                        coat_of(m.color(Index::coat), eta));
    first = Index::coat, last = Index::count;
  } else if (m.kind == kind_of<RoughPlastic>) {
    using Index = RoughPlastic::Index;
    made = make_rough_plastic(m.color(Index::diffuse), m.color(Index::specular),
                              coat_of(m.color(Index::coat), eta), m.scalar(Index::alpha),
                              m.scalar(Index::is_beckmann) != 0.0f);
    first = Index::coat, last = Index::is_beckmann;
  }
  for (int i = first; i < last; ++i) m.parameters[i].value = made.parameters[i].value;
}

/// Where a coated BSDF keeps its coat; -1: it has none.
int coat_index(MaterialKind kind) {
  if (kind == kind_of<Plastic>) return Plastic::Index::coat;
  return kind == kind_of<RoughPlastic> ? static_cast<int>(RoughPlastic::Index::coat) : -1;
}

bool is_precomputed(MaterialKind kind, int i) {
  const int coat = coat_index(kind);
  return coat >= 0 && i >= coat &&
         !(kind == kind_of<RoughPlastic> && i == RoughPlastic::Index::is_beckmann);
}

}  // namespace

std::vector<MaterialValue> material_values(const MaterialDescription& material) {
  std::vector<MaterialValue> values;
  const int coat = coat_index(material.kind);
  int i = 0;
  for (const BsdfParameter& parameter : bsdf_parameters(material.kind)) {
    const int at = i++;
    if (is_precomputed(material.kind, at)) continue;
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

}  // namespace pt
