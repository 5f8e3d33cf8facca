// The elements of a scene's XML, after <include>s and $variables: what the rest of the loader sees;
// the numbers, transformations and files that they name.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/math/transform.h"
#include "common/math/vec.h"
#include "common/scene/load/files/importer.h"
#include "common/scene/load/files/load_options.h"
#include "common/scene/load/files/whole_file.h"

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
/// The same of a message with values in it.
template <class First, class... Rest>
[[noreturn]] void fail(const Element& element, fmt::format_string<First, Rest...> text,
                       First&& first, Rest&&... rest) {
  fail(element, fmt::format(text, std::forward<First>(first), std::forward<Rest>(rest)...));
}

/// Reads a scene and what it includes. Variables come from the options' definitions and from
/// <default>, in this order of precedence. Throws Error with file and line for malformed XML,
/// undefined variables, definitions that nothing uses, files that include each other or the same
/// file too often, variables that expand too far, and elements nested deeper than 64. `text`: what
/// the file holds, which is not read then.
Element read_document(const std::filesystem::path& path, const LoadOptions& options,
                      const std::string_view* text = nullptr);

// Where the files lie that a scene names.

using Folders = std::vector<std::filesystem::path>;

/// The folders of <path>s, the last one first, as Mitsuba has them.
class SearchPath {
 public:
  /// `scene` is the folder of the first file.
  explicit SearchPath(std::filesystem::path scene) : scene_(std::move(scene)) {}

  /// The folder of a <path>: in the file's folder, or else in the scene's. False: there is none.
  bool add(const Element& path);

  const std::filesystem::path& scene() const { return scene_; }
  const Folders& folders() const { return folders_; }

 private:
  std::filesystem::path scene_;
  Folders folders_;
};

/// The first of these that exists: `name` in one of the folders; then in the current one; then what
/// differs in case alone, of which `warn` is told; then the same of a name from Windows, with
/// backslashes; then as many last parts of an absolute name as there are, of which `warn` is told
/// as well. Else an empty path.
std::filesystem::path find_in(const Folders& folders, const std::string& name,
                              const WarnOfName& warn);

// Numbers in attributes.

/// A finite number that a float can hold, or none. Too small a one becomes 0.
std::optional<double> parse_number(std::string_view text);

/// Numbers apart by commas or white space. Throws Error with the element's place.
std::vector<double> parse_numbers(const Element& element, std::string_view text);

/// The number in attribute `name`, or `fallback` where there is none. Throws Error.
double number_attribute(const Element& element, std::string_view name, double fallback);

/// x, y and z, or the three numbers of `value`, of which one stands for all. Throws Error.
Vec3 vector_attributes(const Element& element, double fallback);

/// The three numbers in attribute `name`. Throws Error.
Vec3 vector_attribute(const Element& element, std::string_view name);

// <transform>: a sequence of maps.

/// The maps of a <transform>, the first applied first: translate, rotate, scale, matrix (16 or 9
/// numbers), lookat. Composed in double precision. Throws Error for what is not one of these, not
/// affine or not finite.
Affine read_transform(const Element& element);

/// The same; a map that cannot be inverted is an Error.
Affine read_invertible_transform(const Element& element);

/// The last <lookat> of a <transform>, if it has any. Throws Error.
std::optional<LookAt> read_look_at(const Element& transform);

/// True where the linear part of `map` flattens space, within the precision of its numbers.
bool is_singular(const Affine& map);

}  // namespace pt::mitsuba
