"""The scenes of the suite against Mitsuba, as XML: see scripts/mitsuba_suite.

A scene is a string: shapes and lights. A number in brackets is its probe, which tests change by a
few percent to see that they would notice. SETTINGS has what differs from the usual sensor and
integrator.
"""
# --- XML


def tag(kind, name, value):
    return f'<{kind} name="{name}" value="{value}"/>'


def values(parameters):
    """Floats, booleans and names; texts of three numbers are colours."""
    inside = ""
    for name, value in parameters.items():
        if isinstance(value, bool):
            inside += tag("boolean", name, str(value).lower())
        elif isinstance(value, int):
            inside += tag("integer", name, value)
        elif isinstance(value, str) and len(value.split()) == 3:
            inside += tag("rgb", name, value)
        elif isinstance(value, str) and value[0].isalpha():
            inside += tag("string", name, value)
        else:
            inside += tag("float", name, value)
    return inside


def spectrum(name, *samples):
    """A spectrum of samples every 50 nm."""
    pairs = ", ".join(f"{400 + 50 * i}:{value}" for i, value in enumerate(samples))
    return tag("spectrum", name, pairs)


def plugin(element, kind, *inside, **parameters):
    return f'<{element} type="{kind}">{values(parameters)}{"".join(inside)}</{element}>'


def bsdf(kind, *inside, **parameters):
    return plugin("bsdf", kind, *inside, **parameters)


def emitter(kind, *inside, **parameters):
    return plugin("emitter", kind, *inside, **parameters)


def shape(kind, place, *inside, **parameters):
    return plugin("shape", kind, to_world(place), *inside, **parameters) + "\n"


def texture(kind, name, *inside, **parameters):
    return plugin("texture", kind, *inside, **parameters).replace(">", f' name="{name}">', 1)


def bitmap(file, name, *inside, **parameters):
    return texture("bitmap", name, tag("string", "filename", file), *inside, **parameters)


def transform(name, steps):
    return f'<transform name="{name}">{steps}</transform>'


def to_world(steps):
    return transform("to_world", steps)


def rotate(axis, angle):
    return f'<rotate {axis}="1" angle="{angle}"/>'


def scale(*factors):
    factors += (1,) * (len(factors) == 2)  # of textures
    return f'<scale value="{", ".join(map(str, factors))}"/>'


def move(x, y, z):
    return f'<translate x="{x}" y="{y}" z="{z}"/>'


# --- What scenes are made of. y is up; the camera looks along -z from above.

GREY, RED, BLUE = "0.5 0.45 0.4", "0.8 0.3 0.1", "0.1 0.4 0.9"
COPPER = {"eta": "0.2 0.92 1.1", "k": "3.9 2.45 2.14"}
DOWN = rotate("x", 90)


def diffuse(color=GREY):
    return bsdf("diffuse", reflectance=color)


def two_sided(*inside):
    return bsdf("twosided", *inside)


def floor(material=diffuse()):
    return shape("rectangle", rotate("x", -90) + scale(3), material)


WALL = shape("rectangle", scale(3) + move(0, 1, -2), diffuse("0.25 0.4 0.6"))
BLACK = diffuse("0 0 0")


def glow(radiance, *inside):
    return emitter("area", *inside, radiance=radiance) if radiance else emitter("area", *inside)


LAMP = shape("rectangle", DOWN + scale(0.8, 1, 0.5) + rotate("z", -20) + move(-0.9, 2.5, 1.2),
             BLACK, glow("7 6 5"))
# Small and bright, for highlights that tell how rough something is.
POINTED_LAMP = shape("rectangle", DOWN + scale(0.2, 1, 0.15) + move(-0.9, 2.5, 1.2), BLACK,
                     glow("90 80 70"))
SMALL_LAMP = shape("rectangle", DOWN + scale(0.3, 1, 0.5) + rotate("z", 40) + move(1.5, 2.3, 0.8),
                   BLACK, glow("[2] 9 4"))
SKY = emitter("constant", radiance="0.4 0.45 0.5")
STAGE = floor() + WALL + LAMP + SKY
BALL = scale(0.75) + move(-0.8, 0.77, 0)
CARD = scale(0.7) + rotate("x", -35) + rotate("y", 20) + move(0.8, 0.75, 0.1)
CARD_BACK = scale(0.7) + rotate("x", 145) + rotate("y", 20) + move(0.8, 0.75, 0.1)


def made_of(material):
    """A ball and a card."""
    return shape("sphere", BALL, material) + shape("rectangle", CARD, material) + STAGE


def card(material, place=CARD, *others):
    return shape("rectangle", scale(1.6) + place, material) + "".join(others) + STAGE


def sunlit_card(material):
    sun = emitter("directional", '<vector name="direction" x="0.4" y="-1" z="-0.7"/>',
                  irradiance="3 2.5 2")
    return shape("rectangle", scale(1.6) + CARD, material) + floor() + WALL + sun


def lit_by(*lights):
    """A ball, a block and a floor without other light."""
    return (floor() + shape("sphere", scale(0.6) + move(-0.7, 0.62, 0), diffuse(RED))
            + shape("cube", scale(0.4) + rotate("y", 30) + move(0.8, 0.41, 0.2),
                    diffuse("0.3 0.6 0.4")) + "".join(lights))


def uv(*steps):
    return transform("to_uv", "".join(steps))


CHECKS = two_sided(bsdf("diffuse", texture("checkerboard", "reflectance", uv(scale(3, 5)),
                                           color0="[0.8] 0.3 0.1", color1="0.1 0.4 0.9")))
PICTURE = bsdf("diffuse", bitmap("picture.png", "reflectance"))


def picture(*inside, file="picture.exr", **parameters):
    """A card that shows more than one copy of a picture."""
    more = uv(scale("[2.3]", 1.7), move(-0.3, 0.2, 0))
    return card(bsdf("diffuse", bitmap(file, "reflectance", more, *inside, **parameters)))


def principled(**parameters):
    return made_of(bsdf("principled", **parameters))


def patch(kind, *inside, **parameters):
    """The mesh, whose normals are smoother than it is."""
    place = scale(1.4, 1.1, 1.9) + rotate("x", -50) + rotate("y", 15) + move(0, 0.7, 0)
    return shape(kind, place, *inside,
                 filename=f"patch.{kind}", **parameters) + STAGE


def mesh_lamp(kind, place, *inside, radiance="[4] 5 3", **parameters):
    return lit_by(shape(kind, place, BLACK, glow(radiance), *inside, **parameters))


def many_lamps():
    lamps = ""
    for i in range(24):
        color = " ".join(f"{1 + 9 * ((i * k) % 5 == 2) + k * (i % 3):g}" for k in (1, 2, 3))
        place = scale(0.25) + rotate("x", 60 + 7 * (i % 5)) + move(
            f"{i % 6 - 2.5:g}", f"{2.4 + 0.2 * (i % 4):g}", f"{i // 6 * 0.6 - 0.4:g}")
        lamps += shape("rectangle" if i % 4 else "sphere", place if i % 4 else scale(0.3) + place,
                       BLACK, glow(color if i else "[20] 3 2"))
    return lit_by(lamps)


def group():
    """Instances, stretched and mirrored."""
    parts = shape("ply", scale(0.8), two_sided(diffuse(BLUE)), filename="patch.ply")
    parts += shape("sphere", scale(0.4) + move(0, 0, 0.5), diffuse(RED))
    place = rotate("x", -40) + rotate("y", 30) + move(-0.8, 0.8, 0)
    other = rotate("x", -60) + rotate("y", -20) + move(0.9, "[0.6]", 0.3)
    reference = '<ref id="group"/>'
    return (f'<shape type="shapegroup" id="group">{parts}</shape>'
            + shape("instance", scale(1, 0.7, 1.2) + place, reference)
            + shape("instance", scale(-0.8, 1.1, 0.7) + other, reference) + STAGE)


def room():
    """Closed: five walls and a lamp under the ceiling."""
    def wall(turn, color):
        return shape("rectangle", move(0, 0, -1) + turn + move(0, 1, 0), diffuse(color))

    return (wall(rotate("x", -90), GREY) + wall(rotate("x", 90), GREY) + wall("", GREY)
            + wall(rotate("y", 90), "[0.7] 0.1 0.05") + wall(rotate("y", -90), "0.1 0.5 0.1")
            + shape("cube", scale(0.3, 0.6, 0.3) + rotate("y", 20) + move(-0.35, 0.6, -0.3),
                    diffuse("0.7 0.7 0.7"))
            + shape("sphere", scale(0.35) + move(0.4, 0.35, 0.2), bsdf("conductor", material="Ag"))
            + shape("rectangle", DOWN + scale(0.5, 1, 0.5) + move(0, 1.98, 0), BLACK,
                    glow("6 5 4")))


def medium(*inside, side="interior", **parameters):
    """Homogeneous; sigma_t, albedo, scale."""
    text = plugin("medium", "homogeneous", *inside, **parameters)
    return text.replace(">", f' name="{side}">', 1)


def phase(kind, **parameters):
    return plugin("phase", kind, **parameters)


EMPTY = bsdf("null")
CLOUD = {"albedo": "0.9 0.85 0.8", "sigma_t": 1.5}
PROBED = {**CLOUD, "albedo": "[0.9] 0.85 0.8"}


def filled(*inside, kind="sphere", place=scale(0.9) + move(0, 0.95, 0), around=EMPTY, stage=STAGE,
           **parameters):
    """A shape around a medium, between what lights it."""
    return shape(kind, place, around, medium(*inside, **parameters)) + stage


def volume(name, file, place, *inside, **parameters):
    """A grid in the cube from -1 to 1 of `place`."""
    onto = move(-0.5, -0.5, -0.5) + scale(2) + place
    text = plugin("volume", "gridvolume", tag("string", "filename", file), to_world(onto), *inside,
                  **parameters)
    return text.replace(">", f' name="{name}">', 1)


TURNED = scale(0.35) + rotate("x", 20) + rotate("y", 40) + move(0.1, 0.6, 0)
GRID_BOX = scale(0.9, 0.8, 0.7) + move(0, 0.85, 0)


def gridded(*inside, kind="cube", place=GRID_BOX, density="puffs.vol", stage=STAGE, look=None,
            **parameters):
    """A shape around a medium whose density is a grid in it."""
    grid = volume("sigma_t", density, GRID_BOX, **(look or {}))
    text = plugin("medium", "heterogeneous", grid, *inside, **parameters)
    return shape(kind, place, EMPTY, text.replace(">", ' name="interior">', 1)) + stage


def large(inside):
    return inside.replace("</transform>", scale(1000) + "</transform>")


# --- The scenes

ROUGH = {"distribution": "ggx", "alpha": "[0.3]"}
BECKMANN = {"distribution": "beckmann", "alpha": "[0.3]"}
MAPPED = diffuse("[0.8] 0.3 0.1")
# eta and k by wavelength.
GOLD = spectrum("eta", 1.66, 1.5, 0.92, 0.35, 0.24, 0.16, 0.13) + spectrum(
    "k", 1.95, 1.88, 1.85, 2.69, 3.07, 3.59, 4.1)
GLASS = bsdf("dielectric", int_ior=1.5, ext_ior=1.0)
OLD = {"use_shadowing_function": False, "flip_invalid_normals": False}


def grey(name):
    return bitmap("grey.exr", name, raw=True)


def bumps(material, **parameters):
    return bsdf("bumpmap", bitmap("hills.exr", "map", raw=True), material, **parameters)


def normals(material, **parameters):
    return bsdf("normalmap", bitmap("normals.exr", "normalmap", raw=True), material, **parameters)



SCENES = {
    # bsdfs
    "diffuse": made_of(diffuse("[0.8] 0.3 0.1")),
    "diffuse_back": card(MAPPED, CARD_BACK, shape("sphere", BALL, MAPPED)),
    "conductor_gold": made_of(bsdf("conductor", material="Au", specular_reflectance="[0.9] 0.8 1")),
    "conductor_spectra": made_of(bsdf("conductor", GOLD)) + shape(
        "sphere", scale(0.25) + move(0, 0.3, 1.2), BLACK,
        emitter("area", spectrum("radiance", 1, 2, 4, 5, 7, 8, 9))),
    "conductor_eta_k": made_of(bsdf("conductor", eta="0.2 0.92 1.1", k="[3.9] 2.45 2.14")),
    "roughconductor_ggx": made_of(bsdf("roughconductor", **ROUGH, **COPPER)),
    "roughconductor_beckmann": made_of(bsdf("roughconductor", material="Al", **BECKMANN)),
    "roughconductor_anisotropic": made_of(bsdf("roughconductor", distribution="ggx", material="Cu",
                                               alpha_u="[0.15]", alpha_v=0.5)),
    "roughconductor_textured": card(bsdf("roughconductor", grey("alpha"),
                                         distribution="ggx",
                                         specular_reflectance="[0.9] 0.8 0.5")),
    "dielectric": made_of(bsdf("dielectric", int_ior="[1.5]", ext_ior=1.0)),
    "dielectric_tinted": made_of(bsdf("dielectric", int_ior="diamond",
                                      specular_transmittance="[0.8] 0.9 0.4",
                                      specular_reflectance="0.5 0.7 1")),
    "roughdielectric_ggx": made_of(bsdf("roughdielectric", int_ior=1.5, ext_ior=1.0, **ROUGH)),
    "roughdielectric_beckmann": made_of(bsdf("roughdielectric", int_ior=1.33, ext_ior=1.0,
                                             **BECKMANN)),
    "thindielectric": made_of(bsdf("thindielectric", int_ior="[1.7]", ext_ior=1.0)),
    "plastic": made_of(bsdf("plastic", int_ior=1.6, diffuse_reflectance="[0.8] 0.3 0.1")),
    "plastic_nonlinear": made_of(bsdf("plastic", int_ior=1.6, nonlinear=True,
                                      diffuse_reflectance="[0.8] 0.3 0.1")),
    "roughplastic_ggx": made_of(bsdf("roughplastic", diffuse_reflectance=BLUE, nonlinear=True,
                                     **ROUGH)),
    "roughplastic_beckmann": made_of(bsdf("roughplastic", diffuse_reflectance=RED, **BECKMANN)),
    "principled": principled(base_color=RED, roughness="[0.4]", specular=0.9, spec_tint=0.6),
    "principled_metallic": principled(base_color=RED, metallic=0.9, roughness="[0.5]"),
    "principled_anisotropic": principled(base_color=BLUE, metallic=1.0, roughness="[0.5]",
                                         anisotropic=0.8),
    "principled_clearcoat": principled(base_color=BLUE, roughness=0.8, clearcoat="[1]",
                                       clearcoat_gloss=0.3),
    "principled_sheen": principled(base_color=RED, roughness=0.9, sheen="[1]", sheen_tint=0.5,
                                   flatness=0.6),
    "principled_spec_trans": principled(base_color=BLUE, spec_trans="[0.7]", roughness=0.4,
                                        eta=1.4),
    "principled_textured": card(bsdf("principled", grey("roughness"),
                                     bitmap("picture.exr", "base_color", raw=True),
                                     metallic="[0.6]")),
    "principledthin": made_of(bsdf("principledthin", base_color=RED, roughness=0.5, spec_trans=0.4,
                                   diff_trans="[0.8]", eta=1.4, sheen=0.4, flatness=0.3)),
    "twosided_front": card(two_sided(MAPPED, diffuse(BLUE))),
    "twosided_back": card(two_sided(bsdf("plastic", diffuse_reflectance=BLUE), MAPPED), CARD_BACK),
    "mask": card(bsdf("mask", two_sided(diffuse(RED)), opacity="[0.35]")),
    "mask_textured": card(bsdf("mask", grey("opacity"),
                               two_sided(MAPPED))),
    "blend": made_of(bsdf("blendbsdf", diffuse(RED), bsdf("roughconductor", material="Ag",
                                                          alpha=0.3), weight="[0.4]")),
    "mask_of_blend": card(bsdf("mask", grey("opacity"), bsdf(
        "blendbsdf", two_sided(MAPPED), two_sided(diffuse(BLUE)), weight=0.3))),
    "mask_twice": card(bsdf("mask", grey("opacity"), two_sided(diffuse(RED))), CARD, shape(
        "rectangle", scale(1.4) + CARD + move(0.1, 0.2, 0.4),
        bsdf("mask", two_sided(diffuse(BLUE)), opacity="[0.5]"))),
    "mask_sphere": made_of(bsdf("mask", two_sided(diffuse(RED)), opacity="[0.5]")),
    "blend_twosided": card(two_sided(bsdf("blendbsdf", grey("weight"), MAPPED, diffuse(BLUE))),
                           CARD_BACK),
    "blend_textured": card(bsdf("blendbsdf", grey("weight"), MAPPED,
                                bsdf("roughplastic", diffuse_reflectance=BLUE))),
    # Where a part is a mirror, Mitsuba 3.9.1 weighs light and BSDF samples so that they do not sum
    # to 1 (1 % off); a sun has no such weights.
    "blend_plastic": sunlit_card(bsdf("blendbsdf", grey("weight"), MAPPED,
                                      bsdf("plastic", diffuse_reflectance=BLUE))),
    "blend_of_glass": sunlit_card(bsdf("blendbsdf", grey("weight"), GLASS, bsdf(
        "blendbsdf", two_sided(diffuse(RED)), diffuse(BLUE), weight="[0.6]"))),
    "normalmap": card(normals(MAPPED)),
    "normalmap_old": card(normals(MAPPED, **OLD)),
    "normalmap_within_twosided": card(two_sided(normals(MAPPED)), CARD_BACK),
    "normalmap_around_twosided": card(normals(two_sided(MAPPED)), CARD_BACK),
    "normalmap_glass": card(normals(GLASS)),
    "normalmap_patch": patch("obj", two_sided(normals(MAPPED))),
    "bumpmap": card(bumps(diffuse(RED), scale="[0.4]")),
    "bumpmap_old": card(bumps(diffuse(RED), scale="[0.4]", **OLD)),
    "bumpmap_twosided": card(two_sided(bumps(diffuse(RED), scale="[0.4]")), CARD_BACK),
    "bumpmap_disk": shape("disk", scale(1.3) + rotate("x", -50) + move(0, 0.9, 0),
                          bumps(diffuse(RED), scale="[0.4]")) + STAGE,
    "bumpmap_sphere": shape("sphere", scale(0.9) + rotate("x", 50) + rotate("y", 40) + move(
        -0.3, 1, 0), bumps(diffuse(RED), scale="[0.4]")) + STAGE,
    "bumpmap_patch": patch("ply", two_sided(bumps(diffuse(RED), scale="[0.3]"))),
    # Not rotated: then Mitsuba 3.9.1's slopes are not those of its heights.
    "bumpmap_transform": card(bsdf("bumpmap", bitmap(
        "hills.exr", "map", uv(scale(0.7, 1.6)), raw=True, wrap_mode="mirror"),
        diffuse(RED), scale="[0.3]")),
    "null_textured": card(bsdf("blendbsdf", grey("weight"), two_sided(MAPPED), bsdf("null"))),
    "null": made_of(bsdf("blendbsdf", two_sided(diffuse(RED)), bsdf("null"), weight="[0.4]")),
    # lights
    "light_rectangle": mesh_lamp("rectangle", DOWN + scale(0.7, 1, 1) + move(-0.8, 2, 0.4)),
    "light_sphere": mesh_lamp("sphere", scale(0.4) + move(-0.8, 2, 0.4), radiance="[8] 9 5"),
    "light_disk": mesh_lamp("disk", DOWN + scale(0.8) + move(-0.8, 2, 0.4)),
    "light_cube": mesh_lamp("cube", scale(0.3, 0.2, 0.4) + rotate("y", 20) + move(-0.3, 1.8, 0.4)),
    "light_cylinder": mesh_lamp("cylinder", scale(0.2, 0.2, 1.5) + rotate("y", 70)
                                + move(-1, 1.9, 0.4)),
    # With smooth normals Mitsuba 3.9.1 takes the interpolated cosine: 1 % too bright.
    "light_mesh": mesh_lamp("ply", scale(0.8) + rotate("x", 110) + move(-0.5, 2, 0.4),
                            filename="patch.ply", face_normals=True),
    "light_textured": lit_by(shape("rectangle", DOWN + scale(1.2, 1, 0.9) + move(-0.4, 1.9, 0.4),
                                   BLACK, glow("", bitmap("picture.exr", "radiance", uv(
                                       scale("[1.4]", 1)), raw=True)))),
    "light_two": lit_by(shape("rectangle", DOWN + scale(0.5) + move(-1.2, 2.4, 0.4), BLACK,
                              glow("[9] 4 2")), shape("sphere", scale(0.2) + move(1.6, 2.5, 1),
                                                      BLACK, glow("5 9 20"))),
    "light_many": many_lamps(),
    "light_point": lit_by(emitter("point", '<point name="position" x="-1" y="2.5" z="1.5"/>',
                                  intensity="[9] 8 6")),
    "light_spot": lit_by(emitter("spot", to_world('<lookat origin="-1.5,3,2" target="0,0.2,0" '
                                                  'up="0,1,0"/>'), cutoff_angle=25.0,
                                 beam_width=10.0, intensity="[30] 25 20")),
    "light_directional": lit_by(emitter("directional", '<vector name="direction" x="0.5" y="-1" '
                                        'z="-0.4"/>', irradiance="[3] 2.5 2")),
    "light_constant": lit_by(emitter("constant", radiance="[0.9] 0.7 1.2")),
    "light_envmap": lit_by(emitter("envmap", to_world(rotate("x", 25) + rotate("y", 130)),
                                   filename="sky.exr", scale="[0.8]")),
    "light_envmap_and_lamp": lit_by(emitter("envmap", filename="sky.exr", scale=0.3), LAMP.replace(
        "7 6 5", "[3] 4 5")),
    "light_envmap_poles": lit_by(emitter("envmap", to_world(rotate("x", 25)),
                                         filename="poles.exr", scale="[0.3]")),
    "light_envmap_seen": shape("sphere", move(0, 0, 90)) + emitter("envmap", to_world(
        rotate("x", 25)), filename="poles.exr", scale="[0.3]"),
    "light_envmap_and_three": lit_by(
        emitter("envmap", filename="sky.exr", scale=0.1), LAMP.replace("7 6 5", "[3] 4 5"),
        shape("sphere", scale(0.2) + move(1.6, 2.5, 1), BLACK, glow("5 9 20")),
        shape("rectangle", DOWN + scale(-0.6, 1, 0.4) + rotate("z", 30) + move(1.2, 2.2, -0.5),
              BLACK, glow("9 3 2"))),
    "light_textured_and_plain": lit_by(SMALL_LAMP, shape(
        "rectangle", DOWN + scale(-1.2, 1, 0.9) + move(-0.4, 2.3, 0.6), BLACK,
        glow("", bitmap("picture.exr", "radiance", raw=True)))),
    "light_sunsky_and_lamps": lit_by(LAMP, SMALL_LAMP.replace("[2]", "2"), emitter(
        "sunsky", '<vector name="sun_direction" x="0.5" y="0.4" z="0.6"/>', to_world(
            rotate("x", -90)), sky_scale="[3]", sun_scale=0.1, sun_aperture=40.0)),
    "light_in_glass": floor() + WALL + shape("sphere", move(0, 1.1, 0), GLASS) + shape(
        "sphere", scale(0.6) + move(0, 1.1, 0), diffuse(), glow("[3] 3 3")) + SKY,
    "light_sunsky": lit_by(emitter(
        "sunsky", '<vector name="sun_direction" x="0.5" y="0.4" z="0.6"/>', to_world(
            rotate("x", -90)), turbidity="[4.5]", albedo="0.1 0.3 0.5", sun_aperture=20.0)),
    "light_sky": lit_by(emitter(
        "sunsky", '<vector name="sun_direction" x="-0.3" y="0.7" z="0.4"/>', to_world(
            rotate("x", -90)), turbidity="[3]", sun_scale=0.0)),
    "light_sun": lit_by(emitter(
        "sunsky", '<vector name="sun_direction" x="0.5" y="0.6" z="0.5"/>', to_world(
            rotate("x", -90)), sun_scale="[20]", sun_aperture=10.0, sky_scale=0.0)),
    # shapes
    "shape_sphere": shape("sphere", rotate("x", 50) + rotate("y", 40) + move(0, 1, 0),
                          CHECKS) + STAGE,
    "shape_sphere_textured": shape(
        "sphere", scale(0.8) + rotate("x", 50) + rotate("y", 40) + move(-0.9, 0.85, 0),
        bsdf("diffuse", bitmap("picture.exr", "reflectance", uv(scale("[2.3]", 1.7)), raw=True)))
    + shape("sphere", scale(0.6, 0.6, -0.6) + rotate("x", 40) + move(0.9, 0.75, 0.3), two_sided(
        diffuse(BLUE), PICTURE)) + shape("sphere", scale(0.4) + move(0, 0.45, 1), two_sided(
            diffuse(BLUE), diffuse(RED)), flip_normals=True) + STAGE,
    "shape_disk": shape("disk", scale(1.3) + rotate("x", -50) + move(0, 0.9, 0), CHECKS) + STAGE,
    "shape_cube": shape("cube", scale(0.8) + rotate("y", 30) + rotate("x", 15) + move(0, 0.9, 0),
                        CHECKS) + STAGE,
    "shape_cylinder": shape("cylinder", rotate("x", 20) + move(-0.3, 1, 0), CHECKS,
                            '<point name="p0" x="-1" y="0" z="0"/>'
                            '<point name="p1" x="1" y="0.3" z="0"/>', radius=0.6) + STAGE,
    "shape_ply": patch("ply", CHECKS),
    "shape_obj": patch("obj", CHECKS),
    "shape_serialized": patch("serialized", CHECKS),
    "shape_face_normals": patch("ply", two_sided(bsdf("roughconductor", **ROUGH, **COPPER)),
                                face_normals=True),
    "shape_flip_normals": patch("obj", MAPPED, flip_normals=True) + shape(
        "sphere", scale(-0.5) + move(-1.2, 1.6, 0), MAPPED, flip_normals=True),
    "shape_instances": group(),
    # media
    "medium_grey": filled(sigma_t="[2]", albedo=0.8),
    "medium_absorbing": filled(sigma_t="0.07 [0.33] 1", albedo=0.0, scale=3.0),
    "medium_coloured": filled(sigma_t="0.1 [0.4] 1", albedo="0.9 0.5 0.8", scale=4.0),
    "medium_dense": filled(albedo="0.95 [0.8] 0.9", scale=30.0),
    "medium_thin": filled(sigma_t=0.15, albedo=0.9),
    # All but clear: of a channel of 0 Mitsuba 3.9.1's volpath makes NaN and its volpathmis too little.
    "medium_clear_red": filled(sigma_t="0.0001 0.5 0.9", albedo="0 [0.9] 0.9", scale=2.0),
    "medium_forward": filled(phase("hg", g="[0.8]"), **CLOUD),
    "medium_backward": filled(phase("hg", g=-0.6), **PROBED),
    "medium_rayleigh": filled(phase("rayleigh"), **PROBED),
    "medium_cube": filled(kind="cube", place=scale(0.7) + rotate("y", 25) + rotate("x", 10)
                          + move(0, 0.95, 0), sigma_t="[2]", albedo=0.8),
    "medium_in_glass": filled(around=bsdf("dielectric", int_ior=1.5, ext_ior=1.0),
                              sigma_t="0.4 0.5 1", albedo="0.7 0.8 0.9", scale=2.0),
    "medium_in_rough_glass": filled(around=bsdf("roughdielectric", int_ior=1.3, ext_ior=1.0,
                                                distribution="ggx", alpha=0.3),
                                    sigma_t="0.4 0.5 1", albedo="0.7 0.8 0.9", scale=2.0),
    "medium_nested": filled(stage="", sigma_t="[0.8]", albedo="0.9 0.6 0.5") + shape(
        "sphere", scale(0.4) + move(0.1, 1, 0.1), EMPTY, medium(sigma_t=5.0, albedo="0.3 0.6 0.9"),
        medium(side="exterior", sigma_t="[0.8]", albedo="0.9 0.6 0.5")) + STAGE,
    "medium_around_ball": filled(stage="", **PROBED) + shape(
        "sphere", scale(0.4) + move(0, 0.95, 0), diffuse("0.8 0.3 0.1")) + STAGE,
    "medium_around_glass": filled(stage="", **PROBED) + shape(
        "sphere", scale(0.4) + move(0, 0.95, 0), bsdf("dielectric", int_ior=1.5, ext_ior=1.0),
        medium(side="exterior", **PROBED)) + STAGE,
    "medium_around_lamp": filled(stage="", **CLOUD) + shape(
        "sphere", scale(0.45) + move(0.1, 0.95, 0.2), BLACK, glow("[9] 8 6")) + floor() + WALL,
    "medium_point": filled(stage=lit_by(), **CLOUD) + emitter(
        "point", '<point name="position" x="-1" y="2.5" z="1.5"/>', intensity="[9] 8 6"),
    "medium_spot": filled(stage=lit_by(), **CLOUD) + emitter(
        "spot", to_world('<lookat origin="-1.5,3,2" target="0,0.8,0" up="0,1,0"/>'),
        cutoff_angle=25.0, beam_width=10.0, intensity="[30] 25 20"),
    "medium_directional": filled(stage=lit_by(), **CLOUD) + emitter(
        "directional", '<vector name="direction" x="0.5" y="-1" z="-0.4"/>', irradiance="[3] 2.5 2"),
    "medium_envmap": filled(stage=lit_by(), **CLOUD) + emitter(
        "envmap", to_world(rotate("x", 25) + rotate("y", 130)), filename="sky.exr", scale="[0.8]"),
    "medium_many_lamps": filled(stage=many_lamps().replace("[20]", "20"), **PROBED),
    "medium_instances": (
        '<shape type="shapegroup" id="group">' + shape("sphere", scale(0.5), EMPTY, medium(**CLOUD))
        + "</shape>" + shape("instance", scale(1, 1.4, 1) + move(-0.8, 0.8, 0), '<ref id="group"/>')
        + shape("instance", scale(1.2, 0.7, 1) + move(0.8, "[0.6]", 0.3), '<ref id="group"/>')
        + STAGE),
    "medium_deep": filled(albedo="1 [0.95] 0.99", scale=8.0),
    "medium_grid": gridded(scale="[6]", albedo=0.8),
    "medium_grid_colors": gridded(density="colors.vol", scale="[3]", albedo="0.9 0.6 0.8"),
    "medium_grid_albedo": gridded(volume("albedo", "colors.vol", GRID_BOX), scale="[8]"),
    # The sphere reaches beyond the grid, whose outermost voxels are not empty.
    "medium_grid_nearest": gridded(kind="sphere", place=scale(1.3) + move(0, 0.85, 0),
                                   density="colors.vol", scale="[3]", albedo=0.7,
                                   look={"filter_type": "nearest"}),
    # By the file's box, which is (-2, -1, -1) to (2, 3, 1).
    "medium_grid_turned": shape(
        "cube", scale(2, 2, 1) + move(0, 1, 0) + TURNED, EMPTY, plugin(
            "medium", "heterogeneous", plugin(
                "volume", "gridvolume", tag("string", "filename", "puffs.vol"), to_world(TURNED),
                use_grid_bbox=True).replace(">", ' name="sigma_t">', 1), scale=6.0,
            albedo="[0.9] 0.85 0.8").replace(">", ' name="interior">', 1)) + STAGE,
    "medium_grid_sphere": gridded(phase("hg", g=0.6), kind="sphere",
                                  place=scale(0.7) + move(0, 0.85, 0), scale=8.0, albedo="[0.9]",
                                  stage=lit_by(LAMP)),
    "medium_grid_point": gridded(stage=lit_by(), scale=5.0, albedo="0.9 0.85 0.8") + emitter(
        "point", '<point name="position" x="-1" y="2.5" z="1.5"/>', intensity="[9] 8 6"),
    "medium_grid_shell": gridded(density="shell.vol", scale=60.0, albedo="0.99 [0.95] 0.9"),
    # filters: edges and a bright lamp
    **{f"filter_{name}": lit_by(shape(
        "sphere", scale(0.3) + move(0.3, 1.5, 0.4), BLACK, glow("4 3 5")), SKY)
       for name in ("tent", "gaussian", "default", "mitchell", "catmullrom", "lanczos")},
    # textures
    "texture_checkerboard": card(bsdf("diffuse", texture(
        "checkerboard", "reflectance", uv(scale(3, 2)),
        bitmap("picture.exr", "color0", uv(scale("[1.3]", 0.7), move(0.2, 0.1, 0)), raw=True),
        texture("checkerboard", "color1", uv(rotate("z", 20), scale(7, 8)),
                bitmap("grey.exr", "color0", raw=True), color1="0.1 0.4 0.9")))),
    "texture_checkerboard_number": card(bsdf("blendbsdf", MAPPED.replace("[0.8]", "0.8"), diffuse(
        BLUE), texture("checkerboard", "weight", uv(scale(3, 2)), grey("color0"),
                       color1="[0.9]"))),
    "texture_nearest": picture(filter_type="nearest"),
    "texture_bilinear": picture(filter_type="bilinear"),
    "texture_mirror": picture(wrap_mode="mirror"),
    "texture_clamp": picture(wrap_mode="clamp"),
    "texture_srgb": picture(file="picture.png"),
    "texture_raw": picture(file="picture.png", raw=True),
    "texture_rotated": card(bsdf("diffuse", bitmap("picture.exr", "reflectance", uv(
        rotate("z", 30), scale("[1.7]", 2.6), move(0.3, 0.1, 0)), raw=True))),
    # sensors and the whole
    **{f"sensor_{name}": lit_by(LAMP, SKY) for name in ("fov_axis", "thinlens", "crop",
                                                       "focal_length", "near_far", "orthographic",
                                                       "principal_point")},
    # Behind the hidden sphere are plane faces alone: of a sphere there Mitsuba 3.9.1 has a wrong
    # normal.
    "sensor_hide_emitters": lit_by(
        LAMP, SKY, shape("sphere", scale(0.3) + move(0.65, 1.04, 1.52), BLACK, glow("[3] 4 5"))),
    "room": room(),
    "scale_1000": large(made_of(bsdf("roughplastic", diffuse_reflectance=RED, **ROUGH))),
}

for _name in SCENES:
    if _name.startswith(("rough", "principled", "bumpmap")):
        SCENES[_name] = SCENES[_name].replace(LAMP, POINTED_LAMP)

VIEW = '<lookat origin="0.3,2.3,4.6" target="0,0.6,0" up="0,1,0"/>'
DEEP = {"depth": 24}  # passages through masks count in Mitsuba


def film(width=24, height=24, *inside, rfilter='<rfilter type="box"/>'):
    return {"film": plugin("film", "hdrfilm", *inside, rfilter, width=width, height=height)}


def noisy_filter(kind, **parameters):
    border = tag("boolean", "sample_border", "true")  # weights of pixels beyond it as well
    return {**NOISY, **film(24, 24, border, rfilter=plugin("rfilter", kind, **parameters))}


def sensor(kind="perspective", view=VIEW, *inside, **parameters):
    return {"sensor": (kind, to_world(view) + "".join(inside) + values(parameters))}


NOISY = {"samples": 768}
MEDIUM = {"method": "volpath", "samples": 1024}
MIS = {**MEDIUM, "method": "volpathmis"}  # over the channels
SETTINGS = {
    **{name: NOISY for name in """conductor_gold conductor_spectra conductor_eta_k
       roughconductor_anisotropic dielectric_tinted roughdielectric_beckmann thindielectric blend light_rectangle light_sphere
       light_disk light_cube light_cylinder light_mesh light_textured light_many
       light_envmap_and_three normalmap_glass light_sunsky light_sunsky_and_lamps shape_sphere
       shape_cube shape_cylinder shape_flip_normals""".split()},
    **{name: DEEP for name in SCENES if name.startswith(("mask", "null"))},
    **{name: MEDIUM for name in SCENES if name.startswith("medium")},
    **{name: MIS for name in SCENES if name.startswith("medium_grid")},
    **{name: MIS for name in """medium_clear_red medium_coloured medium_absorbing medium_in_glass
       medium_in_rough_glass""".split()},
    "medium_deep": {**MEDIUM, "depth": 40},
    "medium_grid_shell": {**MIS, "depth": 20},
    "dielectric": {"depth": 6, **NOISY}, "roughdielectric_ggx": {"depth": 6, **NOISY},
    "light_in_glass": {"depth": 8},
    "light_two": {"samples": 1024}, "light_textured_and_plain": {"samples": 1024},
    "light_envmap_seen": sensor(view='<lookat origin="0,0,0" target="0.1,1,-0.4" up="0,0,1"/>',
                                fov=70.0),
    "room": {"depth": 8, "samples": 512, **sensor(
        view='<lookat origin="0,1,3.6" target="0,1,0" up="0,1,0"/>', fov=38.0)},
    "filter_tent": noisy_filter("tent", radius="[1.4]"),
    "filter_gaussian": noisy_filter("gaussian", stddev="[0.6]"),
    "filter_default": {**NOISY, **film(24, 24, tag("boolean", "sample_border", "true"),
                                       rfilter="")},
    "filter_mitchell": noisy_filter("mitchell", B=0.05, C="[0.9]"),
    "filter_catmullrom": noisy_filter("catmullrom"),
    "filter_lanczos": noisy_filter("lanczos", lobes=2),
    "sensor_fov_axis": {**film(24, 16), **sensor(fov="[50]", fov_axis="larger")},
    "sensor_thinlens": sensor("thinlens", VIEW, fov=36.0, aperture_radius="[0.3]",
                              focus_distance=3.9),
    "sensor_crop": film(40, 32, values({"crop_offset_x": 9, "crop_offset_y": 7, "crop_width": 20,
                                        "crop_height": 18})),
    "sensor_near_far": sensor(fov=36.0, near_clip="[4.3]", far_clip=5.6),
    "sensor_orthographic": {**film(24, 16), **sensor(
        "orthographic", scale("[1.6]", 2.1, 1.3) + VIEW, near_clip=3.1, far_clip=6.0)},
    "sensor_principal_point": {**film(24, 16), **sensor(
        fov=36.0, principal_point_offset_x="[0.2]", principal_point_offset_y=-0.15)},
    "sensor_hide_emitters": {"integrator": values({"hide_emitters": True}), **NOISY},
    "sensor_focal_length": sensor("perspective", VIEW, tag("string", "focal_length", "60mm")),
    "scale_1000": sensor(
        view='<lookat origin="300,2300,4600" target="0,600,0" up="0,1,0"/>', fov=36.0),
}
