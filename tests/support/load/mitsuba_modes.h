// One image of a Mitsuba scene in all modes.
#pragma once

#include <gtest/gtest.h>

#include <cstring>

#include "load/mitsuba_scene.h"
#include "mode_cases.h"

namespace pt {

/// On the CPU, from the elements of a <scene>: all modes and structures give the serial mode's
/// bits.
inline void expect_modes_are_equal(const std::string& elements) {
  SCOPED_TRACE(elements);
  const TempFolder folder;
  write_text(folder.file("scene.xml"), "<scene version='3.0.0'>" + elements + "</scene>");
  const auto image = [&](Settings more) {
    const Settings settings = {{"scene", folder.file("scene.xml")},
                               {"width", "24"},
                               {"height", "20"},
                               {"spp", "3"},
                               {"device", "cpu"},
                               {"max-depth", "4"}};
    more.insert(more.begin(), settings.begin(), settings.end());
    return render_options(with(Options(), more)).image;
  };
  const Image serial = image({{"mode", "serial"}});
  for (const Settings& more : std::vector<Settings>{{{"mode", "megakernel"}},
                                                    {{"mode", "wavefront"}},
                                                    {{"mode", "wavefront"}, {"accel", "cwbvh"}},
                                                    {{"mode", "wavefront"}, {"accel", "brute"}}}) {
    const Image other = image(more);
    ASSERT_EQ(std::memcmp(serial.pixel(0, 0), other.pixel(0, 0), 24 * 20 * 3 * sizeof(float)), 0)
        << more[0].second << more.size();
  }
}

}  // namespace pt
