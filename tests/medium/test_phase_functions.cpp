// Phase functions: normalised, sampled with the density that they state, and with the mean cosine
// that their parameter names.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/medium/phase_function.h"
#include "statistics.h"

namespace pt {
namespace {

struct PhaseCase {
  PhaseKind kind;
  float parameter;
};

std::vector<PhaseCase> phase_cases() {
  std::vector<PhaseCase> cases;
  for_each_type(PhaseFunctions{}, [&]<class Phase>(std::type_identity<Phase>) {
    for (const float parameter : {-0.95f, -0.4f, -0.001f, 0.0f, 0.0005f, 0.3f, 0.8f, 0.99f}) {
      if (parameter == 0.0f || std::is_same_v<Phase, HenyeyGreenstein>)
        cases.push_back({phase_kind_of<Phase>, parameter});
    }
  });
  return cases;
}

template <class Function>
void for_each_phase(Function&& function) {
  for (const auto& [kind, parameter] : phase_cases()) {
    visit_phase(kind, parameter, [&](const auto& phase) {
      SCOPED_TRACE(fmt::format("{} {}", phase.name, parameter));
      function(phase, double{parameter});
    });
  }
}

/// The integral of value(cosine) * f(cosine) over the sphere, by the midpoint rule in a variable
/// that is fine at both ends.
template <class Phase, class Function>
double integral_over_sphere(const Phase& phase, Function&& f) {
  constexpr int steps = 400'000;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double s = (i + 0.5) / steps, cosine = s * s * (3 - 2 * s) * 2 - 1;
    const double slope = 12 * s * (1 - s);  // d cosine / d s
    sum += double{phase.value(static_cast<float>(cosine))} * f(cosine) * slope;
  }
  return 2 * pi_double * sum / steps;
}

TEST(PhaseFunctions, AreNormalized) {
  for_each_phase([](const auto& phase, double) {
    EXPECT_NEAR(integral_over_sphere(phase, [](double) { return 1.0; }), 1, 1e-4);
  });
}

TEST(PhaseFunctions, HenyeyGreensteinHasItsMeanCosine) {
  for (const float g : {-0.95f, -0.4f, 0.0f, 0.3f, 0.8f, 0.99f}) {
    const HenyeyGreenstein phase{g};
    EXPECT_NEAR(integral_over_sphere(phase, [](double c) { return c; }), g, 1e-4);
  }
}

TEST(PhaseFunctions, AreSampledByTheirDensity) {
  constexpr int samples = 400'000, cells = 64;
  for_each_phase([](const auto& phase, double) {
    TestRandom random(5);
    std::vector<double> counts(cells), expected(cells);
    const Vec3 direction = normalize(Vec3(1, -2, 0.5f));
    for (int i = 0; i < samples; ++i) {
      const PhaseSample sample = sample_phase(phase, direction, random.unit(), random.unit());
      const double cosine = glm::dot(glm::dvec3(sample.wi), glm::dvec3(direction));
      ASSERT_NEAR(glm::length(glm::dvec3(sample.wi)), 1, 1e-5);
      ++counts[cell_of(0.5 * (cosine + 1), cells)];
    }
    for (int cell = 0; cell < cells; ++cell) {
      constexpr int steps = 2000;
      for (int i = 0; i < steps; ++i) {
        const double cosine = -1 + 2 * (cell + (i + 0.5) / steps) / cells;
        expected[static_cast<std::size_t>(cell)] +=
            double{phase.value(static_cast<float>(cosine))} * 2 * pi_double * 2 / cells / steps *
            samples;
      }
    }
    expect_counts(counts, expected, "cosines");
  });
}

TEST(PhaseFunctions, SamplesHaveTheValueOfTheirDirection) {
  for_each_phase([](const auto& phase, double) {
    TestRandom random(6);
    for (int i = 0; i < 1000; ++i) {
      const Vec3 direction = normalize(Vec3(random.direction()));
      const PhaseSample sample = sample_phase(phase, direction, random.unit(), random.unit());
      // At a peak the cosine's own rounding changes the value.
      const float value = phase.value(dot(direction, sample.wi));
      EXPECT_NEAR(sample.pdf, value, 0.02 * value + 1e-6);
    }
  });
}

// Light on its way back is scattered alike: from -wi to where the path came from.
TEST(PhaseFunctions, AreReciprocal) {
  for_each_phase([](const auto& phase, double) {
    TestRandom random(8);
    for (int i = 0; i < 1000; ++i) {
      const Vec3 in = normalize(Vec3(random.direction())),
                 out = normalize(Vec3(random.direction()));
      EXPECT_EQ(phase.value(dot(in, out)), phase.value(dot(-out, -in)));
    }
  });
}

// The formulas in double precision, of the angle between the directions of travel.
TEST(PhaseFunctions, HaveTheValuesOfTheirFormulas) {
  for_each_phase([](const auto& phase, double g) {
    using Phase = std::remove_cvref_t<decltype(phase)>;
    for (int i = 0; i <= 40; ++i) {
      const double cosine = i / 20.0 - 1;
      double expected = 1;
      if (std::is_same_v<Phase, HenyeyGreenstein>)
        expected = (1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5);
      if (std::is_same_v<Phase, Rayleigh>) expected = 0.75 * (1 + cosine * cosine);
      expected /= 4 * pi_double;
      EXPECT_NEAR(phase.value(static_cast<float>(cosine)), expected, 1e-3 * expected);
    }
  });
}

TEST(PhaseFunctions, SamplesHaveTheMeanCosine) {
  for_each_phase([](const auto& phase, double parameter) {
    TestRandom random(9);
    MeanEstimate cosine;
    for (int i = 0; i < 100'000; ++i) cosine.add(double{phase.sample_cosine(random.unit())});
    const bool has_one = std::is_same_v<std::remove_cvref_t<decltype(phase)>, HenyeyGreenstein>;
    EXPECT_NEAR(cosine.mean(), has_one ? parameter : 0, 5 * cosine.sigma());
  });
}

// Over cells of the sphere that know nothing of the path's direction.
TEST(PhaseFunctions, DirectionsFollowTheDensityOverTheSphere) {
  constexpr int samples = 200'000, rows = 8, columns = 12, fine = 40;
  for_each_phase([](const auto& phase, double parameter) {
    if (std::abs(parameter) > 0.9) return;  // a peak within a cell or two: see the cosines
    for (const Vec3& towards : {Vec3(0.3f, -0.5f, 0.8f), Vec3(0.1f, 0.2f, -1), Vec3(0, 0, -1)}) {
      const Vec3 direction = normalize(towards);
      const glm::dvec3 axis(direction);
      TestRandom random(10);
      std::vector<double> counts(rows * columns), expected(rows * columns);
      for (int i = 0; i < samples; ++i) {
        const Vec3 wi = sample_phase(phase, direction, random.unit(), random.unit()).wi;
        const double turn = std::atan2(double{wi.y}, double{wi.x}) / (2 * pi_double) + 0.5;
        ++counts[cell_of(0.5 * double{wi.z} + 0.5, rows) * columns + cell_of(turn, columns)];
      }
      for (int i = 0; i < rows * fine; ++i) {
        const double z = (i + 0.5) * 2 / (rows * fine) - 1, r = std::sqrt(1 - z * z);
        for (int j = 0; j < columns * fine; ++j) {
          const double turn = ((j + 0.5) / (columns * fine) - 0.5) * 2 * pi_double;
          const glm::dvec3 w(r * std::cos(turn), r * std::sin(turn), z);
          expected[static_cast<std::size_t>(i / fine * columns + j / fine)] +=
              double{phase.value(static_cast<float>(glm::dot(w, axis)))} * 4 * pi_double /
              (rows * columns * fine * fine) * samples;
        }
      }
      expect_counts(counts, expected, "directions");
    }
  });
}

TEST(PhaseFunctions, TurnAroundTheDirectionEvenly) {
  constexpr int samples = 200'000, cells = 32;
  TestRandom random(7);
  std::vector<double> counts(cells);
  for (int i = 0; i < samples; ++i) {
    const PhaseSample sample =
        sample_phase(HenyeyGreenstein{0.7f}, Vec3(0, 0, 1), random.unit(), random.unit());
    const double turn = std::atan2(sample.wi.y, sample.wi.x) / (2 * pi_double) + 0.5;
    ++counts[cell_of(turn, cells)];
  }
  expect_uniform(counts, samples, "turns");
}

}  // namespace
}  // namespace pt
