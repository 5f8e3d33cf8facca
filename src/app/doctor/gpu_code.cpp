#include <charconv>

#include "app/doctor/checks.h"
#include "app/options/option_values.h"

namespace pt {

GpuCode code_for(const std::string& architectures, int major, int minor) {
  const int wanted = 10 * major + minor;
  GpuCode best = GpuCode::none;
  for (const std::string& one : split(architectures, ';')) {
    int number = 0;
    const char* end = one.data() + one.size();
    const auto [stop, error] = std::from_chars(one.data(), end, number);
    if (error != std::errc()) {  // "native", "all"
      if (best == GpuCode::none) best = GpuCode::unknown;
      continue;
    }
    // 90a is for that GPU alone, 100f for those of its generation.
    const bool is_specific = stop != end && *stop == 'a', is_family = stop != end && *stop == 'f';
    const std::string_view form(stop + (is_specific || is_family), end);
    const bool in_family = !is_specific && number / 10 == major && number <= wanted;
    if (form != "-virtual" && (number == wanted || in_family)) return GpuCode::machine;
    const bool compiles = is_specific ? number == wanted : is_family ? in_family : number <= wanted;
    if (form != "-real" && compiles) best = GpuCode::ptx;
  }
  return best;
}

}  // namespace pt
