// A CSV table on disk, to which programs that run at the same time append; and the columns that
// tell where a row comes from.
#pragma once

#include <string>

#include "app/report/report.h"
#include "common/device/devices.h"

namespace pt {

/// Throws Error if append_csv_row(path, row) would fail: the file has another header, or file or
/// folder cannot be written. Changes and creates nothing.
void check_csv(const std::string& path, const CsvRow& row);

/// Appends the values, below the names if the file is new or empty, in one write() under a lock, so
/// that rows of parallel runs neither interleave nor repeat the header. Throws Error, and leaves
/// the file as it was, if it has another header or cannot be written.
void append_csv_row(const std::string& path, const CsvRow& row);

/// Version, commit, compiler and options of the build.
CsvRow build_columns();

/// The first columns of a subcommand: program, command and device. `threads`: of the CPU.
CsvRow origin_columns(const std::string& command_line, const DeviceInfo& device, int threads);

}  // namespace pt
