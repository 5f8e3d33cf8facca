// The times of stages on the CPU are shares of the render's: threads that work side by side do not
// make it longer.
#include <numeric>

#include "mode_cases.h"

namespace pt {
namespace {

TEST(StageTimes, AddUpToTheRender) {
  for (const char* threads : {"1", "2"}) {
    for (const std::string& mode : names_of(Mode::serial)) {
      const Rendered found = render_options(with(Options(), {{"device", "cpu"},
                                                             {"scene", "cornell"},
                                                             {"width", "128"},
                                                             {"height", "96"},
                                                             {"spp", "16"},
                                                             {"mode", mode},
                                                             {"threads", threads}}));
      const double sum = std::accumulate(
          found.run.stages.begin(), found.run.stages.end(), 0.0,
          [](double before, const StageTime& stage) { return before + stage.time_ms; });
      EXPECT_LE(sum, 1.02 * found.run.kernel_ms) << mode << ", threads " << threads;
      EXPECT_GE(sum, 0.2 * found.run.kernel_ms) << mode << ", threads " << threads;
    }
  }
}

}  // namespace
}  // namespace pt
