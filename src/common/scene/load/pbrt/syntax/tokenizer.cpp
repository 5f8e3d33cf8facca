#include "common/scene/load/pbrt/syntax/tokenizer.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "common/error/error.h"
#include "common/scene/load/files/meshes/text_number.h"

namespace pt::pbrt {
namespace {

bool ends_word(char c) { return is_text_space(c) || c == '"' || c == '[' || c == ']' || c == '#'; }

/// What \c stands for, or 0 where that is nothing.
char escaped(char c) {
  switch (c) {
    case 'b':
      return '\b';
    case 'f':
      return '\f';
    case 'n':
      return '\n';
    case 'r':
      return '\r';
    case 't':
      return '\t';
    case '\\':
    case '\'':
    case '"':
      return c;
    default:
      return 0;
  }
}

}  // namespace

Tokenizer::Tokenizer(std::string content, const std::string& name)
    : content_(std::move(content)), name_(std::make_shared<const std::string>(name)) {
  position_ = content_.size() - without_byte_order_mark(content_).size();
}

Place Tokenizer::place() const {
  return {name_, line_, static_cast<int>(position_ - line_start_) + 1};
}

void Tokenizer::skip_space() {
  bool comment = false;
  for (; position_ < content_.size(); ++position_) {
    const char c = content_[position_];
    if (c == '\n') {
      ++line_;
      line_start_ = position_ + 1;
      comment = false;
    } else if (c == '#') {
      comment = true;
    } else if (!comment && !is_text_space(c)) {
      return;
    }
  }
}

Token Tokenizer::read_string() {
  Token token{TokenKind::string, {}, place()};
  for (++position_; position_ < content_.size(); ++position_) {
    char c = content_[position_];
    if (c == '"') {
      ++position_;
      return token;
    }
    if (c == '\n') break;
    if (c == '\\') {
      // What is no escape is a path of Windows.
      const char next = position_ + 1 < content_.size() ? content_[position_ + 1] : '\0';
      if (escaped(next) != 0) c = escaped(next), ++position_;
    }
    token.text += c;
  }
  fail(token.place, "a string without an end; expected a \" in the same line");
}

std::optional<Token> Tokenizer::next() {
  skip_space();
  if (position_ == content_.size()) return std::nullopt;
  const char first = content_[position_];
  if (first == '"') return read_string();
  Token token{TokenKind::word, {}, place()};
  if (first == '[' || first == ']') {
    token.kind = first == '[' ? TokenKind::open : TokenKind::close;
    token.text = content_[position_++];
    return token;
  }
  const std::size_t begin = position_;
  while (position_ < content_.size() && !ends_word(content_[position_])) ++position_;
  token.text = content_.substr(begin, position_ - begin);
  return token;
}

double number_of(const Token& token) {
  const auto wrong = [&] {
    fail(token.place, fmt::format("'{}'; expected a finite number", token.text));
  };
  double value = 0;
  if (token.kind != TokenKind::word) wrong();
  try {
    value = parse_number(token.text);
  } catch (const Error&) {
    wrong();
  }
  if (!(std::abs(value) <= double{std::numeric_limits<float>::max()})) wrong();
  return value;
}

}  // namespace pt::pbrt
