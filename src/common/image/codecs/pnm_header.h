// The header that PPM, PGM and PFM share: words apart by white space and comments.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "common/error/error.h"

namespace pt {

class PnmHeader {
 public:
  /// `bytes` begin with the two letters of the format.
  explicit PnmHeader(std::string_view bytes) : rest_(bytes.substr(2)) {}

  /// The next number, which white space or a comment must precede.
  int number(const char* name) {
    const std::size_t before = rest_.size();
    skip_space();
    int value = 0, digits = 0;
    for (; !rest_.empty() && '0' <= rest_[0] && rest_[0] <= '9'; rest_.remove_prefix(1), ++digits) {
      value = std::min(10 * value + (rest_[0] - '0'), 1'000'000);  // large enough to be refused
    }
    if (rest_.empty()) throw Error(fmt::format("truncated in the header, at the {}", name));
    if (digits == 0 || before == rest_.size() + static_cast<std::size_t>(digits)) {
      throw Error(fmt::format("corrupted header: expected a number, the {}", name));
    }
    if (value < 1 || value > 65535) {
      throw Error(fmt::format("{} out of range, expected 1 to 65535", name));
    }
    return value;
  }

  /// The next word, whatever it is.
  std::string_view word() {
    skip_space();
    const auto end = std::ranges::find_if(rest_, is_space);
    const std::string_view taken = rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
    rest_.remove_prefix(taken.size());
    return taken;
  }

  /// What follows the single white space that ends the header. Throws Error unless there are
  /// `size` bytes or more.
  std::string_view samples(const char* last, int width, int height, std::size_t size) {
    if (rest_.empty()) throw Error("truncated: the header does not end");
    if (!is_space(rest_[0])) {
      throw Error(fmt::format("corrupted header: expected white space after {}", last));
    }
    const std::string_view bytes = rest_.substr(1);
    if (bytes.size() < size) {
      throw Error(fmt::format("truncated: {}x{} pixels need {} bytes, found {}", width, height,
                              size, bytes.size()));
    }
    return bytes;
  }

 private:
  static bool is_space(char c) { return c == ' ' || ('\t' <= c && c <= '\r'); }

  void skip_space() {
    while (!rest_.empty() && (is_space(rest_[0]) || rest_[0] == '#')) {
      const bool comment = rest_[0] == '#';
      rest_.remove_prefix(comment ? std::min(rest_.find_first_of("\r\n"), rest_.size()) : 1);
    }
  }

  std::string_view rest_;
};

}  // namespace pt
