// The files of a run: video, tables, manifest, report.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/graphics/video_writer.h"
#include "app/platform/output_files.h"
#include "app/platform/sha256.h"
#include "app/platform/warnings.h"
#include "app/record/manifest.h"
#include "app/record/tables.h"
#include "app/replay/fixation_tables.h"
#include "app/replay/replay_inputs.h"
#include "app/replay/replayed_eye.h"
#include "app/replay/report.h"
#include "app/replay/report_charts.h"
#include "app/session/frame_record.h"
#include "app/study/study.h"
#include "render/image/frame.h"

namespace foci {

/// A run, and an image of it.
struct RunResult {
  RunSummary summary;
  SheetImage image;  ///< from the middle of the contact sheet
};

/// What the frames of a run add up to.
class FrameStatistics {
 public:
  void add(const FrameRecord& record);

  void fill(RunSummary& summary);
  void fill(ReportFacts& facts) const;

  /// Whether a recording's head and lines of sight fit the scene: a sentence for each doubt, with
  /// the keys to set. Most fixations meet no surface, or the lines of sight usually meet elsewhere
  /// than on the surface.
  std::vector<std::string> doubts() const;

 private:
  ChartSeries charts_{};
  std::vector<float> render_ms_{}, rendered_ms_{}, pupil_mm_{};
  std::vector<std::uint32_t> splats_{};
  std::size_t frames_without_gaze_ = 0, frames_over_ = 0;
  std::size_t fixated_ = 0, without_surface_ = 0, compared_ = 0, disagree_ = 0, diverge_ = 0;
  double first_over_s_ = 0.0, worst_error_ = 0.0;
};

/// If `finish` is not called, no file stays, and a new folder is removed.
class RunWriter {
 public:
  /// @param study, gaze, scene  outlive it
  /// @param warnings  of the run so far, which outlive it; `finish` adds more and writes all
  RunWriter(const Study& study, const ReplayedGaze& gaze, const Scene& scene,
            const std::filesystem::path& out, const OutputGuard& guard, Warnings& warnings);

  /// @param image  without marker
  void add(std::size_t frame, const SeenFrame& seen, const Image& image);

  /// Adds the maps of a frame.
  /// @param rendered  with its depth
  void addMaps(std::size_t frame, const SeenFrame& seen, const Frame& rendered);

  /// @param bytes  of the map's file
  void addMap(FrameMap map, std::size_t frame, const std::string& bytes);

  /// Writes what sums up the run.
  /// @param run  with command, threads, device and inputs
  /// @param heatmap  PLY of the scene to write
  RunResult finish(ManifestFacts run, const std::optional<std::filesystem::path>& heatmap = {});

  /// The folder's files that a run of the study writes. Of images, the numbers are not known before
  /// the run: these are the images that are there already.
  static std::vector<std::filesystem::path> files(const Study& study,
                                                  const std::filesystem::path& out);

 private:
  const Study& study_;
  const ReplayedGaze& gaze_;
  const Scene& scene_;
  Warnings& warnings_;
  std::filesystem::path out_;
  OutputFolder folder_;
  std::filesystem::path video_file_;
  VideoWriter video_;
  Sha256 hash_;
  FrameTable table_;
  ContactSheet sheet_;
  FrameStatistics statistics_;
  std::vector<EyeInFrame> eyes_{};
};

/// "frame-000012.png"
std::string imageFileName(std::size_t frame);

/// The images of frames, and their maps, that a folder holds.
std::vector<std::filesystem::path> imagesIn(const std::filesystem::path& folder);

/// `FrameMap::defocus` by pixel. @param frame  with depth along the line of sight
std::vector<float> defocusMap_D(const Frame& frame, double focus_D);

/// "depth-000012.exr"
std::string mapFileName(FrameMap map, std::size_t frame);

/// Stages the maps of a frame. @return where they are staged, in the order of `maps`
std::vector<std::filesystem::path> stageMaps(const std::vector<FrameMap>& maps, std::size_t frame,
                                             const Frame& rendered, double focus_D,
                                             OutputFolder& folder);

}  // namespace foci
