// A CSV table on disk that programs running at the same time append to.
#pragma once

#include <string>

#include "app/report/report.h"

namespace pt {

/// Throws Error when append_csv_row(path, row) could not work: the file's header is another one,
/// or file or folder cannot be written. Touches nothing and creates nothing.
void check_csv(const std::string& path, const CsvRow& row);

/// Appends the values, below the names if the file is new or empty. All in one write() under a
/// lock, so that rows of parallel runs neither interleave nor repeat the header. Throws Error, the
/// file as it was, when its header is another one or it cannot be written.
void append_csv_row(const std::string& path, const CsvRow& row);

}  // namespace pt
