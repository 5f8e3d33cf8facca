#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "common/scene/load/gltf/read_model.h"

namespace pt::gltf {
namespace {

using Json = nlohmann::json;

/// What a value may be; alternatives are added.
enum Form : unsigned {
  integer = 1,  ///< not negative
  number = 2,
  string = 4,
  boolean = 8,
  object = 16,
  integers = 32,
  numbers = 64,
  objects = 128,
  named_integers = 256
};

const std::map<std::string, unsigned, std::less<>> forms = {
    // numbers of objects, sizes in bytes, codes
    {"buffer", integer},
    {"bufferView", integer},
    {"byteLength", integer},
    {"byteOffset", integer},
    {"byteStride", integer},
    {"camera", integer},
    {"componentType", integer},
    {"count", integer},
    {"index", integer},
    {"indices", integer | object},
    {"input", integer},
    {"inverseBindMatrices", integer},
    {"light", integer},
    {"magFilter", integer},
    {"material", integer},
    {"mesh", integer},
    {"minFilter", integer},
    {"mode", integer},
    {"node", integer},
    {"output", integer},
    {"sampler", integer},
    {"scene", integer},
    {"skin", integer},
    {"source", integer},
    {"texCoord", integer},
    {"wrapS", integer},
    {"wrapT", integer},
    {"children", integers},
    {"joints", integers},
    {"attributes", named_integers},
    // quantities
    {"alphaCutoff", number},
    {"aspectRatio", number},
    {"attenuationDistance", number},
    {"clearcoatFactor", number},
    {"clearcoatRoughnessFactor", number},
    {"emissiveStrength", number},
    {"glossinessFactor", number},
    {"innerConeAngle", number},
    {"intensity", number},
    {"ior", number},
    {"metallicFactor", number},
    {"outerConeAngle", number},
    {"range", number},
    {"roughnessFactor", number},
    {"sheenRoughnessFactor", number},
    {"thicknessFactor", number},
    {"transmissionFactor", number},
    {"xmag", number},
    {"yfov", number},
    {"ymag", number},
    {"zfar", number},
    {"znear", number},
    {"rotation", number | numbers},
    {"scale", number | numbers},
    {"specularFactor", number | numbers},
    {"attenuationColor", numbers},
    {"baseColorFactor", numbers},
    {"color", numbers},
    {"diffuseFactor", numbers},
    {"emissiveFactor", numbers},
    {"matrix", numbers},
    {"offset", numbers},
    {"sheenColorFactor", numbers},
    {"specularColorFactor", numbers},
    {"translation", numbers},
    {"weights", numbers},
    // words
    {"alphaMode", string},
    {"interpolation", string},
    {"path", string},
    {"doubleSided", boolean},
    {"mimeType", string},
    {"name", string},
    {"normalized", boolean},
    {"type", string},
    {"uri", string},
    {"version", string},
    // objects
    {"asset", object},
    {"baseColorTexture", object},
    {"clearcoatNormalTexture", object},
    {"clearcoatRoughnessTexture", object},
    {"clearcoatTexture", object},
    {"diffuseTexture", object},
    {"emissiveTexture", object},
    {"extensions", object},
    {"metallicRoughnessTexture", object},
    {"normalTexture", object},
    {"occlusionTexture", object},
    {"orthographic", object},
    {"pbrMetallicRoughness", object},
    {"perspective", object},
    {"sheenColorTexture", object},
    {"sheenRoughnessTexture", object},
    {"sparse", object},
    {"specularColorTexture", object},
    {"specularGlossinessTexture", object},
    {"specularTexture", object},
    {"spot", object},
    {"thicknessTexture", object},
    {"transmissionTexture", object},
    {"values", object},
    {"accessors", objects},
    {"animations", objects},
    {"bufferViews", objects},
    {"buffers", objects},
    {"cameras", objects},
    {"channels", objects},
    {"images", objects},
    {"lights", objects},
    {"materials", objects},
    {"meshes", objects},
    {"nodes", objects | integers},
    {"primitives", objects},
    {"samplers", objects},
    {"scenes", objects},
    {"skins", objects},
    {"targets", objects},
    {"textures", objects},
};

bool is_index(const Json& value) {
  return value.is_number_unsigned() &&
         value.get<std::uint64_t>() <= std::numeric_limits<std::int32_t>::max();
}

template <class Predicate>
bool all(const Json& values, Predicate predicate) {
  return std::all_of(values.begin(), values.end(), predicate);
}

bool has_form(const Json& value, unsigned form) {
  const auto is_number = [](const Json& x) { return x.is_number(); };
  const auto is_object = [](const Json& x) { return x.is_object(); };
  if (value.is_array()) {
    return ((form & integers) && all(value, is_index)) ||
           ((form & numbers) && all(value, is_number)) ||
           ((form & objects) && all(value, is_object));
  }
  if (value.is_object()) {
    return (form & object) || ((form & named_integers) && all(value, is_index));
  }
  return ((form & integer) && is_index(value)) || ((form & number) && value.is_number()) ||
         ((form & string) && value.is_string()) || ((form & boolean) && value.is_boolean());
}

std::string describe(unsigned form) {
  static const std::pair<Form, const char*> names[] = {
      {integer, "an integer from 0 to 2147483647"},
      {number, "a number"},
      {string, "a string"},
      {boolean, "true or false"},
      {object, "an object"},
      {integers, "an array of integers from 0 to 2147483647"},
      {numbers, "an array of numbers"},
      {objects, "an array of objects"},
      {named_integers, "an object whose members are integers from 0 to 2147483647"}};
  std::string text;
  for (const auto& [bit, name] : names) {
    if (form & bit) text += (text.empty() ? "" : " or ") + std::string(name);
  }
  return text;
}

}  // namespace

std::string expected_form(const std::string& key, const Json& value) {
  const auto form = forms.find(key);
  return form == forms.end() || has_form(value, form->second) ? "" : describe(form->second);
}

bool may_be_lost(const std::string& key) {
  const auto form = forms.find(key);
  if (key == "normalized") return false;
  return key == "alphaMode" || key == "mimeType" || key == "name" || key == "interpolation" ||
         key == "path" ||
         (form != forms.end() && (form->second & ~unsigned{number | numbers | boolean}) == 0);
}

}  // namespace pt::gltf
