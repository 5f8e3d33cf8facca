// Numbers of the sky's and the sun's radiance: see scripts/bake_sunsky.py.
#pragma once

namespace pt {

inline constexpr int sun_node_count = 129;

// By turbidity (1 to 10) and the ground's albedo (0, 1), control points over the sun's elevation,
// and channel. Radiances are in Mitsuba's units.
extern const float sky_shapes[10 * 2 * 6 * 3 * 9];
extern const float sky_radiances[10 * 2 * 6 * 3];
/// By turbidity, elevation pi / 2 (i / 128)^3 and channel: across the rays.
extern const float sun_irradiances[10 * sun_node_count * 3];

}  // namespace pt
