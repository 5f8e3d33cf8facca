// AOVs: planes of a film, found by a pass of their own, and layers of an EXR.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

#include <functional>

#include "common/error/error.h"
#include "common/film/aov.h"
#include "common/image/codecs/image_io.h"
#include "film_cases.h"
#include "temp_folder.h"

namespace pt {
namespace {

const std::string all_names = aov_names(",");

class AovPlanes : public testing::TestWithParam<Settings> {
 protected:
  static Options options(const Settings& more) {
    const Settings small{{"device", "cpu"},  {"width", "19"},    {"height", "11"},
                         {"spp", "5"},       {"threads", "2"},   {"max-depth", "5"},
                         {"aov", all_names}, {"output", "a.exr"}};
    return with(with(with(Options(), small), GetParam()), more);
  }
};
INSTANTIATE_TEST_SUITE_P(Images, AovPlanes,
                         testing::Values(Settings{{"scene", "spheres"}, {"accel", "bvh2"}},
                                         Settings{{"scene", "cornell"}},
                                         Settings{{"scene", "boxes"}, {"aperture", "0.1"}}));

std::size_t differing_values(const Image& a, const Image& b) {
  if (a.layers.size() != b.layers.size()) return ~std::size_t{0};
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.layers.size(); ++i) {
    EXPECT_EQ(a.layers[i].name, b.layers[i].name);
    count += a.layers[i].values != b.layers[i].values || a.layers[i].numbers != b.layers[i].numbers;
  }
  return count;
}

TEST_P(AovPlanes, AreTheSameInAllModesAndDoNotChangeTheImage) {
  const Rendered expected = render_options(options({{"mode", "serial"}}));
  EXPECT_EQ(expected.image.layers.size(), aov_table.size());
  Options without = options({{"mode", "serial"}});
  without.aovs = 0;
  expect_same(render_options(without), expected);
  for (const std::string& mode : names_of(Mode::megakernel, {Mode::serial})) {
    const Rendered found = render_options(options({{"mode", mode}}));
    expect_same(found, expected);
    EXPECT_EQ(differing_values(found.image, expected.image), 0u) << mode;
  }
}

TEST_P(AovPlanes, OfPartsMakeTheWhole) {
  const Options serial = options({{"mode", "serial"}});
  expect_parts_make_the_whole(serial, serial);
  expect_parts_make_the_whole(options({{"mode", "wavefront"}, {"pool-size", "100"}}), serial);
}

// Every sample by itself says what the whole has to have summed: the means in the samples' order,
// the numbers of the first one, the variance by its definition.
TEST_P(AovPlanes, AreMadeOfTheirSamples) {
  const Options o = options({{"mode", "megakernel"}});
  const DeviceInfo device = choose_device(o.device);
  const SceneData scene = make_scene_for(o, device);
  const auto renderer = make_renderer(o, scene, device);
  Film whole = blank_film(o.width, o.height);
  renderer->render(whole, o.spp, {});
  const Image image = renderer->image();
  std::vector<Film> singles;
  for (std::uint32_t k = 0; k < 5; ++k) {
    singles.push_back(blank_film(o.width, o.height));
    singles.back().first_sample = singles.back().next_sample = k;
    renderer->render(singles.back(), 1, {});
  }
  const FilmPlan plan{o.aovs, true, false};
  const std::size_t count = whole.pixels.size();
  ASSERT_EQ(whole.features.size(), count * plan.feature_planes());
  constexpr std::uint32_t first_number = 1 + 3 + 3 + 3 + 1 + 3 + 2, last_number = first_number + 2;
  for (std::size_t i = 0; i < whole.features.size(); ++i) {
    const std::size_t plane = i / count;
    double sum = 0;
    for (const Film& single : singles) sum += single.features[i];
    const bool is_number = plane >= first_number && plane <= last_number;
    ASSERT_EQ(whole.features[i], is_number ? singles[0].features[i] : sum) << "plane " << plane;
  }
  for (std::size_t i = 0; i < count; ++i) {
    double y[5], mean = 0, variance = 0, rays = 0;
    for (std::size_t k = 0; k < 5; ++k) {
      const double* c = singles[k].pixels[i].sum;
      y[k] = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
      mean += y[k] / 5;
      rays += static_cast<double>(singles[k].moments[i].rays);
    }
    for (const double value : y) variance += (value - mean) * (value - mean) / (5 * 4);
    EXPECT_NEAR(image.layers[9].values[i], variance, 2e-6 * (variance + mean * mean));
    EXPECT_EQ(image.layers[10].values[i], 5.0f);
    EXPECT_FLOAT_EQ(image.layers[11].values[i], static_cast<float>(rays / 5 - 1));
  }
  double rays = 0;
  for (const float value : image.layers[12].values) rays += value;
  EXPECT_EQ(rays, static_cast<double>(whole.tally.rays + whole.tally.shadow_rays));
}

// The camera of `cornell` is a pinhole before a box of axis-parallel walls.
void expect_planes_fit_together(float near_clip) {
  const Options o = with(Options(), {{"scene", "cornell"},
                                     {"device", "cpu"},
                                     {"width", "32"},
                                     {"height", "32"},
                                     {"spp", "1"},
                                     {"aov", all_names}});
  SceneData scene = build_scene(o);
  scene.camera.near_clip = near_clip;
  const DeviceInfo device = choose_device(o.device);
  prepare_scene_for(scene, o, device);
  const Vec3 eye = scene.camera.look_from;
  const Image image = take_image(*make_renderer(o, scene, device), {}).image;
  const auto vector = [&](std::size_t layer, std::size_t i) {
    const float* v = &image.layers[layer].values[3 * i];
    return Vec3(v[0], v[1], v[2]);
  };
  std::size_t hits = 0;
  for (std::size_t i = 0; i < 32 * 32; ++i) {
    const std::uint32_t primitive = image.layers[6].numbers[i];
    if (primitive == no_primitive) {
      EXPECT_EQ(image.layers[3].values[i], 0.0f);
      EXPECT_EQ(image.layers[8].numbers[i], no_primitive);
      continue;
    }
    ++hits;
    const float depth = image.layers[3].values[i];
    EXPECT_NEAR(glm::length(vector(4, i) - eye), depth, 1e-4f * depth);
    EXPECT_NEAR(glm::length(vector(2, i)), 1.0f, 1e-5f);
    ASSERT_LT(primitive, scene.primitive_count());
    const Vec3 diffuse = scene.materials[image.layers[8].numbers[i]].parameters[0].value;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(vector(0, i)[c], diffuse[c], 1e-5f);
  }
  EXPECT_GT(hits, 900u);
}

TEST(Aovs, OfTheCornellBoxFitTogether) {
  expect_planes_fit_together(0.0f);
  expect_planes_fit_together(1.5f);  // depth is the distance from the camera all the same
}

// What Mitsuba 3.9.1's aov `uv:uv` shows of these shapes: a rectangle's v grows with y, PLY's is as
// in the file, OBJ's is one less it. Mitsuba has 0 at a texture's head, so v grows downwards there.
TEST(Aovs, UvIsMitsubas) {
  const TempFolder folder;
  write_text(folder.file("a.obj"),
             "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 0.5\nvt 0 0.5\n"
             "f 1/1 2/2 3/3 4/4\n");
  write_text(folder.file("a.ply"),
             "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
             "property float z\nproperty float u\nproperty float v\nelement face 1\n"
             "property list uchar int vertex_indices\nend_header\n-1 -1 0 0 0\n1 -1 0 1 0\n"
             "1 1 0 1 0.5\n-1 1 0 0 0.5\n4 0 1 2 3\n");
  struct Case {
    std::string shape;
    double v0, by_y;  // v at y = 0, and how it grows
  };
  for (const Case& c : {Case{"rectangle'>", 0.5, 0.5},
                        {"ply'><string name='filename' value='a.ply'/>", 0.25, 0.25},
                        {"obj'><string name='filename' value='a.obj'/>", 0.75, -0.25}}) {
    for (const char* reflectance : {"", "<texture type='checkerboard' name='reflectance'/>"}) {
      if (c.v0 == 0.5 && !*reflectance) continue;  // a quad has no coordinates
      write_text(folder.file("a.xml"),
                 "<scene version='3.0.0'><emitter type='constant'/><sensor type='perspective'>"
                 "<transform name='to_world'><lookat origin='0.3, 0.2, 2' target='0, 0, 0' "
                 "up='0, 1, 0'/></transform></sensor><shape type='" +
                     c.shape + "<bsdf type='diffuse'>" + reflectance + "</bsdf></shape></scene>");
      const Image image = render_options(with(Options(), {{"scene", folder.file("a.xml")},
                                                          {"device", "cpu"},
                                                          {"width", "8"},
                                                          {"height", "8"},
                                                          {"spp", "1"},
                                                          {"filter", "box"},
                                                          {"aov", "position,uv"}}))
                              .image;
      for (std::size_t i = 0; i < 64; ++i) {
        const float *p = &image.layers[0].values[3 * i], *uv = &image.layers[1].values[2 * i];
        EXPECT_NEAR(uv[0], 0.5 + 0.5 * p[0], 1e-5) << c.shape;
        EXPECT_NEAR(uv[1], c.v0 + c.by_y * p[1], 1e-5) << c.shape;
      }
    }
  }
}

// The numbers of spheres are those of the scene, whatever structure sorts them.
TEST(Aovs, NumbersDoNotDependOnTheStructure) {
  const auto image = [](const char* accel) {
    return render_options(with(Options(), {{"device", "cpu"},
                                           {"accel", accel},
                                           {"width", "40"},
                                           {"height", "20"},
                                           {"spp", "1"},
                                           {"aov", "primitive,material"}}))
        .image;
  };
  const Image brute = image("brute"), tree = image("bvh2");
  EXPECT_EQ(differing_values(brute, tree), 0u);
}

TEST(Aovs, AreRefusedWhereTheyCannotBe) {
  EXPECT_NE(refusal_of({{"device", "cpu"}, {"aov", "depth"}, {"rng", "xorwow"}})
                .find("--rng xorwow: its numbers cannot be drawn twice, which --aov needs"),
            std::string::npos);
  EXPECT_NE(refusal_of({{"aov", "deep"}}).find("--aov deep: expected a list of albedo, "),
            std::string::npos);
  EXPECT_NE(refusal_of({{"aov", "depth,depth"}}).find("names depth twice"), std::string::npos);
}

std::vector<std::uint32_t> read_channel(const std::string& path, const std::string& name,
                                        Imf::PixelType type) {
  Imf::InputFile file(path.c_str());
  const Imf::Channel* channel = file.header().channels().findChannel(name);
  if (channel == nullptr || channel->type != type) return {};
  const Imath::Box2i window = file.header().dataWindow();
  const std::size_t width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
  const std::size_t height = static_cast<std::size_t>(window.max.y - window.min.y + 1);
  std::vector<std::uint32_t> values(width * height);
  Imf::FrameBuffer buffer;
  buffer.insert(name, Imf::Slice::Make(type, values.data(), window, 4, 4 * width));
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  return values;
}

TEST(Aovs, AreLayersOfAnExrWhichStillIsAnImage) {
  const TempFolder folder;
  Image image{3, 2, std::vector<float>(18, 0.5f)};
  image.place = {4, 5, 20, 10};
  image.layers = {{"depth", "Z", {1, 2, 3, 4, 5, 6}, {}},
                  {"uv", "UV", {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, {}},
                  {"material", "I", {}, {7, 8, 9, ~0u, 1u << 25 | 1u, 0}}};
  const std::string path = folder.file("a.exr");
  write_image(path, image, {});
  EXPECT_EQ(read_image(path).rgb, image.rgb);
  const auto floats = [](const std::vector<std::uint32_t>& bits) {
    std::vector<float> values;
    for (const std::uint32_t b : bits) values.push_back(std::bit_cast<float>(b));
    return values;
  };
  EXPECT_EQ(floats(read_channel(path, "depth.Z", Imf::FLOAT)), image.layers[0].values);
  EXPECT_EQ(floats(read_channel(path, "uv.V", Imf::FLOAT)),
            (std::vector<float>{1, 3, 5, 7, 9, 11}));
  EXPECT_EQ(read_channel(path, "material.I", Imf::UINT), image.layers[2].numbers);
  Imf::InputFile file(path.c_str());
  EXPECT_EQ(file.header().dataWindow(), Imath::Box2i({4, 5}, {6, 6}));
  EXPECT_EQ(file.header().displayWindow(), Imath::Box2i({0, 0}, {19, 9}));
  image.layers[0].values.pop_back();
  EXPECT_THROW(write_image(path, image, {}), Error);
}

}  // namespace
}  // namespace pt
