#include "common/distribute/unit_message.h"

namespace pt {

void write_device(ByteWriter& writer, const RenderReport& report) {
  for (const std::string* text : {&report.device_name, &report.device_kind, &report.driver,
                                  &report.accel, &report.schedule, &report.stages}) {
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
                            &report.schedule, &report.stages}) {
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
