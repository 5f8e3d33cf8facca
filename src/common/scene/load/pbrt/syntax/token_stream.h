// The tokens of a file and of those that it includes.
#pragma once

#include <filesystem>
#include <vector>

#include "common/scene/load/pbrt/syntax/tokenizer.h"

namespace pt::pbrt {

class TokenStream {
 public:
  /// Of a scene's first file. Throws Error where it cannot be read.
  explicit TokenStream(const std::filesystem::path& path);
  /// Of a file that is read, on its own, while those of `parent` are. Throws as include() does.
  TokenStream(const std::filesystem::path& path, const Place& place, const TokenStream& parent);

  /// None where the last file ends.
  std::optional<Token> next();
  /// The same without taking it.
  const Token* peek();

  /// The next token, which must be there, of one kind; `what` is what a message expects.
  Token expect(TokenKind kind, std::string_view what);
  double expect_number(std::string_view what) { return number_of(expect(TokenKind::word, what)); }

  /// Goes on with the tokens of a file. Throws Error at `place` for one that is being read.
  void include(const std::filesystem::path& path, const Place& place);

  /// The folder of the file that is being read.
  std::filesystem::path folder() const;

 private:
  struct File {
    std::filesystem::path path, canonical;
    Tokenizer tokens;
  };
  void open(const std::filesystem::path& path);
  /// That a file is none of those being read.
  void check_new(const std::filesystem::path& path, const Place& place) const;

  const TokenStream* parent_ = nullptr;
  std::vector<File> files_;
  std::optional<Token> peeked_;
  Place last_;
};

}  // namespace pt::pbrt
