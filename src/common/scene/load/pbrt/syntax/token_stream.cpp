#include "common/scene/load/pbrt/syntax/token_stream.h"

#include <fmt/format.h>

#include <utility>

#include "common/error/error.h"
#include "common/scene/load/pbrt/syntax/source.h"

namespace pt::pbrt {
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

TokenStream::TokenStream(const std::filesystem::path& path, const Place& place,
                         const TokenStream& parent)
    : parent_(&parent) {
  include(path, place);
}

void TokenStream::check_new(const std::filesystem::path& path, const Place& place) const {
  const std::filesystem::path own = canonical_of(path);
  std::size_t count = 0;
  for (const TokenStream* stream = this; stream; stream = stream->parent_) {
    for (const File& file : stream->files_) {
      if (file.canonical != own) continue;
      fail(place, fmt::format("{} includes itself", path.string()));
    }
    count += stream->files_.size();
  }
  if (count >= most_files) {
    fail(place, fmt::format("files include each other too deeply; expected at most {} in each "
                            "other",
                            most_files));
  }
}

void TokenStream::include(const std::filesystem::path& path, const Place& place) {
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
  if (!token) fail(last_, fmt::format("the file ends here; expected {}", what));
  if (token->kind != kind) {
    fail(token->place, fmt::format("'{}'; expected {}", token->text, what));
  }
  return std::move(*token);
}

}  // namespace pt::pbrt
