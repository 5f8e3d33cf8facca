// How a CUDA device traces an array of rays.
#pragma once

namespace pt {

enum class TraceVariant {
  automatic,   ///< beam for rays that are coherent and no instances, else persistent;
               ///< threads for other trees
  threads,     ///< a thread for every ray
  persistent,  ///< warps that take new rays when lanes are idle
  beam,        ///< 32 coherent rays together; incoherent ones singly
};

}  // namespace pt
