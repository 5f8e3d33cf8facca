#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "common/error/error.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/scene/prepare/prepare_steps.h"

namespace pt {
namespace {

using DMat3 = glm::dmat3;
using DVec3 = glm::dvec3;

struct Decomposed {
  DVec3 translation;
  glm::dquat rotation;
  DMat3 stretch;  ///< symmetric
};

DMat3 linear_part(const Affine& a) {
  DMat3 linear;  // by columns
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) linear[j][i] = double{a.row[i][j]};
  return linear;
}

double size_of(const DMat3& m) {
  double sum = 0;
  for (int j = 0; j < 3; ++j) sum += glm::dot(m[j], m[j]);
  return std::sqrt(sum);
}

/// The orthogonal factor of M, averaged with its inverse transpose until it is its own (Higham
/// 1986). Of a map that mirrors, the rotation is the opposite of the factor.
Decomposed decompose(const Affine& a) {
  const DMat3 linear = linear_part(a);
  DMat3 factor = linear;
  for (int i = 0; i < 100; ++i) {
    const DMat3 next = 0.5 * (factor + glm::transpose(glm::inverse(factor)));
    const double change = size_of(next - factor);
    factor = next;
    if (change < 1e-14 * size_of(factor)) break;
  }
  if (glm::determinant(factor) < 0) factor = -factor;
  const DMat3 stretch = glm::transpose(factor) * linear;
  return {DVec3(a.translation()), glm::normalize(glm::quat_cast(factor)),
          0.5 * (stretch + glm::transpose(stretch))};
}

Vec4 to_vec4(const glm::dquat& q) { return Vec4(glm::dvec4(q.x, q.y, q.z, q.w)); }

MotionSegment make_segment(const Decomposed& from, Decomposed to, double begin, double end) {
  MotionSegment segment;
  if (glm::dot(from.rotation, to.rotation) < 0) to.rotation = -to.rotation;  // the shorter way
  const double cosine = glm::dot(from.rotation, to.rotation);
  const glm::dquat across = to.rotation - from.rotation * cosine;
  const double sine = glm::length(across);
  segment.begin = static_cast<float>(begin), segment.end = static_cast<float>(end);
  segment.inverse_length = static_cast<float>(1.0 / (end - begin));
  segment.translation = Vec3(from.translation);
  segment.translated = Vec3(to.translation - from.translation);
  segment.rotation = to_vec4(from.rotation);
  constexpr double still = 1e-9;  // below what single precision can tell
  if (sine > still) {
    segment.towards = to_vec4(across * (1.0 / sine));
    segment.turns = static_cast<float>(std::atan2(sine, cosine) / (2 * double{pi}));
  }
  for (int i = 0; i < 3; ++i) {  // symmetric: rows are columns
    segment.stretch[i] = Vec3(from.stretch[i]);
    segment.stretched[i] = Vec3(to.stretch[i] - from.stretch[i]);
  }
  return segment;
}

/// A sphere stays one of the same radius if its keys have the same scale in all directions.
void check_rigid(const std::vector<TransformKey>& keys, const std::string& what) {
  const double scale = decompose(keys.front().to_world).stretch[0][0];
  for (const TransformKey& key : keys) {
    const DMat3 rest = decompose(key.to_world).stretch - DMat3(scale);
    if (!(size_of(rest) <= 1e-3 * std::abs(scale)))
      throw Error(what + " is scaled while it moves; expected poses that turn and move");
  }
}

MotionTrack add_track(const std::vector<TransformKey>& keys, const Shutter& shutter,
                      const std::string& what, MotionTracks& tracks) {
  check_keys(keys, what);
  const MotionTrack track{static_cast<std::uint32_t>(tracks.segments.size()),
                          static_cast<std::uint32_t>(keys.size() - 1)};
  const double open = double{shutter.open}, length = double{shutter.close} - open;
  Decomposed from = decompose(keys[0].to_world);
  for (std::size_t i = 1; i < keys.size(); ++i) {
    const Decomposed to = decompose(keys[i].to_world);
    tracks.segments.push_back(make_segment(from, to, (double{keys[i - 1].time} - open) / length,
                                           (double{keys[i].time} - open) / length));
    from = to;
  }
  return track;
}

void check_vertex_sets(const SceneData& scene) {
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const Mesh& mesh = scene.meshes[i];
    const auto check = [&](std::size_t found, std::size_t expected, const char* what) {
      if (found != expected)
        throw Error(fmt::format("scene '{}': mesh {}, which deforms, has {} {}; expected {}",
                                scene.name, i, found, what, expected));
    };
    if (mesh.vertex_sets() == 1) continue;
    check(mesh.vertex_sets(), scene.vertex_sets(), "sets of vertices");
    if (!mesh.later_normals.empty())
      check(mesh.later_normals.size() + 1, mesh.vertex_sets(), "sets of normals");
    for (const std::vector<Vec3>& set : mesh.later_positions)
      check(set.size(), mesh.positions.size(), "positions in a later set");
    for (const std::vector<Vec3>& set : mesh.later_normals)
      check(set.size(), mesh.normals.size(), "normals in a later set");
  }
}

}  // namespace

void prepare_motion(SceneData& scene) {
  MotionData& motion = scene.motion;
  motion.prepared.reset();
  if (!scene.moves()) return;
  check_vertex_sets(scene);
  const Shutter& shutter = motion.shutter;
  if (!(shutter.close > shutter.open) || !std::isfinite(shutter.close - shutter.open))
    throw Error(
        fmt::format("scene '{}': the shutter opens at {} s and closes at {} s; expected it "
                    "to close after it opens",
                    scene.name, shutter.open, shutter.close));
  motion.prepared = std::make_shared<PreparedMotion>();
  MotionTracks& tracks = motion.prepared->tracks;
  Motion& view = motion.prepared->view;
  tracks.instances.resize(scene.instances.size() + 1);
  for (const MotionData::MovingInstance& moving : motion.instances) {
    if (moving.instance >= scene.instances.size())
      throw Error(fmt::format("scene '{}': instance {} moves, of {}", scene.name, moving.instance,
                              scene.instances.size()));
    tracks.instances[moving.instance] =
        add_track(moving.keys, shutter, fmt::format("instance {}", moving.instance), tracks);
  }
  for (const MotionData::MovingSphere& moving : motion.spheres) {
    const std::string what = fmt::format("sphere {}", moving.sphere);
    if (moving.sphere >= scene.spheres.size())
      throw Error(
          fmt::format("scene '{}': {} moves, of {}", scene.name, what, scene.spheres.size()));
    tracks.spheres.push_back(add_track(moving.keys, shutter, what, tracks));
    check_rigid(moving.keys, what);
  }
  if (!motion.camera.empty()) {
    tracks.camera = add_track(motion.camera, shutter, "the camera", tracks);
    view.to_camera = inverse(motion.camera.front().to_world);
  }
  view.camera = tracks.camera;
  motion.prepared->update_view();
}

void prepare_moving_spheres(SceneData& scene) {
  if (scene.motion.spheres.empty()) return;
  PreparedMotion& motion = *scene.motion.prepared;
  motion.spheres.assign(scene.spheres.size(), {});
  for (std::size_t i = 0; i < scene.motion.spheres.size(); ++i) {
    const MotionData::MovingSphere& moving = scene.motion.spheres[i];
    motion.spheres[moving.sphere] = {moving.own_center(scene.spheres[moving.sphere].center),
                                     motion.tracks.spheres[i]};
    if (!scene.sphere_frames.empty())
      scene.sphere_frames[moving.sphere].turn(inverse(moving.keys.front().to_world));
  }
  motion.update_view();
}

void hold_still_at(SceneData& scene, float time) {
  prepare_motion(scene);
  if (!scene.motion.prepared) return;
  const Motion& motion = scene.motion.prepared->view;
  const Shutter& shutter = scene.motion.shutter;
  const float part = std::clamp((time - shutter.open) / (shutter.close - shutter.open), 0.0f, 1.0f);
  for (const MotionData::MovingInstance& moving : scene.motion.instances)
    scene.instances[moving.instance].to_world = motion.to_world(moving.instance, part);
  for (std::size_t i = 0; i < scene.motion.spheres.size(); ++i) {
    const MotionData::MovingSphere& moving = scene.motion.spheres[i];
    const Affine way = pose_at(motion.segments, scene.motion.tracks().spheres[i], part) *
                       inverse(moving.keys.front().to_world);
    Vec3& center = scene.spheres[moving.sphere].center;
    center = way.point(center);
    if (!scene.sphere_frames.empty()) scene.sphere_frames[moving.sphere].turn(way);
  }
  if (motion.camera.moves()) {
    const Affine way = pose_at(motion.segments, motion.camera, part) * motion.to_camera;
    CameraParameters& camera = scene.camera;
    camera.look_from = way.point(camera.look_from), camera.look_at = way.point(camera.look_at);
    camera.up = way.vector(camera.up);
  }
  const auto mix = [](std::vector<Vec3> begin, const std::vector<Vec3>& end, float by) {
    for (std::size_t i = 0; i < end.size(); ++i) begin[i] += by * (end[i] - begin[i]);
    return begin;
  };
  for (Mesh& mesh : scene.meshes) {
    if (mesh.vertex_sets() == 1) continue;
    const auto [set, by] = vertex_time(part, static_cast<std::uint32_t>(mesh.vertex_sets() - 1));
    mesh.positions = mix(mesh.positions_of(set), mesh.positions_of(set + 1), by);
    if (mesh.later_normals.empty()) continue;
    mesh.normals = mix(mesh.normals_of(set), mesh.normals_of(set + 1), by);
    for (Vec3& normal : mesh.normals) normal = normalize(normal);
  }
  scene.motion.prepared.reset();
  hold_still(scene);
}

void prepare_moving_lights(SceneData& scene) {
  if (!scene.motion.prepared) return;
  PreparedMotion& motion = *scene.motion.prepared;
  motion.lights = scene.light_list.moving;
  std::vector<std::uint32_t> slots(motion.lights.empty() ? 0 : scene.triangle_count());  // by id
  for (std::size_t i = 0; !slots.empty() && i < scene.tree.triangles.size(); ++i)
    slots[scene.tree.triangles[i].id] = static_cast<std::uint32_t>(i);
  for (MovingLight& light : motion.lights)
    if (light.primitive != MovingLight::none) light.primitive = slots[light.primitive];
  const std::vector<std::uint32_t>& of_spheres = scene.light_list.spheres;
  for (const MotionData::MovingSphere& moving : scene.motion.spheres) {
    if (scene.material_records[scene.sphere_material[moving.sphere]].emission == no_emission)
      continue;
    const std::uint32_t light = of_spheres[moving.sphere];
    if (motion.lights.size() <= light) motion.lights.resize(light + 1);
    motion.lights[light].primitive = moving.sphere;
  }
  motion.update_view();
}

}  // namespace pt
