// The words of pbrt files, with their places, and of the files that these include.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pt::pbrt {

struct FileLocation {
  std::shared_ptr<const std::string> file;
  int line = 0, column = 0;  ///< from 1

  /// FILE:LINE:COLUMN
  std::string text() const;
};

/// "FILE:LINE:COLUMN: message" in one line, with short names.
std::string message_at(const FileLocation& place, std::string_view message);

/// The same message with what stands in quotes, which may be as long as a file, cut to 80 bytes,
/// and all of it to 800.
std::string with_short_names(std::string_view message);

/// Control characters become spaces.
std::string one_line(std::string text);

/// Throws Error with the place.
[[noreturn]] void fail(const FileLocation& place, std::string_view message);
/// The same of a message with values in it.
template <class First, class... Rest>
[[noreturn]] void fail(const FileLocation& place, fmt::format_string<First, Rest...> text,
                       First&& first, Rest&&... rest) {
  fail(place, fmt::format(text, std::forward<First>(first), std::forward<Rest>(rest)...));
}

// The content of a file, compressed or not.

/// All of a file; one that gzip has compressed, as its first bytes tell, is decompressed: to at
/// most 256 MiB or a hundred times its size. Throws Error with the file's name where that cannot
/// be.
std::string read_source(const std::filesystem::path& path);

// The words of a pbrt file.

enum class TokenKind { word, string, open, close };  ///< open and close: brackets

struct Token {
  TokenKind kind = TokenKind::word;
  std::string text;  ///< of a string: what is between the quotes, escapes resolved
  FileLocation place;
};

/// White space and comments, from # to the end of the line, are between tokens.
class Tokenizer {
 public:
  /// `name` stands for the content in messages.
  Tokenizer(std::string content, const std::string& name);

  /// None at the end. Throws Error for a string that its line does not end.
  std::optional<Token> next();

  /// Where it has come to.
  FileLocation place() const;

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

// The tokens of a file and of those that it includes.

class TokenStream {
 public:
  /// Reads a scene's first file. Throws Error where it cannot be read.
  explicit TokenStream(const std::filesystem::path& path);
  /// Reads one file by itself while `parent` is read. Throws as include() does.
  TokenStream(const std::filesystem::path& path, const FileLocation& place,
              const TokenStream& parent);

  /// None where the last file ends.
  std::optional<Token> next();
  /// The same without taking it.
  const Token* peek();

  /// The next token, which must be there, of one kind; `what` is what a message expects.
  Token expect(TokenKind kind, std::string_view what);
  double expect_number(std::string_view what) { return number_of(expect(TokenKind::word, what)); }

  /// Goes on with the tokens of a file. Throws Error at `place` for one that is being read.
  void include(const std::filesystem::path& path, const FileLocation& place);

  /// The folder of the file that is being read.
  std::filesystem::path folder() const;

 private:
  struct File {
    std::filesystem::path path, canonical;
    Tokenizer tokens;
  };
  void open(const std::filesystem::path& path);
  /// That a file is none of those being read.
  void check_new(const std::filesystem::path& path, const FileLocation& place) const;

  const TokenStream* parent_ = nullptr;
  std::vector<File> files_;
  std::optional<Token> peeked_;
  FileLocation last_;
};

}  // namespace pt::pbrt
