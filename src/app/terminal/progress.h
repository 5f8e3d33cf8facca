// How far a render is, for a person who waits.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>

namespace pt {

enum class ProgressStyle {
  silent,
  lines,  ///< a line every few seconds: for logs
  bar     ///< one line that is redrawn: for terminals
};

/// `bar` where `stream` is a terminal, else `lines`.
ProgressStyle progress_style(std::FILE* stream, bool quiet);

/// E.g. "[#####...............]  25 %  12.5 Msamples/s  0:08 left"; `bar_width` 0 leaves out the
/// bar. Rate and time left stay away while they are unknown.
std::string progress_text(std::uint64_t done, std::uint64_t total, double elapsed_s, int bar_width);

/// Shows one render after the other. Cheap to call often: it writes at most every tenth of a second
/// (bar) or every five seconds (lines).
class Progress {
 public:
  using Clock = std::function<double()>;  ///< seconds since any fixed moment

  Progress(std::FILE* stream, ProgressStyle style, Clock clock = steady_seconds);
  ~Progress() { finish(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Starts the time of a render; `label` stands before its progress, e.g. "warm-up 1 of 2".
  void begin(const std::string& label);
  void update(std::uint64_t done, std::uint64_t total);
  /// Clears the bar, so that other text can follow.
  void finish();

  static double steady_seconds();

 private:
  std::FILE* stream_;
  ProgressStyle style_;
  Clock clock_;
  std::string label_;
  double begin_s_ = 0;
  double shown_s_ = 0;
  bool bar_visible_ = false;
};

}  // namespace pt
