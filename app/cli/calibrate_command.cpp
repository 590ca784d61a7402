// `foci calibrate screen | gaze | binocular | camera`.
#include <CLI/CLI.hpp>
#include <memory>

#include "app/calibrate/options.h"
#include "app/cli/commands.h"
#include "base/input_error.h"

namespace foci {
namespace {

void refuseEmpty(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() > 0 && option->get_type_size() > 0 && option->as<std::string>().empty()) {
      throw InputError(option->get_name(), "expected a value that is not empty");
    }
  }
}

void addOverwrite(CLI::App& command, bool& overwrite) {
  command.add_flag("--overwrite", overwrite, "also replace files that foci did not make");
}

void addScreen(CLI::App& calibrate) {
  const auto options = std::make_shared<CalibrateScreenOptions>();
  CLI::App* screen =
      calibrate.add_subcommand("screen", "Measure the screen: size, distance, gamma.");
  CalibrateScreenOptions& o = *options;
  screen->add_flag("--headless", o.headless, "no window: the options give every measure");
  screen->add_flag("--window", o.window, "a window instead of the full screen");
  screen->add_option("--size-px", o.size_px, "resolution")->type_name("WxH");
  screen->add_option("--card-px", o.card_px, "size of the bank card on the screen, W or WxH px")
      ->type_name("WxH");
  screen->add_option("--size-m", o.size_m, "visible area, metres")->type_name("WxH");
  screen->add_option("--edid", o.edid, "EDID file, as /sys/class/drm/*/edid")->type_name("FILE");
  screen
      ->add_option("--monitor", o.monitor,
                   "start from this screen: a TOML file of foci or a PsychoPy monitor")
      ->type_name("FILE");
  screen->add_option("--distance-m", o.distance_m, "distance from eye to screen, metres")
      ->type_name("D");
  screen
      ->add_option("--blind-spot-px", o.blind_spot_px,
                   "offsets at which the dot vanished (above 0) or came back (below 0), px")
      ->type_name("PX,...");
  screen->add_option("--face-px", o.face_px, "width of the face in the webcam's image, px")
      ->type_name("PX");
  screen
      ->add_option("--face-reference-px", o.face_reference_px,
                   "width of the face at a known distance, px")
      ->type_name("PX");
  screen->add_option("--face-reference-m", o.face_reference_m, "that distance, metres")
      ->type_name("D");
  screen->add_option("--gamma", o.gamma, "sRGB, or a number from 1 to 4")->type_name("GAMMA");
  screen->add_option("--out", o.out, "write the screen as TOML")->type_name("FILE.toml");
  screen->add_option("--psychopy", o.psychopy, "write the screen as a PsychoPy monitor")
      ->type_name("FILE.json");
  addOverwrite(*screen, o.overwrite);
  screen->add_flag("--json", o.json, "print the summary as JSON");
  screen->callback([=] {
    refuseEmpty(*screen);
    calibrateScreen(*options);
  });
}

void addGaze(CLI::App& calibrate) {
  const auto options = std::make_shared<CalibrateGazeOptions>();
  CLI::App* gaze = calibrate.add_subcommand(
      "gaze", "Fit a map from the tracker's gaze to the screen, and measure its accuracy.");
  CalibrateGazeOptions& o = *options;
  gaze->add_option("--pairs", o.pairs, "samples to fit: a table with x y x_target y_target")
      ->type_name("FILE");
  gaze->add_option("--validate", o.validate, "samples of other targets, to measure accuracy on")
      ->type_name("FILE");
  gaze->add_option("--drift", o.drift, "correct this map; --pairs has samples of one target")
      ->type_name("FILE");
  gaze->add_option("--units", o.units, "unit of the pairs; direction: the plane z = 1")
      ->type_name("deg|norm|direction");
  gaze->add_option("--model", o.model, "kind of map; default: auto")
      ->type_name("auto|offset|affine|second|third");
  gaze->add_option("--screen", o.screen, "calibrated screen")->type_name("FILE");
  gaze->add_option("--out", o.out, "write the map as TOML, and its report beside it")
      ->type_name("FILE.toml");
  gaze->add_option("--report", o.report, "write the report to this file instead")
      ->type_name("FILE.html");
  gaze->add_option("--source", o.source,
                   "mouse or webcam[:N] in the window; webcam:VIDEO with --pairs")
      ->type_name("NAME");
  gaze->add_option("--camera", o.camera, "calibrated camera, for a webcam")->type_name("FILE");
  gaze->add_option("--targets", o.targets, "number of targets in the window; default: 9")
      ->type_name("5|9|13|16");
  gaze->add_option("--seed", o.seed, "seed for the order of the targets")->type_name("N");
  gaze->add_flag("--window", o.window, "a window instead of the full screen");
  gaze->add_flag("--manual", o.manual, "each target waits for the space key");
  addOverwrite(*gaze, o.overwrite);
  gaze->add_flag("--json", o.json, "print the summary as JSON");
  gaze->callback([=] {
    refuseEmpty(*gaze);
    calibrateGaze(*options);
  });
}

void addBinocular(CLI::App& calibrate) {
  const auto options = std::make_shared<CalibrateBinocularOptions>();
  CLI::App* binocular = calibrate.add_subcommand(
      "binocular", "Find the display's pose and each eye's kappa in a binocular tracker's frame.");
  CalibrateBinocularOptions& o = *options;
  binocular
      ->add_option("--pairs", o.pairs, "table of eyes and targets to fit (docs/calibration.md)")
      ->type_name("FILE")
      ->required();
  binocular
      ->add_option("--validate", o.validate, "samples of other targets, to measure accuracy on")
      ->type_name("FILE");
  binocular->add_option("--out", o.out, "write the map as TOML")->type_name("FILE.toml");
  addOverwrite(*binocular, o.overwrite);
  binocular->add_flag("--json", o.json, "print the summary as JSON");
  binocular->callback([=] {
    refuseEmpty(*binocular);
    calibrateBinocular(*options);
  });
}

void addCamera(CLI::App& calibrate) {
  const auto options = std::make_shared<CalibrateCameraOptions>();
  CLI::App* camera =
      calibrate.add_subcommand("camera", "Measure a camera's focal length and distortion.");
  CalibrateCameraOptions& o = *options;
  camera->add_option("--images", o.images, "images of the board")->type_name("FILE");
  camera->add_option("--video", o.video, "video of the board")->type_name("FILE");
  camera->add_option("--device", o.device, "number of the camera that sees the board")
      ->type_name("N");
  camera->add_flag("--window", o.window, "show the video while foci searches it");
  camera->add_option("--board", o.board, "inner corners of the chessboard")->type_name("WxH");
  camera->add_option("--charuco", o.charuco, "squares of a ChArUco board, instead of --board")
      ->type_name("WxH");
  camera->add_option("--square-mm", o.square_mm, "side of a square, millimetres")->type_name("MM");
  camera->add_option("--marker-mm", o.marker_mm, "side of a ChArUco marker, millimetres")
      ->type_name("MM");
  camera->add_option("--out", o.out, "write the camera as TOML")->type_name("FILE.toml");
  addOverwrite(*camera, o.overwrite);
  camera->add_flag("--json", o.json, "print the summary as JSON");
  camera->callback([=] {
    refuseEmpty(*camera);
    calibrateCamera(*options);
  });
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
