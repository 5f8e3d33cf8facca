// Between linear radiance and the integer samples of PNG and PPM files; a picture's own exposure.
#pragma once

#include <string>
#include <string_view>

#include "common/image/image.h"

namespace pt {

/// How linear radiance becomes 8 bits: multiplied by 2^exposure, clamped to [0, 1], then encoded
/// with the sRGB curve (PNG) or gamma 2 (PPM, as in the paper). NaN becomes 0.
struct ToneMapping {
  float exposure = 0.0f;  ///< stops
};

/// A transfer curve and its inverse on [0, 1].
struct TransferCurve {
  float (*encode)(float linear);
  float (*decode)(float encoded);
};

/// IEC 61966-2-1.
extern const TransferCurve srgb_curve;
/// Square root and square: gamma 2, as in the paper.
extern const TransferCurve gamma2_curve;

/// Three bytes per pixel, rounded to nearest. NaN and negative values become 0.
std::string quantize(const Image& image, const ToneMapping& tone_mapping,
                     const TransferCurve& curve);

/// Bytes of one sample: big-endian when there are two.
inline int sample_bytes(int max_value) { return max_value > 255 ? 2 : 1; }

/// Fills image.rgb from as many samples in [0, max_value]; `max_value` in 1..65535.
/// Throws Error for a larger sample.
void dequantize(std::string_view samples, int max_value, const TransferCurve& curve, Image& image);

/// Stops by which an image must be multiplied so that the log-average of its luminance becomes
/// 0.18, a middle grey (Reinhard et al. 2002, 'Photographic Tone Reproduction for Digital Images',
/// equation 1). Of the pixels that are not black, the brightest hundredth (emitters, fireflies) and
/// those a thousand times darker than the rest's brightest (nothing there, deep shadow) do not
/// count. 0 for an image that is black or not finite; within -100 and 100.
float measure_exposure(const Image& image);

}  // namespace pt
