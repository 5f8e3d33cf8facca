// Where in a file something stands, for messages.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace pt::pbrt {

struct Place {
  std::shared_ptr<const std::string> file;
  int line = 0, column = 0;  ///< from 1

  /// FILE:LINE:COLUMN
  std::string text() const;
};

/// "FILE:LINE:COLUMN: message" in one line: names in files may contain control characters, which
/// become spaces.
std::string message_at(const Place& place, std::string_view message);

/// Throws Error with the place.
[[noreturn]] void fail(const Place& place, std::string_view message);

}  // namespace pt::pbrt
