// The timeline of a recording that plays, at the lower edge of the window.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "app/live/panel.h"
#include "app/live/words.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr ImU32 kGround = IM_COL32(60, 62, 66, 255), kFixation = IM_COL32(92, 152, 214, 255),
                kAbsent = IM_COL32(150, 60, 50, 255), kMarker = IM_COL32(255, 214, 10, 255),
                kHead = IM_COL32(255, 255, 255, 255);

/// Fixations and pursuit in blue, blinks and data loss in red, saccades as the ground.
ImU32 colourOf(GazeState state) {
  if (state == GazeState::fixation || state == GazeState::pursuit) return kFixation;
  return state == GazeState::blink || state == GazeState::lost ? kAbsent : kGround;
}

void drawBar(TracePlayer& player, const Playback& playback) {
  const TracePlayer::State now = player.state();
  const float em = ImGui::GetFontSize();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 size(std::max(ImGui::GetContentRegionAvail().x, em), 1.4f * em);
  const double span_s = std::max(now.last_s - now.first_s, 1e-6);
  const auto xOf = [&](double recording_s) {
    return corner.x + size.x * static_cast<float>((recording_s - now.first_s) / span_s);
  };
  ImGui::InvisibleButton("bar", size);
  const double under_s =
      now.first_s + span_s * static_cast<double>((ImGui::GetMousePos().x - corner.x) / size.x);
  const bool drags = ImGui::IsItemActive() && ImGui::GetIO().MouseDelta.x != 0.0f;
  if (ImGui::IsItemActivated() || drags) player.seek(under_s);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 end(corner.x + size.x, corner.y + size.y);
  list.PushClipRect(corner, end, true);
  list.AddRectFilled(corner, end, kGround);
  float drawn_x = corner.x - 1.0f;  // events that are no wider than a pixel share it
  for (const GazeEvent& event : playback.events) {
    const float to_x = xOf(event.onset_s + event.duration_s);
    if (to_x < drawn_x + 0.5f) continue;
    list.AddRectFilled({xOf(event.onset_s), corner.y}, {to_x, end.y}, colourOf(event.kind));
    drawn_x = to_x;
  }
  std::string tip = decimal(under_s - now.first_s, 2) + " s";
  for (const TraceMarker& marker : playback.markers) {
    const float x = xOf(marker.time_s);
    list.AddLine({x, corner.y}, {x, corner.y + 0.5f * size.y}, kMarker, 2.0f);
    if (std::abs(x - ImGui::GetMousePos().x) < 3.0f) tip += "\n" + marker.text;
  }
  const float x = xOf(now.recording_s);
  list.AddLine({x, corner.y}, {x, end.y}, kHead, 3.0f);
  list.PopClipRect();
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tip.c_str());
}

}  // namespace

float drawTimeline(TracePlayer& player, const Playback& playback) {
  struct Button {
    const char *label, *tip;
    PlayerStep step;
  };
  const TracePlayer::State now = player.state();
  const std::array buttons{
      Button{now.plays ? "Pause" : "Play", "space, K", PlayerStep::toggle},
      Button{"< fixation", "J: the fixation before", PlayerStep::fixation_before},
      Button{"fixation >", "L: the next fixation", PlayerStep::fixation_after},
      Button{"-5 s", "left arrow; comma: a thirtieth of a second", PlayerStep::back},
      Button{"+5 s", "right arrow; period: a thirtieth of a second", PlayerStep::forward},
      Button{"slower", "[: half as fast, down to 1/8", PlayerStep::slower},
      Button{"faster", "]: twice as fast, up to 8", PlayerStep::faster}};
  const ImVec2 area = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.0f, area.y}, ImGuiCond_Always, {0.0f, 1.0f});
  ImGui::SetNextWindowSize({area.x, 0.0f});
  ImGui::SetNextWindowBgAlpha(0.9f);
  float height_px = 0.0f;
  if (ImGui::Begin("timeline", nullptr,
                   ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoSavedSettings |
                       ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing)) {
    const float right_px = area.x - ImGui::GetStyle().WindowPadding.x;
    const auto fits = [&](const char* label) {  // else a new line begins
      const float wide_px = ImGui::CalcTextSize(label).x + 2.0f * ImGui::GetStyle().FramePadding.x;
      ImGui::SameLine();
      if (ImGui::GetCursorPosX() + wide_px > right_px) ImGui::NewLine();
    };
    for (const Button& button : buttons) {
      if (&button != buttons.data()) fits(button.label);
      if (ImGui::Button(button.label)) carryOut(button.step, player, playback.events);
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", button.tip);
    }
    fits("loop      ");
    bool loops = now.loops;
    if (ImGui::Checkbox("loop", &loops)) player.setLoops(loops);
    const std::string where = decimal(now.recording_s - now.first_s, 2) + " of " +
                              decimal(now.last_s - now.first_s, 2) + " s, speed " +
                              significant(now.speed);
    fits(where.c_str());
    ImGui::TextUnformatted(where.c_str());
    drawBar(player, playback);
    height_px = ImGui::GetWindowSize().y;
  }
  ImGui::End();
  return height_px;
}

}  // namespace foci
