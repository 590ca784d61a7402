// The window of `foci live`: it shows each frame as soon as it is rendered, and turns keys and the
// mouse into changes of the study. Nothing here takes longer than a buffer swap.
#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/live/headset_display.h"
#include "app/live/options.h"
#include "app/live/outside.h"
#include "app/live/panel.h"
#include "app/live/pose.h"
#include "app/live/record.h"
#include "app/live/renderer.h"
#include "app/live/words.h"
#include "app/platform/remote_socket.h"
#include "app/window/window.h"

namespace foci {

/// Whether a task was started and has its result.
template <class T>
bool isReady(const std::future<T>& task) {
  return task.valid() && task.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

class LiveWindow {
 public:
  /// @throws InputError, std::runtime_error
  LiveWindow(const Study& study, const LiveOptions& options, std::optional<SceneFile>&& scene);
  ~LiveWindow();
  LiveWindow& operator=(LiveWindow&&) = delete;  // nor copied

  LiveSummary run();

 private:
  static constexpr double kNotice_s = 4.0;  // how long notices stay

  void openWindow(const Study& study, const LiveOptions& options);
  void openHeadset(Study& study, const std::function<void()>& wake);
  void takeFrames();
  void requireRecord();
  void draw();
  void showFrame(const Study& study);
  void showOutside();
  void shown(double swap_s);
  void toggleRecord();
  void screenshot();
  void openDropped();
  bool showsTimeline() const;

  // window_input.cpp
  void point();
  Drag dragNow() const;
  LiveSteering* steering();
  glm::dvec2 onScreen_px(const glm::dvec2& at_px) const;
  bool keys();
  void key(int key);
  bool keyOfPlayer(int key);
  void steer(const std::vector<int>& pressed);
  void tellWhatMoves();
  glm::dvec3 walkOf(const std::vector<int>& pressed) const;
  void sendPose();
  void change(const std::string& name, const std::string& toml) { renderer_->change(name, toml); }
  void changeAndSay(const std::string& name, const std::string& toml);
  void toggle(const char* name, bool now) { changeAndSay(name, now ? "false" : "true"); }
  void play(PlayerStep step);
  void placeObject();
  void toggleOutside();
  void holdGaze();
  void restoreView(bool first);

  LiveClock clock_;
  Screen screen_;
  std::optional<LiveSteering> steering_;  // absent: the study or a recording moves the eye
  LiveControls controls_;
  LiveSummary summary_;
  FrameGraph graph_;
  std::atomic<bool> open_ = false;
  std::optional<Window> window_;
  std::optional<Texture> texture_;
  std::shared_ptr<const Image> in_texture_;
  Area area_;  // that shows the frame
  std::optional<Texture> outside_texture_;
  std::shared_ptr<const Image> in_outside_texture_;
  std::optional<HeadsetDisplay> headset_;
  std::optional<GazeFeed> feed_;
  std::optional<LiveRenderer> renderer_;
  std::promise<SharedGpu> gpu_;         // for the renderer, which waits for it; destroyed before it
  std::shared_ptr<LiveFrame> frame_;    // shown last
  std::shared_ptr<LiveRecord> record_;  // of that frame
  std::future<std::string> starting_;   // the record of `--record`
  bool is_new_ = false;                 // not shown yet
  double period_s_ = 1.0 / 60.0, last_swap_s_ = 0.0, image_swap_s_ = 0.0;
  std::string notice_;
  double notice_since_s_ = -kNotice_s;
  bool panel_ = false, help_ = false;
  std::atomic<bool> leaving_ = false;
  glm::dvec2 cursor_px_{0.0}, pressed_px_{0.0};
  bool clicked_ = false, orbits_ = false;         // the left button was down, and has moved
  bool moves_ = false;                            // keys that walk are down
  bool steered_ = false;                          // the renderer does not have the pose yet
  double steered_s_ = 0.0, used_s_ = -kNotice_s;  // the latest look at the keys; use of the player
  std::future<std::string> sent_;                 // the pose
  std::future<void> saving_;
  std::future<OutsideScene> outside_scene_;
  std::unique_ptr<OutsideView> outside_;  // null: the window shows the frames alone
  ObserverTrail trail_;
  std::function<LiveNext(const std::filesystem::path& file, const Study& now)> open_file_;
  std::future<LiveNext> next_;
  std::optional<RemoteSocket> socket_;  // last: its threads call the others
};

}  // namespace foci
