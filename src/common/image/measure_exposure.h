// A picture's exposure from the picture.
#pragma once

#include "common/image/image.h"

namespace pt {

/// Stops by which an image must be multiplied so that the log-average of its luminance becomes
/// 0.18, a middle grey (Reinhard et al. 2002, 'Photographic Tone Reproduction for Digital Images',
/// equation 1). Of the pixels that are not black, the brightest hundredth (emitters, fireflies) and
/// those a thousand times darker than the rest's brightest (nothing there, deep shadow) do not
/// count. 0 for an image that is black or not finite; within -100 and 100.
float measure_exposure(const Image& image);

}  // namespace pt
