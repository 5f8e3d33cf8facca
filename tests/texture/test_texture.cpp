// Texture lookups against Mitsuba 3 and against a lookup written plainly in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "common/texture/sample_texture.h"

namespace pt {
namespace {

struct Image8 {
  std::uint32_t width, height;
  std::vector<std::byte> texels;
};

/// Values without a pattern that a mistake in x, y or channel could hide behind.
Image8 make_image(std::uint32_t width, std::uint32_t height) {
  Image8 image{width, height, {}};
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      for (std::uint32_t c = 0; c < 3; ++c) {
        image.texels.push_back(std::byte((37 * x + 91 * y + 53 * c * (x + 1) + 11) % 256));
      }
      image.texels.push_back(std::byte(255));
    }
  }
  return image;
}

Texture make_texture(const Image8& image) {
  Texture texture;
  texture.width = image.width;
  texture.height = image.height;
  return texture;
}

double exact_srgb(int byte) {
  const double c = byte / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

void expect_near(const Color& found, const Color& expected, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], tolerance) << "channel " << c;
}

TEST(Texture, EveryByteDecodesToTheSrgbCurve) {
  EXPECT_EQ(srgb_to_linear(0), 0.0f);
  EXPECT_EQ(srgb_to_linear(255), 1.0f);
  for (int byte = 0; byte < 256; ++byte) {
    const double exact = exact_srgb(byte), found = srgb_to_linear(static_cast<std::uint32_t>(byte));
    EXPECT_NEAR(found, exact, 1e-5);
    const double step = std::abs(exact_srgb(byte == 255 ? 254 : byte + 1) - exact);
    EXPECT_LT(std::abs(found - exact), step / 800) << byte;
  }
}

struct Golden {
  TextureWrap wrap;
  TextureFilter filter;
  TextureFormat format;
  Vec2 mitsuba_uv;  ///< v = 0 is the image's head
  Color color;
};

// Values of Mitsuba 3.9.1 (scalar_rgb) for the image of make_image(4, 3): load_dict({'type':
// 'bitmap', 'bitmap': Bitmap(image), 'raw': linear8, 'filter_type': ..., 'wrap_mode': ...}) and
// eval() at a SurfaceInteraction3f with these uv.
const Golden goldens[] = {
    {TextureWrap::repeat,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {0.1f, 0.2f},
     {0.03883834f, 0.08185251f, 0.2043482f}},
    {TextureWrap::repeat,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {0.5f, 0.5f},
     {0.3461682f, 0.495643f, 0.4847139f}},
    {TextureWrap::repeat,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {0.93f, 0.97f},
     {0.145362f, 0.1491686f, 0.3403094f}},
    {TextureWrap::repeat,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {-0.3f, 1.6f},
     {0.3558295f, 0.2061551f, 0.5378059f}},
    {TextureWrap::repeat,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {2.71f, -1.4f},
     {0.3626186f, 0.2102659f, 0.5270489f}},
    {TextureWrap::repeat,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {0.02f, 0.01f},
     {0.1955564f, 0.2841819f, 0.2003807f}},
    {TextureWrap::repeat,
     TextureFilter::bilinear,
     TextureFormat::linear8,
     {0.1f, 0.2f},
     {0.122353f, 0.2921569f, 0.4619608f}},
    {TextureWrap::repeat,
     TextureFilter::bilinear,
     TextureFormat::linear8,
     {0.5f, 0.5f},
     {0.6176471f, 0.6352941f, 0.6529412f}},
    {TextureWrap::repeat,
     TextureFilter::bilinear,
     TextureFormat::linear8,
     {0.93f, 0.97f},
     {0.34176f, 0.2528973f, 0.4957302f}},
    {TextureWrap::repeat,
     TextureFilter::bilinear,
     TextureFormat::linear8,
     {-0.3f, 1.6f},
     {0.5396077f, 0.4323922f, 0.6966274f}},
    {TextureWrap::repeat,
     TextureFilter::bilinear,
     TextureFormat::linear8,
     {2.71f, -1.4f},
     {0.5454117f, 0.4344628f, 0.690949f}},
    {TextureWrap::repeat,
     TextureFilter::bilinear,
     TextureFormat::linear8,
     {0.02f, 0.01f},
     {0.3632377f, 0.4113161f, 0.3838997f}},
    {TextureWrap::repeat,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {0.1f, 0.2f},
     {0.003346541f, 0.05126944f, 0.1778884f}},
    {TextureWrap::repeat,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {0.5f, 0.5f},
     {0.4341538f, 0.07818747f, 0.8549924f}},
    {TextureWrap::repeat,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {0.93f, 0.97f},
     {0.02955681f, 0.001214108f, 0.6866854f}},
    {TextureWrap::repeat,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {-0.3f, 1.6f},
     {0.4341538f, 0.07818747f, 0.8549924f}},
    {TextureWrap::repeat,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {2.71f, -1.4f},
     {0.4341538f, 0.07818747f, 0.8549924f}},
    {TextureWrap::repeat,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {0.02f, 0.01f},
     {0.003346541f, 0.05126944f, 0.1778884f}},
    {TextureWrap::clamp,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {0.1f, 0.2f},
     {0.01629873f, 0.0789203f, 0.2231753f}},
    {TextureWrap::clamp,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {0.5f, 0.5f},
     {0.3461682f, 0.495643f, 0.4847139f}},
    {TextureWrap::clamp,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {0.93f, 0.97f},
     {0.02955681f, 0.001214108f, 0.6866854f}},
    {TextureWrap::clamp,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {-0.3f, 1.6f},
     {0.5332768f, 0.9215816f, 0.02415762f}},
    {TextureWrap::clamp,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {2.71f, -1.4f},
     {0.1946178f, 0.07618542f, 0.01599632f}},
    {TextureWrap::clamp,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {0.02f, 0.01f},
     {0.003346541f, 0.05126944f, 0.1778884f}},
    {TextureWrap::clamp,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {0.1f, 0.2f},
     {0.003346541f, 0.05126944f, 0.1778884f}},
    {TextureWrap::clamp,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {0.5f, 0.5f},
     {0.4341538f, 0.07818747f, 0.8549924f}},
    {TextureWrap::clamp,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {0.93f, 0.97f},
     {0.02955681f, 0.001214108f, 0.6866854f}},
    {TextureWrap::clamp,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {-0.3f, 1.6f},
     {0.5332768f, 0.9215816f, 0.02415762f}},
    {TextureWrap::clamp,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {2.71f, -1.4f},
     {0.1946178f, 0.07618543f, 0.01599632f}},
    {TextureWrap::clamp,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {0.02f, 0.01f},
     {0.003346541f, 0.05126944f, 0.1778884f}},
    {TextureWrap::mirror,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {0.1f, 0.2f},
     {0.01629873f, 0.0789203f, 0.2231753f}},
    {TextureWrap::mirror,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {0.5f, 0.5f},
     {0.3461682f, 0.495643f, 0.4847139f}},
    {TextureWrap::mirror,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {0.93f, 0.97f},
     {0.02955681f, 0.001214108f, 0.6866854f}},
    {TextureWrap::mirror,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {-0.3f, 1.6f},
     {0.16092f, 0.5887259f, 0.2047973f}},
    {TextureWrap::mirror,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {2.71f, -1.4f},
     {0.3626186f, 0.2102659f, 0.5270489f}},
    {TextureWrap::mirror,
     TextureFilter::bilinear,
     TextureFormat::srgb8,
     {0.02f, 0.01f},
     {0.003346541f, 0.05126944f, 0.1778884f}},
    {TextureWrap::mirror,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {0.1f, 0.2f},
     {0.003346541f, 0.05126944f, 0.1778884f}},
    {TextureWrap::mirror,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {0.5f, 0.5f},
     {0.4341538f, 0.07818747f, 0.8549924f}},
    {TextureWrap::mirror,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {0.93f, 0.97f},
     {0.02955681f, 0.001214108f, 0.6866854f}},
    {TextureWrap::mirror,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {-0.3f, 1.6f},
     {0.2581827f, 0.9130985f, 0.1144355f}},
    {TextureWrap::mirror,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {2.71f, -1.4f},
     {0.4341538f, 0.07818747f, 0.8549924f}},
    {TextureWrap::mirror,
     TextureFilter::nearest,
     TextureFormat::srgb8,
     {0.02f, 0.01f},
     {0.003346541f, 0.05126944f, 0.1778884f}},
};

TEST(Texture, AgreesWithMitsuba) {
  const Image8 image = make_image(4, 3);
  for (const Golden& golden : goldens) {
    Texture texture = make_texture(image);
    texture.wrap_u = texture.wrap_v = golden.wrap;
    texture.filter = golden.filter;
    texture.format = golden.format;
    const Vec2 uv(golden.mitsuba_uv.x, 1.0f - golden.mitsuba_uv.y);
    SCOPED_TRACE(testing::Message()
                 << int(golden.wrap) << int(golden.filter) << " at " << uv.x << ", " << uv.y);
    expect_near(sample_texture(texture, image.texels.data(), uv), golden.color, 3e-5f);
  }
}

/// An integer coordinate of an image that goes on without end.
int wrapped(long i, int size, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp) return static_cast<int>(std::min(std::max(i, 0l), size - 1l));
  const long period = wrap == TextureWrap::repeat ? size : 2l * size;
  const long rest = ((i % period) + period) % period;
  return static_cast<int>(rest < size ? rest : 2l * size - 1 - rest);
}

/// The definition: a plane of texels, a tent over each.
double reference(const Image8& image, const Texture& texture, const Vec2& uv, int channel) {
  const double x = double(uv.x) * image.width - 0.5, y = (1 - double(uv.y)) * image.height - 0.5;
  double sum = 0;
  for (long j = std::lround(std::floor(y)); j <= std::floor(y) + 1; ++j) {
    for (long i = std::lround(std::floor(x)); i <= std::floor(x) + 1; ++i) {
      const int column = wrapped(i, static_cast<int>(image.width), texture.wrap_u);
      const int row = wrapped(j, static_cast<int>(image.height), texture.wrap_v);
      const int byte =
          std::to_integer<int>(image.texels[4 * (row * image.width + column) + channel]);
      const double value = texture.format == TextureFormat::srgb8 ? exact_srgb(byte) : byte / 255.0;
      sum += value * (1 - std::abs(x - double(i))) * (1 - std::abs(y - double(j)));
    }
  }
  return sum;
}

TEST(Texture, BilinearAgreesWithTheDefinition) {
  const TextureWrap wraps[] = {TextureWrap::repeat, TextureWrap::clamp, TextureWrap::mirror};
  for (const auto& [width, height] : {std::pair{1u, 1u}, {2u, 1u}, {5u, 7u}}) {
    const Image8 image = make_image(width, height);
    Texture texture = make_texture(image);
    for (int i = 0; i < 9 * 64; ++i) {
      texture.wrap_u = wraps[i % 3];
      texture.wrap_v = wraps[i / 3 % 3];
      texture.format = i % 2 ? TextureFormat::srgb8 : TextureFormat::linear8;
      // Multiples of 1/64 far apart: exact in float, so that only the filter is compared.
      const Vec2 uv(static_cast<float>((i * 97) % 512 - 256) / 64.0f,
                    static_cast<float>((i * 61) % 512 - 256) / 64.0f);
      const Color found = sample_texture(texture, image.texels.data(), uv);
      for (int c = 0; c < 3; ++c) {
        ASSERT_NEAR(found[c], reference(image, texture, uv, c), 1.2e-5)
            << width << "x" << height << " " << uv.x << ", " << uv.y << " channel " << c;
      }
    }
  }
}

TEST(Texture, NearestTakesTheTexelAroundThePoint) {
  const Image8 image = make_image(5, 3);
  Texture texture = make_texture(image);
  texture.filter = TextureFilter::nearest;
  texture.format = TextureFormat::linear8;
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) {
      for (const float inside : {0.01f, 0.5f, 0.99f}) {
        const Vec2 uv((static_cast<float>(x) + inside) / 5,
                      1 - (static_cast<float>(y) + inside) / 3);
        const float red = static_cast<float>(image.texels[4 * (5 * y + x)]) / 255;
        EXPECT_NEAR(sample_texture(texture, image.texels.data(), uv).x, red, 1e-6f);
      }
    }
  }
}

TEST(Texture, FloatTexelsAndColor0) {
  const std::vector<float> values = {1, 2, 3, 40, 50, 60};
  std::vector<std::byte> texels(16 + values.size() * sizeof(float));
  std::memcpy(texels.data() + 16, values.data(), values.size() * sizeof(float));
  Texture texture;
  texture.format = TextureFormat::rgb32f;
  texture.width = 2;
  texture.height = 1;
  texture.offset = 16;
  texture.color0 = {0.5f, 1.0f, 2.0f};
  expect_near(sample_texture(texture, texels.data(), {0.25f, 0.3f}), {0.5f, 2, 6}, 0);
  expect_near(sample_texture(texture, texels.data(), {0.5f, 0.3f}), {10.25f, 26, 63}, 1e-5f);
}

TEST(Texture, TransformComesFirst) {
  const Image8 image = make_image(4, 3);
  Texture plain = make_texture(image), turned = plain;
  const float u_row[3] = {0.0f, 2.0f, 0.25f}, v_row[3] = {-1.0f, 0.5f, 0.125f};
  std::copy(u_row, u_row + 3, turned.u_row);
  std::copy(v_row, v_row + 3, turned.v_row);
  const Vec2 uv(0.375f, 0.8125f);
  const Vec2 mapped(2.0f * uv.y + 0.25f, -uv.x + 0.5f * uv.y + 0.125f);
  EXPECT_EQ(sample_texture(turned, image.texels.data(), uv),
            sample_texture(plain, image.texels.data(), mapped));
}

// A bump map's slopes: by the surface's u and v, whatever the texture does with these.
TEST(Texture, TheGradientIsTheSlopeOfWhatIsShown) {
  const Image8 image = make_image(5, 7);
  Texture texture = make_texture(image);
  texture.format = TextureFormat::linear8;
  texture.color0 = Color(0.75f);
  const float u_row[3] = {0.8f, -0.6f, 0.1f}, v_row[3] = {0.9f, 1.2f, 0.3f};
  std::copy(u_row, u_row + 3, texture.u_row);
  std::copy(v_row, v_row + 3, texture.v_row);
  constexpr float step = 1.0f / 512;
  for (const TextureWrap wrap : {TextureWrap::repeat, TextureWrap::mirror}) {
    texture.wrap_u = texture.wrap_v = wrap;
    int compared = 0;
    for (int i = 0; i < 500; ++i) {
      const Vec2 uv(static_cast<float>((i * 97) % 512 - 256) / 100.0f,
                    static_cast<float>((i * 61) % 512 - 256) / 100.0f);
      const auto cell = [&](const Vec2& by) {  // between four texels
        const Vec2 at = map_coordinates(texture, uv + by);
        return std::pair(std::floor(5 * at.x - 0.5f), std::floor(7 * at.y - 0.5f));
      };
      const auto slope = [&](const Vec2& by) {
        const auto height = [&](const Vec2& to) {
          return grey_of(sample_texture(texture, image.texels.data(), uv + to));
        };
        return (height(by) - height(-by)) / (2 * step);
      };
      const Vec2 u(step, 0), v(0, step);
      if (cell(u) != cell(-u) || cell(v) != cell(-v) || cell(u) != cell(v)) continue;
      ++compared;
      const Vec2 found = texture_gradient(texture, image.texels.data(), uv);
      ASSERT_NEAR(found.x, slope(u), 3e-3) << uv.x << ", " << uv.y;
      ASSERT_NEAR(found.y, slope(v), 3e-3) << uv.x << ", " << uv.y;
    }
    EXPECT_GT(compared, 300);
  }
}

TEST(Texture, CheckerboardAgreesWithMitsuba) {
  Texture texture;
  texture.kind = TextureKind::checkerboard;
  texture.color0 = Color(1, 0, 0);
  texture.color1 = Color(0, 0, 1);
  // Mitsuba 3.9.1, load_dict({'type': 'checkerboard', ...}).eval() at these uv, none of them
  // turned.
  const std::pair<Vec2, bool> goldens_of_color0[] = {
      {{0.1f, 0.1f}, true}, {{0.6f, 0.1f}, false},  {{0.1f, 0.6f}, false},  {{0.6f, 0.6f}, true},
      {{1.1f, 0.1f}, true}, {{-0.1f, 0.1f}, false}, {{-0.1f, -0.1f}, true},
  };
  for (const auto& [uv, is_color0] : goldens_of_color0) {
    EXPECT_EQ(sample_texture(texture, nullptr, uv), is_color0 ? texture.color0 : texture.color1)
        << uv.x << ", " << uv.y;
  }
}

TEST(Texture, AnyCoordinateStaysInside) {
  const Image8 image = make_image(3, 2);  // the sanitizer sees a step out of it
  Texture texture = make_texture(image);
  const float infinity = std::numeric_limits<float>::infinity();
  const float wild[] = {0.0f, -0.0f, 1.0f,  0.99999994f, -1e-30f,   1e-30f,
                        3e9f, -3e9f, 1e38f, infinity,    -infinity, std::nanf("")};
  for (const auto wrap : {TextureWrap::repeat, TextureWrap::clamp, TextureWrap::mirror}) {
    for (const auto filter : {TextureFilter::bilinear, TextureFilter::nearest}) {
      texture.wrap_u = texture.wrap_v = wrap;
      texture.filter = filter;
      for (const float u : wild) {
        for (const float v : wild) {
          const Color color = sample_texture(texture, image.texels.data(), {u, v});
          for (int c = 0; c < 3; ++c) {
            ASSERT_TRUE(color[c] >= 0 && color[c] <= 1) << u << ", " << v << ": " << color[c];
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace pt
