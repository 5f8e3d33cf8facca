// Reading the parameters of a directive.
#pragma once

#include "common/scene/load/pbrt/syntax/parameters.h"
#include "common/scene/load/pbrt/syntax/token_stream.h"

namespace pt::pbrt {

/// As many as follow; colours are those of `space`. Throws Error for bad syntax. A second value of
/// the same name is reported and dropped.
std::vector<Parameter> read_parameters(TokenStream& tokens, ColorSpace space, Reporter& reporter);

}  // namespace pt::pbrt
