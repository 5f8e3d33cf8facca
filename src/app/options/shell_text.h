// Arguments as one line of text.
#pragma once

#include <string>
#include <vector>

namespace pt {

/// What a POSIX shell splits into the same arguments: those with other characters than letters,
/// digits and some signs are in single quotes.
std::string shell_text(const std::vector<std::string>& arguments);

}  // namespace pt
