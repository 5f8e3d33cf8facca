// The one exception type for bad input, whose message is a single line for the user, and its text.
#pragma once

#include <algorithm>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

namespace pt {

/// Thrown for anything the user can mend (an option, a file, a size, too little memory).
/// The message names the file or key and what was expected; `main` prints it and exits with 2.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
};

/// Text of a file or of a user as a part of one short line: at most `most_bytes` of it, cut between
/// two characters of UTF-8 and then followed by "...". Control characters, which a terminal could
/// obey, become '?'.
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

/// clipped() between single quotes. (The name `quoted` would find std::quoted by its arguments.)
inline std::string in_quotes(std::string_view text, std::size_t most_bytes = 80) {
  return "'" + clipped(text, most_bytes) + "'";
}

/// Names the file in what a reader or a library says of its content: runs `action` and puts `what`
/// ("cannot read x.png") before the message of any failure, which becomes an Error of one line.
template <class Action>
auto explaining(const std::string& what, Action action) {
  std::string reason;
  try {
    return action();
  } catch (const std::bad_alloc&) {
    reason = "not enough memory";
  } catch (const std::exception& error) {
    reason = error.what();
  }
  // Libraries quote the file's content in their messages, whatever its length.
  std::replace_if(
      reason.begin(), reason.end(), [](unsigned char c) { return c < ' '; }, ' ');
  constexpr std::size_t most_bytes = 1000;
  throw Error(what + ": " + clipped(reason, most_bytes));
}

}  // namespace pt
