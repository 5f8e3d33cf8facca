#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <set>
#include <string>
#include <string_view>

#include "common/error/error.h"
#include "common/scene/load/files/whole_file.h"
#include "common/scene/load/mitsuba/xml/elements.h"

namespace pt::mitsuba {
namespace {

/// The variables of a scene: those of the command line, then those of <default>.
class Variables {
 public:
  explicit Variables(const std::map<std::string, std::string>& definitions)
      : values_(definitions.begin(), definitions.end()), definitions_(definitions) {}

  /// A <default>: it counts where nothing else defines the name.
  void add_default(const std::string& name, const std::string& value) {
    values_.try_emplace(name, value);
    used_.insert(name);
  }

  /// `text` with the value of the longest name that fits in the place of every $name, and \$ for a
  /// dollar. Throws Error (without a place) for a name that is not defined, and where all values
  /// together become too long.
  std::string substitute(const std::string& text);

  /// Throws Error naming the definitions that the scene neither used nor declared.
  void check_used(const std::string& file) const;

 private:
  using Values = std::map<std::string, std::string, std::less<>>;

  Values::const_iterator longest_prefix_of(std::string_view name) const;

  Values values_;
  std::map<std::string, std::string> definitions_;
  std::size_t expanded_ = 0;  ///< bytes of values put in so far
  std::set<std::string> used_;
};

constexpr std::size_t max_expanded = std::size_t{64} << 20;

bool is_name_character(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

}  // namespace

// In alphabetical order, names that begin with a prefix of `name` come after that prefix. So the
// last name up to `name` either is the longest prefix or shares with `name` all that the longest
// one has.
Variables::Values::const_iterator Variables::longest_prefix_of(std::string_view name) const {
  while (!name.empty()) {
    const auto after = values_.upper_bound(name);
    if (after == values_.begin()) break;
    const auto candidate = std::prev(after);
    const std::string_view found = candidate->first;
    const auto [end, ignored] = std::mismatch(name.begin(), name.end(), found.begin(), found.end());
    const auto common = static_cast<std::size_t>(end - name.begin());
    if (common == found.size() && common > 0) return candidate;
    name = name.substr(0, common);
  }
  return values_.end();
}

std::string Variables::substitute(const std::string& text) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    if (text.compare(at, 2, "\\$") == 0) {
      result += '$';
      at += 2;
      continue;
    }
    if (text[at] != '$') {
      result += text[at++];
      continue;
    }
    std::size_t end = at + 1;
    while (end < text.size() && is_name_character(text[end])) ++end;
    const auto name = std::string_view(text).substr(at + 1, end - at - 1);
    const auto value = longest_prefix_of(name);
    if (value == values_.end()) {
      throw Error(fmt::format("${} is not defined; expected a <default> before it or -D {}=VALUE",
                              name, name));
    }
    used_.insert(value->first);
    expanded_ += value->second.size();
    if (expanded_ > max_expanded) {
      throw Error(fmt::format("variables expand to more than {} bytes", max_expanded));
    }
    result += value->second;
    at += 1 + value->first.size();
  }
  return result;
}

void Variables::check_used(const std::string& file) const {
  std::string names;
  for (const auto& [name, value] : definitions_) {
    if (!used_.count(name)) names += (names.empty() ? "" : ", ") + name;
  }
  if (!names.empty()) {
    throw Error(fmt::format("-D {}: {} has no such variable", names, file));
  }
}

namespace {

// XML files to elements: parsing, <include>, <default> and $variables.

constexpr int max_element_depth = 64;
constexpr std::size_t max_include_depth = 16;

// Limits for files that have been included before: small files may name each other 8^15 times.
constexpr int max_repeats = 10000;
constexpr std::size_t max_repeated_bytes = std::size_t{64} << 20;

/// One file: where its lines begin.
class SourceFile {
 public:
  SourceFile(const std::filesystem::path& path, std::string_view text)
      : path_(std::make_shared<std::filesystem::path>(path)) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\n') line_ends_.push_back(i);
    }
  }

  int line(std::ptrdiff_t offset) const {
    const auto at = static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0));
    return 1 + static_cast<int>(std::lower_bound(line_ends_.begin(), line_ends_.end(), at) -
                                line_ends_.begin());
  }
  const std::shared_ptr<const std::filesystem::path>& path() const { return path_; }

 private:
  std::shared_ptr<const std::filesystem::path> path_;
  std::vector<std::size_t> line_ends_;
};

/// A name that is too long for the system stays as it is: opening it is the error.
std::filesystem::path without_links(const std::filesystem::path& path) {
  std::error_code refused;
  const std::filesystem::path found = std::filesystem::weakly_canonical(path, refused);
  return refused ? path : found;
}

class DocumentReader {
 public:
  DocumentReader(const std::filesystem::path& path, const LoadOptions& options)
      : options_(options), variables_(options.definitions), search_path_(path.parent_path()) {}

  Element read(const std::filesystem::path& path, const std::string_view* text) {
    Element root = read_file(path, text);
    if (root.tag != "scene") fail(root, "<{}>; expected <scene>", root.tag);
    variables_.check_used(path.string());
    return root;
  }

 private:
  Element read_file(const std::filesystem::path& path, const std::string_view* text = nullptr) {
    stack_.push_back({path, without_links(path)});
    pugi::xml_document document;
    const SourceFile source = parse(path, text, document);
    Element root = element_of(document.document_element(), source, 0);
    stack_.pop_back();
    return root;
  }

  SourceFile parse(const std::filesystem::path& path, const std::string_view* text,
                   pugi::xml_document& document) {
    try {
      std::optional<WholeFile> file;
      const std::string_view bytes = text ? *text : std::string_view(file.emplace(path).bytes());
      count_repeats(stack_.back().canonical, bytes.size());
      SourceFile source(path, bytes);
      const pugi::xml_parse_result result = document.load_buffer(bytes.data(), bytes.size());
      if (!result) {
        throw Error(fmt::format("line {}: {}; expected a scene in XML", source.line(result.offset),
                                result.description()));
      }
      return source;
    } catch (const Error& error) {
      throw Error(fmt::format("{}: {}", shortened(path.string()), shortened(error.what())));
    }
  }

  void count_repeats(const std::filesystem::path& file, std::size_t size_bytes) {
    if (files_.insert(file).second) return;
    ++repeats_, repeated_bytes_ += size_bytes;
    if (repeats_ > max_repeats || repeated_bytes_ > max_repeated_bytes) {
      throw Error(fmt::format(
          "files are included again and again; expected at most {} times and {} bytes of them",
          max_repeats, max_repeated_bytes));
    }
  }

  Element element_of(const pugi::xml_node& node, const SourceFile& source, int depth) {
    Element element;
    element.tag = node.name();
    element.file = source.path();
    element.line = source.line(node.offset_debug());
    if (depth > max_element_depth) {
      fail(element, "elements are nested deeper than {}", max_element_depth);
    }
    for (const pugi::xml_attribute& attribute : node.attributes()) {
      element.attributes.emplace_back(attribute.name(), substitute(element, attribute.value()));
    }
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() == pugi::node_element) add_child(element, child, source, depth);
    }
    return element;
  }

  void add_child(Element& parent, const pugi::xml_node& node, const SourceFile& source, int depth) {
    Element child = element_of(node, source, depth + 1);
    if (child.tag == "default") {
      variables_.add_default(child.required("name"), child.required("value"));
    } else if (child.tag == "include") {
      splice(parent, child);
    } else {
      if (child.tag == "path") search_path_.add(child);
      parent.children.push_back(std::move(child));
    }
  }

  /// What a <scene> holds, or another object as it is.
  void splice(Element& parent, const Element& element) {
    Element root = include(element);
    if (root.tag == "scene") {
      for (Element& included : root.children) parent.children.push_back(std::move(included));
      return;
    }
    if (const std::string* name = element.attribute("name")) {
      std::erase_if(root.attributes, [](const auto& one) { return one.first == "name"; });
      root.attributes.emplace_back("name", *name);
    }
    parent.children.push_back(std::move(root));
  }

  Element include(const Element& element) {
    const std::filesystem::path path = included_path(element);
    const std::filesystem::path file = without_links(path);
    if (std::ranges::any_of(stack_, [&](const Open& open) { return open.canonical == file; })) {
      fail(element, "{} includes itself", path.string());
    }
    if (stack_.size() >= max_include_depth) {
      fail(element, "files are included deeper than {}", max_include_depth);
    }
    try {
      return read_file(path);
    } catch (const Error& error) {
      throw Error(fmt::format("{} (included at {})", error.what(), element.place()));
    }
  }

  /// Beside the file that names it, then beside those that include that one, then in <path>s.
  std::filesystem::path included_path(const Element& element) const {
    const std::string& name = element.required("filename");
    Folders folders;
    for (auto open = stack_.rbegin(); open != stack_.rend(); ++open) {
      folders.push_back(open->path.parent_path());
    }
    folders.insert(folders.end(), search_path_.folders().begin(), search_path_.folders().end());
    folders.push_back(stack_.back().canonical.parent_path());
    const auto warn = [&](const std::string& line) {
      options_.report(element.place() + ": " + shortened(line));
    };
    const std::filesystem::path found = find_in(folders, name, warn);
    return found.empty() ? folders.front() / name : found;
  }

  std::string substitute(const Element& element, const char* text) {
    try {
      return variables_.substitute(text);
    } catch (const Error& error) {
      fail(element, error.what());
    }
  }

  struct Open {
    std::filesystem::path path, canonical;
  };

  const LoadOptions& options_;
  Variables variables_;
  SearchPath search_path_;
  std::vector<Open> stack_;  ///< files being read
  std::set<std::filesystem::path> files_;
  int repeats_ = 0;
  std::size_t repeated_bytes_ = 0;
};

}  // namespace

Element read_document(const std::filesystem::path& path, const LoadOptions& options,
                      const std::string_view* text) {
  return DocumentReader(path, options).read(path, text);
}

}  // namespace pt::mitsuba
