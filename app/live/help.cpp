// The list of keys of `foci live` (?).
#include <imgui.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "app/live/panel.h"

namespace foci {
namespace {

struct HelpLine {
  const char *key, *what;
};

constexpr HelpLine kKeys[] = {
    {"Escape", "leave"},
    {"?  F1", "these keys; the panel"},
    {"F11", "full screen, or a window"},
    {"1 ... 8", "pupil, mm"},
    {"F", "focus: follow the eye, or keep it fixed"},
    {"+  -", "fixed focus a quarter of a dioptre nearer, farther"},
    {"M  G", "show the gaze; hold it where it is"},
    {"H", "left half sharp"},
    {"C", "foveated rendering"},
    {"X", "the scene from outside: head, path, line of sight, fixations"},
    {"V", "view: mono, side by side, top and bottom, anaglyph"},
    {"N", "next method"},
    {"W A S D", "walk; with shift four times as fast"},
    {"E  Q", "up, down"},
    {"left button", "drag: around the point that the eye faces"},
    {"right, middle", "drag: turn the eye; shift it"},
    {"wheel", "forwards, backwards"},
    {"Z", "undo the last change of the view"},
    {"backspace", "the view back to where it began"},
    {"R  T", "record: begin, end; an event marker"},
    {"P  F2", "save the image; save the study with its objects"},
    {"O", "an object of interest, at the mouse; not in a record that runs"},
    {"a dropped file", "opens the scene, study or recording"},
};
constexpr HelpLine kWithoutPlayer[] = {
    {"arrows, page", "walk; up, down"},
    {"space", "an event marker"},
    {"Home", "as backspace; in a headset, where you are and look now"},
    {"click", "look at it: the map of a calibrated webcam learns"},
};
constexpr HelpLine kOfPlayer[] = {
    {"space  K", "pause, play"},
    {"left  right", "five seconds back, forwards"},
    {",  .", "a thirtieth of a second back, forwards"},
    {"J  L", "the fixation before, the next fixation"},
    {"[  ]", "half, twice the speed"},
    {"Home  End  \\", "to the beginning, to the end; loop"},
};

}  // namespace

void drawHelp(bool plays, bool& open) {
  std::vector<HelpLine> lines(std::begin(kKeys), std::end(kKeys));
  if (plays) {
    lines.insert(lines.end(), std::begin(kOfPlayer), std::end(kOfPlayer));
  } else {
    lines.insert(lines.end(), std::begin(kWithoutPlayer), std::end(kWithoutPlayer));
  }
  float wide_px = 0.0f;
  for (const HelpLine& line : lines) wide_px = std::max(wide_px, ImGui::CalcTextSize(line.what).x);
  // As large as the window holds.
  constexpr float kMargin = 0.97f, kKeys_em = 8.5f, kMore = 2.5f;
  const ImVec2 area = ImGui::GetIO().DisplaySize;
  const float high_px =
      (static_cast<float>(lines.size()) + kMore) * ImGui::GetTextLineHeightWithSpacing();
  const float font = std::min({1.0f, kMargin * area.y / high_px,
                               kMargin * area.x / (wide_px + kKeys_em * ImGui::GetFontSize())});
  ImGui::SetNextWindowPos({0.5f * area.x, 0.5f * area.y}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowBgAlpha(0.94f);
  if (ImGui::Begin("Keys", &open,
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings)) {
    ImGui::SetWindowFontScale(font);
    if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
      for (const HelpLine& line : lines) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(line.key);
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(line.what);
      }
      ImGui::EndTable();
    }
  }
  ImGui::End();
}

}  // namespace foci
