// The panel (F1), the help (?) and the notices of `foci live`, in Dear ImGui.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "app/live/options.h"
#include "app/live/outside.h"
#include "app/live/renderer.h"
#include "app/live/sources.h"
#include "app/window/window.h"
#include "gaze/live/trace_player.h"

namespace foci {

/// The last frames' times, in a ring.
class FrameGraph {
 public:
  static constexpr int kFrames = 180;

  void add(double sample_to_swap_ms, double render_ms, double wait_ms) {
    const auto at = static_cast<std::size_t>(next_);
    sample_to_swap_[at] = static_cast<float>(sample_to_swap_ms);
    render_[at] = static_cast<float>(render_ms);
    wait_[at] = static_cast<float>(wait_ms);
    next_ = (next_ + 1) % kFrames;
  }
  void draw() const;

 private:
  std::array<float, kFrames> sample_to_swap_{}, render_{}, wait_{};
  int next_ = 0;
};

/// What panel and keys can do.
struct LiveControls {
  std::function<void(const std::string& key, const std::string& toml)> change;
  std::function<void(std::vector<NamedShape> objects)> set_objects;
  std::function<void()> toggle_record, screenshot, add_marker, hold_gaze, save_study, show_outside;
};

struct PanelContent {
  const LiveState& state;
  const LiveFrame* frame;  ///< shown last; null before the first
  std::string source;      ///< status of the gaze source
  bool holds_gaze, outside;
  const FrameGraph& graph;
  const LiveSummary& summary;
  double now_s;
};

/// @param lower_px  of the window's lower edge that is in use
/// @param open      false once the observer has closed it
void drawPanel(const PanelContent& content, const LiveControls& controls, float lower_px,
               bool& open);

/// @param plays  the source is a recording: its player has keys
void drawHelp(bool plays, bool& open);

/// Shows problems of gaze and record, and `notice`, at the upper edge.
/// @param first  also shows the most important keys, at the lower edge
void drawNotices(const PanelContent& content, const std::string& notice, bool first,
                 float lower_px);

/// Draws a recording's buttons, and a bar with its fixations, data loss and event markers at the
/// lower edge. A click on the bar seeks.
/// @return its height, px
float drawTimeline(TracePlayer& player, const Playback& playback);

/// Draws gaze markers behind everything, as `drawGazeMarkers` does in an image.
/// @param area  of the window that shows the image
void drawGazeRings(const std::vector<glm::dvec2>& points_px, bool broken,
                   const glm::ivec2& image_px, const Area& area);

/// Draws the observer over the outside view, behind panels.
/// @param path_m  of a recorded head, all of it; empty: the trail's
/// @param view    of the outside image, which fills the window
/// @param inset   in the upper right corner, stays free
void drawObserver(const ObserverTrail& trail, const std::vector<glm::dvec3>& path_m,
                  const FrameRecord& now, const View& view, const Area& inset);

/// Draws the study's objects behind everything.
void drawObjects(const std::vector<glm::dvec2>& ends_px, const glm::ivec2& image_px,
                 const Area& area);

/// Draws the patch for a photodiode in the lower right corner.
/// @param level  0 (black) to 3 (white)
void drawSyncPatch(int side_px, int level);

/// The levels of the patch. With four, a photodiode tells a frame that is missing or shown twice.
inline constexpr int kSyncLevels = 4;

}  // namespace foci
