#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <variant>

#include "common/error/error.h"
#include "common/scene/load/files/text.h"
#include "common/scene/load/obj/mtl.h"

namespace pt::obj {
namespace {

constexpr float no_limit = 1e30f;

struct ColorStatement {
  std::optional<Color> MtlMaterial::*value;
  float most;
};
struct NumberStatement {
  std::optional<float> MtlMaterial::*value;
  float least, most;
};
struct MapStatement {
  MtlMap MtlMaterial::*map;
};
enum class Unused { silent, warned };

using Statement = std::variant<ColorStatement, NumberStatement, MapStatement, Unused>;

/// By name in lower case, as exporters do not agree on it.
const std::map<std::string, Statement, std::less<>>& statements() {
  using M = MtlMaterial;
  static const std::map<std::string, Statement, std::less<>> table = {
      {"ka", ColorStatement{&M::Ka, 1}},
      {"kd", ColorStatement{&M::Kd, 1}},
      {"ks", ColorStatement{&M::Ks, 1}},
      {"ke", ColorStatement{&M::Ke, no_limit}},
      {"tf", ColorStatement{&M::Tf, 1}},
      {"d", NumberStatement{&M::d, 0, 1}},
      {"tr", NumberStatement{&M::Tr, 0, 1}},
      {"ns", NumberStatement{&M::Ns, 0, no_limit}},
      {"ni", NumberStatement{&M::Ni, 0, no_limit}},
      {"pr", NumberStatement{&M::Pr, 0, 1}},
      {"pm", NumberStatement{&M::Pm, 0, 1}},
      {"ps", NumberStatement{&M::Ps, 0, 1}},
      {"pc", NumberStatement{&M::Pc, 0, 1}},
      {"pcr", NumberStatement{&M::Pcr, 0, 1}},
      {"aniso", NumberStatement{&M::aniso, 0, 1}},
      {"map_kd", MapStatement{&M::map_Kd}},
      {"map_ks", MapStatement{&M::map_Ks}},
      {"map_ke", MapStatement{&M::map_Ke}},
      {"map_d", MapStatement{&M::map_d}},
      {"map_opacity", MapStatement{&M::map_d}},
      {"map_tr", MapStatement{&M::map_Tr}},
      {"map_pr", MapStatement{&M::map_Pr}},
      {"map_roughness", MapStatement{&M::map_Pr}},
      {"map_pm", MapStatement{&M::map_Pm}},
      {"map_metallic", MapStatement{&M::map_Pm}},
      {"map_ps", MapStatement{&M::map_Ps}},
      {"bump", MapStatement{&M::bump}},
      {"map_bump", MapStatement{&M::bump}},
      {"norm", MapStatement{&M::norm}},
      {"map_norm", MapStatement{&M::norm}},
      {"map_kn", MapStatement{&M::norm}},
      {"map_tangentspacenormal", MapStatement{&M::norm}},
      // Ambient light and anti-aliasing, which a path tracer has by itself.
      {"map_ka", Unused::silent},
      {"map_ao", Unused::silent},
      {"map_aat", Unused::silent},
      {"sharpness", Unused::silent},
      {"disp", Unused::warned},
      {"map_disp", Unused::warned},
      {"decal", Unused::warned},
      {"refl", Unused::warned},
      {"map_refl", Unused::warned},
      {"map_ns", Unused::warned},
  };
  return table;
}

/// Linear sRGB of CIE XYZ (IEC 61966-2-1).
Color of_xyz(const Color& c) {
  return {dot(c, Vec3(3.2404542f, -1.5371385f, -0.4985314f)),
          dot(c, Vec3(-0.9692660f, 1.8760108f, 0.0415560f)),
          dot(c, Vec3(0.0556434f, -0.2040259f, 1.0572252f))};
}

class MtlLines {
 public:
  MtlLines(const std::string& file, CountedWarnings& warnings) : file_(file), warnings_(warnings) {}

  void read(std::string_view line, std::size_t line_number) {
    line_number_ = line_number;
    const std::string_view word = next_word(line);
    if (word.empty()) return;
    if (word.starts_with('#')) return read_comment(line);
    const std::string key = lower_case(word.substr(0, 40));
    if (key == "newmtl") return begin(trim(line));
    if (materials.empty()) return warn("before newmtl", "a statement before newmtl is ignored");
    if (key == "illum") return read_illum(line);
    const auto found = statements().find(key);
    if (found == statements().end()) {
      return warn("unknown statement",
                  fmt::format("unknown statement {}: it is ignored", pt::in_quotes(word, 40)),
                  word);
    }
    if (key == "d") line = without_halo(line);
    key_ = word;
    std::visit([&](const auto& statement) { apply(statement, line); }, found->second);
  }

  std::vector<MtlMaterial> materials;

 private:
  void warn(std::string_view kind, std::string_view message, std::string_view name = {}) {
    warnings_.add(kind, fmt::format("{}: {}", place(), message), name);
  }

  std::string place() const {
    const std::string line = fmt::format("{}: line {}", file_, line_number_);
    return materials.empty() ? line : line + ": material " + pt::in_quotes(materials.back().name);
  }

  void read_comment(std::string_view comment) {
    const std::string text = lower_case(comment.substr(0, 200));
    const auto names = [&](const char* name) { return text.find(name) != text.npos; };
    if (names("blender")) exporter_ = Exporter::blender;
    if (names("cinema 4d")) exporter_ = Exporter::cinema4d;
    if (names("meshlab")) exporter_ = Exporter::meshlab;
  }

  void begin(std::string_view name) {
    materials.emplace_back();
    materials.back().name = name;
    materials.back().place = place();
    if (name.empty()) warn("newmtl", "newmtl without a name: nothing can use it");
  }

  std::string_view without_halo(std::string_view line) {
    std::string_view rest = line;
    if (lower_case(next_word(rest).substr(0, 8)) != "-halo") return line;
    warn("-halo", "d -halo: the opacity does not depend on the direction: its factor is used");
    return rest;
  }

  /// In [least, most], or nothing where it is no number.
  std::optional<float> read_number(std::string_view word, float least, float most) {
    try {
      const double value = parse_number(word);
      if (value >= least - 1e-3 && value <= most + 1e-3) {
        return std::clamp(static_cast<float>(value), least, most);
      }
      if (std::isnan(value)) throw Error("nan");
      const float nearest = value < least ? least : most;
      warn("range of " + lower_case(key_),
           fmt::format("{} {}: expected {}, {} is used", key_, clipped(word, 40),
                       range(least, most), nearest));
      return nearest;
    } catch (const Error& error) {
      warn("value of " + lower_case(key_),
           fmt::format("{}: {}: the statement is ignored", key_, error.what()));
      return {};
    }
  }

  static std::string range(float least, float most) {
    return most < no_limit ? fmt::format("a number in [{}, {}]", least, most)
                           : fmt::format("a number >= {}", least);
  }

  /// The last of two is used.
  template <class Value>
  void set(std::optional<Value>& value, const std::optional<Value>& read) {
    if (!read) return;
    if (value && *value != *read) warn_of_second();
    value = read;
  }
  void warn_of_second() {
    warn("second " + lower_case(key_), fmt::format("a second {}: the last one is used", key_));
  }

  /// One number is grey.
  void apply(const ColorStatement& statement, std::string_view line) {
    std::string_view words = line;
    const bool is_xyz = lower_case(next_word(words).substr(0, 8)) == "xyz";
    if (!is_xyz) words = line;
    Color color;
    int count = 0;
    for (std::string_view word; count < 3; ++count) {
      word = next_word(words);
      if (word.empty() || word.starts_with('#')) break;
      // Components of XYZ may be larger than those of the colour.
      const auto number = read_number(word, 0.0f, is_xyz ? no_limit : statement.most);
      if (!number) return;
      color[count] = *number;
    }
    if (count == 1) color = Color(color.x);
    if (count != 1 && count != 3) {
      return warn("value of " + lower_case(key_),
                  fmt::format("{}: expected 1 or 3 numbers, found {}: the "
                              "statement is ignored",
                              key_, count));
    }
    if (is_xyz) color = glm::clamp(of_xyz(color), 0.0f, statement.most);
    set(materials.back().*statement.value, std::optional<Color>(color));
  }

  void apply(const NumberStatement& statement, std::string_view line) {
    set(materials.back().*statement.value,
        read_number(next_word(line), statement.least, statement.most));
  }

  void apply(const MapStatement& statement, std::string_view line) {
    const MtlMap map = parse_mtl_map(line, [&](const std::string& kind, const std::string& what) {
      warn("option " + kind, fmt::format("{}: {}", key_, what));
    });
    if (!map) return;
    MtlMap& known = materials.back().*statement.map;
    if (known && known.name != map.name) warn_of_second();
    known = map;
  }

  void apply(Unused unused, std::string_view) {
    if (unused == Unused::warned)
      warn(lower_case(key_), key_ + " has no counterpart: it is ignored");
  }

  void read_illum(std::string_view line) {
    key_ = "illum";
    const std::optional<float> number = read_number(next_word(line), 0, 10);
    if (number) set(materials.back().illum, std::optional<int>(static_cast<int>(*number)));
  }

 public:
  /// What comments say of all. MeshLab wrote Tr 1 for what is opaque, until 2023.
  void finish() {
    for (MtlMaterial& material : materials) {
      material.exporter = exporter_;
      if (exporter_ != Exporter::meshlab || material.d || material.Tr != 1.0f) continue;
      material.Tr.reset();
      warnings_.add("meshlab", material.place + ": Tr 1 of MeshLab: opaque is used");
    }
  }

 private:
  const std::string& file_;
  CountedWarnings& warnings_;
  std::size_t line_number_ = 0;
  std::string key_;  ///< of the statement being read
  Exporter exporter_ = Exporter::unknown;
};

}  // namespace

std::vector<MtlMaterial> parse_mtl(std::string_view text, const std::string& file,
                                   CountedWarnings& warnings) {
  MtlLines lines(file, warnings);
  text = without_byte_order_mark(text);
  for (std::size_t line_number = 1; !text.empty(); ++line_number) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    lines.read(text.substr(0, end), line_number);
    text.remove_prefix(std::min(end + (text.substr(end, 2) == "\r\n" ? 2 : 1), text.size()));
  }
  lines.finish();
  return std::move(lines.materials);
}

}  // namespace pt::obj
