#include "common/scene/load/pbrt/syntax/place.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/error/error.h"

namespace pt::pbrt {

std::string Place::text() const { return fmt::format("{}:{}:{}", *file, line, column); }

namespace {

constexpr std::size_t longest_name = 80, longest_message = 800;  // bytes

/// Its beginning, cut between characters of UTF-8.
std::string clipped(std::string_view text, std::size_t longest) {
  if (text.size() <= longest) return std::string(text);
  const auto continues = [&](std::size_t i) {
    return (static_cast<unsigned char>(text[i]) & 0xc0) == 0x80;
  };
  std::size_t end = longest - 3;
  while (end > 0 && continues(end)) --end;
  return std::string(text.substr(0, end)) + "...";
}

}  // namespace

std::string with_short_names(std::string_view message) {
  std::string text;
  while (!message.empty()) {
    const std::size_t open = message.find('\'');
    const std::size_t close = open == message.npos ? open : message.find('\'', open + 1);
    if (close == message.npos) break;
    text += message.substr(0, open + 1);
    text += clipped(message.substr(open + 1, close - open - 1), longest_name) + '\'';
    message.remove_prefix(close + 1);
  }
  return clipped(text.append(message), longest_message);
}

std::string message_at(const Place& place, std::string_view message) {
  return one_line(fmt::format("{}: {}", place.text(), with_short_names(message)));
}

std::string one_line(std::string text) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  std::ranges::replace_if(text, is_control, ' ');
  return text;
}

void fail(const Place& place, std::string_view message) { throw Error(message_at(place, message)); }

}  // namespace pt::pbrt
