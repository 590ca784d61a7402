// The frame loop of `foci live`, on a thread of its own. It takes the gaze as late as it can,
// renders a frame, and lays it ready. The window takes the frame when it wants one, and never
// waits.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/live/clock.h"
#include "app/live/gaze_feed.h"
#include "app/live/record.h"
#include "app/live/refiner.h"
#include "app/session/session.h"
#include "render/scene/io/open_scene.h"

namespace foci {

/// The method of a live frame. In a saccade, when the eye sees almost nothing, it is the fastest
/// one, so that the frame after the landing starts early. A method that chooses its quality
/// (`auto`) stays: it reuses frames. Otherwise it is the study's method.
std::string methodOfFrame(const Study& study, const FrameRecord& record);

/// What the window shows besides the frame.
struct LiveState {
  Study study;                                  ///< with the changes so far
  std::string notice{};                         ///< the latest; "" at first
  FrameRecord last{};                           ///< of the newest frame
  std::shared_ptr<LiveRecord> record{};         ///< in progress; null: none
  double scene_m = 0.0;                         ///< longest side of the scene; 0 until it is loaded
  std::vector<std::string_view> methods = {};   ///< that render the scene; none until it is loaded
  bool in_view = true;                          ///< whether a resting eye sees any of the scene
  GazeReception reception = {};                 ///< of the gaze
  std::string opening = "opening the scene";    ///< what is done before the first frame
  std::optional<TracePlayer::State> playing{};  ///< absent: the source is no recording
};

/// Where the head is in the frame at a time of the frames' clock.
/// @param study  which may have moved the observer
using LiveHeadAt = std::function<LiveHead(const Study& study, double time_s)>;

/// What renders the scene beside the frame loop.
struct OutsideScene {
  FrameRenderer renderer;
  RenderRequest request;  ///< for any view of one eye, without blur
  unsigned threads = 1;
  FrameRecord last;  ///< the newest frame's
};

class LiveRenderer {
 public:
  /// @param ready    called from the thread when a frame lies ready, or the thread has failed
  /// @param threads  that render
  /// @param scene    the study's scene file, if it has been read
  /// @param gpu      of the window, which shows textures; null: the window shows images. The thread
  ///                 waits for it once the scene is loaded
  /// `clock` and `feed` must outlive the renderer.
  /// @param head     of the frame at a time, in a headset or of a recording, which moves the eye;
  ///                 none: the study moves it
  LiveRenderer(const Study& study, GazeFeed& feed, const LiveClock& clock, std::string command,
               unsigned threads, std::function<void()> ready, std::optional<SceneFile> scene = {},
               std::future<SharedGpu> gpu = {}, LiveHeadAt head = {});
  ~LiveRenderer();
  LiveRenderer& operator=(LiveRenderer&&) = delete;  // nor copied

  /// Takes the frame that lies ready, if there is one, and makes room for the next.
  /// @param next_s  when the window will want the next one
  /// @throws the exception that ended the thread
  std::shared_ptr<LiveFrame> take(double next_s);

  // Each is carried out before the next frame. The answer is "", or the error.
  std::future<std::string> change(const std::string& key, const std::string& toml);
  std::future<std::string> startRecord(const std::filesystem::path& folder);
  std::future<std::string> stopRecord();
  /// Adds an object of interest on the surface that a point of the screen shows.
  std::future<std::string> placeObject(const glm::dvec2& point_px);
  /// They are the study's from now on. A record in progress keeps its own.
  std::future<std::string> setObjects(std::vector<NamedShape> objects);
  /// Writes the study, with all changes that were asked for before.
  std::future<std::string> saveStudy(const std::filesystem::path& file);
  std::future<OutsideScene> outside();
  /// Sets an event marker. @return its time
  double addMarker(const std::string& text);

  LiveState state() const;
  /// On the clock of samples, frames and markers (`GazeFeed::now_s`).
  double now_s() const { return feed_.now_s(); }

  /// An image of the frame, also where it only lies on the GPU.
  std::future<LaterImage> pixelsOf(std::shared_ptr<const LiveFrame> frame);

  /// Shows a notice.
  void tell(const std::string& notice);

  /// Ends the thread, and waits until all records are written.
  /// @param records  gets the folders of those that are complete
  /// @param failed   gets a line for each that is not: the folder, and why
  void finish(std::vector<std::filesystem::path>& records, std::vector<std::string>& failed);

 private:
  using Command = std::function<void()>;

  std::future<std::string> post(std::function<void()> action);
  void run(const std::stop_token& stop, std::optional<SceneFile>&& scene,
           std::future<SharedGpu>&& gpu);
  void renderFrames(const std::stop_token& stop);
  bool waitForRoom(const std::stop_token& stop);
  double takeGaze();
  void pushGaze();
  bool hasNews() const;
  HeadRow beginPath(double time_s);
  LiveHead followHead(double time_s, double now_s);
  void addPose(double time_s, const HeadInWorld& head);
  GazeReception receptionSince(double start_s) const;
  GazeSample asRecorded(GazeSample sample) const;
  std::shared_ptr<LiveFrame> renderFrame();
  void fill(LiveFrame& frame, RenderedFrame& rendered);
  bool refine(const RenderRequest& request, const FrameRecord& record);
  void publish();
  void sayOpening(const std::string& what);
  void noteView();
  const Scene& outlined() const { return outline_ ? *outline_ : *scene_; }
  void closeRecord();
  void noteDevices();
  void noteEnd(LiveRecord& record);

  Study study_;
  GazeFeed& feed_;
  const LiveClock& clock_;
  std::string command_;
  unsigned threads_;
  std::function<void()> ready_;
  LiveHeadAt head_;

  // Used by the thread alone.
  Warnings warnings_;
  std::optional<Scene> scene_;
  std::optional<Scene> outline_;  // of a large scene, instead of all its surfels
  std::unique_ptr<Session> session_;
  std::unique_ptr<Refiner> refiner_;  // under a frame-time budget
  RenderRequest last_request_;
  FrameRecord last_;
  int paused_frames_ = 0;      // since the player's clock stood still, or the last command
  int alike_ = 0;              // renders of the last request at the same quality level
  std::uint64_t refined_ = 0;  // steps of the refiner at the last frame
  bool shows_textures_ = false;
  // The last frame: `LiveFrame` without gaze markers.
  std::shared_ptr<GpuTexture> texture_;
  std::shared_ptr<RenderedFrame> on_gpu_;
  LaterImage plain_;
  FrameReading reading_;
  std::vector<GazeSample> news_;  // as recorded
  std::optional<double> last_sample_s_;
  double last_frame_s_ = -1.0, session_start_s_ = 0.0;
  double last_pose_s_ = 0.0;              // of the head's path
  std::size_t dropped_before_ = 0;        // the record began
  std::map<std::string, double> cost_s_;  // of the last frame of each method
  std::string device_remark_;             // shown last
  std::string devices_;                   // that the record knows of
  std::string last_method_;
  std::vector<std::shared_ptr<LiveRecord>> closing_;

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Command> commands_;
  std::shared_ptr<LiveFrame> laid_ready_;
  double next_swap_s_ = 0.0;
  std::vector<std::filesystem::path> records_;  // that are complete
  std::vector<std::string> failed_records_;
  LiveState state_;
  std::exception_ptr failure_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace foci
