// The promise of a calibrated screen: blur drawn on it subtends the angle that the eye's own blur
// would.
#include <gtest/gtest.h>

#include <cmath>

#include "calibration/screen/screen_size.h"
#include "render/methods/method.h"
#include "render/optics/defocus.h"
#include "render/optics/view.h"
#include "render/scene/surfel_cloud.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kBlur = 0.02;  // the limit
constexpr double kPupil_m = 0.004, kPoint_D = 1.0;
constexpr int kSize_px = 161;

/// A screen as an observer with a card and a blind spot finds it.
Screen measuredScreen(double px_per_m, double distance_m) {
  const glm::dvec2 found_px_per_m = pxPerMetreOfCard(kBankCard_m.x * px_per_m, {});
  const double spot_m = distance_m * std::tan(glm::radians(kBlindSpot_deg));
  const std::vector<BlindSpotRun> runs(4, {.offset_m = spot_m, .outwards = true});
  return {.size_px = {kSize_px, kSize_px},
          .size_m = glm::dvec2(kSize_px) / found_px_per_m,
          .distance_m = distanceByBlindSpot(runs).distance_m};
}

/// Radius of the disc whose blur the frame shows, from its second moment.
double radiusIn_px(const Frame& frame, double unblurred_px2) {
  double mass = 0.0, x = 0.0, square = 0.0;
  for (int py = 0; py < frame.size_px.y; ++py) {
    for (int px = 0; px < frame.size_px.x; ++px) {
      const double light = frame.at(px, py).r;
      mass += light;
      x += light * px;
      square += light * px * px;
    }
  }
  const double variance = square / mass - (x / mass) * (x / mass);
  return std::sqrt((variance - unblurred_px2) / kDiscVariancePerRadius2);
}

TEST(BlurOnScreen, SubtendsTheAngleOfTheEyesOwn) {
  for (const double dpi : {96.0, 220.0, 600.0}) {
    for (const double distance_m : {0.3, 0.6, 3.0}) {
      const double px_per_m = dpi / 0.0254;
      const Screen screen = measuredScreen(px_per_m, distance_m);
      const View view =
          viewThroughScreen(glm::mat4(1.0f), screen.size_px, screen.size_m, screen.distance_m);
      // So much defocus that the blur is 15 px: far from both the pixel and the frame's edge.
      const double defocus_D = 15.0 / (0.5 * kPupil_m * distance_m * px_per_m);
      RenderSettings settings;
      settings.defocus =
          defocusOfLens(kPupil_m, view.focal_px, kPoint_D + defocus_D, DistanceAlong::sight);
      const auto sigma_m = static_cast<float>(0.1 / (distance_m * px_per_m));
      SurfelCloud cloud;
      appendSurfel(cloud, {0.0f, 0.0f, static_cast<float>(-1.0 / kPoint_D)}, {0.0f, 0.0f, 1.0f},
                   sigma_m, 4.0f * sigma_m * sigma_m, glm::vec3(1.0f));
      Frame frame;
      makeMethod("sweep", cloud)->render(view, settings, frame);
      const double radius_px = radiusIn_px(frame, 1.0 + 0.01);
      const double angle_rad = 2.0 * std::atan(radius_px / px_per_m / distance_m);
      EXPECT_NEAR(angle_rad / (kPupil_m * defocus_D), 1.0, kBlur)
          << dpi << " dpi, " << distance_m << " m";
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
