// The worker of `foci live`: takes the gaze as late as it can, renders, and lays the image ready.
// The window takes it when it wants one, and never waits.
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

namespace foci {

/// The one place where a live frame's method is chosen: the study's, but in a saccade, when the
/// eye sees next to nothing, the one that is soonest ready for its landing. `auto` goes on: its
/// image stays while nothing changes, which takes no time at all.
std::string methodOfFrame(const Study& study, const FrameRecord& record);

/// What the window shows besides the image.
struct LiveState {
  Study study;                         ///< with the changes so far
  std::string notice;                  ///< the last thing to be told; "" at first
  FrameRecord last;                    ///< rendered
  std::shared_ptr<LiveRecord> record;  ///< running; or none
};

class LiveRenderer {
 public:
  /// @param ready    called from the worker when an image has been laid ready, or it has failed
  /// @param threads  that render
  /// `clock` and `feed` outlive it.
  LiveRenderer(const Study& study, GazeFeed& feed, const LiveClock& clock, std::string command,
               unsigned threads, std::function<void()> ready);
  ~LiveRenderer();
  LiveRenderer(const LiveRenderer&) = delete;
  LiveRenderer& operator=(const LiveRenderer&) = delete;

  /// The image that lies ready, if one does: room for the next.
  /// @param next_s  when the window will want that
  /// @throws what made the worker end
  std::shared_ptr<LiveFrame> take(double next_s);

  // Each is done before the next frame; what it answers is "" where it is done, else what is wrong.
  std::future<std::string> change(const std::string& key, const std::string& toml);
  std::future<std::string> startRecord(const std::filesystem::path& folder);
  std::future<std::string> stopRecord();
  /// @return the mark's time
  double mark(const std::string& text);

  LiveState state() const;

  /// Shows a notice.
  void tell(const std::string& notice);

  /// Folders of all records that were begun.
  std::vector<std::filesystem::path> records() const;

 private:
  using Command = std::function<void()>;

  std::future<std::string> post(std::function<void()> action);
  void run(const std::stop_token& stop);
  void renderFrames(const std::stop_token& stop);
  bool waitForRoom(const std::stop_token& stop);
  void takeGaze();
  GazeSample asRecorded(GazeSample sample) const;
  std::shared_ptr<LiveFrame> renderFrame();
  bool refine(const RenderRequest& job, const FrameRecord& record);
  void publish();
  void closeRecord();

  Study study_;
  GazeFeed& feed_;
  const LiveClock& clock_;
  std::string command_;
  unsigned threads_;
  std::function<void()> ready_;

  // Touched by the worker alone.
  std::optional<SurfelCloud> cloud_;
  std::unique_ptr<Session> session_;
  std::unique_ptr<Refiner> refiner_;  // where a time is held
  RenderRequest last_job_;
  FrameRecord last_;
  int alike_ = 0;                       // renders of the last job that were rendered alike
  std::uint64_t refined_ = 0;           // as the refiner counts, at the last of them
  std::shared_ptr<const Image> plain_;  // of the last frame, without a mark
  std::vector<GazeSample> news_;
  std::optional<double> last_sample_s_;
  double last_frame_s_ = 0.0, session_start_s_ = 0.0;
  std::map<std::string, double> cost_s_;  // of the last frame by each method
  std::string last_method_;
  std::vector<std::shared_ptr<LiveRecord>> closing_;

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Command> commands_;
  std::shared_ptr<LiveFrame> laid_ready_;
  double next_swap_s_ = 0.0;
  std::vector<std::filesystem::path> records_;
  LiveState state_;
  std::exception_ptr failure_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace foci
