// Text of files in messages.
#include <gtest/gtest.h>

#include "common/error/error.h"

namespace pt {
namespace {

TEST(Messages, QuoteTextInOneShortLine) {
  struct Case {
    std::string text, expected;
    std::size_t most = 80;
  };
  const Case cases[] = {
      {"", "''"},
      {"plain", "'plain'"},
      {std::string(80, 'a'), "'" + std::string(80, 'a') + "'"},
      {std::string(5'000'000, 'a'), "'" + std::string(80, 'a') + "...'"},
      {"abcd", "'abc...'", 3},
      {"ab\xc3\xa4z", "'ab...'", 3},        // not half of an a umlaut
      {"a\xf0\x9f\x98\x80z", "'a...'", 4},  // nor three quarters of an emoji
      {"a\xf0\x9f\x98\x80z", "'a\xf0\x9f\x98\x80...'", 5},
      {"\x80\x80\x80\x80\x80\x80\x80\x80", "'\x80...'", 4},  // no UTF-8: three bytes back at most
      {"a\nb\tc\x1b]52;c;x\x07\x7f", "'a?b?c?]52;c;x\?\?'"},
      {"a\xc2\x9b"
       "2J\xc2\xa0",
       "'a?2J\xc2\xa0'"},  // a control character beyond ASCII
  };
  for (const Case& c : cases) EXPECT_EQ(in_quotes(c.text, c.most), c.expected);
}

}  // namespace
}  // namespace pt
