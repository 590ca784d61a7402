#include "calibration/binocular/binocular_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "base/input_error.h"
#include "calibration/binocular/fit_binocular.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-9;

const Screen kScreen{.size_px = {1000, 500}, .size_m = {0.5, 0.25}, .distance_m = 0.6};

/// A tracker below the screen, tilted; x right, y up, z towards the observer.
BinocularCalibration example() {
  BinocularCalibration calibration;
  calibration.map.rotation =
      glm::dmat3(glm::rotate(glm::dmat4(1.0), 0.2, glm::normalize(glm::dvec3(1.0, 0.3, -0.2))));
  calibration.map.translation_m = {0.01, 0.15, -0.02};
  calibration.map.kappa_rad = {glm::dvec2(0.03, 0.01), glm::dvec2(-0.025, 0.02)};
  calibration.uncertainty_deg = 1.0 / 3.0;
  return calibration;
}

/// What the tracker sees of an eye at `eye_m` that looks at `target_m`, both in the display's
/// frame.
BinocularSample::Eye seen(const BinocularMap& map, std::size_t side, const glm::dvec3& eye_m,
                          const glm::dvec2& target_m) {
  BinocularMap against;
  against.kappa_rad[side] = -map.kappa_rad[side];
  const glm::dvec3 sight = map.rotation * (glm::dvec3(target_m, 0.0) - eye_m);
  return {.centre_m = map.rotation * eye_m + map.translation_m,
          .direction = correctedDirection(against, side, sight)};
}

GazeTrace looking(const BinocularMap& map, const glm::dvec2& target_m) {
  GazeSample sample;
  for (std::size_t side : {0, 1}) {
    const auto eye = seen(map, side, {side == 0 ? -0.03 : 0.03, 0.02, 0.6}, target_m);
    sample.eyes[side] = {.origin_m = eye.centre_m, .direction = eye.direction};
  }
  return {{.format = "test"}, 0.0, {sample}};
}

TEST(BinocularFile, ComesBackToTheLastDigit) {
  const ScratchFile file(binocularToml(example()));
  EXPECT_TRUE(isBinocularFile(file.path()));
  EXPECT_EQ(binocularToml(readBinocular(file.path())), binocularToml(example()));
  EXPECT_FALSE(isBinocularFile(ScratchFile("[map]\nunits = \"deg\"\n").path()));
  EXPECT_FALSE(isBinocularFile("/nowhere"));
}

TEST(BinocularFile, RefusesWhatIsNone) {
  std::string text = binocularToml(example());
  const std::size_t at = text.find("rotation = [") + 12;
  EXPECT_THROW(readBinocular(ScratchFile(text.substr(0, at) + "0.5, " + text.substr(at)).path()),
               InputError);
  EXPECT_THROW(readBinocular(ScratchFile(text.replace(at, 3, "0.1")).path()), InputError);
  EXPECT_THROW(readBinocular(ScratchFile("[binocular]\nrotation = 3\n").path()), InputError);
}

TEST(BinocularMapTrace, LeadsBothEyesToTheTarget) {
  const BinocularCalibration calibration = example();
  const GazeTrace mapped = mapTrace(calibration, kScreen, looking(calibration.map, {0.1, -0.05}));
  const GazeSample& sample = mapped.samples[0];
  for (const auto& point_px : {sample.point_px, sample.eyes[0].point_px, sample.eyes[1].point_px}) {
    ASSERT_TRUE(point_px);
    EXPECT_NEAR(point_px->x, 700.0, 1e-6);
    EXPECT_NEAR(point_px->y, 350.0, 1e-6);
  }
  EXPECT_EQ(sample.uncertainty_deg, calibration.uncertainty_deg);
  // In the frame of an eye before the screen's centre.
  EXPECT_NEAR(glm::distance(*sample.eyes[0].origin_m, glm::dvec3(-0.03, 0.02, 0.0)), 0.0,
              kRounding);
  EXPECT_NEAR(
      glm::distance(*sample.eyes[0].direction, glm::normalize(glm::dvec3(0.13, -0.07, -0.6))), 0.0,
      kRounding);
}

TEST(BinocularMapTrace, RefusesARecordingWithoutLinesOfSight) {
  GazeTrace trace;
  trace.samples = {{.time_s = 0.0, .point_px = glm::dvec2(1.0)}};
  EXPECT_THROW(mapTrace(example(), kScreen, trace), InputError);
}

TEST(RoughBinocularMap, IsExactWithoutKappaAndRefusesNonsense) {
  BinocularMap truth = example().map;
  truth.kappa_rad = {};
  std::vector<BinocularSample> samples;
  for (int i = 0; i < 12; ++i) {
    const glm::dvec2 target_m(0.1 * (i % 3 - 1), 0.08 * (i / 3 % 3 - 1));
    BinocularSample& sample = samples.emplace_back();
    sample.target_m = target_m;
    const glm::dvec3 head(0.02 * (i % 4), 0.01 * (i % 5), 0.5 + 0.02 * i);
    for (std::size_t side : {0, 1}) {
      sample.eyes[side] =
          seen(truth, side, head + glm::dvec3(side == 0 ? -0.03 : 0.03, 0.0, 0.0), target_m);
    }
  }
  const BinocularMap rough = roughBinocularMap(samples);
  EXPECT_NEAR(glm::distance(rough.translation_m, truth.translation_m), 0.0, 1e-6);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(glm::distance(rough.rotation[i], truth.rotation[i]), 0.0, 1e-6);
  }
  for (const double error_deg : errorsOf_deg(truth, samples)) EXPECT_NEAR(error_deg, 0.0, 1e-6);
  for (BinocularSample& sample : samples) sample.target_m.y = 0.0;
  EXPECT_THROW(roughBinocularMap(samples), InputError);
  EXPECT_THROW(roughBinocularMap({}), InputError);
}

TEST(ReadBinocularPairs, TakesOneEyeOrBothAndRefusesByLine) {
  const std::string left =
      "left_origin_x_mm left_origin_y_mm left_origin_z_mm left_direction_x left_direction_y "
      "left_direction_z ";
  const ScratchFile one("x_target_mm y_target_mm " + left + "note\n100 -50 1 2 600 0 0 -2 a\n" +
                        "0 0 n/a 2 600 0 0 -2 b\n");
  const auto samples = readBinocularPairs(one.path());
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[0].target_m, glm::dvec2(0.1, -0.05));
  EXPECT_EQ(samples[0].eyes[0]->centre_m, 1e-3 * glm::dvec3(1, 2, 600));
  EXPECT_FALSE(samples[0].eyes[1]);
  EXPECT_FALSE(samples[1].eyes[0]);
  for (const std::string& bad :
       {std::string(), std::string("x_target_mm y_target_mm\n0 0\n"), left + "x_target_mm\n",
        left + "x_target_mm y_target_mm\n", left + "x_target_mm y_target_mm\n1 2 3 0 0 0 1 1\n",
        left + "x_target_mm y_target_mm\n1 2 3 0 0 -1 1\n",
        left + "x_target_mm y_target_mm\n1 2 3 0 0 -1 1 left\n",
        left + "x_target_mm y_target_mm\n1 2 3 0 0 -1 1 n/a\n"}) {
    EXPECT_THROW(readBinocularPairs(ScratchFile(bad).path()), InputError) << bad;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
