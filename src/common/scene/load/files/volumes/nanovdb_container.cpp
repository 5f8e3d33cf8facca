#include <blosc.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <span>

#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/scene/load/files/volumes/nanovdb.h"

namespace pt::nanovdb_files {
namespace {

constexpr std::uint64_t file_magic = 0x324244566f6e614e;     // "NanoVDB2", of later versions
constexpr std::uint64_t openvdb_magic = 0x0000000056444220;  // of OpenVDB's files
constexpr std::uint32_t major_version = NANOVDB_MAJOR_VERSION_NUMBER;
/// The most bytes that one byte of a compressed file becomes: deflate's; blosc's LZ4 has 255.
constexpr std::uint64_t most_packed = 1032;

/// Reads one thing after the other from bytes that may end too early.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  bool at_end() const { return rest_.empty(); }

  std::string_view take(std::uint64_t size, const char* what) {
    if (size > rest_.size()) {
      throw Error(fmt::format("truncated: {} bytes of {}, expected {}", rest_.size(), what, size));
    }
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }

  template <class T>
  void read(T& value, const char* what) {
    std::memcpy(static_cast<void*>(&value), take(sizeof value, what).data(), sizeof value);
  }

 private:
  std::string_view rest_;
};

void expect_nanovdb(std::uint64_t first_bytes, bool is_first) {
  if (first_bytes == magic || first_bytes == file_magic) return;
  if (!is_first) throw Error("damaged: expected the end or 'NanoVDB' behind its grids");
  if (first_bytes == openvdb_magic) {
    throw Error(
        "a file of OpenVDB, expected one of NanoVDB: 'vdb_tool -read a.vdb -write a.nvdb' "
        "converts it");
  }
  throw Error("not a .nvdb file: expected 'NanoVDB' at its beginning");
}

std::string names_of(const std::vector<GridEntry>& entries) {
  std::string names;
  for (const GridEntry& entry : entries) {
    names += (names.empty() ? "" : ", ") + in_quotes(entry.name);
    if (names.size() > 400) break;
  }
  return names.empty() ? "none" : clipped(names, 400);
}

void unzip(ByteReader& reader, GridBytes& bytes) {
  std::uint64_t packed_size = 0;
  reader.read(packed_size, "a packed grid");
  const std::string_view packed = reader.take(packed_size, "a packed grid");
  uLongf size = bytes.size();
  const int status = uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                                reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  if (status != Z_OK || size != bytes.size()) {
    throw Error(fmt::format("damaged: expected {} bytes packed by zip", bytes.size()));
  }
}

void unpack_blosc(ByteReader& reader, GridBytes& bytes) {
  constexpr std::uint64_t most_at_once = std::uint64_t{1} << 30;  // NanoVDB's
  for (std::uint64_t done = 0; done < bytes.size();) {
    const std::uint64_t expected = std::min(bytes.size() - done, most_at_once);
    std::uint64_t packed_size = 0;
    reader.read(packed_size, "a packed grid");
    const std::string_view packed = reader.take(packed_size, "a packed grid");
    std::size_t size = 0;
    const bool is_whole = blosc_cbuffer_validate(packed.data(), packed.size(), &size) == 0;
    if (!is_whole || size != expected ||
        blosc_decompress_ctx(packed.data(), bytes.data() + done, expected, 1) !=
            static_cast<int>(expected)) {
      throw Error(fmt::format("damaged: expected {} bytes packed by blosc", expected));
    }
    done += expected;
  }
}

constexpr std::uint32_t no_checksum = 0xffffffff;
constexpr std::uint32_t last_known_minor = 5;  // later versions have other checksums

std::uint32_t checksum(const void* data, std::size_t size) {
  return static_cast<std::uint32_t>(crc32_z(0, static_cast<const Bytef*>(data), size));
}

}  // namespace

void expect_version(const nanovdb::Version& version) {
  if (version.getMajor() == major_version) return;
  throw Error(fmt::format("version {}.{}.{} of the format, expected {}", version.getMajor(),
                          version.getMinor(), version.getPatch(), major_version));
}

std::vector<GridEntry> entries_of(std::string_view bytes) {
  ByteReader reader(bytes);
  std::vector<GridEntry> entries;
  bool is_first = true;
  do {
    std::uint64_t first_bytes = 0;
    if (bytes.size() >= sizeof first_bytes) {
      reader.read(first_bytes, "a header");
    }
    expect_nanovdb(first_bytes, is_first);
    is_first = false;
    struct {
      nanovdb::Version version;
      std::uint16_t grids;
      std::uint16_t codec;
    } header;
    reader.read(header, "a header");
    expect_version(header.version);
    if (header.codec >= static_cast<std::uint16_t>(nanovdb::io::Codec::END)) {
      throw Error(fmt::format("codec {}, expected 0, 1 or 2: none, zip or blosc", header.codec));
    }
    std::vector<std::uint64_t> sizes;
    const std::size_t first = entries.size();
    for (int i = 0; i < header.grids; ++i) {
      nanovdb::io::MetaData meta;
      reader.read(meta, "what describes a grid");
      const std::string_view name = reader.take(meta.nameSize, "a grid's name");
      entries.push_back({std::string(name.substr(0, name.find('\0'))),
                         static_cast<nanovdb::io::Codec>(header.codec),
                         meta.gridSize,
                         {}});
      sizes.push_back(meta.fileSize);
    }
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      entries[first + i].data = reader.take(sizes[i], "a grid");
    }
  } while (!reader.at_end());
  return entries;
}

const GridEntry* find_entry(const std::vector<GridEntry>& entries, const std::string& name) {
  const auto found = std::ranges::find(entries, name, &GridEntry::name);
  return found == entries.end() ? nullptr : &*found;
}

const GridEntry& choose_entry(const std::vector<GridEntry>& entries, const std::string& name) {
  const std::string wanted = name.empty() ? "density" : name;
  if (const GridEntry* entry = find_entry(entries, wanted)) return *entry;
  if (name.empty() && entries.size() == 1) return entries.front();
  throw Error(fmt::format("no grid '{}'; expected one of: {}", wanted, names_of(entries)));
}

GridBytes unpack(const GridEntry& entry) {
  if (entry.size / most_packed > entry.data.size()) {  // nothing is allocated for a lie
    throw Error(fmt::format("damaged: {} bytes, expected those of a grid of {}", entry.data.size(),
                            entry.size));
  }
  check_host_memory(entry.size, "the sparse grid");
  GridBytes bytes(entry.size);
  ByteReader reader(entry.data);
  switch (entry.codec) {
    case nanovdb::io::Codec::ZIP:
      unzip(reader, bytes);
      break;
    case nanovdb::io::Codec::BLOSC:
      unpack_blosc(reader, bytes);
      break;
    default:
      std::ranges::copy(std::as_bytes(std::span(reader.take(entry.size, "a grid"))), bytes.data());
  }
  return bytes;
}

void expect_whole(const GridBytes& bytes, std::uint64_t root_end, NodeLevels levels) {
  std::vector<NodeBytes> nodes = {{bytes.data(), root_end, root_end}};
  for (const auto& level : levels) nodes.insert(nodes.end(), level.begin(), level.end());
  std::ranges::sort(nodes, {}, &NodeBytes::begin);
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    if (nodes[i - 1].begin + nodes[i - 1].size > nodes[i].begin)
      throw Error("damaged: nodes used twice");
  }
  const auto& grid = bytes.at<nanovdb::GridData>(0);
  const auto head_sum = static_cast<std::uint32_t>(grid.mChecksum);
  const auto node_sum = static_cast<std::uint32_t>(grid.mChecksum >> 32);
  if (grid.mVersion.getMinor() > last_known_minor || head_sum == no_checksum) return;
  constexpr std::size_t first = 16;  // behind the magic number and the checksum
  bool is_right = head_sum == checksum(bytes.data() + first, root_end - first);
  if (is_right && node_sum != no_checksum && !levels[0].empty()) {
    std::vector<std::uint64_t> sums;
    for (std::vector<NodeBytes>& level : levels) {
      if (grid.mFlags & static_cast<std::uint32_t>(nanovdb::GridFlags::IsBreadthFirst))
        std::ranges::sort(level, {}, &NodeBytes::begin);
      const std::size_t before = sums.size();
      sums.resize(before + level.size());
      tbb::parallel_for(std::size_t{0}, level.size(), [&](std::size_t i) {
        sums[before + i] = checksum(level[i].begin, level[i].head);
      });
    }
    is_right = node_sum == checksum(sums.data(), sums.size() * sizeof sums[0]);
  }
  if (!is_right) throw Error("damaged: its checksum is another");
}

}  // namespace pt::nanovdb_files
