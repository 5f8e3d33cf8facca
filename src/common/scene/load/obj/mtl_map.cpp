#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/error/error.h"
#include "common/scene/load/files/text.h"
#include "common/scene/load/obj/mtl.h"

namespace pt::obj {
namespace {

/// An option and its arguments: words, or up to `most` numbers.
struct Option {
  const char* name;
  int least, most;
  bool takes_words;
};

constexpr std::array<Option, 13> options = {{{"-blendu", 1, 1, true},
                                             {"-blendv", 1, 1, true},
                                             {"-bm", 1, 1, false},
                                             {"-boost", 1, 1, false},
                                             {"-cc", 1, 1, true},
                                             {"-clamp", 1, 1, true},
                                             {"-imfchan", 1, 1, true},
                                             {"-mm", 2, 2, false},
                                             {"-o", 1, 3, false},
                                             {"-s", 1, 3, false},
                                             {"-t", 1, 3, false},
                                             {"-texres", 1, 1, true},
                                             {"-type", 1, 1, true}}};

const Option* find_option(std::string_view word) {
  if (!word.starts_with('-') || word.size() > 8) return nullptr;
  const std::string name = lower_case(word);
  const auto* found =
      std::ranges::find_if(options, [&](const Option& option) { return option.name == name; });
  return found == options.end() ? nullptr : found;
}

std::optional<float> number_in(std::string_view word) {
  try {
    const double value = parse_number(word);
    if (std::isfinite(static_cast<float>(value))) return static_cast<float>(value);
  } catch (const Error&) {
  }
  return {};
}

class MapLine {
 public:
  MapLine(std::string_view text, const WarnOfKind& warn) : rest_(trim(text)), warn_(warn) {}

  MtlMap read() {
    read_options();
    read_name();
    read_options();
    if (!rest_.empty()) {
      warn_("text behind a map",
            fmt::format("{} behind the name of a picture: it is ignored", in_quotes(rest_)));
    }
    return map_;
  }

 private:
  std::string_view take() {
    const std::string_view word = next_word(rest_);
    rest_ = trim(rest_);
    return word;
  }
  std::string_view peek() const {
    std::string_view rest = rest_;
    return next_word(rest);
  }

  void read_options() {
    for (;;) {
      const std::string_view word = peek();
      if (const Option* option = find_option(word)) {
        take();
        read_option(*option);
      } else if (word.size() > 1 && word[0] == '-' && word.size() < rest_.size()) {
        warn_("unknown option", fmt::format("unknown option {}: it is ignored", in_quotes(take())));
        while (rest_.size() > peek().size() && number_in(peek())) take();
      } else {
        return;
      }
    }
  }

  void read_option(const Option& option) {
    const std::string name = option.name;
    std::vector<float> numbers;
    std::string word;
    if (option.takes_words) {
      word = lower_case(take());
    } else {
      while (numbers.size() < static_cast<std::size_t>(option.most)) {
        const std::optional<float> number = number_in(peek());
        if (!number) break;
        numbers.push_back(*number);
        take();
      }
      if (numbers.size() < static_cast<std::size_t>(option.least)) {
        warn_(name, fmt::format("{}: expected {} {}, found {}: it is ignored", name, option.least,
                                option.least == 1 ? "number" : "numbers", in_quotes(peek(), 40)));
        return;
      }
    }
    apply(name, word, numbers);
  }

  void apply(const std::string& name, const std::string& word, const std::vector<float>& numbers) {
    const auto copy = [&](float(&to)[2]) {
      std::copy_n(numbers.begin(), std::min<std::size_t>(numbers.size(), 2), to);
    };
    if (name == "-o") return copy(map_.offset);
    if (name == "-s") return copy(map_.scale);
    if (name == "-bm") map_.bump = numbers[0];
    if (name == "-mm") map_.base = numbers[0], map_.gain = numbers[1];
    if (name == "-clamp") map_.clamps = is_on(name, word, map_.clamps);
    if (name == "-blendu") map_.blends[0] = is_on(name, word, true);
    if (name == "-blendv") map_.blends[1] = is_on(name, word, true);
    if (name == "-imfchan") return set_channel(word);
    const bool is_lost =
        (name == "-t" && std::ranges::any_of(numbers, [](float x) { return x != 0.0f; })) ||
        (name == "-cc" && is_on(name, word, false)) || name == "-boost" || name == "-type";
    if (is_lost) warn_(name, fmt::format("{} has no counterpart: it is ignored", name));
  }

  bool is_on(const std::string& name, const std::string& word, bool fallback) {
    if (word == "on" || word == "off") return word == "on";
    warn_(name, fmt::format("{}: expected on or off, found {}: it is ignored", name,
                            in_quotes(word, 40)));
    return fallback;
  }

  void set_channel(const std::string& word) {
    if (word.size() == 1 && std::string_view("rgbml").find(word[0]) != std::string_view::npos) {
      map_.channel = word[0];
    } else {
      warn_("-imfchan", fmt::format("-imfchan: expected r, g, b, m or l, found {}: it is ignored",
                                    in_quotes(word, 40)));
    }
  }

  void read_name() {
    if (rest_.starts_with('"')) {
      const std::size_t end = std::min(rest_.find('"', 1), rest_.size());
      map_.name = rest_.substr(1, end - 1);
      rest_ = trim(rest_.substr(std::min(end + 1, rest_.size())));
    } else {
      const std::string_view whole = rest_;
      std::string_view before = whole.substr(0, 0);
      while (!rest_.empty() && !(before.size() > 0 && find_option(peek()))) {
        const std::string_view word = take();
        before =
            whole.substr(0, static_cast<std::size_t>(word.data() + word.size() - whole.data()));
      }
      map_.name = before;
    }
    if (map_.name.empty())
      warn_("no picture", "expected the name of a picture: the map is ignored");
  }

  std::string_view rest_;
  const WarnOfKind& warn_;
  MtlMap map_;
};

}  // namespace

MtlMap parse_mtl_map(std::string_view text, const WarnOfKind& warn) {
  return MapLine(text, warn).read();
}

}  // namespace pt::obj
