// The parameters of each BSDF by name, read off its own Index and make() (material/bsdf.h).
#pragma once

#include <span>
#include <string>

#include "common/material/material.h"

namespace pt {

struct BsdfParameter {
  std::string name;
  bool is_color = false;  ///< else a number
};

/// By their indices.
std::span<const BsdfParameter> bsdf_parameters(MaterialKind kind);

}  // namespace pt
