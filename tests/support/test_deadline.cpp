// No test goes on for ever: after a quarter of an hour its name is printed and the process ends, so
// that an error that makes paths or walks endless is seen as one. And no test depends on the user's
// cache folder.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace pt {
namespace {

constexpr unsigned deadline_s = 900;  // under sanitizers some tests take minutes

std::array<char, 300> farewell;

void end_process(int) {
  std::size_t length = 0;
  while (farewell[length] != 0) ++length;
  [[maybe_unused]] const auto written = write(STDERR_FILENO, farewell.data(), length);
  std::_Exit(EXIT_FAILURE);
}

void begin_deadline(const char* suite, const char* test, unsigned limit_s) {
  std::snprintf(farewell.data(), farewell.size(), "[  FAILED  ] %s.%s did not end within %u s\n",
                suite, test, limit_s);
  std::signal(SIGALRM, end_process);
  alarm(limit_s);
}

class Deadline : public testing::EmptyTestEventListener {
  void OnTestStart(const testing::TestInfo& test) override {
    begin_deadline(test.test_suite_name(), test.name(), deadline_s);
  }
  void OnTestEnd(const testing::TestInfo&) override { alarm(0); }
};

[[maybe_unused]] const bool is_listening = [] {
  testing::UnitTest::GetInstance()->listeners().Append(new Deadline);
  return ::setenv("XDG_CACHE_HOME", "/nonexistent", 1) == 0;
}();

void never_end() {
  begin_deadline("Some", "Test", 1);
  for (;;) pause();
}

TEST(DeadlineDeathTest, EndsATestThatDoesNotEnd) {
  EXPECT_EXIT(never_end(), testing::ExitedWithCode(EXIT_FAILURE),
              "Some.Test did not end within 1 s");
}

}  // namespace
}  // namespace pt
