// Real scenes, which are not part of the repository: tests that use them skip where they are
// absent.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace pt {

/// A path in the folder $PTEXP_SHARED, or in `shared` beside the repository.
inline std::string shared_file(const std::string& name) {
  if (const char* folder = std::getenv("PTEXP_SHARED")) return folder + ("/" + name);
  const auto repository = std::filesystem::path(__FILE__).parent_path().parent_path();
  return (repository.parent_path() / "shared" / name).string();
}

}  // namespace pt
