// MTL files as they are written: what a material says, and nothing of what it means.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/math/vec.h"
#include "common/scene/load/files/counted_warnings.h"

namespace pt::obj {

/// A picture with the options of its line.
struct MtlMap {
  std::string name;  ///< as in the file, without quotes; empty: there is no such map
  float offset[2] = {0, 0}, scale[2] = {1, 1};  ///< -o, -s
  float base = 0.0f, gain = 1.0f;               ///< -mm
  float bump = 1.0f;                            ///< -bm
  bool clamps = false;                          ///< -clamp
  bool blends[2] = {true, true};                ///< -blendu, -blendv
  char channel = '\0';                          ///< -imfchan: r, g, b, m or l; 0: not said

  explicit operator bool() const { return !name.empty(); }
};

/// Who wrote a file, where its comments say so and it matters.
enum class Exporter { unknown, blender, cinema4d, meshlab };

/// The members have the names of their statements. Colours and numbers are finite and in range.
struct MtlMaterial {
  std::string name;
  std::string place;  ///< file, line and name, for messages
  Exporter exporter = Exporter::unknown;
  std::optional<Color> Ka, Kd, Ks, Ke, Tf;
  std::optional<float> d, Tr, Ns, Ni, Pr, Pm, Ps, Pc, Pcr, aniso;
  std::optional<int> illum;
  MtlMap map_Kd, map_Ks, map_Ke, map_d, map_Tr, map_Pr, map_Pm, map_Ps, bump, norm;
};

/// `file` names the text in messages.
std::vector<MtlMaterial> parse_mtl(std::string_view text, const std::string& file,
                                   CountedWarnings& warnings);

}  // namespace pt::obj
