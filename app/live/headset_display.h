// A headset as the display of `foci live`, and as its source of gaze and of poses of the head.
#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/headset/headset.h"
#include "app/live/clock.h"
#include "app/live/record.h"
#include "app/live/sources.h"
#include "app/study/study.h"

namespace foci {

class LiveRenderer;

/// Where the observer stands: from the headset's room to the scene. The head that was centred last
/// is at the study's eye, upright, and faces what the study looks at.
class HeadInScene {
 public:
  explicit HeadInScene(const Study& study) { stand(study); }

  /// The study's eye has moved.
  void stand(const Study& study);

  /// @param head  in the room
  void centre(const HeadInWorld& head);
  HeadInWorld inScene(const HeadInWorld& head) const;

 private:
  glm::dvec3 eye_m_{0.0};
  glm::dquat scene_from_facing_{1.0, 0.0, 0.0, 0.0};  // of a head that looks along -z, y up
  glm::dvec3 centre_m_{0.0};
  glm::dquat facing_from_room_{1.0, 0.0, 0.0, 0.0};
};

class HeadsetDisplay {
 public:
  /// Opens the headset. `clock` outlives the display.
  /// @param study    as asked: with the place of the eye
  /// @param context  of OpenGL, for the headset alone; shares its objects with the renderer's
  /// @param loader   of OpenXR; empty: the usual one
  /// @param shown    called from a thread when a frame was shown, or the headset has ended
  /// @throws InputError which says what is missing
  HeadsetDisplay(const Study& study, std::unique_ptr<GpuContext> context, const LiveClock& clock,
                 std::function<void()> shown, const std::string& loader = "");
  /// Ends the session.
  ~HeadsetDisplay();
  HeadsetDisplay& operator=(HeadsetDisplay&&) = delete;  // nor copied

  const HeadsetFacts& facts() const { return headset_->facts(); }

  /// The study on this headset: its displays, and images for both of them.
  Study studyHere(Study study) const;

  /// The gaze, at the tracker's own times if the runtime states them. Each sample has the head at
  /// its time.
  /// @param screen  of `studyHere`
  /// @throws InputError where there is none, and the study does not take the head's direction
  NamedSource gaze(const Study& study, const Screen& screen);

  /// The head in the next frame; the last one while it is not tracked.
  /// @param study  whose eye may have moved; null: it has not
  LiveHead headNext(const Study* study = nullptr);

  /// Shows the renderer's frames until `stop`.
  void start(LiveRenderer& renderer);
  void stop();

  /// The frames shown since the last call, in their order.
  std::vector<std::shared_ptr<LiveFrame>> takeShown();

  /// Puts the observer where the study's eye is.
  void recentre();

  /// Why the headset shows nothing any more; empty: it does.
  /// @throws HeadsetLost
  std::string ended() const;

 private:
  friend class HeadsetSource;
  void run(const std::stop_token& stop);
  void show(const HeadsetTick& tick, std::shared_ptr<LiveFrame> frame);
  void followDisplays();
  double onClock_s(double steady_s) const;
  std::optional<HeadsetGaze> gazeInScene() const;

  const LiveClock& clock_;
  std::function<void()> shown_;
  std::unique_ptr<Headset> headset_;
  LiveRenderer* renderer_ = nullptr;
  // Used by the thread alone.
  HeadsetEyes displays_{};
  double looked_s_ = 0.0, last_display_s_ = 0.0;
  int repeats_ = 0;
  bool has_shown_ = false;

  mutable std::mutex mutex_;
  HeadInScene in_scene_;
  std::optional<LiveHead> last_head_;
  std::vector<std::shared_ptr<LiveFrame>> frames_;
  std::string ended_;
  std::exception_ptr failure_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace foci
