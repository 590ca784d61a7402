// Films an observer who looks at the targets of `foci calibrate gaze`, in the same order.
//
//     foci_film OUT.mp4 TARGETS SEED WIDTH_M HEIGHT_M DISTANCE_M LEAD_S EACH_S
//
// For LEAD_S the observer looks at the centre, then for EACH_S at each target of the calibration
// and of the validation. Prints the targets: onset_s duration_s x_target y_target, in metres.
#include <cstdio>
#include <cstdlib>

#include "calibration/gaze_map/target_session.h"
#include "tests/faces/film.h"
#include "tests/faces/observer.h"

namespace foci {

static int film(char** argv) {
  const auto seed = static_cast<std::uint64_t>(std::atoll(argv[3]));
  const glm::dvec2 screen_m(std::atof(argv[4]), std::atof(argv[5]));
  const double distance_m = std::atof(argv[6]), lead_s = std::atof(argv[7]),
               each_s = std::atof(argv[8]);
  constexpr double kRate_Hz = 10.0;  // few images to render

  std::vector<faces::ShownTarget> shown{{.from_s = 0.0, .to_s = lead_s}};
  std::printf("onset_s\tduration_s\tx_target\ty_target\n");
  for (const int count : {std::atoi(argv[2]), 4}) {
    for (const glm::dvec2& place : shuffled(targetLayout(count), seed)) {
      const glm::dvec2 point_m = (place - 0.5) * glm::dvec2(1.0, -1.0) * screen_m;
      const double from_s = shown.back().to_s;
      shown.push_back({.from_s = from_s, .to_s = from_s + each_s, .point_m = point_m});
      std::printf("%.3f\t%.3f\t%.6f\t%.6f\n", from_s, each_s, point_m.x, point_m.y);
    }
  }
  faces::Sitting sitting{.seed = 5};
  sitting.head_m.z = distance_m;
  const faces::Face face(faces::somebody(0));
  const faces::Observer observer(sitting, shown);
  faces::film(argv[1], face, kRate_Hz, shown.back().to_s + 0.5, {},
              [&](double time_s) { return observer.at(time_s); });
  return 0;
}

}  // namespace foci

int main(int argc, char** argv) { return argc == 9 ? foci::film(argv) : 2; }
