// What the window of `foci live` draws over a frame.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "app/live/outside.h"
#include "app/live/panel.h"

namespace foci {
namespace {

constexpr ImU32 kBright = IM_COL32(255, 214, 10, 255), kUnder = IM_COL32(0, 0, 0, 150),
                kPath = IM_COL32(235, 235, 235, 255), kFixated = IM_COL32(92, 152, 214, 255);
constexpr double kHeadSize = 0.08;  // size of the head, of its distance to the outside camera

void drawWhole(ImDrawList& list, const ObserverTrail& trail, const std::vector<glm::dvec3>& path_m,
               const FrameRecord& now, const View& view) {
  const auto line = [&](const glm::dvec3& from_m, const glm::dvec3& to_m, ImU32 colour,
                        float wide_px) {
    const auto seen = lineInView_px(view, from_m, to_m);
    if (!seen) return;
    const auto& [from, to] = *seen;
    list.AddLine({from.x, from.y}, {to.x, to.y}, kUnder, wide_px + 2.0f);
    list.AddLine({from.x, from.y}, {to.x, to.y}, colour, wide_px);
  };
  const auto polyline = [&](const auto& points_m) {
    for (std::size_t i = 1; i < points_m.size(); ++i) {
      line(points_m[i - 1], points_m[i], kPath, 1.5f);
    }
  };
  path_m.empty() ? polyline(trail.path_m()) : polyline(path_m);

  const ObserverTrail::Fixation* before = nullptr;
  for (const ObserverTrail::Fixation& each : trail.fixations()) {
    if (before) line(before->point_m, each.point_m, kFixated, 1.0f);
    before = &each;
  }
  for (const ObserverTrail::Fixation& each : trail.fixations()) {
    const auto at = lineInView_px(view, each.point_m, each.point_m);
    if (!at) continue;
    const float radius_px = 4.0f + 8.0f * static_cast<float>(std::sqrt(each.to_s - each.from_s));
    list.AddCircleFilled({at->first.x, at->first.y}, radius_px + 1.5f, kUnder);
    list.AddCircleFilled({at->first.x, at->first.y}, radius_px, kFixated);
  }
  if (const auto& end_m = trail.looksAt_m()) line(now.eye_m, *end_m, kBright, 2.0f);

  // The head: a pyramid that opens where it faces, as large at any distance.
  const double size_m =
      kHeadSize * glm::distance(now.eye_m, glm::dvec3(glm::inverse(view.eye_from_world)[3]));
  std::array<glm::dvec3, 4> base_m;
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = i == 0 || i == 3 ? -0.6 : 0.6, y = i < 2 ? 0.4 : -0.4;
    base_m.at(i) = now.eye_m + now.world_from_eye * (size_m * glm::dvec3(x, y, -1.0));
  }
  for (std::size_t i = 0; i < 4; ++i) {
    line(now.eye_m, base_m.at(i), kBright, 2.0f);
    line(base_m.at(i), base_m.at((i + 1) % 4), kBright, 2.0f);
  }
}

}  // namespace

void drawObserver(const ObserverTrail& trail, const std::vector<glm::dvec3>& path_m,
                  const FrameRecord& now, const View& view, const Area& inset) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const glm::vec2 low(inset.corner_px.x, inset.size_px.y), size_px(view.size_px);
  for (const auto& [from, to] : {std::pair(glm::vec2(0.0f), glm::vec2(low.x, size_px.y)),
                                 std::pair(low, size_px)}) {  // beside the inset, and below
    list.PushClipRect({from.x, from.y}, {to.x, to.y});
    drawWhole(list, trail, path_m, now, view);
    list.PopClipRect();
  }
}

void drawSyncPatch(int side_px, int level) {
  const ImVec2 area = ImGui::GetIO().DisplaySize;
  const auto side = static_cast<float>(side_px);
  const int code = 255 * level / (kSyncLevels - 1);
  ImGui::GetForegroundDrawList()->AddRectFilled({area.x - side, area.y - side}, area,
                                                IM_COL32(code, code, code, 255));
}

void drawObjects(const std::vector<glm::dvec2>& ends_px, const glm::ivec2& image_px,
                 const Area& area) {
  const glm::vec2 corner(area.corner_px);
  const glm::vec2 scale = glm::vec2(area.size_px) / glm::vec2(image_px);
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  for (std::size_t i = 0; i + 1 < ends_px.size(); i += 2) {
    const glm::vec2 from = corner + scale * glm::vec2(ends_px[i]),
                    to = corner + scale * glm::vec2(ends_px[i + 1]);
    list.AddLine({from.x, from.y}, {to.x, to.y}, kUnder, 3.0f);
    list.AddLine({from.x, from.y}, {to.x, to.y}, kBright, 1.0f);
  }
}

void drawGazeRings(const std::vector<glm::dvec2>& points_px, bool broken,
                   const glm::ivec2& image_px, const Area& area) {
  const glm::vec2 scale = glm::vec2(area.size_px) / glm::vec2(image_px);
  const float radius = std::max(10.0f, static_cast<float>(image_px.y) / 36.0f) * scale.y;
  const float width = std::max(2.0f, std::floor(static_cast<float>(image_px.y) / 360.0f)) * scale.y;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const glm::vec2 low(area.corner_px), high(area.corner_px + area.size_px);
  list.PushClipRect({low.x, low.y}, {high.x, high.y});
  const int arcs = broken ? 8 : 1;
  constexpr float kTurn_rad = 6.2831853f;
  const float arc_rad = broken ? kTurn_rad / 16.0f : kTurn_rad;
  for (const glm::dvec2& point_px : points_px) {
    const glm::vec2 at = low + glm::vec2(point_px) * scale;
    for (const auto& [colour, wide] : {std::pair{IM_COL32(0, 0, 0, 255), 2.0f * width + 1.0f},
                                       std::pair{IM_COL32(255, 214, 10, 255), width}}) {
      for (int arc = 0; arc < arcs; ++arc) {
        const float from_rad = kTurn_rad * static_cast<float>(arc) / static_cast<float>(arcs);
        list.PathArcTo({at.x, at.y}, radius, from_rad, from_rad + arc_rad);
        list.PathStroke(colour, 0, wide);
      }
    }
  }
  list.PopClipRect();
}

}  // namespace foci
