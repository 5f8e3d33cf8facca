// Flights by warps, emulated: whichever of them a lane takes up, and however often, each ends as it
// does by itself.
#include <gtest/gtest.h>

// The emulation comes before what it emulates.
// clang-format off
#include "emulated_gpu.h"
#include "wavefront/flight_warp.cuh"
// clang-format on

#include "medium/volume_cases.h"

namespace pt {
namespace {

/// How a flight ends.
struct EndedFlight {
  FlightEvent event{};
  float t = -1;
  LaneFlight flight;
  int ends = 0;  ///< how often
};

/// A queue of flights through medium 0 of a scene, every seventh of which is done at once.
struct Flights {
  const SceneData& scene;
  std::vector<LaneFlight> queue;
  mutable std::uint32_t next = 0;
  mutable std::vector<EndedFlight> ended;

  Flights(const SceneData& data, TestRandom& random, std::uint32_t count) : scene(data) {
    const Affine to_world = inverse(scene.grids[0].to_unit);
    for (std::uint32_t i = 0; i < count; ++i) {
      LaneFlight flight;
      flight.ray = random_ray(random, to_world);
      flight.t_max = i % 3 == 0 ? static_cast<float>(random.uniform(0, 3)) : infinite_distance;
      flight.key = random.bits(), flight.index = i;
      flight.beta = Color(0.5f + static_cast<float>(i % 5));
      queue.push_back(flight);
    }
    ended.resize(count);
  }

  static bool is_done_at_once(std::uint32_t index) { return index % 7 == 0; }
  const Medium& medium(const LaneFlight&) const { return scene.media[0]; }

  std::uint32_t take(FlightReserve& reserve, unsigned lane, int wanted, int& count) const {
    return reserve.take(&next, static_cast<std::uint32_t>(queue.size()), lane, wanted, count);
  }
  bool start(std::uint32_t index, LaneFlight& flight) const {
    if (is_done_at_once(index)) {
      ++ended[index].ends;
      return false;
    }
    flight = queue[index];
    return true;
  }
  void finish(const LaneFlight& flight, FlightEvent event, float t) const {
    EndedFlight& end = ended[flight.index];
    end = {event, t, flight, end.ends + 1};
  }

  EndedFlight alone(std::uint32_t index) const {
    EndedFlight end{{}, 0, queue[index], 1};
    LaneFlight& flight = end.flight;
    FreeFlight so_far;
    do {
      end.event = fly_to_collision(grids_of(scene), scene.media[0], flight.ray, flight.t_max,
                                   flight.key, so_far, flight.densities, flight.beta);
    } while (end.event == FlightEvent::collides_with_nothing);
    end.t = so_far.t, flight.collisions = so_far.collisions;
    return end;
  }
};

SceneData scene_with_grid(TestRandom& random, const Color& extinction, std::uint32_t channels) {
  SceneData scene;
  Medium medium;
  medium.extinction = extinction;
  medium.density_grid = add_grid(
      scene, random_volume(random, {24, 17, 30}, channels, channels == 1, random_place(random)));
  scene.media.push_back(medium);
  prepare_media(scene);
  return scene;
}

void expect_each_alone(const Flights& flights) {
  int collided = 0;
  for (std::uint32_t i = 0; i < flights.queue.size(); ++i) {
    const EndedFlight& ended = flights.ended[i];
    ASSERT_EQ(ended.ends, 1) << i;
    if (Flights::is_done_at_once(i)) continue;
    const EndedFlight alone = flights.alone(i);
    ASSERT_EQ(ended.event, alone.event) << i;
    EXPECT_EQ(ended.t, alone.t) << i;
    EXPECT_EQ(ended.flight.collisions, alone.flight.collisions) << i;
    EXPECT_EQ(ended.flight.beta, alone.flight.beta) << i;
    EXPECT_EQ(ended.flight.densities.red, alone.flight.densities.red) << i;
    collided += alone.event == FlightEvent::collides ? 1 : 0;
  }
  if (flights.queue.size() > 100) {
    EXPECT_GT(collided, 10);
    EXPECT_LT(collided + 10, static_cast<int>(flights.queue.size()));
  }
}

TEST(FlightWarps, TakeEachFlightToItsEnd) {
  TestRandom random(91);
  for (const Color& extinction : {Color(0.3f), Color(8.0f), Color(0.5f, 2.0f, 6.0f)}) {
    for (const std::uint32_t channels : {1u, 3u}) {
      const SceneData scene = scene_with_grid(random, extinction, channels);
      for (const std::uint32_t count : {0u, 1u, 31u, 32u, 33u, 1500u}) {
        const Flights flights(scene, random, count);
        EmulatedBlock(64).run([&] { fly_by_warps(grids_of(scene), flights); });
        expect_each_alone(flights);
        if (HasFailure()) return;
      }
    }
  }
}

}  // namespace
}  // namespace pt
