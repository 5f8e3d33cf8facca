// The same scene in pbrt's format and in Mitsuba's: the same image. It has no symmetry, so that
// nothing can be mirrored unseen.
#include <gtest/gtest.h>

#include "common/scene/prepare/prepare_scene.h"
#include "load/pbrt_scene.h"
#include "render_serial.h"

namespace pt {
namespace {

// pbrt's space is left-handed: its image is Mitsuba's where the first thing that is done to the
// camera's space is to mirror it.
const char* const pbrt_text = R"(
Scale -1 1 1
LookAt 1 2 6  0.2 0.5 0  0.1 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 32 "integer yresolution" 24
PixelFilter "box"
Integrator "path" "integer maxdepth" 4
WorldBegin
LightSource "infinite" "rgb L" [ .2 .3 .4 ]
LightSource "point" "point3 from" [ -2 3 2 ] "rgb I" [ 9 6 3 ]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 3 4 5 ]
  Material "diffuse" "rgb reflectance" [ 0 0 0 ]
  Translate 2 2.5 -1  Rotate 60 1 0 1
  Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ]
    "point3 P" [ -1 -1 0  1 -1 0  1 1 0  -1 1 0 ]
AttributeEnd
MakeNamedMaterial "red" "string type" "coateddiffuse" "rgb reflectance" [ .7 .1 .1 ]
  "float thickness" 0
MakeNamedMaterial "gold" "string type" "conductor" "float roughness" .04
  "rgb eta" [ .1 .4 1.5 ] "rgb k" [ 3.4 2.5 1.8 ]
AttributeBegin
  NamedMaterial "red"
  Translate -1 .8 .3
  Shape "sphere" "float radius" .8
AttributeEnd
AttributeBegin
  NamedMaterial "gold"
  Translate 1.1 .6 .8  Scale .6 .6 .6
  Shape "sphere"
AttributeEnd
Texture "floor" "spectrum" "checkerboard" "float uscale" 8 "float vscale" 6 "float udelta" .3
  "rgb tex1" [ .7 .6 .2 ] "rgb tex2" [ .1 .2 .3 ]
Material "diffuse" "texture reflectance" "floor"
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ]
  "point3 P" [ -5 0 5  5 0 5  5 0 -5  -5 0 -5 ]
  "point2 uv" [ 0 0  1 0  1 1  0 1 ]
)";

const char* const mitsuba_text = R"(
<integrator type='path'><integer name='max_depth' value='5'/></integrator>
<sensor type='perspective'><float name='fov' value='40'/><string name='fov_axis' value='smaller'/>
<transform name='to_world'><lookat origin='1,2,6' target='.2,.5,0' up='.1,1,0'/></transform>
<film type='hdrfilm'><integer name='width' value='32'/><integer name='height' value='24'/>
<rfilter type='box'/></film></sensor>
<emitter type='constant'><rgb name='radiance' value='.2 .3 .4'/></emitter>
<emitter type='point'><point name='position' x='-2' y='3' z='2'/>
<rgb name='intensity' value='9 6 3'/></emitter>
<shape type='rectangle'><transform name='to_world'><rotate x='1' z='1' angle='60'/>
<translate x='2' y='2.5' z='-1'/></transform>
<bsdf type='twosided'><bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf></bsdf>
<emitter type='area'><rgb name='radiance' value='3 4 5'/></emitter></shape>
<shape type='sphere'><point name='center' x='-1' y='.8' z='.3'/><float name='radius' value='.8'/>
<bsdf type='plastic'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/>
<boolean name='nonlinear' value='true'/><rgb name='diffuse_reflectance' value='.7 .1 .1'/></bsdf>
</shape>
<shape type='sphere'><point name='center' x='1.1' y='.6' z='.8'/><float name='radius' value='.6'/>
<bsdf type='roughconductor'><rgb name='eta' value='.1 .4 1.5'/>
<rgb name='k' value='3.4 2.5 1.8'/>
<string name='distribution' value='ggx'/><float name='alpha' value='.2'/></bsdf></shape>
<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/><scale value='5'/>
</transform><bsdf type='twosided'><bsdf type='diffuse'>
<texture name='reflectance' type='checkerboard'><rgb name='color0' value='.7 .6 .2'/>
<rgb name='color1' value='.1 .2 .3'/><transform name='to_uv'><scale x='4' y='3'/>
<translate x='.15'/></transform></texture></bsdf></bsdf></shape>
)";

Image image_of(SceneData scene) {
  Options options = image_options(32, 24, 256, *scene.defaults.max_depth);
  options.filter = scene.defaults.filter;
  prepare_scene(scene, options);
  return render(scene, options).image;
}

TEST(PbrtScene, IsTheSameInMitsubasFormat) {
  const LoadedScene ours = load_pbrt_text(pbrt_text), theirs = load_xml(mitsuba_text);
  EXPECT_TRUE(ours.warnings.empty()) << ours.warnings.front();
  EXPECT_TRUE(theirs.warnings.empty()) << theirs.warnings.front();
  EXPECT_EQ(ours.scene.defaults.max_depth, theirs.scene.defaults.max_depth);
  const Image a = image_of(ours.scene), b = image_of(theirs.scene);
  double difference = 0, sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) {
    difference += std::abs(double{a.rgb[i]} - double{b.rgb[i]});
    sum += double{a.rgb[i]};
  }
  // The noise of 256 samples; a mirrored image differs by 0.4.
  EXPECT_LT(difference / sum, 0.02);
}

}  // namespace
}  // namespace pt
