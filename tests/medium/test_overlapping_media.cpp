// Where shapes overlap, the medium of the highest priority is there, and surfaces within it are
// not.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "cloud_modes.h"
#include "common/error/error.h"
#include "common/transport/first_hit.h"

namespace pt {
namespace {

using Kind = Traits<Accel::bvh2, Geometry::mixed, Lighting::full, true, true>;

/// A ball or a box of one medium, whose surface lets light through or is black.
struct Body {
  Vec3 center;
  float radius;
  bool is_box, is_black;
  std::int32_t priority;
  float extinction;

  /// The part of a ray within it; empty where `end` is not behind `begin`.
  void part_of(const Ray& ray, double& begin, double& end) const {
    begin = -1e30, end = 1e30;
    if (!is_box) {
      double b = 0, c = -double{radius} * radius;
      for (int i = 0; i < 3; ++i) {
        const double from = double{ray.origin[i]} - center[i];
        b += from * ray.direction[i], c += from * from;
      }
      const double root = b * b - c;
      begin = root > 0 ? -b - std::sqrt(root) : 0, end = root > 0 ? -b + std::sqrt(root) : 0;
      return;
    }
    for (int i = 0; i < 3; ++i) {
      const double from = double{center[i]} - ray.origin[i], way = ray.direction[i];
      const double a = (from - radius) / way, b = (from + radius) / way;
      begin = std::max(begin, std::min(a, b)), end = std::min(end, std::max(a, b));
    }
  }
};

/// Bodies of different priorities, in a random order, in a small place; black surfaces lie within
/// others.
std::vector<Body> random_bodies(TestRandom& random, std::size_t count) {
  std::vector<Body> bodies;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 center(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    bodies.push_back({center, static_cast<float>(random.uniform(0.4, 1)), random.below(2) == 0,
                      false, static_cast<std::int32_t>(i) - 2,
                      static_cast<float>(random.uniform(0, 1))});
  }
  const Body inside = bodies.back();
  bodies.push_back({inside.center, 0.5f * inside.radius, false, true, -5, 3.0f});
  for (std::size_t i = bodies.size() - 1; i > 0; --i) {
    std::swap(bodies[i], bodies[random.below(static_cast<std::uint32_t>(i + 1))]);
  }
  return bodies;
}

SceneData scene_of(const std::vector<Body>& bodies) {
  SceneData scene;
  scene.name = "bodies";
  for (const Body& body : bodies) {
    const auto number = static_cast<std::uint32_t>(scene.media.size());
    scene.media.push_back(make_medium(Color(body.extinction), Color(0.0f)));
    scene.media.back().priority = body.priority;
    MaterialDescription surface = make_boundary(no_medium, number);
    if (body.is_black) surface = make_diffuse(Color(0.0f));
    surface.is_boundary = true, surface.media.inside = static_cast<std::uint16_t>(number);
    const std::uint32_t material = scene.add_material(surface);
    if (body.is_box) {
      add_cuboid(scene, body.center - Vec3(body.radius), body.center + Vec3(body.radius), material);
    } else {
      scene.add_sphere(body.center, body.radius, material);
    }
  }
  scene.sky = {Color(1.0f), Color(1.0f)};
  return scene;
}

/// Integral of the extinction along a ray up to `length`: piece by piece between all surfaces, in
/// each of which the body of the highest priority is found by asking all of them.
double depth_along(const std::vector<Body>& bodies, const Ray& ray, double length) {
  std::vector<double> ends{0, length};
  for (const Body& body : bodies) {
    double begin, end;
    body.part_of(ray, begin, end);
    for (const double t : {begin, end}) ends.push_back(std::clamp(t, 0.0, length));
  }
  std::ranges::sort(ends);
  double depth = 0;
  for (std::size_t i = 1; i < ends.size(); ++i) {
    const double middle = 0.5 * (ends[i - 1] + ends[i]);
    const Body* highest = nullptr;
    for (const Body& body : bodies) {
      double begin, end;
      body.part_of(ray, begin, end);
      const bool is_inside = begin < middle && middle < end;
      if (is_inside && (!highest || body.priority > highest->priority)) highest = &body;
    }
    if (highest) depth += double{highest->extinction} * (ends[i] - ends[i - 1]);
  }
  return depth;
}

Vec3 random_point_on_ball(TestRandom& random, float radius) {
  return radius * Vec3(random.direction());
}

TEST(OverlappingMedia, TransmittanceIsThatOfTheHighestEverywhere) {
  TestRandom random(81);
  int deep = 0;
  for (int round = 0; round < 12; ++round) {
    const std::vector<Body> bodies = random_bodies(random, 2 + random.below(8));
    SceneData scene = scene_of(bodies);
    prepare_scene(scene, cloud_options("serial"));
    const Scene view = host_view(scene, 1, 1);
    for (int i = 0; i < 200; ++i) {
      const Vec3 from = random_point_on_ball(random, 5), to = random_point_on_ball(random, 0.9f);
      const Ray ray{from, normalize(to - from)};
      const double expected = std::exp(-depth_along(bodies, ray, 20));
      const ViewThroughMedia through = look_through_media<Kind>(view, ray, random.bits());
      EXPECT_TRUE(through.hit.is_miss());
      EXPECT_NEAR(through.transmittance.y, expected, 2e-3 * expected) << round << " " << i;
      const float length = static_cast<float>(random.uniform(1, 10));
      const double up_to = std::exp(-depth_along(bodies, ray, double{length}));
      const Color passed = shadow_transmittance<Kind>(
          view, {ray, length, Color(1.0f), static_cast<std::uint16_t>(no_medium)}, random.bits());
      EXPECT_NEAR(passed.y, up_to, 2e-3 * up_to) << round << " " << i;
      deep += expected < 0.5 ? 1 : 0;
      if (HasFailure()) return;
    }
  }
  EXPECT_GT(deep, 200);
}

// A camera in the lowest: what is around it when paths begin.
TEST(OverlappingMedia, TheCameraMayStandInOne) {
  TestRandom random(82);
  std::vector<Body> bodies = random_bodies(random, 5);
  bodies.push_back({Vec3(0.0f), 6, false, false, -9, 0.1f});
  SceneData scene = scene_of(bodies);
  scene.camera_medium = static_cast<std::uint32_t>(bodies.size() - 1);
  prepare_scene(scene, cloud_options("serial"));
  const Scene view = host_view(scene, 1, 1);
  for (int i = 0; i < 200; ++i) {
    const Vec3 from = random_point_on_ball(random, 5);
    const Ray ray{from, Vec3(random.direction())};
    const double expected = std::exp(-depth_along(bodies, ray, 20));
    EXPECT_NEAR(look_through_media<Kind>(view, ray, random.bits()).transmittance.y, expected,
                2e-3 * expected);
  }
}

// A bar reaches into a box: together they scatter as one grid that has the density of both. No two
// faces lie in one plane.
TEST(OverlappingMedia, ScatterAsOneGridOfTheSameDensity) {
  const auto lit = [](SceneData scene) {
    set_environment(scene);
    scene.camera = {{0.2f, 1.5f, 4}, {0.2f, 0, 0}, {0, 1, 0}, 35.0f, 0.0f, 4.0f};
    const Rendered rendered = render_clouds(
        scene,
        cloud_options("serial",
                      {{"width", "24"}, {"height", "16"}, {"spp", "600"}, {"max-depth", "60"}}));
    const std::vector<float>& rgb = rendered.image.rgb;
    return std::accumulate(rgb.begin(), rgb.end(), 0.0) / static_cast<double>(rgb.size());
  };
  SceneData two;
  two.media = {make_medium(Color(3.0f), Color(0.9f)), make_medium(Color(1.0f), Color(0.3f))};
  two.media[0].priority = 1;
  add_cuboid(two, {0, -0.4f, -0.4f}, {1.5f, 0.4f, 0.4f},
             two.add_material(make_boundary(no_medium, 0)));
  add_cuboid(two, {-1, -0.5f, -0.5f}, {1, 0.5f, 0.5f},
             two.add_material(make_boundary(no_medium, 1)));
  SceneData one;
  one.media.push_back(make_medium(Color(1.0f), Color(1.0f)));
  const auto grid = [&](double bar, double box) {
    const auto value = [&](const GridSize& at, std::uint32_t) {
      const auto is_inner = [](std::uint32_t i) { return i > 0 && i < 9; };
      if (at[0] >= 2 && is_inner(at[1]) && is_inner(at[2])) return bar;
      return at[0] < 4 ? box : 0.0;
    };
    const Affine place = translate({-1, -0.5f, -0.5f}) * scale({2.5f, 1, 1});
    return add_grid(one, make_volume({5, 10, 10}, 1, false, place, value));
  };
  one.media[0].density_grid = grid(3, 1), one.media[0].albedo_grid = grid(0.9, 0.3);
  add_cuboid(one, {-1, -0.5f, -0.5f}, {1.5f, 0.5f, 0.5f},
             one.add_material(make_boundary(no_medium, 0)));
  const double expected = lit(one);
  EXPECT_NEAR(lit(two), expected, 0.002 * expected);
  std::swap(two.media[0].priority, two.media[1].priority);
  EXPECT_GT(std::abs(lit(two) - expected), 0.006 * expected);  // which one is higher matters
}

// Nothing hides a shape's surface but what is higher: it is there for rays that leave it, too.
TEST(OverlappingMedia, SurfacesAreHiddenByHigherOnesAlone) {
  const Medium list[3];
  const MediumBoundary boundaries[] = {
      {no_medium, 0}, {no_medium, 1}, {no_medium, 2}, {1, no_medium}};
  const Media media{list, boundaries, true};
  const Vec3 up(0, 0, 1);
  const auto enter = [&](std::uint16_t around, int material) {
    return media.behind(boundaries[material], -up, up, around);
  };
  for (std::uint16_t set = 0; set < 8; ++set) {
    std::uint16_t around = no_medium;
    for (int i = 0; i < 3; ++i) {
      if (set >> i & 1) around = enter(around, i);
    }
    if (set == 0) {
      EXPECT_EQ(around, no_medium);
    } else {
      EXPECT_EQ(media.at(around) - list, set >= 4 ? 2 : set >= 2 ? 1 : 0);
    }
    EXPECT_FALSE(media.hides(3, around));
    for (std::uint32_t material = 0; material < 3; ++material) {
      EXPECT_EQ(media.hides(material, around), set >> (material + 1) != 0) << set;
      const std::uint16_t inside = enter(around, static_cast<int>(material));
      EXPECT_EQ(media.hides(material, inside), set >> (material + 1) != 0) << set;
      const std::uint16_t outside = media.behind(boundaries[material], up, up, inside);
      EXPECT_EQ(outside, media.behind(boundaries[material], up, up, around));
      if (!(set >> material & 1)) {
        EXPECT_EQ(outside, around);
      }
    }
  }
}

TEST(OverlappingMedia, PreparingAgainChangesNothing) {
  TestRandom random(83);
  SceneData scene = scene_of(random_bodies(random, 6));
  scene.camera_medium = 3;
  const std::int32_t camera_priority = scene.media[3].priority;
  prepare_scene(scene, cloud_options("serial"));
  const std::vector<MediumBoundary> boundaries = scene.boundaries;
  EXPECT_TRUE(std::ranges::is_sorted(scene.media, {}, &Medium::priority));
  EXPECT_EQ(scene.media[scene.camera_medium].priority, camera_priority);
  prepare_scene(scene, cloud_options("serial"));
  EXPECT_EQ(scene.boundaries, boundaries);
  EXPECT_EQ(scene.media[scene.camera_medium].priority, camera_priority);
}

TEST(OverlappingMedia, AreAtMostSixteen) {
  SceneData scene;
  scene.name = "many";
  scene.media.resize(17);
  scene.add_sphere(Vec3(0.0f), 1, scene.add_material(make_boundary(no_medium, 16)));
  EXPECT_NO_THROW(prepare_scene(scene, cloud_options("serial")));
  scene.media[5].priority = 1;
  try {
    prepare_scene(scene, cloud_options("serial"));
    FAIL() << "not refused";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "scene 'many': 17 media, some with a priority; expected at most 16");
  }
  scene.media.resize(16);
  scene.materials[0].media.inside = 15;
  EXPECT_NO_THROW(prepare_scene(scene, cloud_options("serial")));
}

}  // namespace
}  // namespace pt
