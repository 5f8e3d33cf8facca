#include "common/scene/load/files/meshes/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <initializer_list>
#include <set>

#include "common/error/error.h"
#include "common/error/quoted.h"

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

}  // namespace pt
