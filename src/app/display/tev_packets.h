// Packets of the protocol by which the viewer tev is told what to show over TCP: a length of 32
// bits that counts itself, an operation of 8 bits, its operands; all little-endian. Described by
// the README of tev, https://github.com/Tom94/tev.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/image/image.h"
#include "common/options/options.h"

namespace pt::tev {

/// A black image of these channels: R, G, B. Replaces one of the same name. Its window gets the
/// focus, once.
std::string create_image(const std::string& name, int width, int height);

/// The pixels of `part` of the image, which lies at `image.place` in the one that was created.
std::string update_image(const std::string& name, const Image& image, const CropWindow& part);

/// Rectangles, in the image's own pixels, outside of which no bit differs: square tiles, joined to
/// those beside them. Of images of one size; all of them where `before` is empty.
std::vector<CropWindow> changed_parts(const Image& before, const Image& after, int tile = 64);

}  // namespace pt::tev
