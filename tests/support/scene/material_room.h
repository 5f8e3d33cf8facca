// Every BSDF of the tests' cases on a panel of its own, and materials made of two of them, some
// masked or seen from behind, around a lamp.
#pragma once

#include "material/bsdf_cases.h"
#include "scene/lamp_rooms.h"

namespace pt {

inline SceneData material_room(bool masks) {
  SceneData scene;
  scene.name = "material room";
  const std::uint32_t glow = scene.add_material(make_diffuse(Color(0.0f), {9, 8, 6}));
  std::vector<MaterialDescription> materials;
  for (const BsdfCase& bsdf : all_bsdf_cases()) materials.push_back(bsdf.material);
  const auto made_of_others = materials.size();
  const std::uint32_t plain = scene.add_material(make_diffuse({0.3f, 0.5f, 0.6f}));
  const std::uint32_t metal = scene.add_material(make_metal({0.8f, 0.6f, 0.4f}, 0.3f));
  materials.push_back(make_two_sided(plain, metal));
  materials.push_back(make_blend({Color(0.4f)}, metal, plain));
  materials.push_back(make_two_sided(plain, plain));
  const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(double(materials.size()))));
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const auto x = static_cast<float>(i % columns), y = static_cast<float>(i / columns);
    MaterialDescription material = materials[i];
    material.one_sided = i < made_of_others && i % 5 == 4;
    if (masks && i % 3 == 1) material.opacity = constant_opacity(0.3f + 0.1f * (i % 4));
    const std::uint32_t panel_material = scene.add_material(material);
    // Panels lean to and fro, so that some are met at a grazing angle and from behind.
    const float tilt = 0.4f * static_cast<float>(static_cast<int>(i % 7) - 3);
    Mesh panel =
        parallelogram({}, {x, y, 0}, {0.9f, 0, tilt}, {0, 0.9f, 0.3f * tilt}, panel_material);
    panel.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    scene.meshes.push_back(panel);
  }
  const auto size = static_cast<float>(columns);
  const std::uint32_t grey = scene.add_material(make_diffuse(Color(0.5f)));
  scene.meshes.push_back(parallelogram({}, {-1, -1, -1}, {size + 2, 0, 0}, {0, size + 2, 0}, grey));
  scene.meshes.push_back(parallelogram({}, {0, size, 3}, {size, 0, 0}, {0, -0.5f, 0.5f}, glow));
  scene.environment = {4, 3, std::vector<Color>(12, {0.2f, 0.3f, 0.5f}), Affine()};
  scene.camera = {{0.5f * size, 0.5f * size, 1.2f * size},
                  {0.5f * size, 0.5f * size, 0},
                  {0, 1, 0},
                  50.0f,
                  0.0f,
                  1.0f};
  return scene;
}

}  // namespace pt
