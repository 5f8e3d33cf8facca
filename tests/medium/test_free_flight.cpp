// Distances to collisions, against the exponential law of the optical depth.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/transport/travel.h"
#include "medium/volume_cases.h"

namespace pt {
namespace {

const Color grey(0.8f), coloured(0.3f, 1.1f, 4.0f), clear_red(0.0f, 0.5f, 2.0f);

/// exp(-extinction * distance), in double precision.
double passes(float extinction, double distance) {
  return std::exp(-double{extinction} * distance);
}

/// A flight's end, and what it brings.
struct FlightEnd {
  bool collides;
  float t;
  Color weight;
  ChannelDensities densities;
};

FlightEnd fly_through(const Color& extinction, float t_max, TestRandom& random) {
  FreeFlight flight;
  FlightEnd end{false, 0, Color(1.0f), {}};
  const float u0 = random.unit(), u1 = random.unit();
  end.collides = fly_homogeneous(extinction, t_max, u0, u1, flight, end.densities, end.weight) ==
                 FlightEvent::collides;
  end.t = flight.t;
  EXPECT_EQ(flight.collisions, 0u);
  return end;
}

/// Through medium 0 of a scene that has a grid.
FlightEnd fly_through(const SceneData& scene, const Ray& ray, float t_max, std::uint32_t key) {
  FreeFlight flight;
  FlightEnd end{false, 0, Color(1.0f), {}};
  FlightEvent event;
  do {
    event = fly_to_collision(grids_of(scene), scene.media[0], ray, t_max, key, flight,
                             end.densities, end.weight);
  } while (event == FlightEvent::collides_with_nothing);
  end.collides = event == FlightEvent::collides;
  end.t = flight.t;
  return end;
}

TEST(FreeFlight, DistancesOfGreyMediaAreExponential) {
  constexpr int samples = 400'000, cells = 50;
  TestRandom random(11);
  std::vector<double> counts(cells);
  for (int i = 0; i < samples; ++i) {
    const FlightEnd end = fly_through(grey, infinite_distance, random);
    ASSERT_TRUE(end.collides);
    ASSERT_EQ(end.weight, Color(1.0f));
    ++counts[cell_of(1 - passes(grey.x, double{end.t}), cells)];
  }
  expect_uniform(counts, samples, "distances");
}

/// Means over many flights, in each channel: what arrives, and what has collided before `t`.
struct FlightMeans {
  MeanEstimate arrived[3], before[3];

  void add(const FlightEnd& end, double t) {
    for (int c = 0; c < 3; ++c) {
      const double weight = double{end.weight[c]};
      arrived[c].add(end.collides ? 0.0 : weight);
      before[c].add(end.collides && double{end.t} < t ? weight : 0.0);
    }
  }
  void expect(int c, double depth_of_all, double depth_before) const {
    EXPECT_NEAR(arrived[c].mean(), std::exp(-depth_of_all), 5 * arrived[c].sigma() + 1e-5)
        << "of channel " << c << " arrives";
    EXPECT_NEAR(before[c].mean(), -std::expm1(-depth_before), 5 * before[c].sigma() + 1e-5)
        << "of channel " << c << " collides before";
  }
};

// Whichever channel chose the distance.
TEST(FreeFlight, EachChannelHasItsOwnLaw) {
  for (const Color& extinction : {grey, coloured, clear_red}) {
    for (const auto& [length, t] :
         {std::pair{0.01f, 0.004}, {0.7f, 0.1}, {0.7f, 0.6}, {3.0f, 2.0}}) {
      TestRandom random(12);
      FlightMeans means;
      for (int i = 0; i < 100'000; ++i) means.add(fly_through(extinction, length, random), t);
      for (int c = 0; c < 3; ++c) {
        means.expect(c, double{extinction[c]} * double{length}, double{extinction[c]} * t);
      }
    }
  }
}

// A weight is a channel's density over the mean of all: so it is what the densities say, its mean
// over the channels is 1, and it is at most 3.
TEST(FreeFlight, WeightsAreTheDensities) {
  TestRandom random(14);
  const auto check = [](const FlightEnd& end) {
    for (int c = 0; c < 3; ++c) {
      ASSERT_NEAR(end.weight[c], end.densities.all()[c], 1e-3);  // rounding grows
      ASSERT_GE(end.weight[c], 0);
      ASSERT_LE(end.weight[c], 3.001f);
    }
    ASSERT_NEAR(mean(end.weight), 1, 1e-3);
  };
  for (int i = 0; i < 50'000; ++i) {
    const auto length = static_cast<float>(random.log_uniform(1e-3, 1e3));
    check(fly_through(i % 2 == 0 ? coloured : clear_red, length, random));
    if (HasFatalFailure()) return;
  }
  const VolumeData volume = random_volume(random, {20, 4, 9}, 3, true, Affine());
  const SceneData scene = scene_of_density(volume, coloured);
  for (int i = 0; i < 20'000; ++i) {
    const Ray ray{Vec3(random.point(1) + 0.5), normalize(Vec3(random.direction()))};
    check(fly_through(scene, ray, 3.0f, random.bits()));
    if (HasFatalFailure()) return;
  }
}

TEST(FreeFlight, ARayToInfinityCollidesUnlessAChannelIsClear) {
  TestRandom random(15);
  for (int i = 0; i < 10'000; ++i) {
    const float u0 = random.unit(), u1 = random.unit();
    const auto fly = [&](const Color& extinction, Color& weight) {
      FreeFlight flight;
      ChannelDensities densities;
      return fly_homogeneous(extinction, infinite_distance, u0, u1, flight, densities, weight);
    };
    Color weight(1.0f), of_clear(1.0f);
    EXPECT_EQ(fly(coloured, weight), FlightEvent::collides);
    const bool collides = fly(clear_red, of_clear) == FlightEvent::collides;
    EXPECT_EQ(collides, u0 >= 1.0f / 3.0f);
    if (!collides) {
      EXPECT_EQ(of_clear, Color(3, 0, 0));
    }
  }
  Color weight(1.0f);
  FreeFlight flight;
  ChannelDensities densities;
  EXPECT_EQ(fly_homogeneous(Color(0.0f), 7.0f, 0.9f, one_minus_ulp, flight, densities, weight),
            FlightEvent::arrives);
  EXPECT_EQ(flight.t, 7.0f);
  EXPECT_EQ(weight, Color(1.0f));
}

// In media one behind the other the channel is chosen again, by what the path has crossed.
TEST(FreeFlight, LegsOfAPathMultiply) {
  const Color second(2.0f, 0.1f, 0.7f);
  TestRandom random(16);
  MeanEstimate passed[3];
  for (int i = 0; i < 200'000; ++i) {
    Color weight(1.0f);
    ChannelDensities densities;
    bool arrives = true;
    for (const Color& extinction : {coloured, second, clear_red}) {
      FreeFlight flight;
      const float u0 = random.unit(), u1 = random.unit();
      arrives = arrives && fly_homogeneous(extinction, 0.5f, u0, u1, flight, densities, weight) ==
                               FlightEvent::arrives;
    }
    for (int c = 0; c < 3; ++c) {
      ASSERT_LE(weight[c], 3.0001f);
      passed[c].add(arrives ? double{weight[c]} : 0.0);
    }
  }
  for (int c = 0; c < 3; ++c) {
    const float sum = coloured[c] + second[c] + clear_red[c];
    EXPECT_NEAR(passed[c].mean(), passes(sum, 0.5), 5 * passed[c].sigma());
  }
}

// A flight that may be drawn to a light beside the ray, behind it or on it is as unbiased.
TEST(FreeFlight, OnesDrawnToALightHaveTheSameLaw) {
  const Ray ray{Vec3(0.0f), Vec3(0, 0, 1)};
  for (const Color& extinction : {grey, coloured, clear_red}) {
    for (const Vec3& point : {Vec3(0.3f, 0, 0.8f), Vec3(0.5f, 1, -0.2f), Vec3(0, 0, 1)}) {
      TestRandom random(22);
      const float length = 2;
      const double t = 0.9;
      FlightMeans means;
      for (int i = 0; i < 100'000; ++i) {
        FreeFlight flight;
        FlightEnd end{false, 0, Color(1.0f), {}};
        const float u0 = random.unit(), u1 = random.unit(), u2 = random.unit();
        end.collides =
            fly_homogeneous(extinction, length, Equiangular(ray, length, point), 0.5f, u0, u1, u2,
                            flight, end.densities, end.weight) == FlightEvent::collides;
        end.t = flight.t;
        ASSERT_GE(end.t, 0);
        ASSERT_LE(end.t, length);
        means.add(end, t);
      }
      SCOPED_TRACE(fmt::format("a light at {}, {}, {}", point.x, point.y, point.z));
      for (int c = 0; c < 3; ++c) {
        means.expect(c, double{extinction[c]} * double{length}, double{extinction[c]} * t);
      }
    }
  }
}

/// A density that depends on z alone, and its integral from 0.
struct DensityProfile {
  const char* name;
  std::uint32_t voxels;
  double (*density)(double z);
  double (*integral)(double z);
};

constexpr double slab_length = 3;
const DensityProfile profiles[] = {
    {"constant", 2, [](double) { return 0.7; }, [](double z) { return 0.7 * z; }},
    {"linear in one cell", 2, [](double z) { return 0.2 + 0.9 * z; },
     [](double z) { return 0.2 * z + 0.45 * z * z; }},
    {"linear in many cells", 100, [](double z) { return 3 - z; },
     [](double z) { return 3 * z - 0.5 * z * z; }},
    {"exponential", 257, [](double z) { return 4 * std::exp(-1.5 * z); },
     [](double z) { return -4 / 1.5 * std::expm1(-1.5 * z); }},
};

TEST(FreeFlight, DistancesInGridsFollowTheirDensity) {
  constexpr int samples = 150'000, cells = 40;
  for (const DensityProfile& profile : profiles) {
    SCOPED_TRACE(profile.name);
    const SceneData scene =
        scene_of_density(slab_volume(profile.voxels, slab_length, 1,
                                     [&](double z, std::uint32_t) { return profile.density(z); }));
    // Upright, and oblique: three units of length are 1.8 of depth.
    for (const Vec3& direction : {Vec3(0, 0, 1), Vec3(0.8f, 0, 0.6f)}) {
      TestRandom random(17);
      const double t_max = slab_length / double{direction.z};
      const auto arrived = [&](double t) {
        return std::exp(-profile.integral(t * double{direction.z}) / double{direction.z});
      };
      std::vector<double> counts(cells + 1), expected(cells + 1);
      for (int i = 0; i < samples; ++i) {
        const FlightEnd end =
            fly_through(scene, {Vec3(0.0f), direction}, static_cast<float>(t_max), random.bits());
        ASSERT_EQ(end.weight, Color(1.0f));
        const auto cell = end.collides ? cell_of(double{end.t} / t_max, cells) : cells;
        ++counts[static_cast<std::size_t>(cell)];
      }
      for (int cell = 0; cell < cells; ++cell) {
        expected[static_cast<std::size_t>(cell)] =
            samples * (arrived(t_max * cell / cells) - arrived(t_max * (cell + 1) / cells));
      }
      expected[cells] = samples * arrived(t_max);
      expect_counts(counts, expected, "distances");
    }
  }
}

TEST(FreeFlight, EachChannelOfAGridHasItsOwnLaw) {
  // Channels whose densities rise, fall and stay.
  const auto density = [](double z, std::uint32_t c) {
    return c == 0 ? 0.1 + 0.6 * z : c == 1 ? 1.3 - 0.4 * z : 0.5;
  };
  const auto integral = [](double z, int c) {
    return c == 0 ? 0.1 * z + 0.3 * z * z : c == 1 ? 1.3 * z - 0.2 * z * z : 0.5 * z;
  };
  for (const std::uint32_t voxels : {2u, 40u}) {
    for (const Color& extinction :
         {Color(1.0f), Color(0.4f, 2.5f, 1.0f), Color(0.0f, 1.0f, 3.0f)}) {
      const SceneData scene =
          scene_of_density(slab_volume(voxels, slab_length, 3, density), extinction);
      for (const double t : {0.5, 2.0}) {
        TestRandom random(18);
        FlightMeans means;
        for (int i = 0; i < 60'000; ++i) {
          const Ray ray{Vec3(0.0f), Vec3(0, 0, 1)};
          means.add(fly_through(scene, ray, float{slab_length}, random.bits()), t);
        }
        for (int c = 0; c < 3; ++c) {
          means.expect(c, double{extinction[c]} * integral(slab_length, c),
                       double{extinction[c]} * integral(t, c));
        }
      }
    }
  }
}

TEST(FreeFlight, AColouredMediumOfOneGreyGridIsUnbiasedToo) {
  const auto density = [](double z, std::uint32_t) { return 0.1 + 0.6 * z; };
  const SceneData scene = scene_of_density(slab_volume(2, slab_length, 1, density), clear_red);
  TestRandom random(19);
  FlightMeans means;
  for (int i = 0; i < 200'000; ++i) {
    means.add(fly_through(scene, {Vec3(0.0f), Vec3(0, 0, 1)}, float{slab_length}, random.bits()),
              1);
  }
  for (int c = 0; c < 3; ++c) {
    means.expect(c, double{clear_red[c]} * (0.3 + 2.7), double{clear_red[c]} * 0.4);
  }
}

/// The medium of the first path that begins in it.
Scene view_of(const SceneData& data) {
  Scene scene;
  scene.media.list = data.media.data();
  scene.grids = grids_of(data);
  scene.camera_medium_id = 0;
  return scene;
}

// A flight that pauses after some null collisions ends where it would have without a pause.
TEST(Travel, MayPauseAtAnyCollision) {
  TestRandom random(20);
  const VolumeData volume = random_volume(random, {11, 13, 17}, 3, true, random_place(random));
  SceneData data = scene_of_density(volume, {2.0f, 5.0f, 9.0f});
  const Scene scene = view_of(data);
  int pauses = 0, collisions = 0;
  for (int i = 0; i < 2000; ++i) {
    const Ray ray{volume.to_world.point(Vec3(random.point(0.7) + 0.5)),
                  normalize(Vec3(random.direction()))};
    const std::uint32_t key = random.bits();
    const auto far = static_cast<float>(random.log_uniform(0.1, 10));
    const auto rays = static_cast<std::uint16_t>(random.below(3));
    PathState whole;
    whole.rays = rays, whole.medium.id = 0;
    FreeFlight flight;
    Hit expected{far, 5, 0};
    ASSERT_TRUE(travel(scene, ray, key, to_the_end, whole, flight, expected));
    for (const std::uint32_t collisions_max : {1u, 2u, 7u}) {
      PathState path;
      path.rays = rays, path.medium.id = 0;
      FreeFlight paused;
      Hit hit{far, 5, 0};
      while (!travel(scene, ray, key, collisions_max, path, paused, hit)) {
        ++pauses;
        ASSERT_EQ(paused.collisions % collisions_max, 0u);
      }
      ASSERT_EQ(hit.t, expected.t);
      ASSERT_EQ(hit.primitive, expected.primitive);
      ASSERT_EQ(paused.collisions, flight.collisions);
      ASSERT_EQ(path.beta, whole.beta);
      ASSERT_EQ(path.medium.densities.all(), whole.medium.densities.all());
    }
    collisions += expected.is_collision();
    EXPECT_EQ(expected.is_collision(), expected.t < far);
  }
  EXPECT_GT(pauses, 2000);
  EXPECT_GT(collisions, 500);
}

// Into endless emptiness and through an endless density a flight ends after some collisions.
TEST(FreeFlight, EndsWhereItsRayDoesNot) {
  for (const bool is_empty_at_the_rim : {true, false}) {
    const VolumeData volume =
        make_volume({10, 10, 10}, 1, true, Affine(), [&](const GridSize& voxel, std::uint32_t) {
          const bool is_rim = std::ranges::any_of(voxel, [](auto i) { return i == 0 || i == 9; });
          return is_rim && is_empty_at_the_rim ? 0.0 : is_rim ? 1e-6 : 1.0;
        });
    const SceneData scene = scene_of_density(volume, Color(3.0f));
    int arrived = 0;
    for (std::uint32_t key = 0; key < 1000; ++key) {
      FreeFlight flight;
      ChannelDensities densities;
      Color weight(1.0f);
      FlightEvent event;
      do {
        event = fly_to_collision(grids_of(scene), scene.media[0], {Vec3(0.5f), Vec3(0, 0, 1)},
                                 infinite_distance, key, flight, densities, weight);
        ASSERT_LT(flight.collisions, 1000u);
      } while (event == FlightEvent::collides_with_nothing);
      arrived += event == FlightEvent::arrives ? 1 : 0;
    }
    EXPECT_GT(arrived, 100);
  }
}

TEST(Travel, TakesTheCamerasMediumAtFirstAndThePathsAfterwards) {
  TestRandom random(21);
  SceneData data;
  for (const float extinction : {0.0f, 1e6f}) {
    Medium medium;
    medium.extinction = Color(extinction);
    data.media.push_back(medium);
  }
  Scene scene = view_of(data);
  const auto collides = [&](std::uint16_t rays, std::uint32_t medium) {
    PathState path;
    path.rays = rays;
    path.medium.id = static_cast<std::uint16_t>(medium);
    FreeFlight flight;
    Hit hit{2.0f, 5, 0};
    EXPECT_TRUE(
        travel(scene, {Vec3(0.0f), Vec3(0, 0, 1)}, random.bits(), to_the_end, path, flight, hit));
    EXPECT_EQ(path.beta, Color(1.0f));
    return hit.is_collision();
  };
  for (const std::uint32_t of_path : {0u, 1u, no_medium}) {
    scene.camera_medium_id = 1;
    EXPECT_TRUE(collides(0, of_path));
    scene.camera_medium_id = 0;
    EXPECT_FALSE(collides(0, of_path));
    scene.camera_medium_id = no_medium;
    EXPECT_FALSE(collides(0, of_path));
    EXPECT_EQ(collides(1, of_path), of_path == 1);
  }
}

// Lights at a point draw flights before the first scattering alone: others need no weight.
TEST(Travel, LightsDrawTheFirstFlights) {
  TestRandom random(23);
  SceneData data;
  Medium medium;
  medium.extinction = grey;
  data.media.push_back(medium);
  Scene scene = view_of(data);
  const Vec4 points[] = {{0.1f, 0, 1, 0}, {-0.1f, 0.1f, 3, 0}};
  scene.light_points = points, scene.light_point_count = 2;
  for (const auto& [rays, passed] : {std::pair{0, 0}, {2, 2}, {1, 0}, {5, 4}}) {
    MeanEstimate arrived;
    int weighted = 0;
    for (int i = 0; i < 50'000; ++i) {
      PathState path;
      path.rays = static_cast<std::uint16_t>(rays);
      path.medium.id = 0, path.medium.interface_crossings = static_cast<std::uint16_t>(passed);
      FreeFlight flight;
      Hit hit{4.0f, 5, 0};
      travel(scene, {Vec3(0.0f), Vec3(0, 0, 1)}, random.bits(), to_the_end, path, flight, hit);
      arrived.add(hit.is_collision() ? 0.0 : double{path.beta.x});
      weighted += path.beta != Color(1.0f);
    }
    EXPECT_NEAR(arrived.mean(), passes(grey.x, 4), 5 * arrived.sigma());
    EXPECT_EQ(weighted > 0, rays == passed) << "after " << rays << " rays";
  }
}

// Flights of different rays, paths and purposes do not depend on each other.
TEST(Travel, KeysDiffer) {
  EXPECT_NE(flight_key(1, 0), flight_key(1, 1));
  EXPECT_NE(flight_key(1, 0), flight_key(2, 0));
  EXPECT_NE(flight_key(1, 0), combine_hash(1, 0));
  constexpr int samples = 100'000, cells = 20;
  std::vector<double> pairs(cells * cells);
  for (std::uint32_t i = 0; i < samples; ++i) {
    const double u = double{to_unit_float(combine_hash(flight_key(i / 50, i % 50), 1))};
    const double v = double{to_unit_float(combine_hash(flight_key(i / 50, i % 50 + 1), 1))};
    ++pairs[cell_of(u, cells) * cells + cell_of(v, cells)];
  }
  expect_uniform(pairs, samples, "flights of successive rays");
}

TEST(MediumBoundary, KnowsItsSides) {
  const MediumBoundary boundary{3, 5};
  EXPECT_EQ(boundary.towards(Vec3(0, 0, 1), Vec3(0, 0, 1)), 3u);
  EXPECT_EQ(boundary.towards(Vec3(0, 0, -1), Vec3(0, 0, 1)), 5u);
}

}  // namespace
}  // namespace pt
