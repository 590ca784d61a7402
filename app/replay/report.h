// report.html: a replay on one page that opens from disk.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/record/manifest.h"
#include "app/replay/contact_sheet.h"
#include "app/replay/gaze_in_scene.h"
#include "app/replay/heatmap.h"
#include "app/replay/report_charts.h"
#include "app/replay/run_changes.h"
#include "app/replay/scene_view.h"
#include "app/study/study.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

struct ReportFacts {
  RunSummary summary;
  std::vector<ChartRow> rows;  ///< not empty
  std::vector<SheetImage> sheet;
  /// Of the replayed time.
  std::size_t samples = 0, samples_without_gaze = 0, samples_blink = 0;
  double longest_data_loss_s = 0.0;
  std::vector<RecordingPause> pauses;  ///< of the recording
  std::optional<HeadsetAxes> headset;  ///< absent: the screen does not move
  /// In a blink or during data loss, including pauses of the recording.
  std::size_t frames_without_gaze = 0;
  std::size_t frames_over = 0;  ///< whose predicted error exceeds the tolerance
  double first_over_s = 0.0;    ///< time of the first such frame
  double worst_error = 0.0;     ///< largest predicted error, just-noticeable differences
  double pupil_min_mm = 0.0, pupil_max_mm = 0.0;
  std::string fixations;             ///< the text of fixations.tsv
  std::vector<TraceTrial> trials;    ///< in order of their beginnings
  std::vector<ObjectLooks> objects;  ///< `GazeInScene::objects`
  std::optional<SceneView> scene;    ///< absent: no gaze met the scene
  std::vector<HeatPicture> heat;     ///< none: no heatmap was asked for
  double most_heat_s_per_m2 = 0.0;   ///< `HeatMap::most_s_per_m2`
  RecordingQuality quality{};        ///< of the gaze recording
  unsigned threads = 0;
  std::string device;                 ///< that rendered the frames
  RunChanges run;                     ///< the study in force, and what changed
  std::vector<std::string> warnings;  ///< `Warnings::all` of the run
};

/// What `frames_over` means, in one sentence for the reader; "" if there are none.
std::string toleranceText(const Study& study, const ReportFacts& facts);

/// Says that focus varies too little for blur to change visibly, by kVisibleBlur_px, although the
/// observer looked at several places; "" if it does, and for a focus that the study fixes.
std::string focusText(const Study& study, const ReportFacts& facts);
inline constexpr double kVisibleBlur_px = 0.5;  ///< change of the blur radius

struct MethodsText;

/// @param video  embedded, read block by block; a large one is linked, so that the page stays below
///               15 MB
/// @return why the page has no charts, as it says; empty: it has them
/// @throws std::runtime_error
std::string writeReport(const std::filesystem::path& file, const std::filesystem::path& video,
                        const GazeTrace& trace, const ReportFacts& facts,
                        const MethodsText& methods);

}  // namespace foci
