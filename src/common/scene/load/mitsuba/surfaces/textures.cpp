#include "common/scene/load/mitsuba/surfaces/textures.h"

#include <fmt/format.h>

#include "common/scene/load/mitsuba/xml/elements.h"

namespace pt::mitsuba {
namespace {

/// A map of (u, v): two rows of a, b, offset.
struct UvMap {
  double u[3] = {1, 0, 0};
  double v[3] = {0, 1, 0};
};

/// From to_uv in Mitsuba 3 (z is ignored), from uscale, voffset, ... in 0.x.
UvMap read_uv_map(const Object& texture) {
  UvMap map;
  if (const Element* to_uv = texture.find("to_uv")) {
    const Affine m = read_transform(*to_uv);
    return {{m.row[0].x, m.row[0].y, m.row[0].w}, {m.row[1].x, m.row[1].y, m.row[1].w}};
  }
  const double both = texture.number("uvscale").value_or(1.0);
  map.u[0] = texture.number("uscale").value_or(both);
  map.v[1] = texture.number("vscale").value_or(both);
  map.u[2] = texture.number("uoffset").value_or(0.0);
  map.v[2] = texture.number("voffset").value_or(0.0);
  return map;
}

// Mitsuba counts v from the image's head, we count it from its foot: v = 1 - v' on both sides for
// an image. A checkerboard has no head, so its squares stay in Mitsuba's coordinates.
void set_uv_map(Texture& texture, const UvMap& map) {
  const auto row = [&](const double(&from)[3], float(&to)[3]) {
    to[0] = static_cast<float>(from[0]);
    to[1] = static_cast<float>(-from[1]);
    to[2] = static_cast<float>(from[1] + from[2]);
  };
  row(map.u, texture.u_row);
  row(map.v, texture.v_row);
  if (texture.kind == TextureKind::image) {
    for (float& value : texture.v_row) value = -value;
    texture.v_row[2] += 1.0f;
  }
}

TextureWrap wrap_of(Context& context, const Object& texture, const std::string& mode) {
  if (mode == "repeat") return TextureWrap::repeat;
  if (mode == "mirror") return TextureWrap::mirror;
  if (mode != "clamp") {
    context.warn_once("wrap " + mode, texture.element(),
                      "wrap mode '{}' is not supported: clamp is used", mode);
  }
  return TextureWrap::clamp;
}

void read_filter(Context& context, const Object& object, Texture& texture) {
  const std::string filter = object.text("filter_type", context.modern ? "bilinear" : "ewa");
  if (filter == "nearest") texture.filter = TextureFilter::nearest;
  // 0.x's `trilinear` and `ewa` are bilinear but for what they do about aliasing, which samples do.
  if (filter != "nearest" && filter != "bilinear" && filter != "trilinear" && filter != "ewa") {
    context.warn_once("filter " + filter, object.element(),
                      "texture filter '{}' is not supported: bilinear is used", filter);
  }
}

float gamma_of(const Object& bitmap) {
  return bitmap.number("gamma", -1.0f);  // 0.x: -1 is what the file says, sRGB
}

void check_gamma(Context& context, const Object& object) {
  const float gamma = gamma_of(object);
  if (gamma != -1.0f && gamma != 1.0f && gamma != 2.2f) {
    context.warn_once("gamma", object.element(),
                      "gamma {} of a bitmap is not supported: sRGB is used", gamma);
  }
}

/// Mitsuba's, of which a picture makes a number.
constexpr Color luminance_weights(0.212671f, 0.715160f, 0.072169f);

/// What Mitsuba takes for a number where a texture is a single colour.
Color mean_of(const Color& color) { return Color((color.x + color.y + color.z) / 3.0f); }

ColorTexture read_bitmap(Context& context, const Object& object, Quantity quantity,
                         const Color& stand_in) {
  Texture look;
  look.format = integers_of_bitmap(object);
  check_gamma(context, object);
  read_filter(context, object, look);
  const std::string wrap = object.text("wrap_mode", "repeat");
  look.wrap_u = wrap_of(context, object, object.text("wrap_mode_u", wrap));
  look.wrap_v = wrap_of(context, object, object.text("wrap_mode_v", wrap));
  set_uv_map(look, read_uv_map(object));
  object.ignore({"cache", "max_anisotropy", "accel", "format"});
  std::optional<Color> weights;
  if (quantity == Quantity::number) weights = luminance_weights;
  if (const TextureImage* data = context.memory_image(object)) {
    return {Color(1.0f),
            context.textures.add_decoded(*data, object.text("data", ""), look, weights)};
  }
  const Element* filename = object.find("filename");
  if (!filename) fail(object.element(), "texture 'bitmap' has no filename");
  const auto path = context.resolve(*filename, filename->required("value"));
  const std::uint32_t texture =
      context.textures.add_file_if_readable(path, look, weights, [&](const std::string& why) {
        context.warn_unreadable(*filename, why, "what is without it is used");
      });
  return {texture == no_texture ? stand_in : Color(1.0f), texture};
}

/// What one kind of a checkerboard's squares shows.
ColorTexture read_square(Context& context, const Object& object, const char* name, float fallback,
                         Quantity quantity) {
  const bool is_number = quantity == Quantity::number;
  ColorTexture square = read_color_texture(context, object, name, Color(fallback),
                                           is_number ? quantity : Quantity::reflectance);
  if (is_number) square.color = mean_of(square.color);
  if (square.texture == no_texture || !context.colors.is_ours(square.texture)) return square;
  // Their coordinates, which would be the checkerboard's as well, are not the mesh's.
  context.warn_once("checkerboard of colors", object.element(),
                    "a mesh_attribute in a checkerboard is not supported: white is used");
  return {square.color, no_texture};
}

std::uint32_t add_checkerboard(Context& context, const Object& object, Quantity quantity) {
  ColorTexture first = read_square(context, object, "color0", 0.4f, quantity);
  ColorTexture second = read_square(context, object, "color1", 0.2f, quantity);
  if (quantity == Quantity::number) std::swap(first, second);  // as eval_1() of Mitsuba 3 has them
  Texture texture;
  texture.kind = TextureKind::checkerboard;
  texture.color0 = first.color, texture.color1 = second.color;
  texture.nested[0] = first.texture, texture.nested[1] = second.texture;
  set_uv_map(texture, read_uv_map(object));
  return context.textures.add_plain(texture);
}

/// Each once, although others may hold it 2^n times.
ColorTexture read_checkerboard(Context& context, const Object& object, Quantity quantity) {
  const std::pair key(&object, quantity == Quantity::number);
  auto found = context.checkerboards.find(key);
  if (found == context.checkerboards.end()) {
    const std::uint32_t texture = add_checkerboard(context, object, quantity);
    found = context.checkerboards.emplace(key, texture).first;
  }
  return {Color(1.0f), found->second};
}

ColorTexture read_scale(Context& context, const Object& object, Quantity quantity,
                        const Color& stand_in) {
  ColorTexture result;
  if (const Object* nested = object.child("texture")) {
    result = read_texture(context, *nested, quantity, stand_in);
  }
  if (const Element* value = object.find("value")) {
    result.color *= read_color(context, *value, Quantity::plain, stand_in);
  }
  const Color by = read_plain_color(context, object, "scale", Color(1.0f), Quantity::plain);
  result.color *= by;
  return result;
}

/// Reads colours; other attributes of meshes are not supported.
ColorTexture read_mesh_attribute(Context& context, const Object& object, Quantity quantity) {
  const std::string name = object.text("name", "");
  const Color scale(object.number("scale", 1.0f));
  const bool is_color = quantity == Quantity::reflectance || quantity == Quantity::emission;
  if (is_color && name == "vertex_color") return {scale, context.colors.by_vertex()};
  if (is_color && name == "face_color") return {scale, context.colors.by_face()};
  context.warn_once("mesh_attribute " + name, object.element(),
                    "mesh_attribute '{}' is not supported here, vertex_color and face_color are as "
                    "colours: white is used",
                    name);
  return {scale, no_texture};
}

/// Within a d65, which multiplies by white, what it multiplies: its scale is left out, as in the
/// RGB variants of Mitsuba 3.9.
const Object& without_d65(const Object& object) {
  const Object* inside = &object;
  while (inside->type() == "d65") {
    const Object* nested = inside->child("texture");
    if (!nested) nested = inside->child("spectrum");
    if (!nested) break;
    inside->ignore({"scale"});
    inside = nested;
  }
  return *inside;
}

}  // namespace

bool is_bitmap(const Object& texture) {
  const std::string type = texture.type();
  return type == "bitmap" || type == "ldrtexture" || type == "exrtexture";
}

TextureFormat integers_of_bitmap(const Object& bitmap) {
  const bool raw = bitmap.boolean("raw", false);
  return raw || gamma_of(bitmap) == 1.0f ? TextureFormat::linear8 : TextureFormat::srgb8;
}

ColorTexture read_texture(Context& context, const Object& outer, Quantity quantity,
                          const Color& stand_in) {
  const Object& object = without_d65(outer);
  if (is_spectrum(object)) {
    return {read_spectrum_object(context, object, quantity, stand_in), no_texture};
  }
  if (object.tag() != "texture") {
    fail(object.element(), "a <{}>; expected a <texture>", object.tag());
  }
  const std::string type = object.type();
  if (is_bitmap(object)) {
    return read_bitmap(context, object, quantity, stand_in);
  }
  if (type == "checkerboard") return read_checkerboard(context, object, quantity);
  if (type == "mesh_attribute") return read_mesh_attribute(context, object, quantity);
  if (type == "scale") return read_scale(context, object, quantity, stand_in);
  context.warn_once("texture " + type, object.element(),
                    "texture '{}' is not supported: {} is used", type, stand_in.x);
  return {stand_in, no_texture};
}

ColorTexture read_color_texture(Context& context, const Object& owner, std::string_view name,
                                const Color& fallback, Quantity quantity) {
  if (const Element* element = owner.find(name)) {
    return {read_color(context, *element, quantity, fallback), no_texture};
  }
  if (const Object* texture = owner.child_named(name)) {
    return read_texture(context, *texture, quantity, fallback);
  }
  return {fallback, no_texture};
}

std::string_view emission_name(const Object& emitter, std::string_view name) {
  const bool given = emitter.find(name) || emitter.child_named(name);
  const std::string_view old = "intensity";
  return !given && (emitter.find(old) || emitter.child_named(old)) ? old : name;
}

ColorTexture read_number_texture(Context& context, const Object& owner, std::string_view name,
                                 float fallback) {
  ColorTexture result = read_color_texture(context, owner, name, Color(fallback), Quantity::number);
  result.color = mean_of(result.color);
  return result;
}

Color read_plain_color(Context& context, const Object& owner, std::string_view name,
                       const Color& fallback, Quantity quantity) {
  if (const Element* element = owner.find(name)) {
    return read_color(context, *element, quantity, fallback);
  }
  const Object* outer = owner.child_named(name);
  if (!outer) return fallback;
  const Object& nested = without_d65(*outer);
  if (is_spectrum(nested)) return read_spectrum_object(context, nested, quantity, fallback);
  context.warn_once(fmt::format("textured {} {}", owner.type(), name), nested.element(),
                    "a texture as {} of {} '{}' is not supported: {} is used", name, owner.tag(),
                    owner.type(), fallback.x);
  return fallback;
}

float read_plain_number(Context& context, const Object& owner, std::string_view name,
                        float fallback) {
  const Color color = read_plain_color(context, owner, name, Color(fallback), Quantity::plain);
  return (color.x + color.y + color.z) / 3.0f;
}

}  // namespace pt::mitsuba
