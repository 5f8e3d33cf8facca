// Words and numbers in text.
#pragma once

#include <string>
#include <string_view>

namespace pt {

inline bool is_text_space(char c) { return c == ' ' || ('\t' <= c && c <= '\r'); }

/// `text` without the UTF-8 byte order mark that editors on Windows put before the first line.
inline std::string_view without_byte_order_mark(std::string_view text) {
  return text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text;
}

/// Without the white space around it.
std::string_view trim(std::string_view text);

/// With ASCII letters in lower case.
std::string lower_case(std::string_view text);

/// Takes the next word, without the white space around it, off the front of `text`; empty at the
/// end.
std::string_view next_word(std::string_view& text);

/// All of `word` as a number; nan and inf are numbers, what is too large for a double is inf.
/// Throws Error.
double parse_number(std::string_view word);

}  // namespace pt
