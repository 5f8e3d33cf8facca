// The elements of a scene's XML, after <include>s and $variables: what the rest of the loader sees.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/scene/load/files/load_options.h"

namespace pt::mitsuba {

struct Element {
  std::string tag;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<Element> children;
  std::shared_ptr<const std::filesystem::path> file;
  int line = 0;  ///< 0: of no file; `file` says where it is

  /// The value of an attribute, or nullptr.
  const std::string* attribute(std::string_view name) const;
  /// The same; throws Error where the element has none.
  const std::string& required(std::string_view name) const;
  /// "file:line", or the file alone.
  std::string place() const;
};

/// `message` without its middle where a file has made it long, and without control characters.
std::string shortened(const std::string& message);

/// So many kinds of warnings are given, of whatever a file holds.
inline constexpr std::size_t max_reports = 200;

/// Throws Error with the element's place before `message`, shortened.
[[noreturn]] void fail(const Element& element, const std::string& message);

/// Reads a scene and what it includes. Variables come from the options' definitions and from
/// <default>, in this order of precedence. Throws Error with file and line for malformed XML,
/// undefined variables, definitions that nothing uses, files that include each other or the same
/// file too often, variables that expand too far, and elements nested deeper than 64.
Element read_document(const std::filesystem::path& path, const LoadOptions& options);

}  // namespace pt::mitsuba
