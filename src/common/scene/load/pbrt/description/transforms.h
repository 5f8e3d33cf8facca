// Transformations as pbrt's directives give them.
#pragma once

#include "common/math/transform.h"
#include "common/scene/load/pbrt/syntax/token_stream.h"

namespace pt::pbrt {

// Each reads what follows its directive. They throw Error for a map that is none.
Affine read_translate(TokenStream& tokens);
Affine read_scale(TokenStream& tokens);
Affine read_rotate(TokenStream& tokens, const Place& place);
/// From the world to a camera that looks along +z, with +x to its right and +y up: pbrt's space is
/// left-handed.
Affine read_look_at(TokenStream& tokens, const Place& place);
/// 16 numbers, column by column.
Affine read_matrix(TokenStream& tokens, const Place& place);

/// Whether it has an inverse.
bool is_invertible(const Affine& map);

}  // namespace pt::pbrt
