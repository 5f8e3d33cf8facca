#include "common/accel/trace_optix/optix_structure.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>

#include "common/error/error.h"

namespace pt {
namespace {

// In half ulps. Where a triangle is met, its point is beside the ray by hit_error_distance of the
// distance, which is up to sqrt(3) times the one along an axis: with the ray's reach, and half the
// scene.
constexpr float near_reach = 8.0f, near_error = 1.75f * (near_reach + 0.5f) * hit_error_distance;
// In an instance's space, of the sum of the terms' sizes of a transformed point: twice that for the
// ray's two ends, and what our transform, OptiX's and its inverse lose.
constexpr float instance_reach = 1.5f,
                instance_error = 1.75f * 2 * hit_error_distance + 64.0f * half_ulp;
// The same of spheres: for a distance D of up to 1.75 * 2 times the largest coordinate, a radius r
// of a third, and what OptiX's transform and the box's planes lose. sphere_distance() finds t = b -
// h with off = c - o - b d, c - o and b d being wrong by 3u D in all and t by u (D + r); h^2 +
// off^2 = r^2 within 14u r^2 (5u of the root, 4u r^2 of the sum, which is >= 0). o + t d - c is -(h
// d + off) but for that, |d|^2 is 1 within 12u, and d . off at most 19u D. So the exact ray's point
// at t lies no farther from c than r + 23u D + 14u r.
constexpr float sphere_error = (1.75f * 2 * 23 + 20.0f / 3 + 64) * half_ulp;

float size_of(const Bounds& bounds) { return max_abs(bounds.max - bounds.min); }

/// Upper bound on the coordinates, and on all terms of their sums, of points of the box in the
/// instance's space.
float size_inside(const Affine& to_object, const Bounds& world) {
  const Vec3 most = glm::max(glm::abs(world.min), glm::abs(world.max));
  float size = 0;
  for (const Vec4& row : to_object.row) {
    size = std::max(size, std::abs(row.x) * most.x + std::abs(row.y) * most.y +
                              std::abs(row.z) * most.z + std::abs(row.w));
  }
  return size;
}

float norm_of(const Affine& transform) {
  float norm = 0;
  for (const Vec4& row : transform.row)
    norm = std::max(norm, std::abs(row.x) + std::abs(row.y) + std::abs(row.z));
  return norm;
}

}  // namespace

OptixStructure::OptixStructure(const OptixContext& context, OptixMemory& memory,
                               const TriangleTree& tree, OptixHits hits,
                               const Primitives& primitives)
    : context_(context),
      memory_(memory),
      content_{tree.instance_count > 0 || primitives.sphere_count > 0,
               primitives.sphere_count > 0} {
  const auto begin = std::chrono::steady_clock::now();
  if (content_.has_instances) {
    std::vector<Sphere> spheres(primitives.sphere_count);
    if (content_.has_spheres)
      memory_.to_host(spheres.data(), primitives.spheres, spheres.size() * sizeof(Sphere));
    build_scene(tree, hits, spheres);
  } else if (tree.triangle_count > 0) {
    build_triangles(tree, hits);
  }
  build_ms_ =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

Bounds OptixStructure::bounds_of_triangles(const TriangleTree& tree) const {
  std::vector<Triangle> triangles(tree.triangle_count);
  memory_.to_host(triangles.data(), tree.triangles, triangles.size() * sizeof(Triangle));
  Bounds all;
  for (const Triangle& t : triangles) all.grow(triangle_bounds(t.v0, t.v1, t.v2));
  return all;
}

void OptixStructure::build_triangles(const TriangleTree& tree, OptixHits hits) {
  const Bounds all = bounds_of_triangles(tree);
  reach_ = {0.5f * (all.min + all.max), near_reach * size_of(all), 0};
  handle_ = build_group(tree.triangles, tree.triangle_count, hits, {near_error * size_of(all)});
}

/// The groups and the instances.
void OptixStructure::build_scene(const TriangleTree& tree, OptixHits hits,
                                 const std::vector<Sphere>& spheres) {
  std::vector<InstanceRecord> records(tree.instance_count);
  if (tree.instance_count > 0) {
    memory_.to_host(records.data(), tree.instances, records.size() * sizeof(InstanceRecord));
  } else if (tree.triangle_count > 0) {
    InstanceRecord& all = records.emplace_back();
    all.slot_count = tree.triangle_count, all.bounds = bounds_of_triangles(tree);
  }
  Bounds world;
  for (const InstanceRecord& record : records) world.grow(record.bounds);
  for (const Sphere& sphere : spheres) world.grow(sphere_bounds(sphere));
  reach_ = {0.5f * (world.min + world.max), instance_reach * size_of(world), 0};
  const Bounds reached{reach_.centre - Vec3(reach_.distance),
                       reach_.centre + Vec3(reach_.distance)};
  // In the order of the slots, so that a group is found by its first one.
  std::vector<Group> groups;
  for (const InstanceRecord& record : records)
    groups.push_back({record.first_slot, record.slot_count, 0});
  std::ranges::sort(groups, {}, &Group::first_slot);
  const auto is_same = [](const Group& a, const Group& b) { return a.first_slot == b.first_slot; };
  groups.erase(std::unique(groups.begin(), groups.end(), is_same), groups.end());
  std::vector<float> margins(groups.size());
  for (const InstanceRecord& record : records) {
    const auto g = static_cast<std::size_t>(
        std::ranges::lower_bound(groups, record.first_slot, {}, &Group::first_slot) -
        groups.begin());
    const float margin = instance_error * size_inside(record.to_object, reached);
    margins[g] = std::max(margins[g], margin);
    reach_.cull_margin = std::max(reach_.cull_margin, margin * norm_of(inverse(record.to_object)));
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    groups[g].handle = build_group(tree.triangles + groups[g].first_slot, groups[g].slot_count,
                                   hits, {margins[g]});
  }
  handle_ = build_instances(records, groups, build_spheres(spheres, reached));
}

/// As boxes, in world space.
optix::TraversableHandle OptixStructure::build_spheres(const std::vector<Sphere>& spheres,
                                                       const Bounds& reached) {
  if (spheres.empty()) return 0;
  check_count("spheres", spheres.size(), optix::property_max_primitives);
  const float margin = sphere_error * size_inside({}, reached);
  reach_.cull_margin = std::max(reach_.cull_margin, margin);
  std::vector<optix::Box> boxes(spheres.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Bounds box = sphere_bounds(spheres[i]);
    for (int axis = 0; axis < 3; ++axis) {
      boxes[i].min[axis] = lowered(box.min[axis], margin);
      boxes[i].max[axis] = raised(box.max[axis], margin);
    }
  }
  const OptixBuffer device(memory_, boxes.size() * sizeof(optix::Box), "OptiX's boxes");
  memory_.to_device(device.get(), boxes.data(), device.bytes());
  return build_boxes(device, static_cast<std::uint32_t>(boxes.size()));
}

void OptixStructure::check_count(const char* what, std::size_t count, int property) const {
  const unsigned most = context_.property(property);
  if (count > most)
    throw Error(fmt::format("--accel optix: {} {}; OptiX takes at most {}", count, what, most));
}

optix::TraversableHandle OptixStructure::build_boxes(const OptixBuffer& boxes,
                                                     std::uint32_t count) {
  const optix::DevicePointer address = boxes.address();
  const unsigned flags = optix::geometry_none;
  optix::BuildInput input{};
  input.type = optix::input_custom;
  input.boxes.boxes = &address;
  input.boxes.count = count;
  input.boxes.stride = sizeof(optix::Box);
  input.boxes.flags = &flags;
  input.boxes.record_count = 1;
  return build(input);
}

optix::TraversableHandle OptixStructure::build_group(const Triangle* triangles, std::uint32_t count,
                                                     OptixHits hits, const OptixBoxMargin& margin) {
  check_count("triangles of a group", count, optix::property_max_primitives);
  if (hits == OptixHits::custom) {
    const OptixBuffer boxes(memory_, count * sizeof(optix::Box), "OptiX's boxes");
    memory_.enqueue_boxes(static_cast<optix::Box*>(boxes.get()), triangles, count, margin);
    return build_boxes(boxes, count);
  }
  optix::BuildInput input{};
  const unsigned flags = optix::geometry_none;
  static_assert(sizeof(Triangle) == 3 * 16);  // a vertex is the first 12 of 16 bytes
  const auto address = reinterpret_cast<optix::DevicePointer>(triangles);
  input.type = optix::input_triangles;
  input.triangles.vertex_buffers = &address;
  input.triangles.vertex_count = 3 * count;
  input.triangles.vertex_format = optix::vertex_format_float3;
  input.triangles.vertex_stride = 16;
  input.triangles.index_format = optix::index_format_none;
  input.triangles.flags = &flags;
  input.triangles.record_count = 1;
  return build(input);
}

optix::TraversableHandle OptixStructure::build_instances(const std::vector<InstanceRecord>& records,
                                                         const std::vector<Group>& groups,
                                                         optix::TraversableHandle spheres) {
  std::vector<optix::Instance> instances(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    optix::Instance& instance = instances[i];
    const Affine to_world = inverse(records[i].to_object);
    static_assert(sizeof to_world.row == sizeof instance.to_world);
    std::memcpy(instance.to_world, to_world.row, sizeof instance.to_world);
    instance.id = static_cast<unsigned>(i);
    instance.visibility = 0xff;
    instance.group =
        std::ranges::lower_bound(groups, records[i].first_slot, {}, &Group::first_slot)->handle;
  }
  if (spheres != 0) {
    optix::Instance& instance = instances.emplace_back();
    static_assert(sizeof(Affine) == sizeof instance.to_world);
    const Affine identity;
    std::memcpy(instance.to_world, &identity, sizeof instance.to_world);
    instance.record_offset = optix_records;
    instance.visibility = 0xff;
    instance.group = spheres;
  }
  check_count("instances", instances.size(), optix::property_max_instances);
  const OptixBuffer device(memory_, instances.size() * sizeof(optix::Instance),
                           "OptiX's instances");
  memory_.to_device(device.get(), instances.data(), device.bytes());
  optix::BuildInput input{};
  input.type = optix::input_instances;
  input.instances.instances = device.address();
  input.instances.count = static_cast<unsigned>(instances.size());
  return build(input);
}

/// Builds and compacts; what the input refers to is needed until then.
optix::TraversableHandle OptixStructure::build(const optix::BuildInput& input) {
  const optix::FunctionTable& call = context_.functions();
  const OptixLibrary& library = context_.library();
  optix::BuildOptions options{};
  options.flags = optix::build_allow_compaction | optix::build_prefer_fast_trace;
  options.operation = optix::build_operation_build;
  optix::BufferSizes sizes{};
  library.check(call.accel_memory(context_.get(), &options, &input, 1, &sizes),
                "optixAccelComputeMemoryUsage");
  OptixBuffer built(memory_, sizes.output, "OptiX's structure");
  optix::TraversableHandle handle = 0;
  std::uint64_t compacted_bytes = 0;
  {
    const OptixBuffer scratch(memory_, std::max<std::size_t>(sizes.scratch, 1),
                              "OptiX's scratch memory");
    const OptixBuffer size(memory_, sizeof compacted_bytes, "OptiX's sizes");
    const optix::EmitDescription emit{size.address(), optix::emit_compacted_size};
    library.check(
        call.accel_build(context_.get(), memory_.stream(), &options, &input, 1, scratch.address(),
                         sizes.scratch, built.address(), sizes.output, &handle, &emit, 1),
        "optixAccelBuild");
    memory_.to_host(&compacted_bytes, size.get(), sizeof compacted_bytes);
  }
  bytes_built_ += sizes.output;
  if (compacted_bytes > 0 && compacted_bytes < sizes.output) {
    OptixBuffer compacted(memory_, compacted_bytes, "OptiX's structure");
    library.check(call.accel_compact(context_.get(), memory_.stream(), handle, compacted.address(),
                                     compacted_bytes, &handle),
                  "optixAccelCompact");
    memory_.synchronize();
    built = std::move(compacted);
  }
  bytes_ += built.bytes();
  buffers_.push_back(std::move(built));
  return handle;
}

}  // namespace pt
