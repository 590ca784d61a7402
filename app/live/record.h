// The record of a live run: a folder that `foci replay` renders again.
//
// During the run:
//   study.toml         the study in force; its gaze is gaze.tsv
//   gaze.tsv           every sample, in order of arrival, on the clock of the run
//   frames.tsv         as of a replay (app/record/tables.h): a row for each frame shown
//   changes.tsv        keys that changed, each with the time of the first frame with its new value
//   timing.tsv         when each frame was sampled, rendered and shown
//   event_markers.tsv  event markers, set by a key or by remote control
//   head.tsv           of a headset or a recording with a head: the head in the scene, of each
//                      frame and of each sample
//   playback.tsv       of a recording as the source: where and how fast it plays from when on
// Once it is closed:
//   events.tsv         as of a replay
//   manifest.json      with the hash of all frames, which equals that of the replay, and how soon
//                      after saccades the frames had full quality
//
// The files grow in place. If the program is killed, they hold what was recorded until then.
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "app/graphics/image.h"
#include "app/platform/sha256.h"
#include "app/platform/warnings.h"
#include "app/record/later_image.h"
#include "app/record/live_facts.h"
#include "app/record/record_files.h"
#include "app/record/tables.h"
#include "app/session/session.h"
#include "app/study/session_settings_of.h"
#include "gaze/live/trace_player.h"
#include "render/gl/texture.h"

namespace foci {

class LiveRecord;

/// When things happened, on the run's clock.
struct FrameTiming {
  std::optional<double> sample_s;  ///< the newest sample before the frame
  double state_s = 0.0;            ///< the sample that its state is of
  double render_start_s = 0.0, render_end_s = 0.0;
  std::optional<double> swap_s;  ///< absent: never shown
  int repeats = 0;               ///< earlier refreshes of the screen that showed an older frame
  int sync_level = 0;            ///< of the sync patch, 0 to 3
  bool in_full = false;          ///< at full quality: the frame-time budget took nothing away
  std::optional<double> display_s{};  ///< a headset predicted that it shows the frame then
};

/// The head in a frame of a headset.
struct LiveHead {
  HeadInWorld in_scene{}, in_room{};
  HeadsetEyes displays{};
};

struct LiveFrame {
  FrameRecord record;
  std::shared_ptr<GpuTexture> texture;  ///< shows the frame; null: `plain` does
  LaterImage plain, image;              ///< invalid where only the texture is needed
  std::vector<glm::dvec2> markers_px;   ///< gaze markers, which `image` has and the others lack
  std::vector<glm::dvec2> lines_px{};   ///< of the study's objects: two ends each; not in the image
  std::shared_ptr<RenderedFrame> on_gpu;  ///< what the texture was made of, for the renderer alone
  FrameTiming timing;
  std::optional<LiveHead> head{};         ///< absent: on a screen
  std::weak_ptr<LiveRecord> record_file;  ///< the record it belongs to, if any
};

/// Makes the folder of a record.
/// @throws InputError where it is a file, or holds a record; std::runtime_error
void makeRecordFolder(const std::filesystem::path& folder);

/// All functions are called from any thread and, but for `end`, do not wait for the disk.
class LiveRecord {
 public:
  /// @param folder   is made if missing; must not hold a record yet
  /// @param study    as it begins
  /// @param screen   that the samples are on
  /// @param command  as typed, for the manifest
  /// @throws InputError, std::runtime_error
  LiveRecord(const std::filesystem::path& folder, const Study& study, const Screen& screen,
             double rate_Hz, std::string command, unsigned threads, std::string devices);
  /// Closes it first.
  ~LiveRecord();
  LiveRecord& operator=(LiveRecord&&) = delete;  // nor copied

  void add(const GazeSample& sample);
  void add(const Change& change);
  /// Only if the head moves the eye.
  void add(const HeadRow& row);
  /// The source is a recording.
  void play(const std::string& file, const PlayPoint& point);
  void add(const PlayPoint& point);
  void addMarker(double time_s, const std::string& text);
  /// @param devices  that rendered its frames so far (`Session::devices`)
  void setDevices(const std::string& devices);
  /// @param warning  printed already, for the manifest
  void addWarning(const std::string& warning);
  void setReception(const GazeReception& reception);
  /// In order of rendering.
  void add(std::shared_ptr<const LiveFrame> frame);

  /// Ends the record. What waits is still written.
  void close();
  /// Closes it, and waits until everything is written or has failed.
  /// @return as `failure`
  std::optional<std::string> end();

  /// Frames that wait to be written.
  std::size_t backlog() const;

  /// The error that ended the record, if there was one.
  std::optional<std::string> failure() const;
  /// Everything is written, or has failed.
  bool finished() const;
  const std::filesystem::path& folder() const { return folder_; }

 private:
  void post(std::function<void()> task, std::size_t frames = 0);
  void run();
  void write(const LiveFrame& frame);
  void finish();
  void writeStudy(double fps) const;

  std::filesystem::path folder_;
  Study study_;
  std::string command_;
  unsigned threads_;

  // Used by the thread alone.
  std::string devices_;  // that rendered the frames, as `Session::devices`
  Warnings warnings_;
  GazeTable gaze_;
  FrameTable frames_;
  std::ofstream changes_, timing_, markers_, head_, playback_;
  Sha256 hash_;
  Durations render_, rendered_;        // of all frames; without reused frames
  std::map<int, std::size_t> pupils_;  // frames by hundredths of a millimetre
  Landings landings_;
  GazeReception reception_;
  std::size_t gaze_samples_ = 0, gaze_points_ = 0;  // samples; samples with a gaze point
  std::size_t inferred_ = 0;                        // samples that the tracker did not see
  std::size_t queried_ = 0;                         // samples with the time of a query
  std::size_t frame_count_ = 0, splats_ = 0;
  double first_s_ = 0.0, last_s_ = 0.0, flushed_s_ = 0.0;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
  std::size_t frames_waiting_ = 0;
  bool closed_ = false, finished_ = false;
  std::optional<std::string> failure_;
  std::thread thread_;
};

}  // namespace foci
