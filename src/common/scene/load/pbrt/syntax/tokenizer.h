// The words of a pbrt file.
#pragma once

#include <optional>
#include <string>

#include "common/scene/load/pbrt/syntax/place.h"

namespace pt::pbrt {

enum class TokenKind { word, string, open, close };  ///< open and close: brackets

struct Token {
  TokenKind kind = TokenKind::word;
  std::string text;  ///< of a string: what is between the quotes, escapes resolved
  Place place;
};

/// White space and comments, from # to the end of the line, are between tokens.
class Tokenizer {
 public:
  /// `name` stands for the content in messages.
  Tokenizer(std::string content, const std::string& name);

  /// None at the end. Throws Error for a string that its line does not end.
  std::optional<Token> next();

  /// Where it has come to.
  Place place() const;

 private:
  void skip_space();
  Token read_string();

  std::string content_;
  std::shared_ptr<const std::string> name_;
  std::size_t position_ = 0, line_start_ = 0;
  int line_ = 1;
};

/// All of a word as a finite number that a float can hold; throws Error with the token's place.
double number_of(const Token& token);

}  // namespace pt::pbrt
