// `ptexp --compare A B`: how far two image files are apart.
#pragma once

#include <string>

namespace pt {

/// Prints the differences of image file `a` from the reference `b`. Returns the exit code: 0, or 1
/// when the largest absolute difference exceeds `tolerance`. Throws Error.
int compare_command(const std::string& a, const std::string& b, double tolerance);

}  // namespace pt
