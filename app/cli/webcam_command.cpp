#include <memory>

#include "app/cli/commands.h"
#include "app/webcam/watch.h"

namespace foci {

void addWebcamCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "webcam",
      "Show what the webcam tracker sees: face, irises, blinks and head, frame by frame.");
  const auto options = std::make_shared<WatchOptions>();
  command
      ->add_option("source", options->source,
                   "a camera's number, a video, a picture, or a pattern such as eye%04d.png")
      ->required()
      ->type_name("SOURCE");
  addOption(*command, "--out", options->out, "FILE", "write the table to this file (TSV)");
  addOption(
      *command, "--overlay", options->overlay, "FILE",
      "draw box, lids, irises and axes of the head over the frames: .mp4, or .png for one picture");
  addOption(*command, "--camera", options->camera, "FILE",
            "a calibrated camera (foci calibrate camera)");
  command->add_flag("--json", options->json, "print the summary as JSON");
  addOverwriteFlag(*command, options->overwrite);
  command->callback([options] { watchWebcam(*options); });
}

}  // namespace foci
