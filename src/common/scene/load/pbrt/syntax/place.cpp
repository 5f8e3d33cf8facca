#include "common/scene/load/pbrt/syntax/place.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/error/error.h"
#include "common/error/quoted.h"

namespace pt::pbrt {

std::string Place::text() const { return fmt::format("{}:{}:{}", *file, line, column); }

namespace {

constexpr std::size_t longest_name = 80, longest_message = 800;  // bytes

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
