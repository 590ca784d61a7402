// Fits a gaze map to a table of measured gaze and targets (x y x_target y_target, degrees), writes
// the map, and prints the point that it gives for straight ahead:
//   fit_gaze_map PAIRS.tsv MAP.toml
#include <exception>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

#include <foci/calibration/gaze_map/fit_gaze_map.h>
#include <foci/calibration/gaze_map/gaze_map.h>

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::cerr << "usage: fit_gaze_map PAIRS.tsv MAP.toml\n";
    return 2;
  }
  const foci::GazeFrame frame{foci::MapUnits::deg, {{1920, 1080}, {0.531, 0.299}, 0.6}};
  const auto pairs = foci::readGazePairs(argv[1], frame.units);
  const foci::GazeFit fit = foci::fitGazeMap(pairs, frame);
  std::ofstream out(argv[2]);
  out << foci::gazeMapToml(fit.map);
  out.close();
  if (!out) throw std::runtime_error(std::string("cannot write ") + argv[2]);

  const foci::GazeEstimate ahead = foci::estimateGaze(fit.map, {0.0, 0.0});
  std::cout << "model " << foci::nameOf(fit.map.model) << "; straight ahead: " << ahead.point.x
            << ", " << ahead.point.y << " deg, within " << ahead.uncertainty_deg << " deg\n";
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
