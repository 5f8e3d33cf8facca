// Numbers in text.
#pragma once

#include <string_view>

namespace pt {

inline bool is_text_space(char c) { return c == ' ' || ('\t' <= c && c <= '\r'); }

/// Takes the next word, without the white space around it, off the front of `text`; empty at the
/// end.
std::string_view next_word(std::string_view& text);

/// All of `word` as a number; nan and inf are numbers, what is too large for a double is inf.
/// Throws Error.
double parse_number(std::string_view word);

}  // namespace pt
