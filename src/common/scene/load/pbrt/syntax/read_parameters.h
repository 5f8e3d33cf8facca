// Reading the parameters of a directive.
#pragma once

#include "common/scene/load/pbrt/syntax/parameters.h"
#include "common/scene/load/pbrt/syntax/token_stream.h"

namespace pt::pbrt {

/// As many as follow; colours are those of `space`. Throws Error for bad syntax. Of two of the
/// same name the last holds, which is reported.
std::vector<Parameter> read_parameters(TokenStream& tokens, ColorSpace space, Reporter& reporter);

}  // namespace pt::pbrt
