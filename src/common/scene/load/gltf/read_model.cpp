#include "common/scene/load/gltf/read_model.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/scene/load/files/whole_file.h"
#include "common/scene/load/gltf/document.h"

namespace pt::gltf {
namespace {

/// A pipe, a device or a folder is refused, not waited for.
WholeFile map_file(const std::filesystem::path& path) try {
  return WholeFile(path);
} catch (const Error& error) {
  throw Error(fmt::format("{}: cannot be read: {}", path.string(), error.what()));
}

/// tinygltf's, of buffers and pictures beside the model.
bool read_beside(std::vector<unsigned char>* bytes, std::string* error, const std::string& path,
                 void*) try {
  const WholeFile file(path);
  bytes->assign(file.bytes().begin(), file.bytes().end());
  return true;
} catch (const std::exception& problem) {
  *error = problem.what();
  return false;
}

std::uint32_t word_at(std::string_view bytes, std::size_t offset) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

constexpr std::uint32_t json_chunk = 0x4e4f534a, bin_chunk = 0x004e4942;

/// The JSON of a .glb file, whose header and chunks are checked (specification, section 4.4).
std::string_view glb_json(std::string_view bytes, const std::string& file) {
  if (bytes.size() < 20) fail(file, "header", "truncated: expected 20 bytes or more");
  const std::uint64_t version = word_at(bytes, 4), length = word_at(bytes, 8);
  if (version != 2) {
    fail(file, "header", "version {} of .glb, as in glTF {}.0, is not supported: expected 2",
         version, version);
  }
  if (length > bytes.size()) {
    fail(file, "header", "truncated: {} bytes of {}", bytes.size(), length);
  }
  const std::uint64_t json_length = word_at(bytes, 12);
  if (word_at(bytes, 16) != json_chunk || 20 + json_length > length) {
    fail(file, "header", "expected a first chunk of type JSON, within the file");
  }
  const std::uint64_t second = 20 + json_length;
  if (second != length) {
    if (second + 8 > length || second + 8 + word_at(bytes, second) > length ||
        word_at(bytes, second + 4) != bin_chunk) {
      fail(file, "header", "expected a second chunk of type BIN, within the file");
    }
  }
  return bytes.substr(20, json_length);
}

nlohmann::json parse(std::string_view text, const std::string& file) {
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::exception& error) {
    // '[json.exception.parse_error.101] parse error at line 1, column 2: ...'
    const std::string message = error.what();
    const std::size_t end_of_id = message.find("] ");
    fail(file, "", end_of_id == std::string::npos ? message : message.substr(end_of_id + 2));
  }
}

/// The file with another JSON.
std::string with_json(std::string_view bytes, std::string_view old_json,
                      const nlohmann::json& root) {
  std::string json = root.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (old_json.size() == bytes.size()) return json;
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::string_view rest = bytes.substr(20 + old_json.size());
  std::string result(bytes.substr(0, 20));
  const auto set_word = [&](std::size_t offset, std::size_t value) {
    const auto word = static_cast<std::uint32_t>(value);
    std::memcpy(result.data() + offset, &word, sizeof word);
  };
  set_word(8, 20 + json.size() + rest.size());
  set_word(12, json.size());
  return result.append(json).append(rest);
}

bool keep_encoded(tinygltf::Image* image, int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void*) {
  image->as_is = true;
  if (image->bufferView < 0 && size > 0) image->image.assign(bytes, bytes + size);
  return true;
}

/// Where tinygltf looks for files.
struct Folder {
  std::filesystem::path path;  ///< absolute
  std::vector<std::string> warnings;
};

/// The file at the path that the model names, whatever its case; the path itself where there is
/// none.
std::string found_path(const std::string& path, void* user) {
  auto& folder = *static_cast<Folder*>(user);
  const std::filesystem::path name = std::filesystem::path(path).lexically_relative(folder.path);
  if (name.empty()) return path;
  const auto warn = [&](const std::string& line) { folder.warnings.push_back(line); };
  const std::filesystem::path found = find_file(folder.path, name, warn);
  return found.empty() ? path : found.string();
}

/// Only what lies at the path that the file names: tinygltf would also look in the working folder.
bool exists_beside(const std::string& path, void*) {
  std::error_code ignored;
  return std::filesystem::path(path).is_absolute() && std::filesystem::exists(path, ignored);
}

/// tinygltf 2.9 asks for a file's size before it reads it, and refuses 2 GiB and more.
template <class Loader, class Callbacks>
void set_sizes(Loader& loader, Callbacks& callbacks) {
  if constexpr (requires { callbacks.GetFileSizeInBytes; }) {
    callbacks.GetFileSizeInBytes = [](std::size_t* size, std::string* problem,
                                      const std::string& path, void*) {
      std::error_code failure;
      *size = std::filesystem::file_size(path, failure);
      if (failure) *problem += failure.message();
      return !failure;
    };
    loader.SetMaxExternalFileSize(std::numeric_limits<std::size_t>::max());
  }
}

/// tinygltf's complaints as one line. It takes a skin's inverseBindMatrices for required.
std::string one_line(const std::string& complaints) {
  std::string result;
  for (std::size_t begin = 0; begin < complaints.size();) {
    const std::size_t end = std::min(complaints.find('\n', begin), complaints.size());
    const std::string line = complaints.substr(begin, end - begin);
    if (!line.empty() && line.find("inverseBindMatrices") == std::string::npos) {
      result += (result.empty() ? "" : " ") + line.substr(0, 200);
    }
    begin = end + 1;
  }
  return result;
}

}  // namespace

ReadModel read_model(const std::filesystem::path& path) {
  const std::string file = path.string();
  const WholeFile mapped = map_file(path);
  std::string_view bytes = mapped.bytes();
  if (bytes.size() > std::numeric_limits<std::uint32_t>::max()) {
    fail(file, "", "larger than 4 GiB, which glTF does not allow");
  }
  const bool is_glb = bytes.starts_with("glTF");
  const std::string_view text = is_glb ? glb_json(bytes, file) : bytes;
  nlohmann::json root = parse(text, file);
  check_promises(root, file, is_glb);
  const Mended mended = check_json(root, file);
  std::string rewritten;
  if (mended.changed) bytes = rewritten = with_json(bytes, text, root);

  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_encoded, nullptr);
  Folder files{std::filesystem::absolute(path).parent_path(), {}};
  tinygltf::FsCallbacks callbacks{};
  callbacks.FileExists = exists_beside;
  callbacks.ExpandFilePath = found_path;
  callbacks.ReadWholeFile = read_beside;
  callbacks.WriteWholeFile = tinygltf::WriteWholeFile;
  callbacks.user_data = &files;
  set_sizes(loader, callbacks);
  loader.SetFsCallbacks(callbacks);
  const std::string folder = files.path.string();
  const auto size = static_cast<unsigned int>(bytes.size());
  tinygltf::Model model;
  std::string error, warning;
  bool loaded = false;
  try {
    loaded = is_glb
                 ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                               reinterpret_cast<const unsigned char*>(bytes.data()),
                                               size, folder)
                 : loader.LoadASCIIFromString(&model, &error, &warning, bytes.data(), size, folder);
  } catch (const std::exception& exception) {
    fail(file, "", exception.what());
  }
  error = one_line(error);
  if (!loaded && error.empty()) error = one_line(warning);
  if (!loaded && error.empty()) error = "not a glTF file that tinygltf can read";
  if (!error.empty()) fail(file, "", error);
  if (!model.asset.version.starts_with("2.")) fail(file, "asset.version", "missing: expected 2.x");
  files.warnings.insert(files.warnings.end(), mended.lines.begin(), mended.lines.end());
  return {std::move(model), std::move(files.warnings)};
}

}  // namespace pt::gltf
