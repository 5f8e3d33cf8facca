// What a ray carries through OptiX's programs: a query of triangle_query.h, word by word.
#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>

#include "common/platform/platform.h"

namespace pt {

inline constexpr int optix_payload_words = 5;

/// Records of the hit programs, counted from the first (OptixPipeline).
enum OptixRecord : unsigned { optix_record_closest, optix_record_any, optix_record_ties };

struct OptixPayload {
  std::uint32_t word[optix_payload_words];
};

template <class Query>
PT_HD OptixPayload to_payload(const Query& query) {
  static_assert(std::is_trivially_copyable_v<Query> && sizeof(Query) <= sizeof(OptixPayload));
  OptixPayload payload{};
  memcpy(&payload, static_cast<const void*>(&query), sizeof query);
  return payload;
}

/// `query`: any, whose place is taken.
template <class Query>
PT_HD void from_payload(const OptixPayload& payload, Query& query) {
  memcpy(static_cast<void*>(&query), &payload, sizeof query);
}

}  // namespace pt
