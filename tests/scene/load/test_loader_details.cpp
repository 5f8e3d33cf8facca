// Small things of loaders and files that planted bugs showed no other test to see (tests/mutants).
#include <ImfFrameBuffer.h>
#include <ImfInputFile.h>

#include <cmath>

#include "app/report/report.h"
#include "common/image/codecs/image_io.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "load/mesh_bytes.h"
#include "load/mitsuba_scene.h"

namespace pt {
namespace {

// Indices of two bytes and so many vertices that exchanged bytes are an index, too.
TEST(LoaderDetails, BigEndianIndicesOfTwoBytesInParallel) {
  constexpr std::uint32_t count = 65'536;
  MeshBytes body(true);
  for (std::uint32_t i = 0; i < count; ++i) body.put(static_cast<float>(i)).put(0.0f).put(0.0f);
  for (std::uint32_t i = 0; i < count; ++i) {
    body.put<std::uint8_t>(3);
    for (std::uint32_t k = 0; k < 3; ++k) body.put(static_cast<std::uint16_t>((i + k) % count));
  }
  const std::string header =
      "ply\nformat binary_big_endian 1.0\nelement vertex 65536\nproperty float x\n"
      "property float y\nproperty float z\nelement face 65536\n"
      "property list uchar ushort vertex_indices\nend_header\n";
  const Mesh mesh = decode_ply(header + body.text, "a.ply");
  ASSERT_EQ(mesh.triangles.size(), count);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (std::uint32_t k = 0; k < 3; ++k) ASSERT_EQ(mesh.triangles[i].v[k], (i + k) % count);
  }
}

// Read by OpenEXR itself: our reader would undo what our writer does wrong.
TEST(LoaderDetails, ExrChannelsAreWhatTheirNamesSay) {
  const TempFolder folder;
  const std::string path = folder.file("a.exr");
  write_image(path, Image{2, 1, {1, 2, 3, 4, 5, 6}}, {});
  Imf::InputFile file(path.c_str());
  const char* names[] = {"R", "G", "B"};
  for (int c = 0; c < 3; ++c) {
    float values[2] = {};
    Imf::FrameBuffer buffer;
    buffer.insert(names[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values), sizeof(float),
                                       2 * sizeof(float)));
    file.setFrameBuffer(buffer);
    file.readPixels(0);
    EXPECT_EQ(values[0], 1.0f + static_cast<float>(c)) << names[c];
    EXPECT_EQ(values[1], 4.0f + static_cast<float>(c)) << names[c];
  }
}

TEST(LoaderDetails, ASpotsBeamIsThreeQuartersOfItsCone) {
  const SceneData scene = load_xml(
                              "<shape type=\"sphere\"/><emitter type=\"spot\">"
                              "<float name=\"cutoff_angle\" value=\"40\"/></emitter>")
                              .scene;
  EXPECT_NEAR(scene.delta_lights.at(0).cos_inner, std::cos(30 * 3.14159265358979 / 180), 1e-6);
  EXPECT_NEAR(scene.delta_lights.at(0).cos_outer, std::cos(40 * 3.14159265358979 / 180), 1e-6);
}

TEST(LoaderDetails, ATextureScaleKeepsWhatItScales) {
  const SceneData scene = load_xml(
                              "<shape type=\"rectangle\"><bsdf type=\"diffuse\"><texture "
                              "type=\"scale\" name=\"reflectance\"><rgb name=\"value\" "
                              "value=\"0.8 0.4 0.2\"/><float name=\"scale\" value=\"0.5\"/>"
                              "</texture></bsdf></shape>",
                              "0.6.0")
                              .scene;
  const Color albedo = scene.materials.at(0).color(0);
  EXPECT_FLOAT_EQ(albedo.x, 0.4f);
  EXPECT_FLOAT_EQ(albedo.y, 0.2f);
  EXPECT_FLOAT_EQ(albedo.z, 0.1f);
}

TEST(LoaderDetails, ABlackBodysScaleMultiplies) {
  const auto radiance = [](const std::string& scale) {
    return load_xml(
               "<shape type=\"rectangle\"><emitter type=\"area\"><blackbody name=\"radiance\" "
               "temperature=\"4000\"" +
                   scale + "/></emitter></shape>",
               "0.6.0")
        .scene.materials.at(0)
        .emission.radiance;
  };
  const Color one = radiance(""), three = radiance(" scale=\"3\"");
  EXPECT_GT(one.x, 0.0f);
  for (int c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(three[c], 3.0f * one[c]);
}

TEST(LoaderDetails, OtherStagesAreSummed) {
  RenderReport report;
  report.runs.resize(1);
  report.runs[0].stages = {{"first", 1.5, 2}, {"intersect", 7.0, 1}, {"second", 2.0, 3}};
  std::string median, launches;
  for (const auto& [name, value] : report_csv_row(Options(), report)) {
    if (name == "other_ms_median") median = value;
    if (name == "other_launches") launches = value;
  }
  EXPECT_EQ(median, "3.500000");
  EXPECT_EQ(launches, "5");
}

}  // namespace
}  // namespace pt
