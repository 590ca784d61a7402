// Project Aria's glasses: the head's trajectory from their machine perception services, beside a
// table of gaze (facebookresearch.github.io/projectaria_tools). The drawings are those of
// projectaria_tools (core/calibration/ConfigData.cpp): the camera's place and its y and z axes in
// the frame CPF, x to the left, y up, z forward. The device's frame is that of the camera to the
// left in front.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/text.h"
#include "gaze/sources/recording_formats.h"
#include "gaze/sources/table_layout.h"

namespace foci {
namespace {

struct Drawing {
  glm::dvec3 place_m, y, z;
};

constexpr Drawing kFirstGeneration = {{0.071351, 0.002372, 0.008454},
                                      {0.793353, 0.000000, -0.608761},
                                      {0.607927, -0.052336, 0.792266}};
constexpr Drawing kSecondGeneration = {{0.071079, 0.005720, 0.011555},
                                       {-0.138127, -0.912873, -0.384166},
                                       {0.308866, -0.408244, 0.859034}};
constexpr double kMaxGap_s = 0.1, kMicrosecond_s = 1e-6;
constexpr double kUnitQuaternionSlack = 0.01;

/// The head's frame looks along -z, with x to the right.
HeadInWorld deviceFromHead(const Drawing& drawing) {
  const glm::dvec3 y = glm::normalize(drawing.y), z = glm::normalize(drawing.z);
  const glm::dmat3 device_from_cpf = glm::transpose(glm::dmat3(glm::cross(y, z), y, z));
  const glm::dmat3 cpf_from_head(-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0);
  return {.position_m = -(device_from_cpf * drawing.place_m),
          .world_from_head = glm::normalize(glm::quat_cast(device_from_cpf * cpf_from_head))};
}

/// closed_loop_trajectory.csv, packed or not: beside a recording of gaze, or in the folder slam or
/// trajectory beside its folder.
std::optional<std::filesystem::path> trajectoryBeside(const std::filesystem::path& gaze) {
  const std::filesystem::path folder = gaze.parent_path();
  for (const auto& place : {folder, folder / ".." / "slam", folder / ".." / "trajectory"}) {
    for (const char* name : {"closed_loop_trajectory.csv", "closed_loop_trajectory.csv.gz"}) {
      std::error_code unreadable;
      const std::filesystem::path file = (place / name).lexically_normal();
      if (std::filesystem::is_regular_file(file, unreadable)) return file;
    }
  }
  return std::nullopt;
}

/// Where the head is, in the frame of the scene's points (global_points.csv).
class AriaTrajectory {
 public:
  /// The trajectory is that of a camera. The place of the eyes' frame (CPF) in the camera's frame
  /// is known from the glasses' drawings, which differ for the two generations.
  /// @param header  of the table of gaze
  /// @throws InputError
  AriaTrajectory(const std::filesystem::path& file, std::string_view header)
      : first_generation_(header.find("left_pitch_rads_cpf") == std::string_view::npos) {
    const HeadInWorld device_from_head =
        deviceFromHead(first_generation_ ? kFirstGeneration : kSecondGeneration);
    NamedTable table(file, "the columns of Aria's closed_loop_trajectory.csv", true);
    constexpr std::array<const char*, 8> kNames = {
        "tracking_timestamp_us", "tx_world_device", "ty_world_device", "tz_world_device",
        "qx_world_device",       "qy_world_device", "qz_world_device", "qw_world_device"};
    std::array<std::size_t, kNames.size()> at{};
    for (std::size_t i = 0; i < kNames.size(); ++i) at[i] = table.column(kNames[i]);
    while (table.next()) {
      std::array<double, kNames.size()> v{};
      for (std::size_t i = 0; i < v.size(); ++i) v[i] = table.needed(at[i]);
      const glm::dquat q(v[7], v[4], v[5], v[6]);
      if (std::abs(glm::length(q) - 1.0) > kUnitQuaternionSlack) {
        throw table.error("qx_world_device to qw_world_device: expected a quaternion of length 1");
      }
      const double time_s = kMicrosecond_s * v[0];
      if (!poses_.empty() && time_s <= poses_.back().time_s) continue;
      const glm::dquat world_from_device = glm::normalize(q);
      poses_.push_back({time_s,
                        {.position_m = glm::dvec3(v[1], v[2], v[3]) +
                                       world_from_device * device_from_head.position_m,
                         .world_from_head = world_from_device * device_from_head.world_from_head}});
    }
  }

  /// Between the poses around a time: the place linearly, the orientation along the shortest arc.
  /// Nothing beside the trajectory, or in a gap of over 0.1 s.
  std::optional<HeadInWorld> at(double time_s) const {
    const auto after = std::ranges::lower_bound(poses_, time_s, {}, &Pose::time_s);
    if (after == poses_.end() || (after == poses_.begin() && after->time_s > time_s)) {
      return std::nullopt;
    }
    if (after->time_s == time_s) return after->head;
    const Pose &a = *(after - 1), &b = *after;
    if (b.time_s - a.time_s > kMaxGap_s) return std::nullopt;
    const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
    return HeadInWorld{
        .position_m = glm::mix(a.head.position_m, b.head.position_m, share),
        .world_from_head = glm::slerp(a.head.world_from_head, b.head.world_from_head, share)};
  }

  /// Whose drawings were taken, for reports.
  std::string assumed() const {
    return std::string(
               "head: the trajectory's camera lies before the eyes as in the drawings of ") +
           (first_generation_ ? "Aria Gen 1, size L" : "Aria Gen 2, size LL");
  }

 private:
  struct Pose {
    double time_s = 0.0;
    HeadInWorld head{};
  };

  bool first_generation_;
  std::vector<Pose> poses_{};
};

bool isAria(const RecordingFile& file) {
  const std::string_view header = file.firstLine();
  return file.isUndescribed() && !file.columns().space.hasHead() &&
         header.starts_with("tracking_timestamp_us,") &&
         header.find("yaw_rads_cpf") != header.npos && trajectoryBeside(file.path());
}

/// Gaze has no place in the world while the head has none.
TraceHeader readAria(const RecordingFile& file, const Screen&, const TakeSample& take) {
  const AriaTrajectory trajectory(*trajectoryBeside(file.path()), file.firstLine());
  std::size_t lost = 0;
  LineReader lines(file.path());
  TextRows rows(lines);
  TraceHeader header = readRows(rows, file.columns(), {}, [&](const GazeSample& gaze) {
    GazeSample sample = gaze;
    sample.head = trajectory.at(sample.time_s);
    if (!sample.head) {
      ++lost;
      sample.point_px.reset();
      loseGaze(sample);
    }
    take(sample);
  });
  header.world_y_up = false;
  header.assumed.push_back(trajectory.assumed());
  if (lost > 0) {
    header.warnings.push_back("gaze is left out of " + counted(lost, "sample") +
                              " beside the trajectory");
  }
  return header;
}

}  // namespace

const RecordingFormat kAria{
    .name = "Project Aria",
    .is = isAria,
    .read = readAria,
    .companions =
        [](const std::filesystem::path& file) { return std::vector{*trajectoryBeside(file)}; },
    .preview = [](const std::filesystem::path&) { return SpacePreview{.has_head = true}; }};

}  // namespace foci
