// A look at an OpenEXR header before OpenEXR reads it, which allocates what the file announces.
#pragma once

#include <string_view>

namespace pt {

/// Throws Error unless `bytes` begin with the header of a flat, single-part OpenEXR file whose
/// attributes have the sizes of their types and lie within the file
/// (https://openexr.com/en/latest/OpenEXRFileLayout.html).
void check_exr_header(std::string_view bytes);

}  // namespace pt
