#include "common/rays/ray_file.h"
#include "fuzz.h"
#include "fuzz_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const pt::FuzzFolder folder;
  const std::string path = folder.write("input", pt::as_bytes(data, size)).string();
  pt::expect_result_or_error([&] { pt::check_mesh(pt::read_trace_mesh(path)); });
  pt::expect_result_or_error([&] { pt::read_rays(path); });
  pt::expect_result_or_error([&] { pt::read_hits(path); });
  return 0;
}
