#include "common/scene/load/files/meshes/ply.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <set>

#include "common/error/error.h"
#include "common/image/tone_mapping.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/text.h"
#include "common/scene/load/files/whole_file.h"

namespace pt {
namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr TypeName type_names[] = {
    {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
    {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
    {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
    {"float64", PlyType::float64}};

PlyType type_of(std::string_view name) {
  for (const TypeName& known : type_names) {
    if (known.name == name) return known.type;
  }
  throw Error("unknown type " + in_quotes(name));
}

/// The words of a header's line.
std::vector<std::string_view> split(std::string_view line) {
  constexpr std::string_view blank = " \t\r";
  std::vector<std::string_view> words;
  for (std::size_t begin = 0; (begin = line.find_first_not_of(blank, begin)) != line.npos;) {
    const std::size_t end = std::min(line.find_first_of(blank, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

PlyEncoding read_format(const std::vector<std::string_view>& words) {
  if (words.size() != 3 || words[2] != "1.0") throw Error("expected 'format ENCODING 1.0'");
  if (words[1] == "ascii") return PlyEncoding::ascii;
  if (words[1] == "binary_little_endian") return PlyEncoding::little_endian;
  if (words[1] == "binary_big_endian") return PlyEncoding::big_endian;
  throw Error("unknown encoding " + in_quotes(words[1]));
}

PlyElement read_element(const std::vector<std::string_view>& words) {
  if (words.size() != 3) throw Error("expected 'element NAME COUNT'");
  PlyElement element{std::string(words[1]), 0, {}};
  const char* end = words[2].data() + words[2].size();
  const auto [stop, failure] = std::from_chars(words[2].data(), end, element.count);
  if (failure != std::errc{} || stop != end) {
    throw Error(in_quotes(words[2]) + " is not a count of elements");
  }
  return element;
}

PlyProperty read_property(const std::vector<std::string_view>& words) {
  if (words.size() == 3) return {std::string(words[2]), type_of(words[1]), {}};
  if (words.size() != 5 || words[1] != "list") {
    throw Error("expected 'property TYPE NAME' or 'property list COUNT_TYPE TYPE NAME'");
  }
  const PlyType count_type = type_of(words[2]);
  if (!is_integer(count_type)) throw Error("the count of a list is an integer");
  return {std::string(words[4]), type_of(words[3]), count_type};
}

/// Takes the header's lines one by one.
class HeaderParser {
 public:
  /// False for the last line.
  bool parse(std::string_view line) {
    const std::vector<std::string_view> words = split(line);
    if (words.empty() || words[0] == "obj_info") return true;
    if (words[0] == "comment") {
      header.names_texture |= words.size() > 2 && words[1] == "TextureFile";  // MeshLab and others
      return true;
    }
    if (words[0] == "end_header") {
      if (!has_format_) throw Error("the header ends without a format");
      return false;
    }
    if (words[0] == "format") {
      header.encoding = read_format(words);
      has_format_ = true;
    } else if (words[0] == "element") {
      PlyElement element = read_element(words);
      if (!names_.insert(element.name).second) {
        throw Error(fmt::format("element {} appears twice", clipped(element.name)));
      }
      header.elements.push_back(std::move(element));
    } else if (words[0] == "property") {
      if (header.elements.empty()) throw Error("a property before any element");
      header.elements.back().properties.push_back(read_property(words));
    } else {
      throw Error("unknown keyword " + in_quotes(words[0]));
    }
    return true;
  }

  PlyHeader header;

 private:
  bool has_format_ = false;
  std::set<std::string, std::less<>> names_;  ///< of elements
};

}  // namespace

std::size_t size_bytes(PlyType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

std::size_t PlyElement::least_bytes(bool ascii) const {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties) {
    bytes += ascii ? 2 : size_bytes(property.count_type.value_or(property.type));
  }
  return bytes;
}

std::optional<std::size_t> PlyElement::find(std::initializer_list<std::string_view> names) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (std::ranges::count(names, properties[i].name) > 0) return i;
  }
  return {};
}

bool PlyElement::has_lists() const {
  return std::ranges::any_of(properties, [](const auto& p) { return p.count_type.has_value(); });
}

const PlyElement* PlyHeader::find(std::string_view name) const {
  const auto it = std::ranges::find(elements, name, &PlyElement::name);
  return it == elements.end() ? nullptr : &*it;
}

PlyHeader read_ply_header(std::string_view file) {
  if (!file.starts_with("ply\n") && !file.starts_with("ply\r")) {
    throw Error("not a PLY file: it does not begin with a line 'ply'");
  }
  // Lines end with \n, \r\n (the \r is blank) or, long ago, \r.
  const char line_end = file.starts_with("ply\r") && !file.starts_with("ply\r\n") ? '\r' : '\n';
  HeaderParser parser;
  std::size_t line_number = 1, begin = file.find(line_end) + 1;
  for (bool more = true; more;) {
    ++line_number;
    const std::size_t end = file.find(line_end, begin);
    if (end == file.npos) throw Error("the file ends within its header");
    try {
      more = parser.parse(file.substr(begin, end - begin));
    } catch (const Error& error) {
      throw Error(fmt::format("line {}: {}", line_number, error.what()));
    }
    begin = end + 1;
  }
  parser.header.bytes = begin;
  parser.header.lines = line_number;
  return std::move(parser.header);
}

double PlyTextValues::next(PlyType type) {
  const std::string_view word = next_word(rest_);
  if (word.empty()) throw Error("the file ends here");
  const double value = parse_number(word);
  if (is_integer(type) && value != std::floor(value)) {
    throw Error(fmt::format("expected an integer, found '{}'", word.substr(0, 40)));
  }
  return value;
}

namespace {

/// What stands for 1 among integers of which `most` is the largest.
float white_of(PlyType type, float most) {
  const int bits = 8 * static_cast<int>(size_bytes(type));
  const bool has_sign = type == PlyType::int8 || type == PlyType::int16 || type == PlyType::int32;
  const float largest = std::exp2(static_cast<float>(has_sign ? bits - 1 : bits)) - 1.0f;
  for (const float white : {255.0f, 65535.0f}) {
    if (most <= std::min(white, largest)) return std::min(white, largest);
    if (most <= white) return white;  // a text may exceed its type
  }
  return largest;
}

}  // namespace

void decode_ply_colors(std::vector<Color>& colors, PlyType type) {
  float most = 0.0f;
  for (const Color& c : colors) {
    for (int i = 0; i < 3; ++i) most = std::max(most, std::isfinite(c[i]) ? c[i] : 0.0f);
  }
  const float white = white_of(type, most);
  const auto decode = [&](float x) {
    if (!(x > 0.0f) || !std::isfinite(x)) return 0.0f;
    return is_integer(type) ? srgb_curve.decode(std::min(x / white, 1.0f)) : x;
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, colors.size(), 2048),
                    [&](const tbb::blocked_range<std::size_t>& block) {
                      for (std::size_t i = block.begin(); i < block.end(); ++i) {
                        Color& c = colors[i];
                        c = {decode(c.x), decode(c.y), decode(c.z)};
                      }
                    });
}

namespace {

/// Passes over elements that mean nothing to us, such as edges.
template <class Values>
void skip_element(Values& values, const PlyElement& element, bool ascii) {
  if (element.properties.empty()) return;
  check_ply_count(element, values.rest().size(), ascii);
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) skip_ply_property(values, property);
  }
}

std::string names_of(const PlyHeader& header) {
  std::string names;
  for (const PlyElement& element : header.elements) {
    names += fmt::format("{}{} {}", names.empty() ? "" : ", ", element.count, element.name);
    if (names.size() > 200) break;
  }
  return clipped(names, 200);
}

template <class Values>
void read_body(Values& values, const PlyHeader& header, PlyMesh& out) {
  const PlyElement* vertices = header.find("vertex");
  const PlyElement *faces = header.find("face"), *strips = header.find("tristrips");
  if (!vertices || (!faces && !strips)) {
    throw Error(fmt::format("expected elements 'vertex' and 'face' or 'tristrips', found {}{}",
                            header.elements.empty() ? "none" : names_of(header),
                            vertices ? ": points without faces are not supported" : ""));
  }
  const PlyElement* last = std::max({vertices, faces, strips});  // what follows is not ours
  for (const PlyElement& element : header.elements) {
    if (&element == vertices) {
      read_ply_vertices(values, element, out);
    } else if (&element == faces) {
      read_ply_faces(values, element, vertices->count, out);
    } else if (&element == strips) {
      read_ply_strips(values, element, vertices->count, out);
    } else {
      skip_element(values, element, header.encoding == PlyEncoding::ascii);
    }
    if (&element == last) break;
  }
}

void read_text(std::string_view body, const PlyHeader& header, PlyMesh& out) {
  PlyTextValues values(body);
  try {
    read_body(values, header, out);
  } catch (const Error& error) {
    const std::string_view done = body.substr(0, body.size() - values.rest().size());
    throw Error(fmt::format("line {}: {}", header.lines + 1 + std::ranges::count(done, '\n'),
                            error.what()));
  }
}

/// A few bad faces are left out. Where they are the most the file is taken for damaged.
void report_lost(PlyMesh& out) {
  if (out.lost == 0) return;
  if (out.lost > out.mesh.triangles.size()) throw Error(out.first_lost);
  out.warnings.push_back(
      fmt::format("{} bad faces are left out, the first is {}", out.lost, out.first_lost));
}

Mesh decode_file(std::string_view file, const MeshFileOptions& options) {
  const std::string_view bytes = without_byte_order_mark(file);
  const PlyHeader header = read_ply_header(bytes);
  const std::string_view body = bytes.substr(header.bytes);
  PlyMesh read;
  if (header.names_texture) read.warnings.emplace_back("the picture that it names is ignored");
  if (header.encoding == PlyEncoding::ascii) {
    read_text(body, header, read);
  } else {
    PlyBinaryValues values(body, header.encoding == PlyEncoding::big_endian);
    read_body(values, header, read);
  }
  report_lost(read);
  if (!read.mesh.face_colors.empty()) {  // strips have none
    read.mesh.face_colors.resize(read.mesh.triangles.size(), Color(1.0f));
  }
  read.fans.cut_concave(read.mesh, &read.warnings);
  finish_mesh(read.mesh, options, &read.warnings);
  if (options.warnings) {
    options.warnings->insert(options.warnings->end(), read.warnings.begin(), read.warnings.end());
  }
  return std::move(read.mesh);
}

}  // namespace

Mesh decode_ply(std::string_view bytes, const std::string& name, const MeshFileOptions& options) {
  return explaining("cannot read " + name, [&] { return decode_file(bytes, options); });
}

Mesh read_ply(const std::filesystem::path& path, const MeshFileOptions& options) {
  return explaining("cannot read " + path.string(), [&] {
    const WholeFile file(path);
    if (is_gzip(file.bytes())) return decode_file(decompress_gzip(file.bytes()), options);
    return decode_file(file.bytes(), options);
  });
}

}  // namespace pt
