#include "app/calibrate/calibrate.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "app/calibrate/options.h"
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

}  // namespace

void addCalibrateCommand(CLI::App& app) {
  CLI::App* calibrate =
      app.add_subcommand("calibrate", "The screen, the gaze, both eyes in space, the camera")
          ->require_subcommand(1);

  const auto screen_options = std::make_shared<CalibrateScreenOptions>();
  CLI::App* screen = calibrate->add_subcommand("screen", "Size, distance and gamma of the screen");
  {
    CalibrateScreenOptions& o = *screen_options;
    screen->add_flag("--headless", o.headless, "No window: everything comes from the options");
    screen->add_flag("--window", o.window, "A window instead of the full screen");
    screen->add_option("--size-px", o.size_px, "Resolution, WxH");
    screen->add_option("--card-px", o.card_px, "Bank card as fitted on screen, W or WxH px");
    screen->add_option("--size-m", o.size_m, "Visible area, WxH m");
    screen->add_option("--edid", o.edid, "EDID file, as /sys/class/drm/*/edid");
    screen->add_option("--monitor", o.monitor, "PsychoPy monitor or our TOML, to start from");
    screen->add_option("--distance-m", o.distance_m, "Eye to screen, by hand");
    screen->add_option(
        "--blind-spot-px", o.blind_spot_px,
        "Offsets where the dot vanished, by commas: outwards above 0, inwards below");
    screen->add_option("--face-px", o.face_px, "Width of the face in the webcam's image");
    screen->add_option("--face-reference-px", o.face_reference_px, "The same at a known distance");
    screen->add_option("--face-reference-m", o.face_reference_m, "That distance");
    screen->add_option("--gamma", o.gamma, "sRGB, or a number from 1 to 4");
    screen->add_option("--out", o.out, "Screen as TOML");
    screen->add_option("--psychopy", o.psychopy, "Screen as a PsychoPy monitor (JSON)");
    screen->add_flag("--json", o.json, "Summary on standard output as JSON");
  }
  screen->callback([=] {
    refuseEmpty(*screen);
    calibrateScreen(*screen_options);
  });

  const auto gaze_options = std::make_shared<CalibrateGazeOptions>();
  CLI::App* gaze = calibrate->add_subcommand("gaze", "From the tracker's gaze to the screen");
  {
    CalibrateGazeOptions& o = *gaze_options;
    gaze->add_option("--pairs", o.pairs, "Samples to fit: TSV with x y x_target y_target");
    gaze->add_option("--validate", o.validate, "Samples to measure on, of other targets");
    gaze->add_option("--drift", o.drift, "Map to move: --pairs has samples of one target");
    gaze->add_option("--units", o.units, "deg, norm or direction (the plane z = 1)");
    gaze->add_option("--model", o.model, "auto, offset, affine, second or third");
    gaze->add_option("--screen", o.screen, "Calibrated screen");
    gaze->add_option("--out", o.out, "Map as TOML; the report goes beside it");
    gaze->add_option("--report", o.report, "Report as HTML, another name");
    gaze->add_option("--source", o.source,
                     "mouse or webcam[:N] in the window; webcam:VIDEO with --pairs");
    gaze->add_option("--camera", o.camera, "Calibrated camera, for a webcam");
    gaze->add_option("--targets", o.targets, "In the window: 5, 9, 13 or 16");
    gaze->add_option("--seed", o.seed, "Order of the targets");
    gaze->add_flag("--window", o.window, "A window instead of the full screen");
    gaze->add_flag("--manual", o.manual, "Each target waits for the space key");
    gaze->add_flag("--json", o.json, "Summary on standard output as JSON");
  }
  gaze->callback([=] {
    refuseEmpty(*gaze);
    calibrateGaze(*gaze_options);
  });

  const auto binocular_options = std::make_shared<CalibrateBinocularOptions>();
  CLI::App* binocular = calibrate->add_subcommand(
      "binocular", "From eyes in space to the screen: the display's pose, each eye's kappa");
  {
    CalibrateBinocularOptions& o = *binocular_options;
    binocular
        ->add_option("--pairs", o.pairs, "Eyes and targets to fit, a table (docs/calibration.md)")
        ->required();
    binocular->add_option("--validate", o.validate, "Others, to measure on");
    binocular->add_option("--out", o.out, "Map as TOML");
    binocular->add_flag("--json", o.json, "Summary on standard output as JSON");
  }
  binocular->callback([=] {
    refuseEmpty(*binocular);
    calibrateBinocular(*binocular_options);
  });

  const auto camera_options = std::make_shared<CalibrateCameraOptions>();
  CLI::App* camera = calibrate->add_subcommand("camera", "Focal length and distortion of a camera");
  {
    CalibrateCameraOptions& o = *camera_options;
    camera->add_option("--images", o.images, "Images of the board");
    camera->add_option("--video", o.video, "Video of the board");
    camera->add_option("--device", o.device, "Camera to watch the board with");
    camera->add_flag("--window", o.window, "Show the video as it is searched");
    camera->add_option("--board", o.board, "Chessboard's inner corners, WxH");
    camera->add_option("--charuco", o.charuco, "ChArUco board's squares, WxH, instead");
    camera->add_option("--square-mm", o.square_mm, "Side of a square");
    camera->add_option("--marker-mm", o.marker_mm, "Side of a ChArUco marker");
    camera->add_option("--out", o.out, "Camera as TOML");
    camera->add_flag("--json", o.json, "Summary on standard output as JSON");
  }
  camera->callback([=] {
    refuseEmpty(*camera);
    calibrateCamera(*camera_options);
  });
}

}  // namespace foci
