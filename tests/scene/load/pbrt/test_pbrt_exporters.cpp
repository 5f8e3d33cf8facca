// Files in the conventions of those who write them: each shows the camera one colour that its
// numbers say.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/scene/prepare/prepare_scene.h"
#include "load/expect_near.h"
#include "load/pbrt_scene.h"
#include "render_serial.h"

namespace pt {
namespace {

struct Convention {
  const char* name;
  const char* text;
  Color center;           ///< what the middle of the image shows
  Color left_of_it;       ///< and halfway to its left side
  std::size_t notes = 0;  ///< lines that are said of it
};

const std::string quad_ply =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float "
    "v\nelement face 2\nproperty list uint8 int vertex_indices\nend_header\n"
    "-4 -4 0 0 0 1 0 0\n4 -4 0 0 0 1 1 0\n4 4 0 0 0 1 1 1\n-4 4 0 0 0 1 0 1\n"
    "3 0 1 2\n3 0 2 3\n";

/// The camera looks at the middle of a wall, whose left half in the image differs where said.
const Convention conventions[] = {
    // Bitterli's scenes of pbrt-v4: matrices, brackets around each value, lamps with normals.
    {"bitterli-v4",
     "Integrator \"volpath\"\n  \"integer maxdepth\" [ 65 ]\nTransform [ 1 0 0 0 0 1 0 0 0 0 -1 0 "
     "0 0 5 1 "
     "]\nSampler \"zsobol\"\n  \"integer pixelsamples\" [ 16 ]\nPixelFilter \"triangle\"\n  "
     "\"float "
     "yradius\" [ 1 ]\n  \"float xradius\" [ 1 ]\nFilm \"rgb\"\n  \"string filename\" [ \"a.png\" "
     "]\n  "
     "\"integer yresolution\" [ 16 ]\n  \"integer xresolution\" [ 16 ]\nCamera \"perspective\"\n  "
     "\"float "
     "fov\" [ 60 ]\nWorldBegin\nMakeNamedMaterial \"Light\"\n  \"string type\" [ \"diffuse\" ]\n  "
     "\"rgb "
     "reflectance\" [ 0 0 0 ]\nNamedMaterial \"Light\"\nAttributeBegin\nAreaLightSource "
     "\"diffuse\"\n  "
     "\"rgb L\" [ 17 12 4 ]\nShape \"trianglemesh\"\n  \"point2 uv\" [ 0 0 1 0 1 1 0 1 ]\n  "
     "\"normal N\" [ "
     "0 0 1 0 0 1 0 0 1 0 0 1 ]\n  \"point3 P\" [ -4 -4 0 4 -4 0 4 4 0 -4 4 0 ]\n  \"integer "
     "indices\" [ "
     "0 1 2 0 2 3 ]\nAttributeEnd\n",
     {17, 12, 4},
     {17, 12, 4}},
    // His scenes of pbrt-v3.
    {"bitterli-v3",
     "Integrator \"path\" \"integer maxdepth\" [65]\nTransform [1 0 0 0 0 1 0 0 0 0 -1 0 0 0 5 "
     "1]\nSampler "
     "\"sobol\" \"integer pixelsamples\" [16]\nPixelFilter \"triangle\" \"float xwidth\" [1.0] "
     "\"float "
     "ywidth\" [1.0]\nFilm \"image\" \"integer xresolution\" [16] \"integer yresolution\" [16] "
     "\"string "
     "filename\" [\"a.png\"]\nCamera \"perspective\" \"float fov\" "
     "[60]\nWorldBegin\n\tMakeNamedMaterial "
     "\"Wall\" \"string type\" [\"matte\"] \"rgb Kd\" [0.2 0.4 0.6]\n\tLightSource \"infinite\" "
     "\"rgb L\" [1 1 "
     "1]\n\tNamedMaterial \"Wall\"\n\tShape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] "
     "\"point P\" [-4 "
     "-4 0 4 -4 0 4 4 0 -4 4 0] \"normal N\" [0 0 1 0 0 1 0 0 1 0 0 1] \"float uv\" [0 0 1 0 1 1 0 "
     "1]\nWorldEnd\n",
     {0.2f, 0.4f, 0.6f},
     {0.2f, 0.4f, 0.6f},
     1},
    // obj2pbrt: uber, areas, attributes around each group.
    {"obj2pbrt",
     "LookAt 0 0 5 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" [60]\nFilm \"image\" "
     "\"integer "
     "xresolution\" [16] \"integer yresolution\" [16]\nWorldBegin\nLightSource \"infinite\" "
     "\"color L\" [1 1 "
     "1]\nAttributeBegin\nMaterial \"uber\" \"rgb Kd\" [ 0.3 0.5 0.7 ] \"rgb Ks\" [ 0 0 0 ] "
     "\"float roughness\" "
     "[ 0.05 ]\nShape \"trianglemesh\"\n\"point P\" [ -4 -4 0 4 -4 0 4 4 0 -4 4 0 ]\n\"integer "
     "indices\" [ 0 1 2 "
     "0 2 3 ]\nAttributeEnd\nWorldEnd\n",
     {0.3f, 0.5f, 0.7f},
     {0.3f, 0.5f, 0.7f},
     1},
    // pbrt's own tools write meshes as PLY beside the scene.
    {"plytool",
     "LookAt 0 0 5 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" 60\nFilm \"rgb\" \"integer "
     "xresolution\" 16 "
     "\"integer yresolution\" 16\nPixelFilter \"box\"\nWorldBegin\nLightSource "
     "\"infinite\"\nMaterial "
     "\"diffuse\" \"rgb reflectance\" [.1 .6 .3]\nShape \"plymesh\" \"string filename\" "
     "\"geometry/quad.ply\"\n",
     {0.1f, 0.6f, 0.3f},
     {0.1f, 0.6f, 0.3f}},
    // Blender's exporters: z up, screenwindow, textures in a folder, upper case and Windows'
    // slashes.
    {"blender",
     "Scale -1 1 1\nLookAt 0 -5 0  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" [60] \"float "
     "screenwindow\" [-1 1 -1 1]\nFilm \"rgb\" \"integer xresolution\" [16] \"integer "
     "yresolution\" [16]\n"
     "PixelFilter \"box\"\nWorldBegin\nLightSource \"infinite\"\nAttributeBegin\nTexture \"Map\" "
     "\"spectrum\" "
     "\"imagemap\" \"string filename\" [\"textures\\halves.ppm\"] \"string encoding\" \"sRGB\" "
     "\"string filter\" "
     "\"point\"\nMaterial \"diffuse\" \"texture reflectance\" [\"Map\"]\nTransform [1 0 0 0  0 0 1 "
     "0  0 -1 0 0  0 "
     "0 0 1]\nShape \"plymesh\" \"string filename\" [\"geometry/quad.ply\"]\nAttributeEnd\n",
     {0.5f, 0.5f, 0},
     {1, 0, 0}},
    // Exporters of pbrt-v2's time.
    {"luxblend-v2",
     "Scale -1 1 1\nLookAt 0 0 5 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" [60]\nSampler "
     "\"lowdiscrepancy\" \"integer pixelsamples\" [4]\nSurfaceIntegrator \"path\"\nFilm \"image\" "
     "\"integer "
     "xresolution\" [16] \"integer yresolution\" [16]\nPixelFilter \"mitchell\" \"float xwidth\" "
     "[2] \"float "
     "ywidth\" [2]\nWorldBegin\nLightSource \"infinite\" \"color L\" [2 2 2] \"integer nsamples\" "
     "[1]\n"
     "AttributeBegin\nTexture \"m\" \"color\" \"imagemap\" \"string filename\" "
     "\"textures/halves.ppm\" \"string "
     "wrap\" \"repeat\"\nMaterial \"matte\" \"texture Kd\" \"m\"\nShape \"trianglemesh\" \"point "
     "P\" [-4 -4 0 4 -4 "
     "0 4 4 0 -4 4 0] \"float uv\" [0 0 1 0 1 1 0 1] \"integer indices\" [0 1 2 0 2 "
     "3]\nAttributeEnd\nWorldEnd\n",
     // Between texels at u = 1/4 and 3/4, at u = 1/2 - 5 tan(30 degrees) / 16.
     {1, 1, 0},
     {2 * 0.861f, 2 * 0.139f, 0},
     1},
    // pbrt-v4's scenes: attributes, colour spaces, objects.
    {"pbrt-v4-scenes",
     "ColorSpace \"srgb\"\nLookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" "
     "60\nFilm \"rgb\" "
     "\"integer xresolution\" 16 \"integer yresolution\" 16 \"float iso\" 150 \"string sensor\" "
     "\"cie1931\"\n"
     "PixelFilter \"box\"\nOption \"bool disablepixeljitter\" true\nWorldBegin\nLightSource "
     "\"infinite\" "
     "\"spectrum L\" \"stdillum-D65\" \"float scale\" 2\nAttribute \"material\" \"rgb "
     "reflectance\" [.2 .2 .1]\n"
     "AttributeBegin\nMaterial \"diffuse\"\nObjectBegin \"quad\"\nShape \"bilinearmesh\" \"point3 "
     "P\" [-1 -1 0 1 "
     "-1 0 -1 1 0 1 1 0]\nObjectEnd\nAttributeEnd\nAttributeBegin\nScale 4 4 1\nObjectInstance "
     "\"quad\"\n"
     "AttributeEnd\n",
     {0.6f, 0.6f, 0.3f},
     {0.6f, 0.6f, 0.3f}},
    // The killeroos of pbrt-v3: z up, a lamp in view, an included file.
    {"killeroo",
     "LookAt 0 -5 0   0 0 0 0 0 1\nRotate 0 0 0 1\nCamera \"perspective\" \"float fov\" [60]\nFilm "
     "\"image\"\n"
     "\"integer xresolution\" [16] \"integer yresolution\" [16]\n    \"string filename\" "
     "\"killeroo.exr\"\nSampler "
     "\"halton\" \"integer pixelsamples\" [8]\nIntegrator "
     "\"path\"\nWorldBegin\nAttributeBegin\nMaterial \"matte\" "
     "\"color Kd\" [0 0 0]\nTranslate 0 1 0\nAreaLightSource \"area\" \"color L\" [2 3 4] "
     "\"integer nsamples\" [8]\n"
     "Shape \"sphere\" \"float radius\" [3]\nAttributeEnd\nMaterial \"plastic\" \"color Kd\" [.4 "
     ".2 .2] \"color "
     "Ks\" [.5 .5 .5] \"float roughness\" [.025]\nTranslate 100 200 -140\nInclude "
     "\"geometry/part.pbrt\"\nWorldEnd\n",
     {2, 3, 4},
     {2, 3, 4},
     1},
    // Mitsuba's scenes converted: mirrored world, a coloured lamp as a mesh, two-sided.
    {"mitsuba-converter",
     "Scale -1 1 1\nLookAt 0 0 5 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" [60]\nFilm "
     "\"rgb\" \"integer "
     "xresolution\" [16] \"integer yresolution\" [16]\nWorldBegin\nAttributeBegin\nAreaLightSource "
     "\"diffuse\" "
     "\"rgb L\" [1 2 3] \"bool twosided\" [true]\nMaterial "
     "\"interface\"\nAttributeBegin\nReverseOrientation\n"
     "ConcatTransform [4 0 0 0 0 4 0 0 0 0 1 0 0 0 0 1]\nShape \"bilinearmesh\" \"point3 P\" [-1 "
     "-1 0 1 -1 0 -1 1 0 "
     "1 1 0]\nAttributeEnd\nAttributeEnd\n",
     {1, 2, 3},
     {1, 2, 3},
     1},
    // Houdini's: the camera's space by name, transformations in blocks.
    {"houdini",
     "LookAt 0 0 5 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" [ 60 ] \"float "
     "focaldistance\" [ 10 ] \"float "
     "lensradius\" [ 0 ]\nFilm \"rgb\" \"integer xresolution\" [ 16 ] \"integer yresolution\" [ 16 "
     "]\nPixelFilter "
     "\"box\"\nWorldBegin\nAttributeBegin # light\n    CoordSysTransform \"camera\"\n    "
     "LightSource \"distant\" "
     "\"point3 from\" [ 0 0 0 ] \"point3 to\" [ 0 0 1 ] \"rgb L\" [ 3.14159265 0 0 "
     "]\nAttributeEnd\nTransformBegin\n"
     "Scale 4 4 4\nMaterial \"diffuse\" \"rgb reflectance\" [ .5 .5 .5 ]\nShape \"bilinearmesh\" "
     "\"point3 P\" [ -1 -1 "
     "0 1 -1 0 -1 1 0 1 1 0 ]\nTransformEnd\n",
     {0.5f, 0, 0},
     {0.5f, 0, 0}},
    // Windows: line ends, a mark of byte order, a bad normal that C writes as it does.
    {"windows",
     "\xef\xbb\xbfLookAt 0 0 5 0 0 0 0 1 0\r\nCamera \"perspective\" \"float fov\" [60]\r\nFilm "
     "\"rgb\" \"integer "
     "xresolution\" [16] \"integer yresolution\" [16]\r\nPixelFilter "
     "\"box\"\r\nWorldBegin\r\nLightSource "
     "\"infinite\"\r\nMaterial \"diffuse\" \"rgb reflectance\" [0.25 0.5 0.75]\r\nShape "
     "\"plymesh\" \"string "
     "filename\" [\"geometry\\quad.ply\"]\r\nShape \"trianglemesh\" \"point3 P\" [0 0 1 1 0 1 0 1 "
     "1] \"normal N\" "
     "[-nan(ind) 0 1 0 0 1 0 0 1] \"integer indices\" [0 1 2]\r\n",
     {0.25f, 0.5f, 0.75f},
     {0.25f, 0.5f, 0.75f},
     1},
    // By hand: no camera's parameters, one value without brackets, comments.
    {"by-hand",
     "# a scene\nLookAt 0 0 5  0 0 0  0 1 0 # eye, point, up\nCamera \"orthographic\" \"float "
     "screenwindow\" [-1 1 "
     "-1 1]\nFilm \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16 PixelFilter "
     "\"box\"\nWorldBegin\n"
     "LightSource \"infinite\" \"rgb L\" [.5 .5 .5]\nAttributeBegin Translate -1 0 0 Material "
     "\"diffuse\" \"rgb "
     "reflectance\" [0 1 0] Shape \"bilinearmesh\" \"point3 P\" [-2 -2 0 1 -2 0 -2 2 0 1 2 0] "
     "AttributeEnd\n"
     "AttributeBegin Translate 1 0 0 Material \"diffuse\" \"rgb reflectance\" [1 0 0] Shape "
     "\"bilinearmesh\" "
     "\"point3 P\" [-1 -2 0 2 -2 0 -1 2 0 2 2 0] AttributeEnd\n",
     // Looking along -z with y up, x is to the left in pbrt's left-handed space.
     {0.25f, 0.25f, 0},
     {0.5f, 0, 0}},
};

Color mean_between(const Image& image, int x0, int x1) {
  Color sum(0.0f);
  for (int y = 7; y < 9; ++y) {
    for (int x = x0; x < x1; ++x) {
      const float* p = image.pixel(x, y);
      sum += Color(p[0], p[1], p[2]) / (2.0f * static_cast<float>(x1 - x0));
    }
  }
  return sum;
}

TEST(PbrtExporters, FilesShowWhatTheyMean) {
  const TempFolder folder;
  std::filesystem::create_directories(folder.file("geometry"));
  std::filesystem::create_directories(folder.file("textures"));
  write_text(folder.file("geometry/quad.ply"), quad_ply);
  write_text(folder.file("geometry/part.pbrt"),
             "Shape \"trianglemesh\" \"integer indices\" [0 1 2] \"point P\" [0 0 0 1 0 0 0 1 0]");
  // Left red, right green.
  std::string halves = "P6 2 1 255\n";
  for (const int b : {255, 0, 0, 0, 255, 0}) halves += static_cast<char>(b);
  write_text(folder.file("textures/halves.ppm"), halves);
  for (const Convention& c : conventions) {
    SCOPED_TRACE(c.name);
    write_text(folder.file("scene.pbrt"), c.text);
    LoadedScene loaded = load_pbrt_file(folder.file("scene.pbrt"));
    EXPECT_EQ(loaded.warnings.size(), c.notes)
        << (loaded.warnings.empty() ? "-" : loaded.warnings.back());
    Options options = image_options(16, 16, 64, 2);
    options.filter = FilterChoice();
    prepare_scene(loaded.scene, options);
    const Image image = render(loaded.scene, options).image;
    expect_near(mean_between(image, 7, 9), c.center, 0.03f * std::max(1.0f, max_abs(c.center)));
    expect_near(mean_between(image, 3, 5), c.left_of_it,
                0.03f * std::max(1.0f, max_abs(c.left_of_it)));
  }
}

}  // namespace
}  // namespace pt
