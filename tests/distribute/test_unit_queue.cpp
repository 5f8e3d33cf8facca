// Which worker gets which samples, by the rules alone: no pixel is lost or done twice, workers of
// any speed end together, images grow evenly.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <queue>
#include <utility>

#include "common/distribute/unit_queue.h"

namespace pt {
namespace {

std::uint64_t pixels_in(const std::vector<Window>& windows) {
  std::uint64_t count = 0;
  for (const Window& w : windows) count += w.pixel_count();
  return count;
}

/// Each pixel of `where` is in one of the windows.
void expect_division(const std::vector<Window>& where, const std::vector<Window>& windows) {
  EXPECT_EQ(pixels_in(windows), pixels_in(where));
  for (std::size_t i = 0; i < windows.size(); ++i) {
    EXPECT_TRUE(
        std::ranges::any_of(where, [&](const Window& w) { return w.contains(windows[i]); }));
    EXPECT_GT(windows[i].pixel_count(), 0u);
    if (i > 0) {  // from the image's head to its foot
      EXPECT_LT(std::pair(windows[i - 1].y, windows[i - 1].x),
                std::pair(windows[i].y, windows[i].x));
    }
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(windows[i].overlaps(windows[j]));
  }
}

TEST(UnitQueue, DividesPixelsExactly) {
  const std::vector<std::vector<Window>> places = {
      {{0, 0, 1, 1}},
      {{5, 7, 640, 480}},
      {{0, 0, 65535, 1}},
      {{2, 3, 1, 999}},
      {{0, 0, 100, 3}, {0, 9, 100, 1}, {0, 20, 100, 60}}};
  for (const auto& where : places) {
    for (const int workers : {1, 2, 3, 7, 64}) {
      for (const int samples : {1, 16, 100000}) {
        for (const std::uint64_t least : {std::uint64_t{1}, std::uint64_t{1} << 22}) {
          for (const int per_worker : {0, 1, 5}) {
            expect_division(where, divide_pixels(where, samples, {workers, least, per_worker}));
          }
        }
      }
    }
  }
}

TEST(UnitQueue, LargeWindowsComeFirst) {
  const std::vector<Window> windows = divide_pixels({{0, 0, 1000, 1000}}, 64, {4, 1 << 20, 0});
  EXPECT_EQ(windows.front().pixel_count(), 63000u);  // a quarter, by four, in rows
  std::uint64_t last = 1000000;
  for (std::size_t i = 0; i + 1 < windows.size(); ++i) {
    EXPECT_LE(windows[i].pixel_count(), last + 1000);  // a row
    EXPECT_GE(windows[i].pixel_count() * 64, 1u << 20);
    last = windows[i].pixel_count();
  }
  EXPECT_LT(windows.size(), 80u);
  EXPECT_EQ(divide_pixels({{0, 0, 1000, 1000}}, 64, {1, 1 << 20, 0}).size(), 1u);
  EXPECT_EQ(divide_pixels({{0, 0, 1000, 1000}}, 64, {2, 1 << 20, 8}).size(), 16u);
}

/// A render by workers of these speeds in paths per second, each unit costing `overhead` more.
struct Replay {
  double end_s = 0, busy_s = 0;
  std::uint64_t units = 0, paths = 0;
  std::uint32_t widest = 0;  ///< difference of samples between windows, while the image grows
};

Replay replay(const Window& image, int samples, const std::vector<double>& speeds, double overhead,
              std::uint64_t least) {
  const int workers = static_cast<int>(speeds.size());
  std::vector<FilmPart> parts;
  for (const Window& w : divide_pixels({image}, samples, {workers, least, 0}))
    parts.push_back({w, 0, 0});
  UnitQueue queue(parts, static_cast<std::uint32_t>(samples));
  std::map<std::uint32_t, std::uint32_t> done;  // by the window's row and column
  for (const FilmPart& part : parts) done[part.window.y * 65536 + part.window.x] = 0;
  double all = 0;
  for (const double speed : speeds) all += speed;
  struct Event {
    double time;
    std::size_t worker;
    UnitSpan span;
    bool operator<(const Event& e) const { return time > e.time; }
  };
  std::priority_queue<Event> events;
  Replay result;
  const auto hand_out = [&](double now, std::size_t worker) {
    const auto span = queue.next(static_cast<std::uint64_t>(speeds[worker]) + 1,
                                 static_cast<std::uint64_t>(20 * all));
    if (!span) return;
    const double paths = static_cast<double>(span->part.window.pixel_count()) * span->samples;
    events.push({now + overhead + paths / speeds[worker], worker, *span});
    result.busy_s += overhead + paths / speeds[worker];
    ++result.units;
  };
  for (std::size_t w = 0; w < speeds.size(); ++w) hand_out(0, w);
  while (!events.empty()) {
    const Event event = events.top();
    events.pop();
    const FilmPart& part = event.span.part;
    std::uint32_t& own = done.at(part.window.y * 65536 + part.window.x);
    EXPECT_EQ(own, part.next_sample) << "samples in their order, each once";
    own = part.next_sample + static_cast<std::uint32_t>(event.span.samples);
    result.paths += part.window.pixel_count() * static_cast<std::uint64_t>(event.span.samples);
    queue.end(part.window, own);
    if (queue.paths_left() > static_cast<std::uint64_t>(20 * all)) {
      const auto [low, high] =
          std::ranges::minmax_element(done, {}, &decltype(done)::value_type::second);
      result.widest = std::max(result.widest, high->second - low->second);
    }
    result.end_s = event.time;
    for (std::size_t w = 0; w < speeds.size(); ++w) {
      if (w == event.worker) hand_out(event.time, w);
    }
  }
  EXPECT_TRUE(queue.is_done());
  return result;
}

TEST(UnitQueue, WorkersEndTogether) {
  const Window image{0, 0, 1920, 1080};
  for (const int samples : {16, 256, 8192}) {
    for (const std::vector<double>& speeds :
         {std::vector<double>{5e8, 5e8}, {5e8, 5e8, 5e8, 2.5e8}, std::vector<double>(8, 4e8)}) {
      const Replay r = replay(image, samples, speeds, 2e-4, std::uint64_t{1} << 22);
      EXPECT_EQ(r.paths, image.pixel_count() * static_cast<std::uint64_t>(samples));
      double all = 0;
      for (const double speed : speeds) all += speed;
      const double ideal_s = static_cast<double>(r.paths) / all;
      // A unit that keeps a device busy for 10 ms is the end's worst unevenness.
      EXPECT_LT(r.end_s, 1.02 * ideal_s + 0.02) << samples << " " << speeds.size();
    }
  }
}

TEST(UnitQueue, LongImagesGrowEvenly) {
  const Replay r = replay({0, 0, 640, 480}, 100000, {1e6, 1e6, 5e5}, 0, 1 << 12);
  EXPECT_LT(r.widest, 400u);  // 5 s of the largest window: 1/12 of the image
  EXPECT_GT(r.widest, 0u);
}

TEST(UnitQueue, GoesOnWhereAUnitWasCutShort) {
  UnitQueue queue({{{0, 0, 10, 10}, 0, 3}}, 10);
  EXPECT_EQ(queue.paths_left(), 700u);
  const auto first = queue.next(1000000, 0);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->part.next_sample, 3u);
  EXPECT_EQ(first->samples, 7);
  EXPECT_FALSE(queue.next(1, 0));
  queue.end({0, 0, 10, 10}, 5);
  EXPECT_EQ(queue.paths_left(), 500u);
  const auto second = queue.next(200, 0);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->part.next_sample, 5u);
  EXPECT_EQ(second->samples, 2);
  queue.end({0, 0, 10, 10}, 10);
  EXPECT_TRUE(queue.is_done());
}

// What would be left after the unit is part of it where it is less than half a unit.
TEST(UnitQueue, LeavesNoSmallRest) {
  struct Case {
    std::uint64_t paths;
    int samples;
  };
  for (const Case& c : {Case{10000, 10}, {900, 10}, {700, 10}, {600, 6}, {500, 5}, {1, 1}}) {
    UnitQueue queue({{{0, 0, 10, 10}, 0, 0}}, 10);
    EXPECT_EQ(queue.next(c.paths, 0)->samples, c.samples) << c.paths;
  }
}

}  // namespace
}  // namespace pt
