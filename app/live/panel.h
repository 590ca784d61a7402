// The panel (F1), the help (?) and the line of signs of `foci live`, in Dear ImGui.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>

#include "app/live/options.h"
#include "app/live/pose.h"
#include "app/live/renderer.h"

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

/// What the observer does, by panel or key.
struct LiveControls {
  std::function<void(const std::string& key, const std::string& toml)> change;
  std::function<void()> toggle_record, screenshot, mark;
};

struct PanelContent {
  const LiveState& state;
  const LiveFrame* frame;  ///< shown last; or none
  std::string source;      ///< its status
  const FrameGraph& graph;
  const LiveSummary& summary;
};

/// @param open  the observer may close it
void drawPanel(const PanelContent& content, const LiveControls& controls, bool& open);

void drawHelp(bool& open);

/// What is wrong with the gaze or the record and `notice`, at the upper edge; the most important
/// keys below where it is the `first` time.
void drawSigns(const PanelContent& content, const std::string& notice, bool first);

}  // namespace foci
