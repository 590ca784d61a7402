// `foci calibrate screen`: measured in its window or, with --headless, given as options.
#include <cmath>
#include <cstdio>
#include <fstream>

#include "app/calibrate/options.h"
#include "app/calibrate/windows.h"
#include "app/platform/output_files.h"
#include "app/platform/warnings.h"
#include "base/input_error.h"
#include "base/text.h"
#include "calibration/calibration_file.h"
#include "calibration/screen/screen_file.h"
#include "calibration/screen/screen_size.h"
#include "gaze/sources/trace_doubts.h"

namespace foci {
namespace {

/// Numbers of `text`, separated by any of `separators`.
std::vector<double> numbersOf(const std::string& option, const std::string& text,
                              const char* separators) {
  std::vector<double> numbers;
  std::size_t at = 0;
  while (at <= text.size()) {
    const std::size_t end = std::min(text.find_first_of(separators, at), text.size());
    const auto value = parseNumber(std::string_view(text).substr(at, end - at));
    if (!value) throw InputError(option, text.substr(0, 40) + ": expected numbers");
    numbers.push_back(*value);
    at = end + 1;
  }
  return numbers;
}

glm::dvec2 pairOf(const std::string& option, const std::string& text, double low, double high) {
  const auto two = numbersOf(option, text, "xX,");
  if (two.size() != 2 || !(two[0] >= low && two[1] >= low && two[0] <= high && two[1] <= high)) {
    throw InputError(option, text.substr(0, 40) + ": expected WxH, each " + exactText(low) +
                                 " to " + exactText(high));
  }
  return {two[0], two[1]};
}

std::optional<glm::dvec2> edidOf(const std::filesystem::path& file, Warnings& warnings) {
  if (file.empty()) return std::nullopt;
  requireRegularFile(file);
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file.string(), "cannot be read");
  std::vector<unsigned char> bytes(512);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  const EdidSize size = edidSize(bytes);
  warnings.add(file.string(), size.warning);
  return size.size_m;
}

/// Size of the visible area: a bank card takes precedence over --size-m, --size-m over the EDID.
void measureSize(const CalibrateScreenOptions& options, const std::optional<glm::dvec2>& edid_m,
                 ScreenCalibration& calibration) {
  Screen& screen = calibration.screen;
  if (!options.size_px.empty()) {
    screen.size_px = glm::ivec2(pairOf("--size-px", options.size_px, 16, 16384));
  }
  if (screen.size_px.x == 0) throw InputError("--size-px", "missing: expected WxH");
  const glm::dvec2 size_px(screen.size_px);
  if (!options.card_px.empty()) {
    const auto card = numbersOf("--card-px", options.card_px, "xX,");
    if (card.size() > 2) throw InputError("--card-px", "expected W or WxH");
    screen.size_m =
        size_px /
        pxPerMetreOfCard(card[0], card.size() == 2 ? std::optional<double>(card[1]) : std::nullopt);
    calibration.size_from = "bank card";
  } else if (!options.size_m.empty()) {
    screen.size_m = pairOf("--size-m", options.size_m, 0.01, 20.0);
    calibration.size_from = "by hand";
  } else if (edid_m && options.monitor.empty()) {
    screen.size_m = *edid_m;
    calibration.size_from = "EDID";
  }
  if (screen.size_m.x <= 0.0) {
    throw InputError("--card-px", "missing: expected --card-px, --size-m, --edid or --monitor");
  }
}

void measureDistance(const CalibrateScreenOptions& options, ScreenCalibration& calibration) {
  Screen& screen = calibration.screen;
  const double px_per_m = screen.size_px.x / screen.size_m.x;
  if (options.distance_m) {
    if (!isScreenDistance(*options.distance_m)) {
      throw InputError("--distance-m " + exactText(*options.distance_m), "expected 0.01 to 20 m");
    }
    screen.distance_m = *options.distance_m;
    calibration.distance_from = "by hand";
  } else if (!options.blind_spot_px.empty()) {
    std::vector<BlindSpotRun> runs;
    for (double px : numbersOf("--blind-spot-px", options.blind_spot_px, ",")) {
      runs.push_back({.offset_m = std::abs(px) / px_per_m, .outwards = px > 0.0});
    }
    const BlindSpotDistance found = distanceByBlindSpot(runs);
    screen.distance_m = found.distance_m;
    calibration.distance_from =
        printed("blind spot, %s, %zu refused, +-%.0f mm", counted(runs.size(), "run").c_str(),
                found.refused.size(), 1000.0 * found.sd_m);
  } else if (options.face_px) {
    if (!options.face_reference_px || !options.face_reference_m) {
      throw InputError("--face-px", "needs --face-reference-px and --face-reference-m");
    }
    screen.distance_m =
        distanceByFace_m(*options.face_px, *options.face_reference_px, *options.face_reference_m);
    calibration.distance_from = "face size";
  }
  if (screen.distance_m <= 0.0) {
    throw InputError("--distance-m",
                     "missing: expected --distance-m, --blind-spot-px, --face-px or --monitor");
  }
}

}  // namespace

void calibrateScreen(const CalibrateScreenOptions& options) {
  OutputFiles files(OutputGuard({options.out, options.psychopy}, {options.monitor, options.edid},
                                options.overwrite));
  ScreenCalibration calibration;
  if (!options.monitor.empty()) calibration = readScreen(options.monitor);
  if (options.gamma != "sRGB") {
    const auto gamma = numbersOf("--gamma", options.gamma, ",");
    if (gamma.size() != 1 || gamma[0] < 1.0 || gamma[0] > 4.0) {
      throw InputError("--gamma", options.gamma + ": expected sRGB or 1 to 4");
    }
    calibration.gamma = gamma[0];
  }
  Warnings warnings;
  const auto edid_m = edidOf(options.edid, warnings);
  if (options.headless) {
    measureSize(options, edid_m, calibration);
    measureDistance(options, calibration);
  } else {
    const auto found = calibrateScreenInWindow(calibration, edid_m, options.window);
    if (!found) {
      std::fprintf(stderr, "left without a calibration\n");
      return;
    }
    calibration = *found;
  }

  const Screen& screen = calibration.screen;
  const ScreenNames names{"--size-px", "--size-m", "--distance-m"};
  for (const std::string& doubt : screenDoubts(screen, names)) warnings.add(doubt);
  std::optional<double> edid_off;
  if (edid_m) edid_off = disagreement(screen.size_m, *edid_m);
  if (edid_off && *edid_off > kEdidTolerance) {
    std::fprintf(
        stderr,
        "the display states %.3f x %.3f m, which differs by %.0f %% from the measured size\n",
        edid_m->x, edid_m->y, 100.0 * *edid_off);
  }
  if (!options.psychopy.empty()) {
    files.write(options.psychopy, psychoPyMonitor(screen, calibration.gamma, "foci"));
  }
  if (!options.out.empty()) files.write(options.out, screenToml(calibration));
  files.commit();

  const glm::dvec2 px_per_m = glm::dvec2(screen.size_px) / screen.size_m;
  const double px_per_deg = px_per_m.x * screen.distance_m * std::tan(glm::radians(1.0));
  if (!options.json) {
    std::printf("%d x %d px, %.4f x %.4f m (%s), %.1f px/m\n", screen.size_px.x, screen.size_px.y,
                screen.size_m.x, screen.size_m.y, calibration.size_from.c_str(), px_per_m.x);
    std::printf("%.3f m away (%s), %.2f px per degree at the centre\n", screen.distance_m,
                calibration.distance_from.c_str(), px_per_deg);
    return;
  }
  std::printf("{\"size_px\": [%d, %d], \"size_m\": %s, \"distance_m\": %s, \"px_per_m\": %s, ",
              screen.size_px.x, screen.size_px.y, exactText(screen.size_m).c_str(),
              exactText(screen.distance_m).c_str(), exactText(px_per_m).c_str());
  std::printf("\"px_per_deg\": %s, \"gamma\": %s, \"size_from\": %s, \"distance_from\": %s, ",
              exactText(px_per_deg).c_str(),
              calibration.gamma ? exactText(*calibration.gamma).c_str() : "\"sRGB\"",
              quotedText(calibration.size_from).c_str(),
              quotedText(calibration.distance_from).c_str());
  std::printf("\"edid_disagreement\": %s}\n", edid_off ? exactText(*edid_off).c_str() : "null");
}

}  // namespace foci
