// Mitsuba's .vol files, for tests that read them. Mitsuba 3.9.1 reads this layout and writes it.
#pragma once

#include "load/mesh_bytes.h"

namespace pt {

struct VolKind {
  std::string magic = "VOL";
  int version = 3;
  std::int32_t encoding = 1;
  std::int32_t x = 2, y = 1, z = 1, channels = 1;
  std::vector<float> box = {0, 0, 0, 1, 1, 1};
};

inline std::string vol_bytes(const VolKind& kind, const std::vector<float>& values) {
  MeshBytes file;
  file.text = kind.magic;
  file.put(static_cast<std::uint8_t>(kind.version)).put(kind.encoding);
  file.put(kind.x).put(kind.y).put(kind.z).put(kind.channels);
  for (const float corner : kind.box) file.put(corner);
  for (const float value : values) file.put(value);
  return file.text;
}

}  // namespace pt
