// Lamps whose emission comes from a texture: how often they are asked, and that it changes nothing.
#include <cstring>

#include "common/scene/prepare/prepare_scene.h"
#include "common/scene/prepare/prepare_steps.h"
#include "render_serial.h"
#include "scene/lamp_rooms.h"
#include "statistics.h"

namespace pt {
namespace {

/// Appends an image of these colours, row by row.
std::uint32_t add_image(SceneData& scene, std::uint32_t width, const std::vector<Color>& texels,
                        const Color& factor = Color(1.0f)) {
  Texture texture;
  texture.format = TextureFormat::rgb32f;
  texture.width = width, texture.height = static_cast<std::uint32_t>(texels.size()) / width;
  texture.offset = scene.texels.size();
  texture.color0 = factor;
  scene.texels.resize(scene.texels.size() + (12 * texels.size() + 15) / 16 * 16);
  std::memcpy(scene.texels.data() + texture.offset, texels.data(), 12 * texels.size());
  scene.textures.push_back(texture);
  return static_cast<std::uint32_t>(scene.textures.size() - 1);
}

/// A lamp whose emission is `glow` times a texture.
std::uint32_t add_glow(SceneData& scene, const Color& glow, std::uint32_t texture) {
  MaterialDescription material = make_diffuse(Color(0.0f), glow);
  material.emission.texture = texture;
  return scene.add_material(material);
}

Mesh screen(const Vec3& corner, const Vec3& a, const Vec3& b, std::uint32_t material) {
  Mesh mesh = parallelogram({}, corner, a, b, material);
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  return mesh;
}

/// A floor below two screens of one size: one of a texture that is nearly black but for a corner,
/// one of a bright checkerboard.
SceneData two_screens() {
  SceneData scene;
  scene.name = "two screens";
  const std::uint32_t grey = scene.add_material(make_diffuse(Color(0.6f)));
  scene.meshes.push_back(parallelogram({}, {-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, grey));
  std::vector<Color> dim(16, Color(0.01f, 0.02f, 0.01f));
  dim[5] = Color(1.0f, 0.5f, 0.2f);
  const std::uint32_t dark = add_image(scene, 4, dim, Color(0.5f, 1, 1));
  Texture board;
  board.kind = TextureKind::checkerboard;
  board.color0 = Color(4, 1, 0.5f), board.color1 = Color(0.5f);
  scene.textures.push_back(board);
  const std::uint32_t glows[] = {add_glow(scene, Color(1, 2, 3), dark),
                                 add_glow(scene, Color(2, 2, 1), dark + 1)};
  scene.meshes.push_back(screen({-1.5f, 1, -0.5f}, {1, 0, 0}, {0, 0, 1}, glows[0]));
  scene.meshes.push_back(screen({0.5f, 1, -0.5f}, {1, 0, 0}, {0, 0, 1}, glows[1]));
  scene.camera = {{0, 0.8f, 2.5f}, {0, 0, 0}, {0, 1, 0}, 60.0f, 0.0f, 1.0f};
  return scene;
}

TEST(TexturedLamps, TheirWeightTakesTheTexturesMeanIntoAccount) {
  SceneData scene = two_screens();
  prepare_scene(scene);
  const double dim = (15 * (0.2126 * 0.005 + 0.7152 * 0.02 + 0.0722 * 0.01) +
                      (0.2126 * 0.5 + 0.7152 * 0.5 + 0.0722 * 0.2)) /
                     16;
  const double board = 0.5 * ((0.2126 * 4 + 0.7152 * 1 + 0.0722 * 0.5) + 0.5);
  EXPECT_NEAR(mean_luminance(scene.textures.data(), 0, scene.texels.data()), dim, 1e-6);
  EXPECT_NEAR(mean_luminance(scene.textures.data(), 1, scene.texels.data()), board, 1e-6);
  ASSERT_EQ(scene.light_list.lights.size(), 4u);
  const double powers[] = {dim * 0.5 * (0.2126 * 1 + 0.7152 * 2 + 0.0722 * 3),
                           board * 0.5 * (0.2126 * 2 + 0.7152 * 2 + 0.0722 * 1)};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(scene.light_list.lights[i].weight, powers[i / 2], 1e-6) << i;
  }
}

TEST(TexturedLamps, MeansOfBytesAreLinear) {
  SceneData scene;
  Texture texture;
  texture.width = 2, texture.height = 1;
  const unsigned char bytes[16] = {255, 255, 255, 255, 0, 0, 0, 255};
  scene.texels.resize(16);
  std::memcpy(scene.texels.data(), bytes, 16);
  EXPECT_NEAR(mean_luminance(&texture, 0, scene.texels.data()), 0.5, 1e-6);
  texture.width = 1;
  scene.texels[0] = scene.texels[1] = scene.texels[2] = std::byte{188};
  EXPECT_NEAR(mean_luminance(&texture, 0, scene.texels.data()), 0.5029, 1e-3) << "sRGB 188 / 255";
}

TEST(TexturedLamps, LightSamplingDoesNotChangeTheMean) {
  for (const bool both : {true, false}) {
    MeanEstimate means[2];
    for (const bool nee : {true, false}) {
      Options options = image_options(16, 16, nee ? 64 : 512, 3);
      options.nee = nee;
      SceneData scene = two_screens();
      if (!both) scene.meshes.pop_back();
      prepare_scene(scene, options);
      for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        options.seed = seed;
        double sum = 0;
        for (const float v : render(scene, options).image.rgb) sum += v;
        means[nee].add(sum / (16 * 16 * 3));
      }
    }
    const double error = std::hypot(means[0].sigma(), means[1].sigma());
    EXPECT_LT(error, 0.02 * means[0].mean());
    EXPECT_NEAR(means[0].mean(), means[1].mean(), 4 * error) << "both screens: " << both;
  }
}

// One that is black shines nowhere and is not asked; a scene may hold nothing else.
TEST(TexturedLamps, ABlackTextureIsNoLight) {
  SceneData scene = two_screens();
  scene.meshes.pop_back();
  std::fill(scene.texels.begin(), scene.texels.end(), std::byte{0});
  const Options options = image_options(4, 4, 2, 3);
  prepare_scene(scene, options);
  EXPECT_TRUE(scene.light_list.lights.empty());
  // Or a ray that meets it would ask for its place in the list.
  for (const Mesh& mesh : scene.meshes) {
    EXPECT_EQ(scene.material_records[mesh.material].emission, no_emission);
  }
  for (const float v : render(scene, options).image.rgb) EXPECT_EQ(v, 0.0f);
}

}  // namespace
}  // namespace pt
