// Units, their results and reports of devices as bytes, to be sent to other processes. Exact: no
// bit of a sum changes on the way. Readers throw Error for bytes that are cut off or make no sense.
#pragma once

#include "common/distribute/bytes.h"
#include "common/distribute/worker.h"

namespace pt {

void write(ByteWriter& writer, const Film& film);
Film read_film(ByteReader& reader);

void write(ByteWriter& writer, const Unit& unit);
Unit read_unit(ByteReader& reader);

void write(ByteWriter& writer, const UnitResult& result);
UnitResult read_unit_result(ByteReader& reader);

/// What Worker::describe() says: device, plan, memory, kernels and set-up times.
void write_device(ByteWriter& writer, const RenderReport& report);
/// Replaces these fields and leaves the others.
void read_device(ByteReader& reader, RenderReport& report);

}  // namespace pt
