// Textures computed from others, texel by texel.
#include <algorithm>
#include <cmath>

#include "common/error/host_memory.h"
#include "common/scene/load/pbrt/surfaces/textures.h"
#include "common/texture/sample_texture.h"

namespace pt::pbrt {
namespace {

constexpr std::uint32_t plain_side = 512;  // of what is no image
constexpr std::uint32_t most_side = 4096;

bool maps_alike(const Texture& a, const Texture& b) {
  return a.kind == TextureKind::image && b.kind == TextureKind::image && a.wrap_u == b.wrap_u &&
         a.wrap_v == b.wrap_v && std::equal(a.u_row, a.u_row + 3, b.u_row) &&
         std::equal(a.v_row, a.v_row + 3, b.v_row);
}

/// How often a texture is repeated along a coordinate of the unit square.
float repetitions(const float (&row)[3]) { return std::max(std::abs(row[0]), std::abs(row[1])); }

struct Plan {
  Texture look;           ///< of the result
  bool own_space = true;  ///< all parts have the map of `look`
  std::uint32_t width = 1, height = 1;
};

std::uint32_t side_for(std::uint32_t texels, float times) {
  const double wanted = std::ceil(texels * std::clamp(double{times}, 1.0, 8.0));
  return std::min(most_side, static_cast<std::uint32_t>(wanted));
}

Plan plan_for(const std::vector<const Texture*>& textures) {
  Plan plan;
  plan.look = *textures.front();
  for (const Texture* t : textures) plan.own_space = plan.own_space && maps_alike(plan.look, *t);
  if (!plan.own_space) plan.look = Texture();
  for (const Texture* t : textures) {
    const bool image = t->kind == TextureKind::image;
    const float u = plan.own_space ? 1.0f : repetitions(t->u_row);
    const float v = plan.own_space ? 1.0f : repetitions(t->v_row);
    plan.width = std::max(plan.width, side_for(image ? t->width : plain_side, u));
    plan.height = std::max(plan.height, side_for(image ? t->height : plain_side, v));
  }
  plan.look.color0 = Color(1.0f);
  return plan;
}

/// What others are computed to is bounded by what they are made of: a few lines can ask for more
/// than any memory holds.
void check_size(Context& context, const Plan& plan) {
  constexpr std::uint64_t most = std::uint64_t{1} << 30, factor = 16;
  const std::uint64_t bytes = std::uint64_t{12} * plan.width * plan.height;
  const std::uint64_t pictures = context.scene.texels.size() - context.baked_bytes;
  context.baked_bytes += bytes;
  if (context.baked_bytes > most + factor * pictures) {
    throw Error("textures computed from others take more than 1 GiB and 16 times their pictures");
  }
  check_host_memory(bytes, "a texture computed from others");
}

/// The value of a part at a point of the result's own space.
Color value_at(const Context& context, const ColorTexture& part, const Plan& plan, const Vec2& uv) {
  if (part.is_constant()) return part.color;
  const SceneData& scene = context.scene;
  const Texture& texture = scene.textures[part.texture];
  const std::byte* texels = scene.texels.data();
  if (plan.own_space) {
    return part.color * texture.color0 * sample_image(texture, texels, uv);
  }
  return part.color * sample_texture(scene.textures.data(), part.texture, texels, uv);
}

}  // namespace

ColorTexture bake(Context& context, const std::vector<ColorTexture>& parts,
                  const std::function<Color(const std::vector<Color>&)>& function) {
  std::vector<const Texture*> textures;
  std::vector<Color> values;
  for (const ColorTexture& part : parts) {
    values.push_back(part.color);
    if (!part.is_constant()) textures.push_back(&context.scene.textures[part.texture]);
  }
  if (textures.empty()) return {function(values)};
  const Plan plan = plan_for(textures);
  check_size(context, plan);
  const TextureImage image = make_float_image(plan.width, plan.height, [&](auto x, auto y) {
    const Vec2 uv((static_cast<float>(x) + 0.5f) / static_cast<float>(plan.width),
                  1.0f - (static_cast<float>(y) + 0.5f) / static_cast<float>(plan.height));
    for (std::size_t i = 0; i < parts.size(); ++i) {
      values[i] = value_at(context, parts[i], plan, uv);
    }
    return function(values);
  });
  return {Color(1.0f), context.textures.add_image(image, plan.look)};
}

}  // namespace pt::pbrt
