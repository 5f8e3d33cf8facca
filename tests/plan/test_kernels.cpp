// The table of kernels: each row can be rendered, and what no row has is refused with one that has.
#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "app/options/option_values.h"
#include "common/plan/kernels.h"
#include "kernel_cases.h"

namespace pt {
namespace {

TEST(Kernels, EachOfTheCpuRenders) { render_by_each_kernel(false); }

/// Calls function(need) for all needs that a plan can have, of scenes with these contents.
template <class Function>
void for_each_need(EnumSet<Content> contents, Function&& function) {
  for (const bool on_cuda : {false, true})
    for (int body = 0; body < 8; ++body)
      for (int accel = 0; accel < 5; ++accel)
        for (int source = 0; source < 3; ++source)
          for (int memory = 1; memory < 4; ++memory)
            for (const Branching branching : {Branching::divergent, Branching::reduced}) {
              KernelNeed need{
                  on_cuda,   KernelBody{body}, {}, NumberSource{source}, SceneMemory{memory},
                  branching, contents};
              for (const Lighting light : {Lighting::sky, Lighting::emitters}) {
                need.scene = {Accel{accel}, Geometry::spheres_and_quads, light};
                function(need);
              }
              for (const bool masks : {false, true}) {
                for (const bool media : {false, true}) {
                  need.scene = general_traits(Accel{accel}, contents, masks, media,
                                              on_cuda && (masks || media), true);
                  function(need);
                  for (const bool sparse : {false, on_cuda && media}) {
                    need.scene = general_traits(Accel{accel}, contents, masks, media, sparse);
                    function(need);
                  }
                }
              }
            }
}

TEST(Kernels, ARefusalNamesAKernelOfTheSameScene) {
  int refused = 0;
  for (const EnumSet<Content> contents :
       {EnumSet<Content>{}, EnumSet<Content>{Content::spheres},
        EnumSet<Content>{Content::instances, Content::open_boundaries}}) {
    for_each_need(contents, [&](const KernelNeed& need) {
      if (has_kernel(need)) return;
      ++refused;
      for (const EnumSet<KernelChoice> asked :
           {EnumSet<KernelChoice>{}, EnumSet<KernelChoice>{KernelChoice::accel}}) {
        const NearestKernel nearest = nearest_kernel(need, asked);
        ASSERT_FALSE(nearest.refused.empty());
        // What is expected, option by option, makes a need that is served.
        KernelNeed other = need;
        std::istringstream words(
            std::regex_replace(nearest.expected, std::regex(" or [a-z0-9]+"), ""));
        std::string option, value;
        while (words >> option >> value) {
          if (value.ends_with(',')) value.pop_back();
          if (option == "--accel") {
            const auto& s = need.scene;
            const Accel accel = accel_of(parse_name<AccelKind>("accel", value));
            if (s.geometry != Geometry::spheres_and_quads)
              other.scene = general_traits(accel, need.contents, s.has_masks, s.has_media,
                                           s.has_sparse, s.has_motion);
            other.scene.accel = accel;
          } else if (option == "--scene-memory") {
            other.memory = parse_name<SceneMemory>("scene-memory", value);
          } else if (option == "--branching") {
            other.branching = parse_name<Branching>("branching", value);
          } else if (option == "--rng") {
            other.sources = value == "xorwow"
                                ? EnumSet{NumberSource::xorwow}
                                : EnumSet{NumberSource::philox, NumberSource::sampler};
          } else {  // of a body
            other.bodies = {};
            for (int body = 0; body < 8; ++body)
              for (const auto& [name, its] : settings_of(KernelBody{body}))
                if ("--" + name == option && its == value)
                  other.bodies = other.bodies | KernelBody{body};
            if (option == "--persistent") other.bodies = KernelBody::warps;
          }
        }
        ASSERT_TRUE(has_kernel(other)) << nearest.refused << " -> " << nearest.expected;
      }
    });
  }
  EXPECT_GT(refused, 1000);
}

TEST(Kernels, TheListHasALineForEachRow) {
  const std::string list = kernel_list();
  EXPECT_EQ(std::ranges::count(list, '\n'), std::ssize(kernel_table) + 1);
  EXPECT_NE(list.find("cuda    megakernel vote, megakernel sort, wavefront warps"),
            std::string::npos)
      << list;
  EXPECT_NE(list.find("all primitives, masks; no spheres, instances"), std::string::npos);
}

}  // namespace
}  // namespace pt
