// The stages: whatever has a time of its own. Whoever lists them (queues, tags, clocks, option
// --stage-block, columns of the reports) reads this table; a new one is a line here and its
// functor.
#pragma once

#include <array>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>

namespace pt {

// In the order in which a wave runs them, then what else takes time:
//   name, in whose queue its slots wait (`idle`: it takes none), whether --stage-block has it
#define PT_STAGES(STAGE)                    \
  STAGE(generate, generate, true)           \
  STAGE(mutate, generate, true)             \
  STAGE(intersect, intersect, true)         \
  STAGE(route_hits, intersect, true)        \
  STAGE(sample_medium, sample_medium, true) \
  STAGE(shade_miss, shade_miss, true)       \
  STAGE(shade_surface, shade_surface, true) \
  STAGE(shade_medium, shade_medium, true)   \
  STAGE(shadow, shadow, true)               \
  STAGE(bounce, intersect, true)            \
  STAGE(hand_over, intersect, true)         \
  STAGE(finish, intersect, true)            \
  STAGE(features, idle, false)              \
  STAGE(accumulate, idle, true)             \
  STAGE(compact, idle, false)               \
  STAGE(order_surfaces, idle, false)        \
  STAGE(begin_wave, idle, false)            \
  STAGE(megakernel, idle, false)            \
  STAGE(serial, idle, false)                \
  STAGE(render_init, idle, false)

/// A stage; as the tag of a slot, the one in whose queue the slot waits. `idle`: none of them.
#define PT_STAGE_ENUMERATOR(name, queue, has_block) name,
enum class StageId : std::uint8_t { PT_STAGES(PT_STAGE_ENUMERATOR) idle };
#undef PT_STAGE_ENUMERATOR

struct StageInfo {
  StageId id;
  std::string_view name;  ///< ends with 0
  StageId queue;          ///< where its slots wait
  bool has_block;         ///< --stage-block sets its threads per block

  constexpr bool has_own_queue() const { return queue == id; }
};

#define PT_STAGE_ROW(name, queue, has_block) {StageId::name, #name, StageId::queue, has_block},
inline constexpr StageInfo stage_table[] = {PT_STAGES(PT_STAGE_ROW)};
#undef PT_STAGE_ROW
#undef PT_STAGES
inline constexpr int stage_count = static_cast<int>(std::size(stage_table));

/// Of all but StageId::idle.
constexpr const StageInfo& stage_info(StageId id) { return stage_table[static_cast<int>(id)]; }

inline std::string to_string(StageId id) {
  return id == StageId::idle ? "idle" : std::string(stage_info(id).name);
}

inline constexpr int queue_count = [] {
  int count = 0;
  for (const StageInfo& stage : stage_table) count += stage.has_own_queue() ? 1 : 0;
  return count;
}();

/// [StageId] queue_index.
inline constexpr auto queue_indices = [] {
  std::array<std::uint8_t, stage_count> indices{};
  for (const StageInfo& stage : stage_table) {
    int index = 0;
    for (const StageInfo& other : stage_table) {
      if (other.id == stage.queue) break;
      index += other.has_own_queue() ? 1 : 0;
    }
    indices[static_cast<std::size_t>(stage.id)] = static_cast<std::uint8_t>(index);
  }
  return indices;
}();

/// The number of the queue in which the slots of this stage wait: queues stand side by side, in the
/// order of the table. queue_count for a stage that takes none.
constexpr int queue_index(StageId id) { return queue_indices[static_cast<std::size_t>(id)]; }

/// The same for code that runs on a device.
template <StageId id>
inline constexpr int queue_of = queue_index(id);

}  // namespace pt
