// Flights in media with grids by persistent warps. A flight's steps are of two kinds, through a
// cell of majorants and at a collision, and how many it has of each is random: where each lane took
// one flight to its end, a warp would wait for the longest of them. So the warp votes, as for rays
// in a tree (Aila and Laine 2009, 'if-if'): its lanes walk until hardly any still does, then all
// that have got somewhere learn what they collide with, and lanes whose flights have ended begin
// others as soon as there are a few of them.
#pragma once

#include "common/accel/trace_cuda/persistent_cwbvh.cuh"
#include "common/medium/free_flight.h"

namespace pt {

/// A flight of a queue, in a lane.
struct LaneFlight {
  Ray ray;
  float t_max = 0.0f;
  std::uint32_t key = 0;        ///< flight_key
  std::uint32_t medium_id = 0;  ///< see Media
  std::uint32_t index = 0;      ///< in the queue
  std::uint32_t collisions = 0;
  ChannelDensities densities;
  Color beta = Color(1.0f);
};

/// Numbers [next, end) of a queue's flights that a warp has reserved; the same in all of its lanes.
struct FlightReserve {
  std::uint32_t next = 0, end = 0;
  bool has_more = true;  ///< there may be others in the queue

  /// Takes up to `wanted` flights, of which there are `all`: the first one's index is returned.
  /// `handed_out` counts them.
  __device__ std::uint32_t take(std::uint32_t* handed_out, std::uint32_t all, unsigned lane,
                                int wanted, int& count) {
    if (next == end) {
      const std::uint32_t left = end < all ? all - end : 0;
      const std::uint32_t batch = reserved_batch(left, gridDim.x * blockDim.x);
      std::uint32_t first = 0;
      if (lane == 0) first = atomicAdd(handed_out, batch);
      next = __shfl_sync(0xffffffffu, first, 0);
      end = min(next + batch, all);
      if (next >= all) end = next, has_more = false;
    }
    const std::uint32_t first = next;
    count = min(wanted, static_cast<int>(end - next));
    next += static_cast<std::uint32_t>(count);
    return first;
  }
};

/// Takes all flights of a queue to their ends, by all threads of the warp together; `has_sparse`:
/// see sample_grid(). `flights` has
///   take(reserve, lane, wanted, count)   as FlightReserve does
///   start(index, flight)                 false: that flight was done at once
///   medium(flight)
///   finish(flight, event, t)
template <bool has_sparse = false, class Flights>
__device__ void fly_by_warps(const VolumeGrids& grids, const Flights& flights) {
  using State = CellWalk::State;
  // By simulation of the flights of `cloud`, from thin to dense.
  constexpr int idle_most = 7, walking_least = 6;
  const unsigned lane = threadIdx.x & 31;
  const auto lanes_that = [](bool value) { return __ballot_sync(0xffffffffu, value); };
  FlightReserve reserve;
  LaneFlight flight;
  CellWalk walk;
  State state = State::idle;
  const VolumeGrid* grid = nullptr;
  for (;;) {
    const std::uint32_t idle = lanes_that(state == State::idle);
    int walking = __popc(lanes_that(state == State::walks));
    const int ended = 32 - walking - __popc(idle);
    bool begins = false;
    if (reserve.has_more && __popc(idle) > idle_most) {
      int count;
      const std::uint32_t first = flights.take(reserve, lane, __popc(idle), count);
      const int rank = __popc(idle & ((1u << lane) - 1));
      if (state == State::idle && rank < count) begins = flights.start(first + rank, flight);
      if (begins) {
        grid = grids.grids + flights.medium(flight).density_grid;
        walk = CellWalk(*grid, flight.ray, flight.t_max);
      }
    } else if (ended > 0 && walking < walking_least) {
      if (state == State::reaches_depth || state == State::arrives) {
        const MajorantWalk end = walk.result(state, flight.t_max);
        FreeFlight so_far{end.t, flight.collisions};
        const FlightEvent event =
            end_walk<has_sparse>(grids, flights.medium(flight), flight.ray, end,
                                 CollisionDraw(flight.key, so_far, flight.densities), so_far,
                                 flight.densities, flight.beta);
        flight.collisions = so_far.collisions;
        begins = event == FlightEvent::collides_with_nothing;
        if (!begins) flights.finish(flight, event, so_far.t), state = State::idle;
      }
    } else if (walking > 0) {
      do {
        if (state == State::walks) state = walk.step<has_sparse>(grids, *grid);
        walking = __popc(lanes_that(state == State::walks));
      } while (walking >= walking_least);
    } else {
      return;
    }
    if (begins) {
      lanes_of(flight.ray).count(LanePoint::flight);
      const FreeFlight so_far{walk.t(), flight.collisions};
      const CollisionDraw draw(flight.key, so_far, flight.densities);
      state = walk.begin(*grid, so_far.t, draw.depth(flights.medium(flight)));
    }
  }
}

}  // namespace pt
