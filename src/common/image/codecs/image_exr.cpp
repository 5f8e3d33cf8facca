// EXR through OpenEXR.
#include <Iex.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <thread>
#include <vector>

#include "common/error/error.h"
#include "common/image/codecs/exr.h"
#include "common/image/codecs/image_codec.h"

namespace pt {
namespace {

constexpr int max_tile_size = 4096;

/// Channels and the places that their values take in a pixel: R, G and B, or Y alone in the first.
using Names = std::vector<const char*>;

/// The `names` of `pixels`, wherever the data window lies.
Imf::FrameBuffer frame_buffer(const float* pixels, const Imath::Box2i& window, const Names& names) {
  const std::size_t stride = 3 * sizeof(float);
  const std::size_t width = static_cast<std::size_t>(window.max.x - window.min.x) + 1;
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < names.size(); ++c) {
    buffer.insert(names[c],
                  Imf::Slice::Make(Imf::FLOAT, pixels + c, window, stride, stride * width));
  }
  return buffer;
}

/// Names to which OpenEXR gives a meaning, so that they are not ours to use.
bool is_reserved(const std::string& name) {
  static const Imf::Header standard;
  const char* const optional[] = {"type", "name", "view", "version", "chunkCount", "tiles"};
  return standard.find(name) != standard.end() || std::ranges::count(optional, name) > 0;
}

Imf::Header header_of(const Image& image) {
  const ImagePlace& place = image.place;
  if (place.width == 0) return Imf::Header(image.width, image.height);
  const Imath::V2i corner(place.x, place.y), size(image.width - 1, image.height - 1);
  return Imf::Header(Imath::Box2i({0, 0}, {place.width - 1, place.height - 1}),
                     Imath::Box2i(corner, corner + size));
}

Imf::PixelType type_of(const ImageLayer& layer) {
  return layer.numbers.empty() ? Imf::FLOAT : Imf::UINT;
}

/// A layer's channels are named LAYER.C.
std::string channel_name(const ImageLayer& layer, std::size_t channel) {
  return layer.name + '.' + layer.channels[channel];
}

void insert_layer(const ImageLayer& layer, const Imath::Box2i& window, Imf::FrameBuffer& buffer) {
  const std::size_t count = layer.channels.size(), stride = 4 * count;  // both types have 4 bytes
  const std::size_t width = static_cast<std::size_t>(window.max.x - window.min.x) + 1;
  for (std::size_t c = 0; c < count; ++c) {
    const void* first = layer.numbers.empty() ? static_cast<const void*>(layer.values.data() + c)
                                              : static_cast<const void*>(layer.numbers.data() + c);
    buffer.insert(channel_name(layer, c),
                  Imf::Slice::Make(type_of(layer), first, window, stride, stride * width));
  }
}

void add_layer(const ImageLayer& layer, Imf::Header& header, Imf::FrameBuffer& buffer) {
  for (std::size_t c = 0; c < layer.channels.size(); ++c)
    header.channels().insert(channel_name(layer, c), Imf::Channel(type_of(layer)));
  insert_layer(layer, header.dataWindow(), buffer);
}

/// Decompressed, of all channels.
std::size_t bytes_per_pixel(const Imf::ChannelList& channels) {
  std::size_t bytes = 0;
  for (auto it = channels.begin(); it != channels.end(); ++it) {
    bytes += it.channel().type == Imf::HALF ? 2 : 4;
  }
  return bytes;
}

/// A plain image is compressed at once; many layers take seconds.
int compression_threads() {
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 8);
}

/// Other threads change the time alone, not the bytes: where none can be started this one does all.
int start_compression_threads() {
  const int threads = compression_threads();
  try {
    if (Imf::globalThreadCount() < threads) Imf::setGlobalThreadCount(threads);
  } catch (const std::exception&) {
    Imf::setGlobalThreadCount(0);
  }
  return Imf::globalThreadCount();
}

std::string encode_exr(const Image& image, const ImageMetadata& metadata, const ToneMapping&) {
  Imf::Header header = header_of(image);
  header.compression() = image.is_compressed ? Imf::ZIP_COMPRESSION : Imf::NO_COMPRESSION;
  const Names rgb = {"R", "G", "B"};
  for (const char* name : rgb) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  Imf::FrameBuffer buffer = frame_buffer(image.rgb.data(), header.dataWindow(), rgb);
  for (const ImageLayer& layer : image.layers) add_layer(layer, header, buffer);
  for (const auto& [key, value] : metadata) {
    if (is_reserved(key)) throw Error(fmt::format("metadata key '{}' is taken by OpenEXR", key));
    header.insert(key, Imf::StringAttribute(value));
  }
  ExrWriter stream;
  if (!image.is_compressed) {  // its size is known but for the header: it grows in place
    const std::size_t pixels = std::size_t{1} * image.width * image.height;
    stream.bytes.reserve(pixels * bytes_per_pixel(header.channels()) + 65536);
  }
  {
    const int threads = start_compression_threads();
    Imf::OutputFile file(stream, header, threads);
    file.setFrameBuffer(buffer);
    file.writePixels(image.height);
  }  // writes the table of offsets
  return std::move(stream.bytes);
}

std::string all_names(const Imf::ChannelList& channels) {
  std::string names;
  for (auto it = channels.begin(); it != channels.end(); ++it) {
    names += names.empty() ? it.name() : fmt::format(", {}", it.name());
  }
  return names;
}

/// Luminance without the differences that would make it a colour.
bool is_grey(const Imf::ChannelList& channels) {
  for (const char* name : {"R", "G", "B", "RY", "BY"}) {
    if (channels.findChannel(name)) return false;
  }
  return channels.findChannel("Y") != nullptr;
}

/// R, G and B, or Y where there is none of them. Refuses files without or with fewer pixels in one.
Names channels_to_read(const Imf::ChannelList& channels) {
  const Names names = is_grey(channels) ? Names{"Y"} : Names{"R", "G", "B"};
  for (const char* name : names) {
    const Imf::Channel* channel = channels.findChannel(name);
    if (!channel) throw Error(fmt::format("no channel {}, only {}", name, all_names(channels)));
    if (channel->xSampling != 1 || channel->ySampling != 1) {
      throw Error(fmt::format("channel {} is subsampled", name));
    }
  }
  return names;
}

/// The layers that are wanted besides the image.
struct LayersWanted {
  std::string prefix;  ///< of their names
  bool only_numbers;
};

/// Blank layers for the channels PREFIX...C, in the order of the file; R, G and B in this order.
std::vector<ImageLayer> blank_layers(const Imf::ChannelList& channels, const LayersWanted& wanted,
                                     std::size_t pixels) {
  std::vector<ImageLayer> layers;
  for (auto it = channels.begin(); it != channels.end(); ++it) {
    const std::string name = it.name();
    const Imf::Channel& channel = it.channel();
    const std::size_t dot = name.size() < 2 ? name.npos : name.size() - 2;
    if (dot == name.npos || name[dot] != '.' || !name.starts_with(wanted.prefix)) continue;
    const bool has_numbers = channel.type == Imf::UINT;
    if (channel.xSampling != 1 || channel.ySampling != 1) continue;
    if (wanted.only_numbers && !has_numbers) continue;
    if (layers.empty() || layers.back().name != name.substr(0, dot)) {
      layers.push_back({name.substr(0, dot), "", {}, {}});
      if (has_numbers) layers.back().numbers.resize(1);  // its type
    }
    if (has_numbers == !layers.back().numbers.empty()) layers.back().channels += name.back();
  }
  for (ImageLayer& layer : layers) {
    if (layer.channels == "BGR") layer.channels = "RGB";
    if (layer.channels == "ABGR") layer.channels = "RGBA";
    const std::size_t size = pixels * layer.channels.size();
    layer.numbers.empty() ? layer.values.resize(size) : layer.numbers.resize(size);
  }
  return layers;
}

/// `wanted`: null: no layers.
Image read_exr(std::string_view bytes, ImageMetadata* metadata, const LayersWanted* wanted) {
  const ExrSize announced = check_exr_header(bytes);
  const double pixels =
      static_cast<double>(announced.width) * static_cast<double>(announced.height);
  const double stored = static_cast<double>(announced.bytes_per_pixel) * pixels;
  AnnouncedSize size{announced.width, announced.height, stored};
  // OpenEXR unpacks up to 256 lines, or a row of tiles, at once.
  size.decoding_bytes = 2.0 * stored * std::min(1.0, 256.0 / static_cast<double>(size.height));
  if (wanted != nullptr) size.decoding_bytes += 2.0 * stored;  // of halves, floats
  check_image_size(size, bytes.size());
  // For the whole process, hence the same value each time.
  Imf::Header::setMaxImageSize(max_image_size, max_image_size);
  Imf::Header::setMaxTileSize(max_tile_size, max_tile_size);
  ExrReader stream(bytes);
  Imf::InputFile file(stream, 0);
  const Imf::Header& header = file.header();
  const Names names = channels_to_read(header.channels());
  if (!file.isComplete()) throw Error("truncated: some of its pixels are missing");

  const Imath::Box2i window = header.dataWindow();
  Image image = allocate_image(size, bytes.size());
  Imf::FrameBuffer buffer = frame_buffer(image.rgb.data(), window, names);
  if (wanted != nullptr) {
    image.layers = blank_layers(header.channels(), *wanted, image.rgb.size() / 3);
    for (const ImageLayer& layer : image.layers) insert_layer(layer, window, buffer);
  }
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  if (names.size() == 1) {
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
      image.rgb[i + 1] = image.rgb[i + 2] = image.rgb[i];
    }
  }

  for (auto it = header.begin(); it != header.end(); ++it) {
    const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute());
    if (text && !is_reserved(it.name())) (*metadata)[it.name()] = text->value();
  }
  return image;
}

Image decode(std::string_view bytes, ImageMetadata* metadata, const LayersWanted* wanted) {
  try {
    return read_exr(bytes, metadata, wanted);
  } catch (const Iex::BaseExc& error) {
    // OpenEXR begins with 'Cannot read image file "NAME". ', and our stream has no name.
    const std::string_view message = error.what();
    const std::size_t name = message.rfind("\"\". ");
    throw Error(std::string(name == message.npos ? message : message.substr(name + 4)));
  }
}

Image decode_exr(std::string_view bytes, ImageMetadata* metadata) {
  return decode(bytes, metadata, nullptr);
}

}  // namespace

Image decode_exr_numbers(std::string_view bytes, const std::string& prefix,
                         ImageMetadata* metadata) {
  const LayersWanted wanted{prefix, true};
  return decode(bytes, metadata, &wanted);
}

Image decode_exr_layers(std::string_view bytes, ImageMetadata* metadata) {
  const LayersWanted wanted{"", false};
  return decode(bytes, metadata, &wanted);
}

const ImageCodec exr_codec{".exr", encode_exr, decode_exr};

}  // namespace pt
