// Units, results and devices as bytes: nothing is lost on the way, and nothing wrong is taken.
#include <random>

#include "common/distribute/unit_message.h"
#include "film_cases.h"
#include "gtest/gtest.h"

namespace pt {
namespace {

std::vector<FilmPlan> film_plans() {
  std::vector<FilmPlan> plans;
  for (const std::uint32_t aovs : {0u, 1u, 5u, ~0u >> 1}) {
    for (const bool moments : {false, true}) {
      for (const bool two_signs : {false, true}) plans.push_back({aovs, moments, two_signs});
    }
  }
  return plans;
}

/// Random bits, NaNs among them.
template <class T>
void scramble(T* values, std::size_t count) {
  static std::mt19937_64 random(1);
  for (std::size_t i = 0; i < count * sizeof(T) / 8; ++i) {
    const std::uint64_t bits = random();
    std::memcpy(reinterpret_cast<char*>(values) + 8 * i, &bits, 8);
  }
}

Film film_of(const FilmPlan& plan) {
  Film film;
  film.window = {70'000, 3, 7, 5};
  film.first_sample = 2, film.next_sample = 4'000'000'000u;
  film.reset(plan, film.window.pixel_count());
  scramble(film.pixels.data(), film.pixels.size());
  scramble(film.moments.data(), film.moments.size());
  scramble(film.features.data(), film.features.size());
  scramble(&film.tally, 1);
  film.parts = {{70'000, 3, 7, 2}, {70'000, 5, 3, 3}};
  return film;
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same(const Film& a, const Film& b) {
  EXPECT_EQ(a.window, b.window);
  EXPECT_EQ(a.first_sample, b.first_sample);
  EXPECT_EQ(a.next_sample, b.next_sample);
  EXPECT_EQ(a.parts, b.parts);
  EXPECT_EQ(std::memcmp(&a.tally, &b.tally, sizeof a.tally), 0);
  EXPECT_TRUE(same_bits(a.pixels, b.pixels));
  EXPECT_TRUE(same_bits(a.moments, b.moments));
  EXPECT_TRUE(same_bits(a.features, b.features));
}

UnitResult result_of(const FilmPlan& plan) {
  UnitResult result;
  result.id = 1ull << 40, result.wall_ms = 3.25, result.error = "out of memory";
  result.warning = "a smaller pool";
  result.film = film_of(plan);
  RenderRun& run = result.run;
  run.kernel_ms = 1.5, run.waves = 77, run.samples_done = 9, run.ended_by = RunEnd::interrupted;
  run.stages = {{"shade", 0.25, 3}, {"", 1e300, ~0ull}};
  run.relative_error = 0.125;
  run.metropolis = MetropolisStats{1, 2, 3, 4.5, 5.5, 6.5, 7.5, 8.5, 9.5, 10.5};
  return result;
}

template <class T>
std::string bytes_of(const T& value) {
  ByteWriter writer;
  write(writer, value);
  return writer.take();
}

TEST(UnitMessage, UnitsOfAllFilmsStayAsTheyAre) {
  for (const FilmPlan& plan : film_plans()) {
    const Unit unit{1ull << 50, film_of(plan), 12};
    const std::string bytes = bytes_of(unit);
    ByteReader reader(bytes);
    const Unit read = read_unit(reader);
    reader.expect_end();
    EXPECT_EQ(read.id, unit.id);
    EXPECT_EQ(read.samples, unit.samples);
    expect_same(read.film, unit.film);
    EXPECT_TRUE(read.film.have(plan, read.film.window.pixel_count()));
  }
}

TEST(UnitMessage, AUnitWithoutSamplesIsSmall) {
  Unit unit{3, blank_film(8192, 8192), 12};
  const std::string bytes = bytes_of(unit);
  EXPECT_LT(bytes.size(), 1300u);
  ByteReader reader(bytes);
  expect_same(read_unit(reader).film, unit.film);
  unit.film.pixels.resize(1 << 16);  // of another film, to be used again
  EXPECT_EQ(bytes_of(unit), bytes);
}

TEST(UnitMessage, ResultsStayAsTheyAre) {
  for (const FilmPlan& plan : film_plans()) {
    const UnitResult result = result_of(plan);
    const std::string bytes = bytes_of(result);
    ByteReader reader(bytes);
    const UnitResult read = read_unit_result(reader);
    reader.expect_end();
    EXPECT_EQ(read.id, result.id);
    EXPECT_EQ(read.wall_ms, result.wall_ms);
    EXPECT_EQ(read.error, result.error);
    EXPECT_EQ(read.warning, result.warning);
    expect_same(read.film, result.film);
    EXPECT_EQ(bytes_of(read), bytes);  // the run as well, whose fields the next test looks at
  }
}

TEST(UnitMessage, RunsKeepTheirFields) {
  const std::string bytes = bytes_of(result_of({}));
  ByteReader reader(bytes);
  const RenderRun run = read_unit_result(reader).run;
  EXPECT_EQ(run.kernel_ms, 1.5);
  EXPECT_EQ(run.waves, 77u);
  EXPECT_EQ(run.samples_done, 9);
  EXPECT_EQ(run.ended_by, RunEnd::interrupted);
  ASSERT_EQ(run.stages.size(), 2u);
  EXPECT_EQ(run.stages[0].stage, "shade");
  EXPECT_EQ(run.stages[0].time_ms, 0.25);
  EXPECT_EQ(run.stages[0].launches, 3u);
  EXPECT_EQ(run.stages[1].launches, ~0ull);
  EXPECT_EQ(run.relative_error, 0.125);
  ASSERT_TRUE(run.metropolis);
  EXPECT_EQ(run.metropolis->chains, 1u);
  EXPECT_EQ(run.metropolis->brightness, 4.5);
  EXPECT_EQ(run.metropolis->mutations_per_s, 10.5);
}

TEST(UnitMessage, EveryNumberIsLittleEndian) {
  ByteWriter writer;
  writer.number(std::uint32_t{0x04030201});
  writer.number(1.0);
  writer.array(std::vector<FilmPixel>{{{0, 0, 2.0}, 0x0807060504030201}});
  const std::string bytes = writer.take();
  EXPECT_EQ(bytes.substr(0, 4), "\1\2\3\4");
  EXPECT_EQ(bytes.substr(4, 8), std::string("\0\0\0\0\0\0\xf0\x3f", 8));
  EXPECT_EQ(bytes.substr(12, 8), std::string("\1\0\0\0\0\0\0\0", 8));
  EXPECT_EQ(bytes.substr(12 + 8 + 16, 8), std::string("\0\0\0\0\0\0\0\x40", 8));
  EXPECT_EQ(bytes.substr(12 + 8 + 24), "\1\2\3\4\5\6\7\x08");
}

TEST(UnitMessage, EveryTruncationIsAnError) {
  const std::string bytes = bytes_of(result_of({5, true, true}));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ByteReader reader(std::string_view(bytes).substr(0, size));
    EXPECT_THROW(read_unit_result(reader), Error) << size;
  }
  ByteReader longer(std::string_view(bytes).substr(0, bytes.size()));
  read_unit_result(longer);
  EXPECT_NO_THROW(longer.expect_end());
  const std::string more = bytes + "x";
  ByteReader rest(more);
  read_unit_result(rest);
  EXPECT_THROW(rest.expect_end(), Error);
}

TEST(UnitMessage, NoFlippedBitIsWorseThanAnError) {
  const std::string bytes = bytes_of(result_of({1, true, false}));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (const char bit : {'\1', '\x80'}) {
      std::string bad = bytes;
      bad[i] = static_cast<char>(bad[i] ^ bit);
      ByteReader reader(bad);
      try {
        const Film film = read_unit_result(reader).film;
        EXPECT_EQ(film.pixels.size() % film.window.pixel_count(), 0u);
      } catch (const Error&) {
      }
    }
  }
}

TEST(UnitMessage, PlanesThatDoNotFitTheWindowAreRefused) {
  Film film = film_of({1, true, false});
  const auto refused = [](const Film& f) {
    const std::string bytes = bytes_of(f);
    ByteReader reader(bytes);
    EXPECT_THROW(read_film(reader), Error);
  };
  for (auto change : {+[](Film& f) { f.pixels.pop_back(); }, +[](Film& f) { f.moments.pop_back(); },
                      +[](Film& f) { f.features.pop_back(); }, +[](Film& f) { ++f.window.width; },
                      +[](Film& f) { f.pixels.clear(); }}) {
    Film bad = film;
    change(bad);
    refused(bad);
  }
}

TEST(UnitMessage, DevicesStayAsTheyAre) {
  RenderReport report;
  report.device_name = "NVIDIA H200", report.device_kind = "cuda", report.driver = "13.0";
  report.accel = "bvh8", report.schedule = "graph", report.stages = "fused";
  report.calibration = "fedc4321";
  report.plan = {{"--accel", "bvh8", "the fastest"}};
  report.pool_size = 1 << 20, report.finish_paths = 33, report.primitives = 1234567;
  report.setup_ms = 1, report.load_ms = 2, report.transfer_ms = 3;
  report.memory = {{"pool", 1ull << 36}};
  report.kernels = {{"shade", 61, 8, 1024, 256, 0.5}};
  ByteWriter writer;
  write_device(writer, report);
  const std::string bytes = writer.take();
  RenderReport read;
  read.scene_ms = 5;  // of this process, and to stay
  ByteReader reader(bytes);
  read_device(reader, read);
  reader.expect_end();
  EXPECT_EQ(read.device_name, report.device_name);
  EXPECT_EQ(read.device_kind, "cuda");
  EXPECT_EQ(read.driver, "13.0");
  EXPECT_EQ(read.accel + read.schedule + read.stages, "bvh8graphfused");
  EXPECT_EQ(read.plan, report.plan);
  EXPECT_EQ(read.pool_size, report.pool_size);
  EXPECT_EQ(read.calibration, "fedc4321");
  EXPECT_EQ(read.finish_paths, 33u);
  EXPECT_EQ(read.primitives, 1234567u);
  EXPECT_EQ(read.setup_ms + 10 * read.load_ms + 100 * read.transfer_ms, 321);
  EXPECT_EQ(read.scene_ms, 5);
  EXPECT_EQ(read.memory.at(0).name, "pool");
  EXPECT_EQ(read.memory.at(0).size_bytes, 1ull << 36);
  const KernelInfo& kernel = read.kernels.at(0);
  EXPECT_EQ(kernel.name, "shade");
  EXPECT_EQ(kernel.registers, 61);
  EXPECT_EQ(kernel.spill_bytes + kernel.shared_bytes, 8u + 1024u);
  EXPECT_EQ(kernel.block_threads, 256);
  EXPECT_EQ(kernel.occupancy, 0.5);
}

}  // namespace
}  // namespace pt
