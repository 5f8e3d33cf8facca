// The compaction strategies, one line each. wavefront/compaction/compaction.h says what they do.
#pragma once

#include <string_view>

namespace pt {

/// What happens to the tags of all slots between two stages.
enum class TagPass {
  none,
  count,   ///< how many slots wait for each stage
  gather,  ///< as count, and fills the queues; by CUB on CUDA
  scan,    ///< as gather; by one kernel of ours on CUDA
};

//   name, whether stages append to queues (else they write tags), whether there are queues, its
//   pass
#define PT_COMPACTIONS(STRATEGY)     \
  STRATEGY(cub, false, true, gather) \
  STRATEGY(scan, false, true, scan)  \
  STRATEGY(atomic, true, true, none) \
  STRATEGY(none, false, false, count)

#define PT_COMPACTION_ENUMERATOR(name, appends, has_queues, pass) name,
enum class Compaction { PT_COMPACTIONS(PT_COMPACTION_ENUMERATOR) };
#undef PT_COMPACTION_ENUMERATOR

struct CompactionInfo {
  Compaction id;
  std::string_view name;
  bool appends;
  bool has_queues;
  TagPass pass;
};

#define PT_COMPACTION_ROW(name, appends, has_queues, pass) \
  {Compaction::name, #name, appends, has_queues, TagPass::pass},
inline constexpr CompactionInfo compaction_table[] = {PT_COMPACTIONS(PT_COMPACTION_ROW)};
#undef PT_COMPACTION_ROW
#undef PT_COMPACTIONS

constexpr const CompactionInfo& compaction_info(Compaction strategy) {
  return compaction_table[static_cast<int>(strategy)];
}

}  // namespace pt
