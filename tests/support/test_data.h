// Files of tests/data.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace pt {

/// In the folder $PTEXP_TEST_DATA, which ctest sets, or below the nearest parent of the test
/// program that has tests/data: the build lies in the checkout.
inline std::string test_data(const std::string& name) {
  if (const char* folder = std::getenv("PTEXP_TEST_DATA")) return folder + ("/" + name);
  std::filesystem::path folder = std::filesystem::canonical("/proc/self/exe").parent_path();
  while (!exists(folder / "tests" / "data") && folder != folder.root_path()) {
    folder = folder.parent_path();
  }
  return (folder / "tests" / "data" / name).string();
}

}  // namespace pt
