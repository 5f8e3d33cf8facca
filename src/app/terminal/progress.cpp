#include "app/terminal/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/options/option_values.h"

namespace pt {
namespace {

constexpr double bar_interval_s = 0.1;
constexpr double line_interval_s = 5;
constexpr int bar_width = 20;

std::string rate_text(double samples_per_s) {
  if (samples_per_s >= 1e9) return fmt::format("{:.2f} Gsamples/s", samples_per_s / 1e9);
  if (samples_per_s >= 1e6) return fmt::format("{:.2f} Msamples/s", samples_per_s / 1e6);
  return fmt::format("{:.1f} ksamples/s", samples_per_s / 1e3);
}

/// "0:08", "12:34", "1:02:03".
std::string clock_text(double time_s) {
  if (time_s >= 100 * 3600) return "over 100 h";
  const int s = static_cast<int>(std::ceil(time_s));
  if (s < 3600) return fmt::format("{}:{:02}", s / 60, s % 60);
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

}  // namespace

ProgressStyle progress_style(std::FILE* stream, bool quiet) {
  if (quiet) return ProgressStyle::silent;
  return isatty(fileno(stream)) ? ProgressStyle::bar : ProgressStyle::lines;
}

std::string progress_text(std::uint64_t done, std::uint64_t total, double elapsed_s, int width) {
  const double fraction =
      total == 0 ? 1 : std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
  std::string text;
  if (width > 0) {
    const auto filled = static_cast<std::size_t>(fraction * width);
    text = fmt::format("[{:.<{}}] ", std::string(filled, '#'), width);
  }
  // Rounded down: 100 % means done.
  text += fmt::format("{:>3} %", static_cast<int>(100 * fraction));
  if (done == 0 || elapsed_s <= 0) return text;
  const double samples_per_s = static_cast<double>(done) / elapsed_s;
  text += "  " + rate_text(samples_per_s);
  if (done < total)
    text += fmt::format("  {} left", clock_text(static_cast<double>(total - done) / samples_per_s));
  return text;
}

std::string forecast_text(const Options& options, const RenderProgress& progress) {
  constexpr double first_estimate = 16;  // samples per pixel, see StopClock
  const auto pixels = static_cast<double>(progress.pixels);
  const double done = static_cast<double>(progress.done) / pixels;
  const double expected = static_cast<double>(progress.total) / pixels;
  if (done < first_estimate || expected <= done || progress.elapsed_s <= 0) return "";
  const std::string error = "--target-error " + number_text(options.target_error);
  const auto samples = [](double count) {
    return grouped(static_cast<std::uint64_t>(std::llround(count)));
  };
  if (expected >= options.spp) return fmt::format("{}: not within --spp {}", error, options.spp);
  const double left_s = progress.elapsed_s * (expected / done - 1);
  // The limit's own clock began a little later than this one.
  if (options.time_limit > 0 && progress.elapsed_s + left_s > 0.99 * options.time_limit)
    return fmt::format("{}: not within --time-limit {}, which ends it after about {} samples",
                       error, number_text(options.time_limit), samples(expected));
  return fmt::format("{}: about {} samples per pixel, {} left", error, samples(expected),
                     clock_text(left_s));
}

Progress::Progress(std::FILE* stream, ProgressStyle style, Clock clock)
    : stream_(stream), style_(style), clock_(std::move(clock)) {}

void Progress::begin(const std::string& label) {
  finish();
  label_ = label;
  begin_s_ = shown_s_ = clock_();
}

void Progress::update(std::uint64_t done, std::uint64_t total) {
  if (style_ == ProgressStyle::silent) return;
  const double now_s = clock_();
  const bool is_bar = style_ == ProgressStyle::bar;
  if (now_s - shown_s_ < (is_bar ? bar_interval_s : line_interval_s)) return;
  shown_s_ = now_s;
  const std::string text =
      label_ + ' ' + progress_text(done, total, now_s - begin_s_, is_bar ? bar_width : 0);
  // One write per line; "\x1b[K" clears what a longer line before left behind.
  std::fputs((is_bar ? "\r" + text + "\x1b[K" : text + '\n').c_str(), stream_);
  std::fflush(stream_);
  bar_visible_ = is_bar;
}

void Progress::finish() {
  if (!bar_visible_) return;
  std::fputs("\r\x1b[K", stream_);
  std::fflush(stream_);
  bar_visible_ = false;
}

}  // namespace pt
