// `foci calibrate screen | gaze | binocular | camera`.
#include <memory>

#include "app/calibrate/options.h"
#include "app/cli/commands.h"

namespace foci {
namespace {

void addScreen(CLI::App& calibrate) {
  const auto options = std::make_shared<CalibrateScreenOptions>();
  CLI::App* screen =
      calibrate.add_subcommand("screen", "Measure the screen: size, distance, gamma.");
  CalibrateScreenOptions& o = *options;
  screen->add_flag("--headless", o.headless, "no window: the options give every measure");
  screen->add_flag("--window", o.window, "a window instead of the full screen");
  addOption(*screen, "--size-px", o.size_px, "WxH", "resolution");
  addOption(*screen, "--card-px", o.card_px, "WxH",
            "size of the bank card on the screen, W or WxH px");
  addOption(*screen, "--size-m", o.size_m, "WxH", "visible area, metres");
  addOption(*screen, "--edid", o.edid, "FILE", "EDID file, as /sys/class/drm/*/edid");
  addOption(*screen, "--monitor", o.monitor, "FILE",
            "start from this screen: a TOML file of foci or a PsychoPy monitor");
  addOption(*screen, "--distance-m", o.distance_m, "D", "distance from eye to screen, metres");
  addOption(*screen, "--blind-spot-px", o.blind_spot_px, "PX,...",
            "offsets at which the dot vanished (above 0) or came back (below 0), px");
  addOption(*screen, "--face-px", o.face_px, "PX", "width of the face in the webcam's image, px");
  addOption(*screen, "--face-reference-px", o.face_reference_px, "PX",
            "width of the face at a known distance, px");
  addOption(*screen, "--face-reference-m", o.face_reference_m, "D", "that distance, metres");
  addOption(*screen, "--gamma", o.gamma, "GAMMA", "sRGB, or a number from 1 to 4");
  addOption(*screen, "--out", o.out, "FILE.toml", "write the screen as TOML");
  addOption(*screen, "--psychopy", o.psychopy, "FILE.json",
            "write the screen as a PsychoPy monitor");
  addOverwriteFlag(*screen, o.overwrite);
  screen->add_flag("--json", o.json, "print the summary as JSON");
  onceParsed(*screen, [=] { calibrateScreen(*options); });
}

void addGaze(CLI::App& calibrate) {
  const auto options = std::make_shared<CalibrateGazeOptions>();
  CLI::App* gaze = calibrate.add_subcommand(
      "gaze", "Fit a map from the tracker's gaze to the screen, and measure its accuracy.");
  CalibrateGazeOptions& o = *options;
  addOption(*gaze, "--pairs", o.pairs, "FILE",
            "samples to fit: a table with x y x_target y_target");
  addOption(*gaze, "--validate", o.validate, "FILE",
            "samples of other targets, to measure accuracy on");
  addOption(*gaze, "--drift", o.drift, "FILE",
            "correct this map; --pairs has samples of one target");
  addOption(*gaze, "--units", o.units, "deg|norm|direction",
            "unit of the pairs; direction: the plane z = 1");
  addOption(*gaze, "--model", o.model, "auto|offset|affine|second|third",
            "kind of map; default: auto");
  addOption(*gaze, "--screen", o.screen, "FILE", "calibrated screen");
  addOption(*gaze, "--out", o.out, "FILE.toml", "write the map as TOML, and its report beside it");
  addOption(*gaze, "--report", o.report, "FILE.html", "write the report to this file instead");
  addOption(*gaze, "--source", o.source, "NAME",
            "mouse or webcam[:N] in the window; webcam:VIDEO with --pairs");
  addOption(*gaze, "--camera", o.camera, "FILE", "calibrated camera, for a webcam");
  addOption(*gaze, "--targets", o.targets, "5|9|13|16",
            "number of targets in the window; default: 9");
  addOption(*gaze, "--seed", o.seed, "N", "seed for the order of the targets");
  gaze->add_flag("--window", o.window, "a window instead of the full screen");
  gaze->add_flag("--manual", o.manual, "each target waits for the space key");
  for (const char* other : {"--validate", "--units", "--model", "--screen", "--report", "--source",
                            "--camera", "--targets", "--seed", "--window", "--manual"}) {
    gaze->get_option("--drift")->excludes(gaze->get_option(other));
  }
  addOverwriteFlag(*gaze, o.overwrite);
  gaze->add_flag("--json", o.json, "print the summary as JSON");
  onceParsed(*gaze, [=] { calibrateGaze(*options); });
}

void addBinocular(CLI::App& calibrate) {
  const auto options = std::make_shared<CalibrateBinocularOptions>();
  CLI::App* binocular = calibrate.add_subcommand(
      "binocular", "Find the display's pose and each eye's kappa in a binocular tracker's frame.");
  CalibrateBinocularOptions& o = *options;
  addOption(*binocular, "--pairs", o.pairs, "FILE",
            "table of eyes and targets to fit (docs/calibration.md)")
      ->required();
  addOption(*binocular, "--validate", o.validate, "FILE",
            "samples of other targets, to measure accuracy on");
  addOption(*binocular, "--out", o.out, "FILE.toml", "write the map as TOML");
  addOverwriteFlag(*binocular, o.overwrite);
  binocular->add_flag("--json", o.json, "print the summary as JSON");
  onceParsed(*binocular, [=] { calibrateBinocular(*options); });
}

void addCamera(CLI::App& calibrate) {
  const auto options = std::make_shared<CalibrateCameraOptions>();
  CLI::App* camera =
      calibrate.add_subcommand("camera", "Measure a camera's focal length and distortion.");
  CalibrateCameraOptions& o = *options;
  addOption(*camera, "--images", o.images, "FILE", "images of the board");
  addOption(*camera, "--video", o.video, "FILE", "video of the board");
  addOption(*camera, "--device", o.device, "N", "number of the camera that sees the board");
  camera->add_flag("--window", o.window, "show the video while foci searches it");
  addOption(*camera, "--board", o.board, "WxH", "inner corners of the chessboard");
  addOption(*camera, "--charuco", o.charuco, "WxH",
            "squares of a ChArUco board, instead of --board");
  addOption(*camera, "--square-mm", o.square_mm, "MM", "side of a square, millimetres");
  addOption(*camera, "--marker-mm", o.marker_mm, "MM", "side of a ChArUco marker, millimetres");
  addOption(*camera, "--out", o.out, "FILE.toml", "write the camera as TOML");
  addOverwriteFlag(*camera, o.overwrite);
  camera->add_flag("--json", o.json, "print the summary as JSON");
  onceParsed(*camera, [=] { calibrateCamera(*options); });
}

}  // namespace

void addCalibrateCommand(CLI::App& app) {
  CLI::App* calibrate =
      app.add_subcommand("calibrate", "Calibrate the screen, a tracker, a webcam or a camera.")
          ->require_subcommand(1);
  addScreen(*calibrate);
  addGaze(*calibrate);
  addBinocular(*calibrate);
  addCamera(*calibrate);
}

}  // namespace foci
