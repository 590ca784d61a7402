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
  command.add_flag("--overwrite", overwrite, "Also replace files that foci did not make");
}

void addScreen(CLI::App& calibrate) {
  const auto options = std::make_shared<CalibrateScreenOptions>();
  CLI::App* screen =
      calibrate.add_subcommand("screen", "Measure the screen: size, distance, gamma.");
  CalibrateScreenOptions& o = *options;
  screen->add_flag("--headless", o.headless, "No window: the options give every measure");
  screen->add_flag("--window", o.window, "Use a window instead of the full screen");
  screen->add_option("--size-px", o.size_px, "Resolution, WxH");
  screen->add_option("--card-px", o.card_px, "Bank card as fitted on screen, W or WxH px");
  screen->add_option("--size-m", o.size_m, "Visible area, WxH m");
  screen->add_option("--edid", o.edid, "EDID file, as /sys/class/drm/*/edid");
  screen->add_option("--monitor", o.monitor, "Start from this screen: a PsychoPy monitor or TOML");
  screen->add_option("--distance-m", o.distance_m, "Distance from eye to screen");
  screen->add_option(
      "--blind-spot-px", o.blind_spot_px,
      "Offsets at which the dot vanished (above 0) or came back (below 0), by commas");
  screen->add_option("--face-px", o.face_px, "Width of the face in the webcam's image");
  screen->add_option("--face-reference-px", o.face_reference_px,
                     "Width of the face at a known distance");
  screen->add_option("--face-reference-m", o.face_reference_m, "The known distance");
  screen->add_option("--gamma", o.gamma, "sRGB, or a number from 1 to 4");
  screen->add_option("--out", o.out, "Write the screen as TOML");
  screen->add_option("--psychopy", o.psychopy, "Write the screen as a PsychoPy monitor (JSON)");
  addOverwrite(*screen, o.overwrite);
  screen->add_flag("--json", o.json, "Print the summary as JSON");
  screen->callback([=] {
    refuseEmpty(*screen);
    calibrateScreen(*options);
  });
}

void addGaze(CLI::App& calibrate) {
  const auto options = std::make_shared<CalibrateGazeOptions>();
  CLI::App* gaze =
      calibrate.add_subcommand("gaze", "Map the tracker's gaze to the screen, with its accuracy.");
  CalibrateGazeOptions& o = *options;
  gaze->add_option("--pairs", o.pairs, "Samples to fit: a table with x y x_target y_target");
  gaze->add_option("--validate", o.validate, "Samples of other targets, to measure accuracy on");
  gaze->add_option("--drift", o.drift, "Correct this map; --pairs has samples of one target");
  gaze->add_option("--units", o.units, "Unit of the pairs; direction: the plane z = 1")
      ->type_name("deg|norm|direction");
  gaze->add_option("--model", o.model, "auto, offset, affine, second or third");
  gaze->add_option("--screen", o.screen, "Calibrated screen");
  gaze->add_option("--out", o.out, "Write the map as TOML, and its report beside it");
  gaze->add_option("--report", o.report, "Write the report (HTML) to this file instead");
  gaze->add_option("--source", o.source,
                   "mouse or webcam[:N] in the window; webcam:VIDEO with --pairs");
  gaze->add_option("--camera", o.camera, "Calibrated camera, for a webcam");
  gaze->add_option("--targets", o.targets, "Number of targets in the window: 5, 9, 13 or 16");
  gaze->add_option("--seed", o.seed, "Seed for the order of the targets");
  gaze->add_flag("--window", o.window, "Use a window instead of the full screen");
  gaze->add_flag("--manual", o.manual, "Each target waits for the space key");
  addOverwrite(*gaze, o.overwrite);
  gaze->add_flag("--json", o.json, "Print the summary as JSON");
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
      ->add_option("--pairs", o.pairs, "Eyes and targets to fit, a table (docs/calibration.md)")
      ->required();
  binocular->add_option("--validate", o.validate,
                        "Samples of other targets, to measure accuracy on");
  binocular->add_option("--out", o.out, "Write the map as TOML");
  addOverwrite(*binocular, o.overwrite);
  binocular->add_flag("--json", o.json, "Print the summary as JSON");
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
  camera->add_option("--images", o.images, "Images of the board");
  camera->add_option("--video", o.video, "Video of the board");
  camera->add_option("--device", o.device, "Number of the camera that sees the board");
  camera->add_flag("--window", o.window, "Show the video while it is searched");
  camera->add_option("--board", o.board, "Inner corners of the chessboard, WxH");
  camera->add_option("--charuco", o.charuco, "Squares of a ChArUco board, WxH, instead");
  camera->add_option("--square-mm", o.square_mm, "Side of a square");
  camera->add_option("--marker-mm", o.marker_mm, "Side of a ChArUco marker");
  camera->add_option("--out", o.out, "Write the camera as TOML");
  addOverwrite(*camera, o.overwrite);
  camera->add_flag("--json", o.json, "Print the summary as JSON");
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
