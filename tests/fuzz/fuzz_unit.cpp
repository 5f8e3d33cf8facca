// Messages between the ranks of a job.
#include "common/distribute/unit_message.h"
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = pt::as_bytes(data, size);
  pt::expect_result_or_error([&] {
    pt::ByteReader reader(bytes);
    pt::read_unit(reader);
    reader.expect_end();
  });
  pt::expect_result_or_error([&] {
    pt::ByteReader reader(bytes);
    pt::read_unit_result(reader);
    reader.expect_end();
  });
  return 0;
}
