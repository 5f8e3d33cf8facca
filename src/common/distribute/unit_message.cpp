#include "common/distribute/unit_message.h"

namespace pt {
namespace {

// Sent as they lie in memory, but for the order of bytes.
static_assert(sizeof(FilmPixel) == 4 * 8 && sizeof(PixelMoments) == 3 * 8);
static_assert(sizeof(PathTally) == (3 + path_length_bins) * 8 && sizeof(Window) == 4 * 4);
static_assert(sizeof(double) == 8 && sizeof(int) == 4);

void write(ByteWriter& writer, const Window& w) {
  for (const std::uint32_t number : {w.x, w.y, w.width, w.height}) writer.number(number);
}

Window read_window(ByteReader& reader) {
  Window w;
  for (std::uint32_t* number : {&w.x, &w.y, &w.width, &w.height}) reader.raw(number, 1);
  return w;
}

/// A FilmPlan has each plane once or twice, and all of them whole.
void check_planes(const Film& film) {
  const std::uint64_t count = film.window.pixel_count(), pixels = film.pixels.size();
  const bool has_pixels = pixels == count || pixels == 2 * count;
  const bool has_moments = film.moments.empty() || film.moments.size() == pixels;
  const bool has_features =
      film.features.empty() || (pixels > 0 && film.features.size() % pixels == 0);
  const bool is_blank = pixels == 0 && film.is_empty();
  if ((has_pixels || is_blank) && has_moments && has_features) return;
  throw Error("a message with a film whose planes do not fit its window");
}

template <class T, class Write>
void write_optional(ByteWriter& writer, const std::optional<T>& value, Write&& write_value) {
  writer.number(std::uint32_t{value.has_value()});
  if (value) write_value(*value);
}

template <class Read>
auto read_optional(ByteReader& reader, Read&& read) {
  std::optional<decltype(read())> value;
  if (reader.number<std::uint32_t>() != 0) value = read();
  return value;
}

/// The numbers of `m`, all of 8 bytes, for write and read alike.
template <class Stats, class Visit>
void for_each_number(Stats& m, Visit&& visit) {
  visit(m.chains), visit(m.mutations), visit(m.bootstrap), visit(m.brightness);
  visit(m.brightness_error), visit(m.large_share), visit(m.large_acceptance);
  visit(m.small_acceptance), visit(m.bootstrap_ms), visit(m.mutations_per_s);
}

void write(ByteWriter& writer, const RenderRun& run) {
  writer.number(run.kernel_ms);
  writer.list(run.stages, [&](const StageTime& stage) {
    writer.text(stage.stage), writer.number(stage.time_ms), writer.number(stage.launches);
  });
  writer.number(run.waves), writer.number(run.samples_done);
  writer.number(static_cast<std::uint32_t>(run.ended_by));
  write_optional(writer, run.relative_error, [&](double error) { writer.number(error); });
  write_optional(writer, run.metropolis, [&](const MetropolisStats& m) {
    for_each_number(m, [&](const auto& number) { writer.number(number); });
  });
}

RenderRun read_run(ByteReader& reader) {
  RenderRun run;
  reader.raw(&run.kernel_ms, 1);
  run.stages = reader.list([&] {
    StageTime stage{reader.text()};
    reader.raw(&stage.time_ms, 1), reader.raw(&stage.launches, 1);
    return stage;
  });
  reader.raw(&run.waves, 1), reader.raw(&run.samples_done, 1);
  const auto ended_by = reader.number<std::uint32_t>();
  if (ended_by > static_cast<std::uint32_t>(RunEnd::interrupted)) {
    throw Error("a message with a render that ended in no known way");
  }
  run.ended_by = static_cast<RunEnd>(ended_by);
  run.relative_error = read_optional(reader, [&] { return reader.number<double>(); });
  run.metropolis = read_optional(reader, [&] {
    MetropolisStats m;
    for_each_number(m, [&](auto& number) { reader.raw(&number, 1); });
    return m;
  });
  return run;
}

}  // namespace

void write(ByteWriter& writer, const Film& film) {
  write(writer, film.window);
  writer.number(film.first_sample), writer.number(film.next_sample);
  writer.raw(&film.tally, 1);
  writer.list(film.parts, [&](const Window& part) { write(writer, part); });
  const FilmSums none;
  const FilmSums& sums = film.is_empty() ? none : film;
  writer.array(sums.pixels), writer.array(sums.moments), writer.array(sums.features);
}

Film read_film(ByteReader& reader) {
  Film film;
  film.window = read_window(reader);
  reader.raw(&film.first_sample, 1), reader.raw(&film.next_sample, 1);
  reader.raw(&film.tally, 1);
  film.parts = reader.list([&] { return read_window(reader); });
  film.pixels = reader.array<FilmPixel>();
  film.moments = reader.array<PixelMoments>();
  film.features = reader.array<double>();
  check_planes(film);
  return film;
}

void write(ByteWriter& writer, const Unit& unit) {
  writer.number(unit.id), writer.number(unit.samples);
  write(writer, unit.film);
}

Unit read_unit(ByteReader& reader) {
  Unit unit;
  reader.raw(&unit.id, 1), reader.raw(&unit.samples, 1);
  unit.film = read_film(reader);
  return unit;
}

void write(ByteWriter& writer, const UnitResult& result) {
  writer.number(result.id), writer.number(result.wall_ms), writer.text(result.error),
      writer.text(result.warning);
  write(writer, result.run);
  write(writer, result.film);
}

UnitResult read_unit_result(ByteReader& reader) {
  UnitResult result;
  reader.raw(&result.id, 1), reader.raw(&result.wall_ms, 1);
  result.error = reader.text();
  result.warning = reader.text();
  result.run = read_run(reader);
  result.film = read_film(reader);
  return result;
}

void write_device(ByteWriter& writer, const RenderReport& report) {
  for (const std::string* text :
       {&report.device_name, &report.device_kind, &report.driver, &report.accel, &report.schedule,
        &report.stages, &report.calibration}) {
    writer.text(*text);
  }
  writer.list(report.plan, [&](const Decision& decision) {
    writer.text(decision.option), writer.text(decision.value), writer.text(decision.reason);
  });
  writer.number(report.pool_size), writer.number(report.finish_paths);
  writer.number(report.primitives);
  writer.number(report.setup_ms), writer.number(report.load_ms), writer.number(report.transfer_ms);
  writer.list(report.memory, [&](const BufferSize& buffer) {
    writer.text(buffer.name), writer.number(buffer.size_bytes);
  });
  writer.list(report.kernels, [&](const KernelInfo& kernel) {
    writer.text(kernel.name), writer.number(kernel.registers), writer.number(kernel.spill_bytes);
    writer.number(kernel.shared_bytes), writer.number(kernel.block_threads);
    writer.number(kernel.occupancy);
  });
}

void read_device(ByteReader& reader, RenderReport& report) {
  for (std::string* text : {&report.device_name, &report.device_kind, &report.driver, &report.accel,
                            &report.schedule, &report.stages, &report.calibration}) {
    *text = reader.text();
  }
  report.plan = reader.list([&] {
    Decision decision;
    decision.option = reader.text(), decision.value = reader.text();
    decision.reason = reader.text();
    return decision;
  });
  reader.raw(&report.pool_size, 1), reader.raw(&report.finish_paths, 1);
  reader.raw(&report.primitives, 1);
  reader.raw(&report.setup_ms, 1), reader.raw(&report.load_ms, 1);
  reader.raw(&report.transfer_ms, 1);
  report.memory = reader.list([&] {
    BufferSize buffer{reader.text()};
    reader.raw(&buffer.size_bytes, 1);
    return buffer;
  });
  report.kernels = reader.list([&] {
    KernelInfo kernel{reader.text()};
    reader.raw(&kernel.registers, 1), reader.raw(&kernel.spill_bytes, 1);
    reader.raw(&kernel.shared_bytes, 1), reader.raw(&kernel.block_threads, 1);
    reader.raw(&kernel.occupancy, 1);
    return kernel;
  });
}

}  // namespace pt
