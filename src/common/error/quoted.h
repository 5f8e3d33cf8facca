// Text of a file or of a user within a message.
#pragma once

#include <string>
#include <string_view>

namespace pt {

/// `text` as a part of one short line: at most `most_bytes` of it, cut between two characters of
/// UTF-8 and then followed by "...". Control characters, which a terminal could obey, become '?'.
inline std::string clipped(std::string_view text, std::size_t most_bytes = 80) {
  const auto is_continuation = [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0u) == 0x80u;
  };
  std::size_t size = text.size();
  if (size > most_bytes) {
    size = most_bytes;
    for (int i = 0; i < 3 && size > 0 && is_continuation(text[size]); ++i) --size;
  }
  std::string result(text.substr(0, size));
  for (std::size_t i = 0; i < result.size(); ++i) {
    const auto c = static_cast<unsigned char>(result[i]);
    const bool is_c1 = c == 0xc2u && i + 1 < result.size() &&  // U+0080 to U+009f, as UTF-8
                       static_cast<unsigned char>(result[i + 1]) < 0xa0u;
    if (c < 0x20u || c == 0x7fu || is_c1) result[i] = '?';
    if (is_c1) result.erase(i + 1, 1);
  }
  return size < text.size() ? result + "..." : result;
}

/// The same between single quotes. (std::quoted would be found by its arguments.)
inline std::string in_quotes(std::string_view text, std::size_t most_bytes = 80) {
  return "'" + clipped(text, most_bytes) + "'";
}

}  // namespace pt
