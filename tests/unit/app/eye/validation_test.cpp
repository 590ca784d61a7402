// Depth of focus of made curves, the page of validation figures, and what leaves its bounds.
#include "app/eye/validation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "app/eye/visual_quality.h"

namespace foci {
namespace FOCI_FILE {

TEST(DepthOfFocus, IsTheWidthOfTheCurveAtItsCriterion) {
  // A roof with its ridge at 0.2 D falls to 80 % within 0.2 D on either side.
  ThroughFocus roof;
  for (int i = -10; i <= 10; ++i) {
    roof.defocus_D.push_back(0.1 * i);
    roof.contrast.push_back(0.5 * (1.0 - std::abs(0.1 * i - 0.2)));
  }
  const DepthOfFocus depth = depthOfFocus(roof);
  EXPECT_NEAR(depth.best_D, 0.2, 1e-12);
  EXPECT_NEAR(depth.nearest_D, 0.0, 1e-9);
  EXPECT_NEAR(depth.farthest_D, 0.4, 1e-9);
  EXPECT_NEAR(depth.total_D(), 0.4, 1e-9);
  EXPECT_TRUE(depth.complete);
  // A curve that ends above the limit says so.
  EXPECT_FALSE(
      depthOfFocus({.defocus_D = {-1.0, 0.0, 1.0}, .contrast = {0.1, 0.5, 0.45}}).complete);
}

TEST(TypicalPupil, HasTheMeanHigherOrderRms) {
  EXPECT_NEAR(rms_um(typicalPupil(6e-3).wavefront, 3), 0.33, 1e-12);
  EXPECT_LT(rms_um(typicalPupil(3e-3).wavefront, 3), 0.06);
  EXPECT_EQ(power_D(typicalPupil(3e-3).wavefront), glm::dvec3(0.0));
}

TEST(MeanMtf, IsThatOfWatson) {
  for (const auto& [pupil_mm, contrast] :
       {std::pair{2.0, 0.657}, {3.0, 0.563}, {4.0, 0.427}, {5.0, 0.295}, {6.0, 0.205}}) {
    EXPECT_NEAR(meanMtf(pupil_mm, 10.0), contrast, 0.001);
  }
}

TEST(Acuity, IsThatOfTheGrating) {
  EXPECT_NEAR((GratingAcuity{.cycles_per_deg = 30.0}.logMAR()), 0.0, 1e-12);
  EXPECT_NEAR((GratingAcuity{.cycles_per_deg = 3.0}.logMAR()), 1.0, 1e-12);
  const double sharp = acuityOf({.pupil = typicalPupil(3e-3)}).cycles_per_deg;
  const double blurred = acuityOf({.pupil = typicalPupil(3e-3), .defocus_D = 1.0}).cycles_per_deg;
  EXPECT_GT(sharp, 30.0);
  EXPECT_LT(blurred, 0.6 * sharp);
}

TEST(WhiteMtf, LosesContrastToTheOtherColours) {
  const std::vector<double> u{0.0, 10.0, 30.0};
  const EyeOptics eye{.pupil = {.diameter_m = 3e-3}};
  const std::vector<double> white = whiteMtf(eye, u), green = radialMtf(eye, u);
  EXPECT_NEAR(white[0], 1.0, 1e-9);
  EXPECT_LT(white[1], green[1]);
  EXPECT_LT(white[2], 0.9 * green[2]);
}

TEST(Validation, AFigureOutOfBoundsShows) {
  const ValidationFigure good{.group = "g",
                              .what = "w",
                              .unit = "D",
                              .source = "s",
                              .expected = 1.0,
                              .tolerance = 0.1,
                              .value = 1.1 - 1e-9};
  ValidationFigure bad = good, none = good;
  bad.value = 1.2;
  none.value = NAN;
  EXPECT_TRUE(good.inBounds());
  EXPECT_FALSE(bad.inBounds());
  EXPECT_FALSE(none.inBounds());
  EXPECT_NE(validationPage({good}).find("all within their bounds"), std::string::npos);
  EXPECT_NE(validationPage({good, bad, none}).find("2 out of bounds"), std::string::npos);
  bad.known_miss = "the sources disagree";
  EXPECT_NE(validationPage({good, bad}).find("all within their bounds but 1 known miss"),
            std::string::npos);
  EXPECT_NE(validationTable({bad}).find("\t1.0000\t0.1000\t1.2000\t0\ts"), std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci
