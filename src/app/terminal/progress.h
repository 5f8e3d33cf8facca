// The progress of a render on a terminal or in a log.
#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>

#include "common/options/options.h"
#include "common/platform/steady_seconds.h"

namespace pt {

enum class ProgressStyle {
  silent,
  lines,  ///< a line every few seconds: for logs
  bar     ///< one line that is redrawn: for terminals
};

/// `bar` where `stream` is a terminal, else `lines`.
ProgressStyle progress_style(std::FILE* stream, bool quiet);

/// E.g. "[#####...............]  25 %  12.5 Msamples/s  0:08 left"; without a bar if `bar_width` is
/// 0, without rate and time while they are unknown.
std::string progress_text(std::uint64_t done, std::uint64_t total, double elapsed_s, int bar_width);

/// How far a render is.
struct RenderProgress {
  std::uint64_t pixels = 1;
  std::uint64_t done = 0, total = 0;  ///< samples of all pixels, as RenderHooks has them
  double elapsed_s = 0;
};

/// What --target-error will take, by the first estimate of the error, which is behind `total`;
/// empty while there is none.
std::string forecast_text(const Options& options, const RenderProgress& progress);

/// Shows one render after the other. Cheap to call often: it writes at most every tenth of a second
/// (bar) or every five seconds (lines).
class Progress {
 public:
  using Clock = std::function<double()>;  ///< seconds since any fixed moment

  Progress(std::FILE* stream, ProgressStyle style, Clock clock = steady_seconds);
  ~Progress() { finish(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Starts the clock of a render; `label` stands before its progress, e.g. "warm-up 1 of 2".
  void begin(const std::string& label);
  void update(std::uint64_t done, std::uint64_t total);
  /// Clears the bar, so that other text can follow.
  void finish();

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
