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

/// "FILE:LINE:COLUMN: message" in one line, with short names.
std::string message_at(const Place& place, std::string_view message);

/// The same message with what stands in quotes, which may be as long as a file, cut to 80 bytes,
/// and all of it to 800.
std::string with_short_names(std::string_view message);

/// Control characters become spaces.
std::string one_line(std::string text);

/// Throws Error with the place.
[[noreturn]] void fail(const Place& place, std::string_view message);

}  // namespace pt::pbrt
