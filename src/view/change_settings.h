// What a page can change: what is rendered, a camera that moves around the point that it looks at,
// and how the image is shown.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/image/image.h"
#include "common/options/option_names.h"
#include "common/scene/data/camera.h"

namespace pt {

/// The position of a camera relative to its first one.
struct Orbit {
  double yaw = 0;    ///< degrees about the camera's up vector; positive: to its right
  double pitch = 0;  ///< degrees towards the up vector
  double zoom = 1;   ///< factor of the distance from the point looked at, > 0

  bool operator==(const Orbit&) const = default;
};

/// Limits of a camera's pitch, in degrees. They keep it a degree away from the poles, the
/// directions of its up vector, or at its first distance if that is less.
struct PitchRange {
  double least = 0, most = 0;
};
PitchRange pitch_range(const CameraParameters& camera);

/// The moved camera, with its pitch clamped. It keeps its up vector. A lens' plane in focus moves
/// with the distance; an orthographic camera sees less the nearer it is. Without a movement no bit
/// changes. `camera` is valid (check_camera).
CameraParameters orbit_camera(const CameraParameters& camera, const Orbit& orbit);

struct ImageSize {
  int width = 0, height = 0;  ///< pixels, 1..image_side_max

  bool operator==(const ImageSize&) const = default;
};
inline constexpr int image_side_max = 8192;
inline constexpr double scale_min = 1.0 / 16, scale_max = 4;

/// The size times `scale`, at least 1 and at most image_side_max.
ImageSize scaled(const ImageSize& size, double scale);

/// The camera as options of ptexp. An orthographic one's size has none.
std::string camera_options(const CameraParameters& camera);
/// The camera as a <sensor> of a Mitsuba 3 scene, with a film of this size.
std::string camera_xml(const CameraParameters& camera, const ImageSize& size);

/// From radiance to what a display shows: sRGB clamps to [0, 1].
enum class ToneCurve { srgb, neutral, agx, aces };
template <>
inline constexpr auto enum_names<ToneCurve> =
    std::to_array<EnumName<ToneCurve>>({{ToneCurve::srgb, "srgb"},
                                        {ToneCurve::neutral, "neutral"},
                                        {ToneCurve::agx, "agx"},
                                        {ToneCurve::aces, "aces"}});

/// The layer that is the image itself; the others are AOVs.
inline constexpr const char* color_layer = "color";
/// That layer's name and those of all AOVs.
std::vector<std::string> layer_names();
/// The AOV's bit, or 0 for the image; nothing for a name of no layer.
std::optional<std::uint32_t> layer_bit(std::string_view name);

struct Display {
  std::string layer = color_layer;
  float exposure = 0;  ///< stops; of the image alone, as is the curve
  ToneCurve curve = ToneCurve::srgb;

  bool operator==(const Display&) const = default;
};

/// Linear values that the sRGB curve encodes for a display (tone_mapping.h).
struct Picture {
  Image image;
  float exposure = 0;  ///< stops that are still to be applied
  /// Where colours stand for numbers: what the first and the last of them stand for.
  std::optional<std::array<float, 2>> range;
};

/// What the page shows of an image. A number becomes a colour of a scale from the least value to
/// the one that a hundredth exceeds; `rays` are those of a sample, `variance` the standard error of
/// a pixel's luminance; indices get colours by chance. Nothing if the image lacks the layer.
std::optional<Picture> make_picture(const Image& image, const Display& display, int samples);

/// By the names of scene parameters.
using ParameterValues = std::map<std::string, std::vector<float>>;

struct SettingsChange {
  std::optional<Orbit> orbit;
  std::optional<std::vector<Mode>> modes;
  std::optional<ImageSize> size;
  std::optional<double> scale;
  std::optional<int> spp;
  std::optional<bool> is_paused;
  std::optional<std::string> layer;
  std::optional<float> exposure;  ///< stops
  std::optional<ToneCurve> curve;
  std::optional<std::optional<float>> time;  ///< seconds, that of what moves; none: all of them
  ParameterValues parameters;
  bool resets_parameters = false;  ///< before those are set
};

/// Reads JSON such as {"orbit": {"yaw": 10, "pitch": -5, "zoom": 1.5}, "mode": "split", "exposure":
/// 1, "size": [640, 480], "parameters": {"materials.red.albedo": [1, 0, 0]}}; each key is optional,
/// and "parameters": null resets all. Throws Error that names the key and what was expected.
SettingsChange read_change(std::string_view json);

/// The mode's name, or "split" for several.
std::string mode_name(const std::vector<Mode>& modes);

}  // namespace pt
