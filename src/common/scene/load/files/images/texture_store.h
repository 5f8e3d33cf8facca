// Fills a scene's textures and texels; what is loaded twice is stored once.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "common/scene/load/files/images/image_files.h"
#include "common/texture/texture.h"

namespace pt {

/// Lives as long as a scene is being loaded; `textures` and `texels` are the scene's and outlive
/// it. Each `add` returns the texture's number; a texture equal to an earlier one gets its number.
class TextureStore {
 public:
  TextureStore(std::vector<Texture>& textures, std::vector<std::byte>& texels)
      : textures_(textures), texels_(texels) {}

  /// `look` says all but the image: wrap, filter, transform, color0, and in `format` whether
  /// integers are srgb8 or linear8. Throws Error as read_texture_image does.
  /// With `weights` it is grey (grey_image).
  std::uint32_t add_file(const std::filesystem::path& path, const Texture& look = {},
                         const std::optional<Color>& weights = {});

  /// As add_file, but a picture that cannot be read is no_texture, and `report` is told why in one
  /// line that names the file; the caller uses a colour in its place.
  std::uint32_t add_file_if_readable(const std::filesystem::path& path, const Texture& look,
                                     const std::optional<Color>& weights,
                                     const std::function<void(const std::string&)>& report);

  /// The same of a file's content. `name` stands for it in errors and must be its own: the same
  /// name is the same image.
  std::uint32_t add_memory(std::string_view bytes, const std::string& name,
                           const Texture& look = {}, const std::optional<Color>& weights = {});

  /// The same of an image that is decoded; integers become what `look` says.
  std::uint32_t add_decoded(const TextureImage& image, const std::string& name, const Texture& look,
                            const std::optional<Color>& weights);

  /// An image made by the caller.
  std::uint32_t add_image(TextureImage image, const Texture& look = {});

  /// The alpha of texture `number`, an image, as a texture; no_texture where it has none or is 1
  /// everywhere. That of 8 bits shares its texels.
  std::uint32_t add_alpha_of(std::uint32_t texture_index);

  /// Whether the image of texture `number`, as linear numbers, looks like normals and not like
  /// heights: they are grey, normals are blue.
  bool is_normal_map(std::uint32_t texture_index) const;

  /// A texture without texels, such as a checkerboard.
  std::uint32_t add_plain(const Texture& texture);

 private:
  /// What of a Texture says where the texels are.
  struct Stored {
    TextureFormat format;
    std::uint32_t width, height;
    std::uint64_t offset;
  };

  Stored store(TextureImage image);
  std::size_t append(std::vector<std::byte> bytes);
  std::uint32_t add_stored(const Stored& stored, Texture look);

  std::vector<Texture>& textures_;
  std::vector<std::byte>& texels_;
  std::map<std::string, Stored> stored_;                         ///< by encoding and name
  std::unordered_multimap<std::size_t, std::uint32_t> by_hash_;  ///< what add_plain() has added
  std::map<std::uint64_t, std::uint64_t> alphas_;  ///< offsets of floats' alpha, by the image's
};

}  // namespace pt
