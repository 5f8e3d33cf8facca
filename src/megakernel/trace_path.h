// The megakernel's body: one thread follows whole paths, everything in registers.
#pragma once

#include "common/film/film.h"
#include "common/transport/extra_state.h"
#include "common/transport/path_step.h"

namespace pt {

/// Traces paths until `work` has no more. A thread whose path ends takes the next one at once and
/// does not wait for the other paths of its warp, so there is one iteration per ray, not per
/// path: it draws the numbers that decide the ray, then makes it (at the camera or at the last
/// hit), then traces it. The parts that every thread needs, the draw and the intersection, are
/// executed together whatever each path's length.
///
/// `Work` hands out paths: `bool next(std::uint32_t& path_index, bool wanted)` is called by all
/// threads of a warp together; where `wanted`, it names a new path or returns false; elsewhere it
/// returns true. `bool any(bool)` is true when the argument is true for any thread of the warp.
template <class Traits, Branching branching, class Source, class Work>
PT_HD_IN_KERNEL void trace_paths(const Scene& scene, const Source& source,
                                 const SampleBuffer& samples, const PathSettings& settings,
                                 Work& work) {
  PathState path;
  bool working = work.next(path.index, true);
  PathId id = samples.id_of(path.index);
  set_time<Traits>(scene, id, path);
  typename Source::Stream random = source.open(id);
  Color radiance(0.0f);
  Ray ray;
  Hit hit;
  ExtraRegisters<extra_records_of<Source>()> extra(settings);
  const auto path_key = [&] { return path_hash<Traits>(scene, id); };
  PathRegisters<Traits, decltype(path_key)> registers{scene, path_key, radiance, ray};
  while (work.any(working)) {
    bool ended = false;
    if (working) {
      lanes_of(scene).at(path.rays).count(LanePoint::iteration);
      const Vec4 u = random.draw(scatter_block(path.rays));
      if (path.rays == 0) {
        ray = generate_camera_path<Traits::has_motion>(scene, random, id.pixel, u, path.time);
        extra.begin(path.index);
      } else {
        const EagerShading policy = eager_shading<Traits>(u, random, path);
        if constexpr (branching == Branching::reduced) {
          shade_without_branches<Traits>(scene, ray, hit, path, settings, policy, registers);
        } else {
          shade_vertex<Traits>(scene, ray, hit, path, settings, policy, registers);
        }
        ended = !registers.alive;
        if (!ended) extra.step();
      }
      if (!ended) {
        hit = next_hit<Traits>(scene, ray, path_key(), path);
        ++path.rays;
        if (branching == Branching::divergent && hit.is_miss()) {
          shade_miss<Traits::lighting>(scene, ray.direction, path, settings, registers);
          ended = true;
        }
      }
      if (ended) samples.store(path, extra.is_whole(path) ? radiance : broken_radiance());
    }
    if (work.any(ended)) {
      std::uint32_t path_index = path.index;
      const bool has_path = work.next(path_index, ended);
      if (ended) {
        working = has_path;
        path = PathState{};
        path.index = path_index;
        id = samples.id_of(path_index);
        random = source.open(id);
        set_time<Traits>(scene, id, path);
        radiance = Color(0.0f);
      }
    }
  }
}

}  // namespace pt
