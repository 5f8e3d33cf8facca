#include "common/scene/load/pbrt/syntax/tokens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <utility>

#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/scene/load/files/text.h"
#include "common/scene/load/files/whole_file.h"

namespace pt::pbrt {

std::string FileLocation::text() const { return fmt::format("{}:{}:{}", *file, line, column); }

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

std::string message_at(const FileLocation& place, std::string_view message) {
  return one_line(fmt::format("{}: {}", place.text(), with_short_names(message)));
}

std::string one_line(std::string text) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  std::ranges::replace_if(text, is_control, ' ');
  return text;
}

void fail(const FileLocation& place, std::string_view message) {
  throw Error(message_at(place, message));
}

std::string read_source(const std::filesystem::path& path) {
  try {
    const WholeFile file(path);
    if (is_gzip(file.bytes())) return decompress_gzip(file.bytes());
    return std::string(file.bytes());
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path.string(), error.what()));
  }
}

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

FileLocation Tokenizer::place() const {
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
  const auto wrong = [&] { fail(token.place, "'{}'; expected a finite number", token.text); };
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

namespace {

std::filesystem::path canonical_of(const std::filesystem::path& path) {
  std::error_code ignored;
  std::filesystem::path found = std::filesystem::canonical(path, ignored);
  return ignored ? path : found;
}

constexpr std::size_t most_files = 64;  // in each other

}  // namespace

TokenStream::TokenStream(const std::filesystem::path& path) { open(path); }

void TokenStream::open(const std::filesystem::path& path) {
  files_.push_back({path, canonical_of(path), Tokenizer(read_source(path), path.string())});
  last_ = files_.back().tokens.place();
}

TokenStream::TokenStream(const std::filesystem::path& path, const FileLocation& place,
                         const TokenStream& parent)
    : parent_(&parent) {
  include(path, place);
}

void TokenStream::check_new(const std::filesystem::path& path, const FileLocation& place) const {
  const std::filesystem::path own = canonical_of(path);
  std::size_t count = 0;
  for (const TokenStream* stream = this; stream; stream = stream->parent_) {
    for (const File& file : stream->files_) {
      if (file.canonical != own) continue;
      fail(place, "{} includes itself", path.string());
    }
    count += stream->files_.size();
  }
  if (count >= most_files) {
    fail(place, "files include each other too deeply; expected at most {} in each other",
         most_files);
  }
}

void TokenStream::include(const std::filesystem::path& path, const FileLocation& place) {
  check_new(path, place);
  try {
    open(path);
  } catch (const Error& error) {
    fail(place, error.what());
  }
}

std::filesystem::path TokenStream::folder() const {
  return files_.empty() ? std::filesystem::path() : files_.back().path.parent_path();
}

std::optional<Token> TokenStream::next() {
  if (peeked_) return std::exchange(peeked_, std::nullopt);
  while (!files_.empty()) {
    std::optional<Token> token = files_.back().tokens.next();
    if (token) {
      last_ = token->place;
      return token;
    }
    last_ = files_.back().tokens.place();
    files_.pop_back();
  }
  return std::nullopt;
}

const Token* TokenStream::peek() {
  if (!peeked_) peeked_ = next();
  return peeked_ ? &*peeked_ : nullptr;
}

Token TokenStream::expect(TokenKind kind, std::string_view what) {
  std::optional<Token> token = next();
  if (!token) fail(last_, "the file ends here; expected {}", what);
  if (token->kind != kind) {
    fail(token->place, "'{}'; expected {}", token->text, what);
  }
  return std::move(*token);
}

}  // namespace pt::pbrt
