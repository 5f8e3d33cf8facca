// What reaches a terminal: characters, lengths and numbers of messages.
#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "app/options/option_values.h"
#include "app/render/checkpoint_keeper.h"
#include "app/terminal/warning_limit.h"
#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/error/terminal.h"

namespace pt {
namespace {

using Texts = std::vector<std::string>;
using std::string_literals::operator""s;

TEST(TerminalText, ShowsLettersAndNoControl) {
  const std::pair<std::string, std::string> table[] = {
      {"plain text, 100 % ~", "plain text, 100 % ~"},
      {"caf\xc3\xa9 \xe6\x9c\xa8 \xf0\x9f\x8c\xb2", "caf\xc3\xa9 \xe6\x9c\xa8 \xf0\x9f\x8c\xb2"},
      {"a\x1b]52;c;cm0gLXJm\x07", "a?]52;c;cm0gLXJm?"},
      {"a\nb\tc\rd\be\x7f", "a?b?c?d?e?"},
      {"zero\0byte"s, "zero?byte"},
      {"\xc2\x9b"
       "31m",
       "?31m"},  // CSI of 8 bits, U+009B
      {"a\xc2\x80"
       "b\xc2\x9f"
       "c\xc2\xa0"
       "d",
       "a?b?c\xc2\xa0"
       "d"},
      {"evil\xe2\x80\xaegnp.exe", "evil?gnp.exe"},  // U+202E
      {"\xe2\x80\xaa\xe2\x81\xa6\xe2\x81\xa9\xe2\x80\x8e\xe2\x80\x8f\xd8\x9c", "??????"},
      {"a\xe2\x80\xa8"
       "b\xe2\x80\xa9",
       "a?b?"},  // ends of lines
      {"a\xe2\x80\x8b"
       "b\xef\xbb\xbf",
       "a?b?"},  // no width
      {"\xe2\x80\x93\xe2\x82\xac\xe2\x81\xa5\xe2\x81\xb0", "\xe2\x80\x93\xe2\x82\xac?\xe2\x81\xb0"},
      {"\xff\xfe", "??"},
      {"\xc3", "?"},  // cut short
      {"\xe6\x9c", "??"},
      {"\x9b"
       "31m",
       "?31m"},                      // a byte of the C1 set alone
      {"\xc0\xaf\xc1\xbf", "????"},  // overlong
      {"\xe0\x80\xaf", "???"},
      {"\xed\xa0\x80", "???"},  // a surrogate
      {"\xf4\x8f\xbf\xbd", "\xf4\x8f\xbf\xbd"},
      {"\xf4\x90\x80\x80", "????"},  // above U+10FFFF
      {"\xf3\xa0\x81\x81", "?"},     // a tag
      {"caf\xe9!", "caf?!"}};        // Latin-1
  for (const auto& [text, shown] : table) EXPECT_EQ(terminal_text(text), shown) << text;
  EXPECT_EQ(terminal_text("a\n\tb\x1b[0m\r", true), "a\n\tb?[0m?");
}

TEST(TerminalText, IsClippedBetweenCharacters) {
  EXPECT_EQ(begin_and_end("123456789", 9), "123456789");
  EXPECT_EQ(begin_and_end("1234567890", 9), "123456 [...] 890 (10 bytes in all)");
  for (std::size_t most = 9; most < 20; ++most) {
    const std::string text =
        begin_and_end(std::string(4, 'x') + "\xe6\x9c\xa8\xe6\x9c\xa8\xe6\x9c\xa8" +
                          "\xe6\x9c\xa8\xe6\x9c\xa8\xe6\x9c\xa8\xe6\x9c\xa8",
                      most);
    EXPECT_EQ(terminal_text(text), text) << "no half character";
  }
  const std::string line =
      message_line("s.xml:3: '" + std::string(5'000'000, 'a') + "': expected b");
  EXPECT_LT(line.size(), 4100u);
  EXPECT_TRUE(line.starts_with("s.xml:3: 'aaa")) << line.substr(0, 50);
  EXPECT_NE(line.find("a': expected b (5000"), std::string::npos) << "what was expected is kept";
  EXPECT_EQ(message_line("two\nlines"), "two?lines");
}

TEST(Messages, OfWhatTheMachineLacks) {
  const auto of = [](const auto& error) { return message_of(error); };
  const std::string memory = "not enough host memory for this scene and image size";
  EXPECT_EQ(of(std::bad_alloc()), memory);
  EXPECT_EQ(of(std::length_error("vector")), memory);
  const auto again = std::make_error_code(std::errc::resource_unavailable_try_again);
  const std::string thread = of(std::system_error(again));
  EXPECT_NE(thread.find("ulimit -v"), std::string::npos) << thread;
  EXPECT_EQ(of(std::runtime_error("pthread_create has failed: Resource temporarily unavailable")),
            thread);
  EXPECT_EQ(of(Error("a.xml:3: another")), "a.xml:3: another");
}

TEST(WarningLimits, CountEqualKinds) {
  Texts said;
  {
    WarningLimit limit([&](const std::string& text) { said.push_back(text); });
    const auto warn = limit.function();
    for (int i = 0; i < 100'000; ++i)
      warn(fmt::format("s.pbrt:{}: the parameter 'float a{}' is unknown: ignored", i, i));
    warn("s.pbrt:7: the shape \"hair\" is left out");
    EXPECT_EQ(said.size(), WarningLimit::most_of_kind + 1u);
    EXPECT_EQ(said.back(), "s.pbrt:7: the shape \"hair\" is left out");
  }
  EXPECT_EQ(said.back(),
            "99980 warnings more, of kinds that were shown; --strict ends at the first");
  said.clear();
  {
    WarningLimit limit([&](const std::string& text) { said.push_back(text); });
    for (int i = 0; i < 1000; ++i) limit("material m" + std::string(i, 'x') + " is left out");
  }
  EXPECT_EQ(said.size(), WarningLimit::most_in_all + 1u);
  EXPECT_EQ(said.back(), "800 warnings more, of these and other kinds; --strict ends at the first");
  said.clear();
  {
    WarningLimit limit([&](const std::string& text) { said.push_back(text); });
    for (const char* text : {"a", "a", "b"}) limit(text);
  }
  EXPECT_EQ(said, (Texts{"a", "a", "b"})) << "few are as they are";
  EXPECT_FALSE(WarningLimit(nullptr).function()) << "nobody wants them";
}

// %XX stands for what would part a definition from the next one.
TEST(Definitions, AreOneTextWhateverTheirValues) {
  const std::map<std::string, std::string> all{{"a", "0.5 0.5 0.5"},
                                               {"b", "\"quoted\" 'too'"},
                                               {"c", "line\nbreak\ttab"},
                                               {"d", "x=y=z"},
                                               {"e", ""},
                                               {"f", "50% %20 %"},
                                               {"g", " ends "},
                                               {"h", "\xc3\xa9"},
                                               {"i", "C:\\tex\\n"}};
  const std::string text = definitions_text(all);
  EXPECT_EQ(text,
            "a=0.5%200.5%200.5 b=\"quoted\"%20'too' c=line%0Abreak%09tab d=x=y=z e= "
            "f=50%25%20%2520%20%25 g=%20ends%20 h=\xc3\xa9 i=C:\\tex\\n");
  std::map<std::string, std::string> again;
  for (const std::string& one : split_definitions(text)) parse_definition("define", one, again);
  EXPECT_EQ(again, all);
  // Files that were written before have no code.
  EXPECT_EQ(split_definitions("a=1 b=50% c=%zz%2 d=1%"),
            (Texts{"a=1", "b=50%", "c=%zz%2", "d=1%"}));
  EXPECT_EQ(split_definitions(""), Texts{});
}

TEST(CheckpointKeepers, SayOnceWhatFails) {
  Texts said;
  int saved = 0;
  std::string problem = "full";
  {
    CheckpointKeeper keeper(
        0.0f,
        [&](const ImageFilm&) {
          if (!problem.empty()) throw Error(problem);
          ++saved;
        },
        [&](const std::string& text) { said.push_back(text); });
    const ImageFilm film({0, 0, 1, 1}, {});
    const auto grow = [&](const std::string& now) {
      problem = now;
      keeper.film_grew(film);
      keeper.wait();
    };
    grow("full"), grow("full");
    EXPECT_EQ(said, Texts{"full"});
    grow("gone"), grow(""), grow("");
    EXPECT_EQ(saved, 2);
    grow("gone");
    EXPECT_EQ(said, (Texts{"full", "gone", "gone"}));
    problem = "full";
    EXPECT_THROW(keeper.finish(film), Error);
  }
  EXPECT_EQ(said.size(), 3u);
}

TEST(CheckpointKeepers, SaveOnceInAnInterval) {
  int saved = 0;
  CheckpointKeeper keeper(
      0.3f, [&](const ImageFilm&) { ++saved; }, [](const std::string&) {});
  const ImageFilm film({0, 0, 1, 1}, {});
  const auto grow = [&] {
    keeper.film_grew(film);
    keeper.wait();
  };
  grow();
  EXPECT_EQ(saved, 0) << "nothing is lost yet";
  std::this_thread::sleep_for(std::chrono::milliseconds(350));
  grow(), grow(), grow();
  EXPECT_EQ(saved, 1);
  std::this_thread::sleep_for(std::chrono::milliseconds(350));
  grow();
  keeper.finish(film);
  EXPECT_EQ(saved, 3);
}

}  // namespace
}  // namespace pt
