// Project Aria's glasses: the head's trajectory from their machine perception services, beside a
// table of gaze (facebookresearch.github.io/projectaria_tools).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Whether a table's header is that of Aria's gaze. @param header  its first line
bool isAriaGaze(std::string_view header);

/// closed_loop_trajectory.csv, packed or not: beside a recording of gaze, or in the folder slam or
/// trajectory beside its folder. Nothing if there is none.
std::optional<std::filesystem::path> ariaTrajectoryBeside(const std::filesystem::path& gaze);

/// Where the head is, in the frame of the scene's points (global_points.csv).
class AriaTrajectory {
 public:
  /// The trajectory is that of a camera. The place of the eyes' frame (CPF) in the camera's frame
  /// is known from the glasses' drawings, which differ for the two generations.
  /// @param header  of the table of gaze
  /// @throws InputError
  AriaTrajectory(const std::filesystem::path& file, std::string_view header);

  /// Between the poses around a time: the place linearly, the orientation along the shortest arc.
  /// Nothing beside the trajectory, or in a gap of over 0.1 s.
  std::optional<HeadInWorld> at(double time_s) const;

  /// Whose drawings were taken, for reports.
  std::string assumed() const;

 private:
  struct Pose {
    double time_s = 0.0;
    HeadInWorld head{};
  };

  bool first_generation_;
  std::vector<Pose> poses_{};
};

}  // namespace foci
