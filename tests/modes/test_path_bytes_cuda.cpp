// --path-bytes on a GPU: all kernels that carry more state give the image of the loop without.
#include "common/plan/kernels.h"
#include "cuda_test.h"
#include "mode_cases.h"

namespace pt {
namespace {

class CudaPathBytes : public CudaTest, public testing::WithParamInterface<ImageKind> {
 protected:
  void SetUp() override {
    CudaTest::SetUp();
    if (!has_carrying_kernels) GTEST_SKIP() << "not in a build without PTEXP_PATH_STATE";
  }

  Rendered render(const std::string& mode, const Settings& more) const {
    Settings settings{{"width", "131"}, {"height", "97"}, {"spp", "7"}, {"max-depth", "6"}};
    settings.insert(settings.end(), GetParam().settings.begin(), GetParam().settings.end());
    const Options options = with(cuda_options(mode, settings), more);
    SCOPED_TRACE(command_of(options));
    const Rendered rendered = render_options(options);
    expect_plausible(rendered, options);
    return rendered;
  }
};
INSTANTIATE_TEST_SUITE_P(
    Cuda, CudaPathBytes,
    testing::Values(ImageKind{"boxes", {{"scene", "boxes"}}},
                    ImageKind{"statue", {{"scene", "statue:3K"}}},
                    ImageKind{"closed_dial", {{"scene", "dial:14:0:closed"}, {"max-depth", "20"}}},
                    ImageKind{"open_dial", {{"scene", "dial:6:0:open"}}},
                    ImageKind{"cornell", {{"scene", "cornell"}, {"kernel-set", "general"}}},
                    ImageKind{"camera_rays", {{"scene", "boxes"}, {"max-depth", "1"}}},
                    ImageKind{"roulette", {{"scene", "boxes"}, {"rr", "2"}, {"max-depth", "30"}}}),
    [](const auto& kind) { return kind.param.name; });

TEST_P(CudaPathBytes, LeaveTheImageAsItIs) {
  const Rendered expected = render("megakernel", {{"kernel", "loop"}});
  for (const char* bytes : {"0", "32", "64", "128", "256"}) {
    SCOPED_TRACE(bytes);
    expect_same(render("megakernel", {{"kernel", "loop"}, {"path-bytes", bytes}}), expected);
  }
  for (const char* bytes : {"0", "16", "32", "144", "256"}) {
    SCOPED_TRACE(bytes);
    for (const char* block : {"32x1", "16x16"}) {
      expect_same(
          render("megakernel", {{"kernel", "vote"}, {"block", block}, {"path-bytes", bytes}}),
          expected);
    }
    expect_same(render("megakernel", {{"kernel", "sort"}, {"path-bytes", bytes}}), expected);
    for (const char* layout : {"soa", "sectors", "aos"}) {
      // All by blocks; a few by blocks; none. A pool for all paths, and one that is used again.
      for (const char* finished : {"auto", "700", "0"}) {
        for (const char* pool : {"auto", "9000"}) {
          expect_same(render("wavefront", {{"layout", layout},
                                           {"finish-paths", finished},
                                           {"pool-size", pool},
                                           {"path-bytes", bytes}}),
                      expected);
        }
      }
    }
  }
}

class CudaPathBytesRefusal : public CudaTest {};

TEST_F(CudaPathBytesRefusal, NamesWhatThereIs) {
  const auto refusal = [](const Settings& more) {
    Settings settings{{"device", "cuda"}, {"width", "8"}, {"height", "8"}, {"scene", "boxes"}};
    settings.insert(settings.end(), more.begin(), more.end());
    return refusal_of(settings);
  };
  const Settings loop{{"mode", "megakernel"}, {"kernel", "loop"}, {"path-bytes", "48"}};
  if (!has_carrying_kernels) {
    EXPECT_NE(refusal(loop).find("-DPTEXP_PATH_STATE=ON"), std::string::npos) << refusal(loop);
    return;
  }
  EXPECT_NE(refusal(loop).find("expected --path-bytes 32 or 64 or 128 or 256"), std::string::npos)
      << refusal(loop);
  const Settings lean{{"scene", "spheres"}, {"path-bytes", "32"}};
  EXPECT_NE(refusal(lean).find("expected --kernel-set general"), std::string::npos)
      << refusal(lean);
}

}  // namespace
}  // namespace pt
