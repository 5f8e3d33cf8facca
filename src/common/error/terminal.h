// What the program says to whoever looks on. All of it goes through here: files, peers and the
// command line put names into messages, and no name may move a cursor, turn a text around or fill
// a screen. A stream that takes nothing (a full disk, a reader that has gone) ends no render.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

namespace pt {

/// UTF-8 that a terminal shows as it is: a ? stands for each control character, each character
/// that is invisible or changes the direction of a text, and each byte that is no UTF-8. Lines and
/// tabs stay where `keeps_lines`.
std::string terminal_text(std::string_view text, bool keeps_lines = false);

/// The begin and the end of a text of more than `most` bytes, and between them its size.
std::string begin_and_end(std::string_view text, std::size_t most);

/// A message of any length and content as one line of a terminal or a log.
std::string message_line(std::string_view message);

/// Prints on the standard output. Never throws: flush_printed() tells whether it was written.
void print_text(std::string_view text);

template <class... Values>
void print(fmt::format_string<Values...> form, Values&&... values) {
  print_text(fmt::format(form, std::forward<Values>(values)...));
}

/// Writes what was printed. Returns 0, or errno of the first write that failed.
int flush_printed();

/// Prints "ptexp: MESSAGE" on the standard error stream: one line, written at once, or lost.
void print_notice(std::string_view message);
void print_warning(const std::string& message);
void print_error(const std::string& message);

}  // namespace pt
