// Transformations as pbrt's directives give them.
#pragma once

#include <optional>

#include "common/math/transform.h"
#include "common/scene/load/pbrt/syntax/token_stream.h"

namespace pt::pbrt {

// Each reads what follows its directive. None: the numbers are no map.
Affine read_translate(TokenStream& tokens);
Affine read_scale(TokenStream& tokens);
std::optional<Affine> read_rotate(TokenStream& tokens);
/// From the world to a camera that looks along +z, with +x to its right and +y up: pbrt's space is
/// left-handed.
std::optional<Affine> read_look_at(TokenStream& tokens);
/// 16 numbers, column by column, of which the last row is 0 0 0 1.
std::optional<Affine> read_matrix(TokenStream& tokens);

/// Whether it has an inverse.
bool is_invertible(const Affine& map);

}  // namespace pt::pbrt
