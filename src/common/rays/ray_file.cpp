#include "common/rays/ray_file.h"

#include <fmt/format.h>

#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string_view>

#include "common/accel/triangle_query.h"
#include "common/error/error.h"
#include "common/image/atomic_file.h"

namespace pt {
namespace {

static_assert(std::endian::native == std::endian::little, "the files are little endian");

constexpr std::string_view mesh_magic = "TRBMESH1", rays_magic = "TRBRAYS1",
                           hits_magic = "TRBHITS1";

struct MeshHeader {
  char magic[8];
  std::uint32_t vertices, triangles;
};

struct SetHeader {
  char magic[8];
  std::uint64_t count;
  std::uint32_t type;
  std::uint32_t reserved[3];
};
static_assert(sizeof(MeshHeader) == 16 && sizeof(SetHeader) == 32);

[[noreturn]] void fail(const std::string& path, const std::string& problem) {
  throw Error(fmt::format("{}: {}", path, problem));
}

/// A binary file with a header of a known kind.
class Input {
 public:
  explicit Input(const std::string& path) : path_(path), stream_(path, std::ios::binary) {
    errno = 0;
    stream_.seekg(0, std::ios::end);
    const std::streamoff size = stream_.tellg();
    if (!stream_ || size < 0)
      fail(path, fmt::format("cannot be read: {}", std::strerror(errno ? errno : ENOENT)));
    size_ = static_cast<std::uint64_t>(size);
    stream_.seekg(0);
  }

  template <class Header>
  Header header(std::string_view magic) {
    Header header;
    if (size_ < sizeof header) fail(path_, fmt::format("expected a {} file, is too short", magic));
    read(&header, sizeof header);
    if (std::string_view(header.magic, 8) != magic)
      fail(path_, fmt::format("expected a {} file, begins with other bytes", magic));
    return header;
  }

  /// The counts of a header demand this many bytes in all.
  void check_size(std::uint64_t expected) const {
    if (size_ != expected)
      fail(path_, fmt::format("has {} bytes, its header says {}", size_, expected));
  }

  void read(void* data, std::uint64_t bytes) {
    stream_.read(static_cast<char*>(data), static_cast<std::streamsize>(bytes));
    if (!stream_) fail(path_, "cannot be read to its end");
  }

 private:
  std::string path_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
};

/// Reads the records of a set; none where the header is wrong.
template <class Record>
std::vector<Record> read_set(const std::string& path, std::string_view magic, RayType& type) {
  Input input(path);
  const auto header = input.header<SetHeader>(magic);
  if (header.type > 1)
    fail(path, fmt::format("type {}: expected 0 (closest hit) or 1 (any hit)", header.type));
  constexpr std::uint64_t most = 0xffffffffu;  // threads number rays with 32 bits
  if (header.count > most)
    fail(path, fmt::format("{} entries: expected {} at most", header.count, most));
  input.check_size(sizeof header + header.count * sizeof(Record));
  std::vector<Record> records(header.count);
  input.read(records.data(), header.count * sizeof(Record));
  type = static_cast<RayType>(header.type);
  return records;
}

template <class Record>
void write_set(const std::string& path, std::string_view magic, RayType type,
               const std::vector<Record>& records) {
  SetHeader header{};
  std::memcpy(header.magic, magic.data(), 8);
  header.count = records.size();
  header.type = static_cast<std::uint32_t>(type);
  std::string bytes(sizeof header + records.size() * sizeof(Record), '\0');
  std::memcpy(bytes.data(), &header, sizeof header);
  if (!records.empty())
    std::memcpy(bytes.data() + sizeof header, records.data(), records.size() * sizeof(Record));
  write_file_atomically(path, bytes);
}

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

Mesh read_trace_mesh(const std::string& path) {
  Input input(path);
  const auto header = input.header<MeshHeader>(mesh_magic);
  input.check_size(sizeof header + std::uint64_t{header.vertices} * sizeof(Vec3) +
                   std::uint64_t{header.triangles} * sizeof(TriangleIndices));
  Mesh mesh;
  mesh.positions.resize(header.vertices);
  mesh.triangles.resize(header.triangles);
  input.read(mesh.positions.data(), mesh.positions.size() * sizeof(Vec3));
  input.read(mesh.triangles.data(), mesh.triangles.size() * sizeof(TriangleIndices));
  check_trace_mesh(mesh, path);
  return mesh;
}

void check_trace_mesh(const Mesh& mesh, const std::string& name) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    if (!is_finite(mesh.positions[i])) fail(name, fmt::format("vertex {} is not finite", i));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t v : mesh.triangles[i].v)
      if (v >= mesh.positions.size())
        fail(name,
             fmt::format("triangle {} has vertex {}: there are {}", i, v, mesh.positions.size()));
}

void check_rays(const RaySet& set, const std::string& name) {
  for (std::size_t i = 0; i < set.rays.size(); ++i) {
    const RayRecord& ray = set.rays[i];
    if (!is_finite(ray.origin) || !is_finite(ray.direction))
      fail(name, fmt::format("ray {} is not finite", i));
    if (!is_traceable(ray.ray())) fail(name, fmt::format("ray {} has no direction", i));
    if (!(ray.t_min >= 0.0f) || std::isnan(ray.t_max))
      fail(name, fmt::format("ray {} is from {} to {}: expected 0 or more to a number", i,
                             ray.t_min, ray.t_max));
  }
}

RaySet read_rays(const std::string& path) {
  RaySet set;
  set.rays = read_set<RayRecord>(path, rays_magic, set.type);
  check_rays(set, path);
  return set;
}

HitSet read_hits(const std::string& path) {
  HitSet set;
  set.hits = read_set<HitRecord>(path, hits_magic, set.type);
  return set;
}

void write_trace_mesh(const std::string& path, const Mesh& mesh) {
  MeshHeader header{};
  std::memcpy(header.magic, mesh_magic.data(), 8);
  header.vertices = static_cast<std::uint32_t>(mesh.positions.size());
  header.triangles = static_cast<std::uint32_t>(mesh.triangles.size());
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
  bytes.append(reinterpret_cast<const char*>(mesh.positions.data()),
               mesh.positions.size() * sizeof(Vec3));
  bytes.append(reinterpret_cast<const char*>(mesh.triangles.data()),
               mesh.triangles.size() * sizeof(TriangleIndices));
  write_file_atomically(path, bytes);
}

void write_rays(const std::string& path, const RaySet& rays) {
  write_set(path, rays_magic, rays.type, rays.rays);
}

void write_hits(const std::string& path, const HitSet& hits) {
  write_set(path, hits_magic, hits.type, hits.hits);
}

}  // namespace pt
