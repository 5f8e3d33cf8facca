#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <thread>

#include "common/image/atomic_file.h"
#include "temp_folder.h"

namespace pt {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

mode_t permissions(const std::string& path) {
  struct stat status {};
  EXPECT_EQ(::stat(path.c_str(), &status), 0);
  return status.st_mode & 0777;
}

/// While it lives, a file cannot grow past `bytes`: a disk that fills up in the middle of a write.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  void (*handler_)(int);
  rlimit old_{};
};

/// A process in the middle of a write; `last` is what it does at SIGUSR1.
class Writer {
 public:
  using Act = void (*)();

  explicit Writer(const std::string& target, Act last = nullptr) {
    int ready[2];
    EXPECT_EQ(::pipe(ready), 0);
    id_ = ::fork();
    if (id_ == 0) {
      std::signal(SIGTERM, SIG_DFL);
      TemporaryFile file(target);
      file.descriptor().write("half");
      static Act final_act = nullptr;
      final_act = last;
      std::signal(SIGUSR1, [](int) {
        final_act();
        ::_exit(0);
      });
      [[maybe_unused]] const auto written = ::write(ready[1], "x", 1);
      for (;;) ::pause();
    }
    ::close(ready[1]);
    char byte = 0;
    EXPECT_EQ(::read(ready[0], &byte, 1), 1);
    ::close(ready[0]);
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() { end(SIGKILL); }

  void end(int signal) {
    if (id_ <= 0) return;
    ::kill(id_, signal);
    ::waitpid(id_, nullptr, 0);
    id_ = 0;
  }

 private:
  pid_t id_ = 0;
};

TEST(AtomicFile, WritesAndReplaces) {
  const TempFolder folder;
  const std::string path = folder.file("a.json");
  write_file_atomically(path, "first, and longer");
  EXPECT_EQ(read_text(path), "first, and longer");
  const std::string second("sec\0nd", 6);
  write_file_atomically(path, second);
  EXPECT_EQ(read_text(path), second);
  EXPECT_EQ(folder.entries(), Names{"a.json"});
}

TEST(AtomicFile, FailureInTheMiddleKeepsTheOldFileAndLeavesNoTemporary) {
  const TempFolder folder;
  const std::string path = folder.file("a.json");
  write_file_atomically(path, "old");
  {
    const FileSizeLimit limit(1000);
    expect_error([&] { write_file_atomically(path, std::string(5000, 'x')); }, path);
    expect_error([&] { write_file_atomically(folder.file("new"), std::string(5000, 'x')); },
                 "File too large");
  }
  EXPECT_EQ(read_text(path), "old");
  EXPECT_EQ(folder.entries(), Names{"a.json"});
}

TEST(AtomicFile, TheOldFileIsWholeWhileItsReaderHasItOpen) {
  const TempFolder folder;
  const std::string path = folder.file("a");
  write_file_atomically(path, "old");
  std::ifstream reader(path);
  write_file_atomically(path, "the successor");
  std::string text;
  reader >> text;
  EXPECT_EQ(text, "old");
}

TEST(AtomicFile, PlacesThatCannotBeWritten) {
  const TempFolder folder;
  write_text(folder.file("plain"), "text");
  fs::create_directory(folder.file("sub"));
  const std::pair<std::string, std::string> cases[] = {
      {folder.file("missing/a"), "the folder " + folder.file("missing") + " does not exist"},
      {folder.file("sub"), "it is a folder"},
      {folder.file("plain/a"), "Not a directory"},
      {folder.file("sub/"), "it is a folder"},
      {folder.file("none/"), "it names no file"},
      {folder.file(std::string(300, 'n')), "File name too long"},
      {"", "it names no file"},
  };
  for (const auto& [path, reason] : cases) {
    expect_error([&, &p = path] { check_writable(p); }, "cannot write " + path + ": " + reason);
    expect_error([&, &p = path] { write_file_atomically(p, "x"); }, reason);
  }
  EXPECT_EQ(folder.entries(), (Names{"plain", "sub"}));
  EXPECT_EQ(read_text(folder.file("plain")), "text");
}

TEST(AtomicFile, CheckTouchesNothing) {
  const TempFolder folder;
  const std::string path = folder.file("a");
  check_writable(path);
  EXPECT_EQ(folder.entries(), Names{});
  write_text(path, "old");
  const auto before = fs::last_write_time(path);
  check_writable(path);
  EXPECT_EQ(read_text(path), "old");
  EXPECT_EQ(fs::last_write_time(path), before);
  EXPECT_EQ(folder.entries(), Names{"a"});
}

TEST(AtomicFile, PermissionsFollowTheUmaskOrTheReplacedFile) {
  const TempFolder folder;
  const mode_t old_mask = ::umask(027);
  write_file_atomically(folder.file("new"), "x");
  ::umask(old_mask);
  EXPECT_EQ(permissions(folder.file("new")), 0640u);

  ASSERT_EQ(::chmod(folder.file("new").c_str(), 0604), 0);
  write_file_atomically(folder.file("new"), "y");
  EXPECT_EQ(permissions(folder.file("new")), 0604u);
}

TEST(AtomicFile, WriteProtectionHolds) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const TempFolder folder;
  const std::string path = folder.file("a");
  write_text(path, "old");
  ASSERT_EQ(::chmod(path.c_str(), 0444), 0);
  expect_error([&] { write_file_atomically(path, "x"); }, "Permission denied");
  EXPECT_EQ(read_text(path), "old");
}

TEST(AtomicFile, ALinkStaysALink) {
  const TempFolder folder;
  fs::create_directory(folder.file("sub"));
  write_text(folder.file("sub/target"), "old");
  fs::create_symlink("sub/target", folder.file("link"));
  write_file_atomically(folder.file("link"), "new");
  EXPECT_TRUE(fs::is_symlink(folder.file("link")));
  EXPECT_EQ(read_text(folder.file("sub/target")), "new");
}

// With pipes and devices of our own: a mistake here, run as root, would replace those in /dev.
TEST(AtomicFile, APipeIsWrittenDirectlyAndSurvives) {
  const TempFolder folder;
  const std::string path = folder.file("pipe");
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const int reader = ::open(path.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  check_writable(path);
  write_file_atomically(path, "through");
  char text[16] = "";
  EXPECT_EQ(::read(reader, text, sizeof text), 7);
  ::close(reader);
  EXPECT_STREQ(text, "through");
  EXPECT_TRUE(fs::is_fifo(path));
  EXPECT_EQ(folder.entries(), Names{"pipe"});
}

TEST(AtomicFile, APipeBehindALinkSurvives) {
  const TempFolder folder;
  ASSERT_EQ(::mkfifo(folder.file("pipe").c_str(), 0600), 0);
  fs::create_symlink("pipe", folder.file("link"));
  const int reader = ::open(folder.file("pipe").c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  write_file_atomically(folder.file("link"), "through");
  ::close(reader);
  EXPECT_TRUE(fs::is_fifo(folder.file("pipe")));
  EXPECT_TRUE(fs::is_symlink(folder.file("link")));
}

// Like /dev/stdout of a program whose output is closed.
TEST(AtomicFile, ALinkToNothingIsNotReplaced) {
  const TempFolder folder;
  fs::create_symlink("nothing", folder.file("link"));
  expect_error([&] { check_writable(folder.file("link")); }, "link to nothing");
  expect_error([&] { write_file_atomically(folder.file("link"), "x"); }, "link to nothing");
  EXPECT_EQ(fs::read_symlink(folder.file("link")), "nothing");
  EXPECT_EQ(folder.entries(), Names{"link"});
}

TEST(AtomicFile, APipesReaderMayComeLateAndReadSlowly) {
  const TempFolder folder;
  const std::string path = folder.file("pipe");
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const std::string sent(300'000, 'x');  // more than a pipe holds
  std::string got;
  std::thread reader([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(120));
    std::ifstream file(path, std::ios::binary);
    std::this_thread::sleep_for(std::chrono::milliseconds(120));
    got.assign(std::istreambuf_iterator<char>(file), {});
  });
  write_file_atomically(path, sent);
  reader.join();
  EXPECT_EQ(got, sent);
}

TEST(AtomicFile, APipeWithoutAReaderIsGivenUpAfterASignal) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  const TempFolder folder;
  const std::string path = folder.file("pipe");
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const auto write = [&] {
    std::signal(SIGTERM, [](int) { hurry_pipe_writers(); });
    std::thread([] {
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
      ::kill(::getpid(), SIGTERM);
    }).detach();
    try {
      write_file_atomically(path, "x");
    } catch (const Error& error) {
      std::fputs(error.what(), stderr);
      std::_Exit(3);
    }
  };
  EXPECT_EXIT(write(), testing::ExitedWithCode(3), "pipe: nobody reads this pipe");
}

TEST(AtomicFile, OneFileHasManyNames) {
  const TempFolder folder;
  const std::string a = folder.file("a"), b = folder.file("b");
  write_text(a, "x"), write_text(b, "x");
  fs::create_symlink("a", folder.file("link"));
  fs::create_hard_link(a, folder.file("hard"));
  fs::create_symlink(".", folder.file("here"));
  for (const char* name : {"a", "link", "hard", "here/a", "././a"})
    EXPECT_TRUE(is_same_file(a, folder.file(name)) && is_same_file(folder.file(name), a)) << name;
  EXPECT_FALSE(is_same_file(a, b));
  ASSERT_EQ(::mkfifo(folder.file("pipe").c_str(), 0600), 0);
  fs::create_symlink("pipe", folder.file("other"));
  EXPECT_TRUE(is_same_file(folder.file("pipe"), folder.file("./pipe")));
  EXPECT_FALSE(is_same_file(folder.file("pipe"), folder.file("other"))) << "nothing is replaced";
  // Files that do not exist yet.
  EXPECT_TRUE(is_same_file(folder.file("new"), folder.file("here/new")));
  EXPECT_FALSE(is_same_file(folder.file("new"), folder.file("newer")));
  EXPECT_FALSE(is_same_file(folder.file("new"), a));
  EXPECT_FALSE(is_same_file("", "") || is_same_file(a, "") || is_same_file("", a));
  expect_error([&] { check_not_read("--stats", folder.file("hard"), a); },
               "--stats " + folder.file("hard") + ": is the file " + a);
}

TEST(AtomicFile, AFullDeviceIsAnError) {
  const TempFolder folder;
  const std::string path = folder.file("full");
  if (::mknod(path.c_str(), S_IFCHR | 0600, makedev(1, 7)) != 0 || !std::ofstream(path)) {
    GTEST_SKIP() << "only root may make devices";
  }
  expect_error([&] { write_file_atomically(path, "x"); }, path + ": No space left on device");
  EXPECT_TRUE(fs::is_character_file(path));
}

TEST(AtomicFile, ANameInTheCurrentFolder) {
  const TempFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.file(""));
  write_file_atomically("a", "here");
  fs::current_path(before);
  EXPECT_EQ(read_text(folder.file("a")), "here");
}

TEST(AtomicFile, TheNextWriterRemovesWhatAKilledOneLeft) {
  const TempFolder folder;
  const std::string path = folder.file("a.exr");
  for (const bool asks_first : {false, true}) {
    Writer(path).end(SIGKILL);
    ASSERT_EQ(folder.entries().size(), asks_first ? 2 : 1);
    if (asks_first) {
      check_writable(path);
    } else {
      write_file_atomically(path, "whole");
    }
    EXPECT_EQ(folder.entries(), Names{"a.exr"});
    EXPECT_EQ(read_text(path), "whole");
  }
}

TEST(AtomicFile, WhatIsNotItsOwnIsLeftAlone) {
  const TempFolder folder;
  const std::string path = folder.file("a.exr"), other = folder.file("b.exr");
  Writer(other).end(SIGKILL);  // another target's
  const Writer alive(path);    // another process's, at work
  write_text(folder.file(".ptexp-0123456789abcdef-01234567.tmp"), "of a third target");
  const Names before = folder.entries();
  ASSERT_EQ(before.size(), 3);
  write_file_atomically(path, "whole");
  Names after = folder.entries();
  EXPECT_EQ(std::erase(after, "a.exr"), 1);
  EXPECT_EQ(after, before);
}

TEST(AtomicFile, AHandlerOfSignalsCanRemoveWhatIsUnfinished) {
  const TempFolder folder;
  Writer writer(folder.file("a.exr"), remove_unfinished_file);
  ASSERT_EQ(folder.entries().size(), 1);
  writer.end(SIGUSR1);
  EXPECT_EQ(folder.entries(), Names{});
  write_file_atomically(folder.file("a.exr"), "whole");
  remove_unfinished_file();  // there is none
  EXPECT_EQ(folder.entries(), Names{"a.exr"});
}

}  // namespace
}  // namespace pt
