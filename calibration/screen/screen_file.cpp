#include "calibration/screen/screen_file.h"

#include <fstream>

#include "base/input_error.h"
#include "calibration/calibration_file.h"
#include "calibration/screen/monitor.h"

namespace foci {

std::string screenToml(const ScreenCalibration& calibration) {
  const Screen& screen = calibration.screen;
  std::string text = "# Screen calibrated by foci.\n[screen]\n";
  text += "size_px = " + exactText(screen.size_px) + "\n";
  text += "size_m = " + exactText(screen.size_m) + "\n";
  text += "distance_m = " + exactText(screen.distance_m) + "\n\n[display]\n";
  text += "gamma = " + (calibration.gamma ? exactText(*calibration.gamma) : "\"sRGB\"") + "\n";
  text += "size_from = " + quotedText(calibration.size_from) + "\n";
  text += "distance_from = " + quotedText(calibration.distance_from) + "\n";
  return text;
}

ScreenCalibration readScreen(const std::filesystem::path& file) {
  requireRegularFile(file);
  {
    std::ifstream peek(file, std::ios::binary);
    char first = 0;
    if (peek >> first && first == '{') {
      const PsychoPyMonitor monitor = readPsychoPyMonitor(file);
      return {.screen = monitor.screen,
              .gamma = monitor.gamma,
              .size_from = "PsychoPy monitor",
              .distance_from = "PsychoPy monitor"};
    }
  }
  CalibrationFile in(file);
  ScreenCalibration calibration;
  calibration.screen = {.size_px = in.size_px("screen.size_px"),
                        .size_m = in.pair("screen.size_m", 0.01, 20.0),
                        .distance_m = in.number("screen.distance_m", 0.01, 100.0)};
  if (in.has("display.gamma")) {
    calibration.gamma = in.numberOrWord("display.gamma", "sRGB", 1.0, 4.0);
  }
  if (in.has("display.size_from")) calibration.size_from = in.text("display.size_from");
  if (in.has("display.distance_from")) calibration.distance_from = in.text("display.distance_from");
  in.refuseUnknownKeys();
  return calibration;
}

}  // namespace foci
