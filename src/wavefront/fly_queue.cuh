// The flights of a queue, by persistent warps: for media with grids, where a thread per flight
// would wait for the longest of its warp.
#pragma once

#include "common/device/cuda/stage_stamp.cuh"
#include "wavefront/flight_warp.cuh"
#include "wavefront/wave_steps.h"

namespace pt {

/// The flights of the paths in the stage's queue; `index` is that of a slot in it.
struct QueuedFlights {
  Scene scene;
  PathPool pool;
  SampleBuffer samples;
  StageQueues queues;
  std::uint32_t* next;  ///< flights of the queue that are handed out so far

  __device__ std::uint32_t take(FlightReserve& reserve, unsigned lane, int wanted,
                                int& count) const {
    return reserve.take(next, *queues.count, lane, wanted, count);
  }

  __device__ const Medium& medium(const LaneFlight& flight) const {
    return *scene.media.at(flight.medium_id);
  }

  /// One in a homogeneous medium is a single step.
  __device__ bool start(std::uint32_t index, LaneFlight& flight) const {
    const std::uint32_t slot = queues.slots[index];
    PathState path = load(slot, flight.ray);
    set_lanes(flight.ray, pool.path_lanes(lanes_of(scene), slot));
    flight.t_max = pool.load_hit(slot).t;
    flight.key = flight_key(media_key(scene, samples, path.index), path.rays);
    flight.medium_id = path.medium.id;
    flight.index = index;
    const Medium& around = medium(flight);
    if (around.is_homogeneous()) {
      FreeFlight end;
      const FlightEvent event = fly_homogeneous(scene, around.extinction, flight.ray, flight.t_max,
                                                flight.key, end, path);
      store(slot, flight.ray, path, event, end.t);
      return false;
    }
    flight.collisions = 0, flight.densities = path.medium.densities, flight.beta = path.beta;
    return true;
  }

  __device__ void finish(const LaneFlight& flight, FlightEvent event, float t) const {
    const std::uint32_t slot = queues.slots[flight.index];
    Ray ray;
    PathState path = load(slot, ray);
    path.medium.densities = flight.densities;
    path.beta = flight.beta;
    store(slot, ray, path, event, t);
  }

 private:
  __device__ PathState load(std::uint32_t slot, Ray& ray) const {
    PathState path = pool.load_path(slot, ray);
    pool.load_medium(slot, path);
    begin_flight(scene, path);
    return path;
  }

  __device__ void store(std::uint32_t slot, const Ray& ray, const PathState& path,
                        FlightEvent event, float t) const {
    pool.store_path(slot, ray, path);
    pool.store_medium(slot, path);
    if (event == FlightEvent::collides) pool.store_hit(slot, {t, medium_collision, 0});
  }
};

inline constexpr int flight_block = 128;

template <class Flights, bool has_sparse>
__global__ void __launch_bounds__(flight_block, 6)
    fly_flights_of_queue(const __grid_constant__ Flights flights, StageClock* clock) {
  stamp_first_thread(clock, StageId::sample_medium);
  if (*flights.queues.count == 0) return;
  fly_by_warps<has_sparse>(flights.scene.grids, flights);
}

}  // namespace pt
