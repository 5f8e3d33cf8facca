// `ptexp --compare A B`: how far two image files are apart.
#pragma once

#include <string>

namespace pt {

/// Prints the differences of image file `a` from the reference `b`. Returns the exit code: 0, or 1
/// when the largest absolute difference exceeds `tolerance`. FLIP is the one of 8-bit images where
/// both are that, else that of radiance (flip.h). Writes the difference to a file where one is
/// named (compare.h). Throws Error.
int compare_command(const std::string& a, const std::string& b, double tolerance,
                    const std::string& difference_file = "");

}  // namespace pt
