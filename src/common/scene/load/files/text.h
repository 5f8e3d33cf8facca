// Words and numbers in text, and warnings of a kind as one.
#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

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

// Warnings of a kind as one: files repeat their faults, sometimes a hundred thousand times.

class CountedWarnings {
 public:
  /// `message` names the place. Of each kind the first message is kept, how many followed, and of
  /// these the first few names of what they are about. Kinds are few: their texts are ours.
  void add(std::string_view kind, std::string_view message, std::string_view name = {});

  /// A line for each kind, in the order in which they came first.
  std::vector<std::string> lines() const;

 private:
  struct Kind {
    std::string message;
    std::size_t more = 0;
    std::vector<std::string> names;  ///< the first one is in the message
  };

  std::unordered_map<std::string, std::size_t> index_of_;
  std::vector<Kind> kinds_;
};

}  // namespace pt
