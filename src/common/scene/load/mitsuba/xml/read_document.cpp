// XML files to elements: parsing, <include>, <default> and $variables.
#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>

#include "common/scene/load/files/find_file.h"
#include "common/scene/load/files/mapped_file.h"
#include "common/scene/load/mitsuba/xml/element.h"
#include "common/scene/load/mitsuba/xml/variables.h"

namespace pt::mitsuba {
namespace {

constexpr int max_element_depth = 64;
constexpr std::size_t max_include_depth = 16;

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

/// Of a name that the system does not take, being too long, that name: opening it is the error.
std::filesystem::path without_links(const std::filesystem::path& path) {
  std::error_code refused;
  const std::filesystem::path found = std::filesystem::weakly_canonical(path, refused);
  return refused ? path : found;
}

class DocumentReader {
 public:
  explicit DocumentReader(const LoadOptions& options)
      : options_(options), variables_(options.definitions) {}

  Element read(const std::filesystem::path& path) {
    Element root = read_file(path);
    variables_.check_used(path.string());
    return root;
  }

 private:
  Element read_file(const std::filesystem::path& path) {
    stack_.push_back(without_links(path));
    pugi::xml_document document;
    const SourceFile source = parse(path, document);
    Element root = element_of(document.document_element(), source, 0);
    if (root.tag != "scene") fail(root, fmt::format("<{}>; expected <scene>", root.tag));
    stack_.pop_back();
    return root;
  }

  SourceFile parse(const std::filesystem::path& path, pugi::xml_document& document) const {
    try {
      const MappedFile file(path);
      SourceFile source(path, file.bytes());
      const pugi::xml_parse_result result =
          document.load_buffer(file.bytes().data(), file.bytes().size());
      if (!result) {
        throw Error(fmt::format("line {}: {}; expected a scene in XML", source.line(result.offset),
                                result.description()));
      }
      return source;
    } catch (const Error& error) {
      throw Error(fmt::format("{}: {}", path.string(), error.what()));
    }
  }

  Element element_of(const pugi::xml_node& node, const SourceFile& source, int depth) {
    Element element;
    element.tag = node.name();
    element.file = source.path();
    element.line = source.line(node.offset_debug());
    if (depth > max_element_depth) {
      fail(element, fmt::format("elements are nested deeper than {}", max_element_depth));
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
      for (Element& included : include(child).children) {
        parent.children.push_back(std::move(included));
      }
    } else {
      parent.children.push_back(std::move(child));
    }
  }

  Element include(const Element& element) {
    const std::filesystem::path path = included_path(element);
    if (std::find(stack_.begin(), stack_.end(), without_links(path)) != stack_.end()) {
      fail(element, fmt::format("{} includes itself", path.string()));
    }
    if (stack_.size() >= max_include_depth) {
      fail(element, fmt::format("files are included deeper than {}", max_include_depth));
    }
    try {
      return read_file(path);
    } catch (const Error& error) {
      throw Error(fmt::format("{} (included at {})", error.what(), element.place()));
    }
  }

  std::filesystem::path included_path(const Element& element) const {
    const std::string& name = element.required("filename");
    const std::filesystem::path folder = stack_.back().parent_path();
    const auto warn = [&](const std::string& line) {
      options_.report(element.place() + ": " + line);
    };
    const std::filesystem::path found = find_file(folder, name, warn);
    return found.empty() ? folder / name : found;
  }

  std::string substitute(const Element& element, const char* text) {
    try {
      return variables_.substitute(text);
    } catch (const Error& error) {
      fail(element, error.what());
    }
  }

  const LoadOptions& options_;
  Variables variables_;
  std::vector<std::filesystem::path> stack_;  ///< files being read
};

}  // namespace

Element read_document(const std::filesystem::path& path, const LoadOptions& options) {
  return DocumentReader(options).read(path);
}

}  // namespace pt::mitsuba
