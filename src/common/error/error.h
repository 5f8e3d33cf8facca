// The one exception type for bad input: its message is a single line for the user.
#pragma once

#include <stdexcept>
#include <string>

namespace pt {

/// Thrown for anything the user can mend (an option, a file, a size, too little memory).
/// The message names the file or key and what was expected; `main` prints it and exits with 2.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
};

}  // namespace pt
