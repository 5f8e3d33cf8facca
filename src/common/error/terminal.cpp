#include "common/error/terminal.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <utility>

namespace pt {
namespace {

constexpr std::size_t most_of_message = 4000;

std::atomic<int> print_errno{0};

constexpr std::pair<char32_t, char32_t> unwanted[] = {
    {0x00, 0x1f},     {0x7f, 0x9f},                                           // control characters
    {0x061c, 0x061c}, {0x200e, 0x200f}, {0x202a, 0x202e},  {0x2066, 0x2069},  // direction
    {0x2028, 0x2029},                                                         // ends of lines
    {0x00ad, 0x00ad}, {0x200b, 0x200b}, {0x2060, 0x2065},  {0x206a, 0x206f},
    {0xfeff, 0xfeff}, {0xfff9, 0xfffb}, {0xe0000, 0xe0fff}};  // invisible

bool is_wanted(char32_t c) {
  return std::ranges::none_of(
      unwanted, [&](const auto& range) { return range.first <= c && c <= range.second; });
}

/// The character that `text` begins with, and its bytes; 0 bytes: it is no UTF-8 (RFC 3629).
struct Character {
  char32_t code = 0;
  std::size_t bytes = 0;
};

Character first_of(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || bytes > text.size()) return {};
  char32_t code = lead & (0xffu >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3fu);
  }
  constexpr char32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xd800 && code <= 0xdfff;
  if (code < least[bytes] || is_surrogate || code > 0x10ffff) return {};
  return {code, bytes};
}

bool is_within_character(std::string_view text, std::size_t at) {
  return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80;
}

}  // namespace

std::string terminal_text(std::string_view text, bool keeps_lines) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const Character c = first_of(text);
    const bool is_kept = keeps_lines && (c.code == '\n' || c.code == '\t');
    if (c.bytes > 0 && (is_kept || is_wanted(c.code)))
      result += text.substr(0, c.bytes);
    else
      result += '?';
    text.remove_prefix(std::max(c.bytes, std::size_t{1}));
  }
  return result;
}

std::string begin_and_end(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  std::size_t head = most - most / 3, tail = text.size() - most / 3;
  for (int i = 0; i < 3 && is_within_character(text, head); ++i) --head;
  for (int i = 0; i < 3 && is_within_character(text, tail); ++i) ++tail;
  return fmt::format("{} [...] {} ({} bytes in all)", text.substr(0, head), text.substr(tail),
                     text.size());
}

std::string message_line(std::string_view message) {
  return terminal_text(begin_and_end(message, most_of_message));
}

void print_text(std::string_view text) {
  const std::string shown = terminal_text(text, true);
  errno = 0;
  if (std::fwrite(shown.data(), 1, shown.size(), stdout) == shown.size()) return;
  int none = 0;
  print_errno.compare_exchange_strong(none, errno != 0 ? errno : EIO);
}

int flush_printed() {
  errno = 0;
  const bool is_written = std::fflush(stdout) == 0 && !std::ferror(stdout);
  int none = 0;
  if (!is_written) print_errno.compare_exchange_strong(none, errno != 0 ? errno : EIO);
  return print_errno;
}

void print_notice(std::string_view message) {
  const std::string line = "ptexp: " + message_line(message) + '\n';
  [[maybe_unused]] const auto written = std::fwrite(line.data(), 1, line.size(), stderr);
}

void print_warning(const std::string& message) { print_notice("warning: " + message); }

void print_error(const std::string& message) { print_notice("error: " + message); }

}  // namespace pt
