// report.html: a replay on one page that opens from disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/graphics/image.h"
#include "app/record/manifest.h"
#include "app/replay/gaze_in_scene.h"
#include "app/replay/heatmap.h"
#include "app/replay/report_charts.h"
#include "app/replay/scene_view.h"
#include "app/session/frame_record.h"
#include "app/study/study.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

// The contact sheet, chosen while frames go by.

struct SheetImage {
  double time_s = 0.0;
  GazeState state = GazeState::lost;
  double focus_D = 0.0;
  std::optional<double> surface_distance_m;
  std::string jpeg;
};

/// Divides the replay into equal stretches and takes a frame of each: the one at which a fixation
/// has lasted longest, so that the focus has settled. A stretch without fixation gives its first
/// frame.
class ContactSheet {
 public:
  explicit ContactSheet(std::size_t frames);

  /// @param points_px  of the gaze, one for each view in the image
  /// @param image      without marker
  void offer(std::size_t frame, const FrameRecord& record, const std::vector<glm::dvec2>& points_px,
             const Image& image);

  /// @param image_px  size of the offered images
  std::vector<SheetImage> images(const glm::ivec2& image_px) const;

 private:
  struct Chosen {
    FrameRecord record;
    Image small;
    std::vector<glm::dvec2> points_px;  // of gaze, in the image at full size
  };
  std::size_t frames_, count_;
  std::size_t fixating_ = 0, best_ = 0;  // frames that a fixation lasts: now, at the chosen frame
  std::size_t chosen_at_ = 0,
              chosen_before_ = 0;  // last chosen frame, and that of the stretch before
  std::vector<Chosen> chosen_;
};

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

// methods.md and references.bib of a run: paragraphs for the methods section of a paper, with
// citations as Pandoc and Quarto take them.

struct MethodsText {
  std::string markdown, bibtex;
};

MethodsText methodsOf(const GazeTrace& trace, const ReportFacts& facts);

/// "0.50 m", "infinity", "behind the eye".
std::string distanceText(double focus_D);

/// How the eye focuses, its pupil and its optics, in sentences: plain text, each after a blank.
std::string eyeSentences(const Study& study);

}  // namespace foci
