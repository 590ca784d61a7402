#include "app/live/panel.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "app/live/objects.h"
#include "app/study/study_words.h"
#include "base/text.h"
#include "render/methods/method.h"

namespace foci {
namespace {

constexpr ImU32 kWarning = IM_COL32(255, 214, 10, 255), kQuiet = IM_COL32(235, 235, 235, 255),
                kVeil = IM_COL32(0, 0, 0, 150), kRecording = IM_COL32(230, 60, 50, 255);

constexpr double kStep_s = 6.0;  // how long the notice of a step of a clock stays

struct HelpLine {
  const char *key, *what;
};

constexpr HelpLine kHelp[] = {
    {"Escape", "leave"},
    {"?", "these keys"},
    {"F1", "the panel"},
    {"1 ... 8", "pupil, mm"},
    {"F", "focus: follow the eye, or keep it fixed"},
    {"+  -", "fixed focus a quarter of a dioptre nearer, farther"},
    {"M", "show the gaze"},
    {"S", "left half sharp"},
    {"V", "view: mono, side by side, top and bottom, anaglyph"},
    {"N", "next method"},
    {"arrows", "move the eye by a step of the scene's size; with page up and down up and down"},
    {"right button", "turn the eye"},
    {"left button", "look at it and click: the map of a calibrated webcam learns"},
    {"Home", "the eye back to where it began; in a headset, where you are and look now"},
    {"R", "record: begin, end"},
    {"space", "an event marker in the record"},
    {"P", "save the image to a file"},
    {"O", "an object of interest, at the mouse; not in a record that runs"},
    {"F2", "save the study to a file, with its objects"},
};

/// Shows text on a dark ground, centred at `x`. @return the y below it
float noticeAt(float x, float y, ImU32 colour, const std::string& text) {
  ImDrawList* draw = ImGui::GetForegroundDrawList();
  const float width = 0.9f * ImGui::GetIO().DisplaySize.x;
  const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, width);
  const ImVec2 corner(x - 0.5f * size.x, y);
  draw->AddRectFilled({corner.x - 10.0f, corner.y - 5.0f},
                      {corner.x + size.x + 10.0f, corner.y + size.y + 5.0f}, kVeil, 6.0f);
  draw->AddText(nullptr, 0.0f, corner, colour, text.c_str(), nullptr, width);
  return y + size.y + 14.0f;
}

void focusControls(const PanelContent& content, const LiveControls& controls) {
  const Study& study = content.state.study;
  const double now_D = content.frame ? content.frame->record.eye.focus_D : 1.0;
  int fixed = study.focus.fixed_D ? 1 : 0;
  if (ImGui::RadioButton("follow", &fixed, 0)) controls.change("focus.fixed_D", "null");
  ImGui::SameLine();
  if (ImGui::RadioButton("fixed", &fixed, 1)) controls.change("focus.fixed_D", tomlNumber(now_D));
  ImGui::SameLine();
  ImGui::Text("focus");
  if (study.focus.fixed_D) {
    auto fixed_D = static_cast<float>(*study.focus.fixed_D);
    if (ImGui::SliderFloat("focus, D", &fixed_D, 0.0f, 6.0f, "%.2f")) {
      controls.change("focus.fixed_D", tomlNumber(std::clamp(fixed_D, 0.0f, 20.0f)));
    }
  }
}

template <class Names>
void combo(const char* label, std::string_view now, const Names& names, const char* key,
           const LiveControls& controls) {
  if (!ImGui::BeginCombo(label, std::string(now).c_str())) return;
  for (const auto& each : names) {
    const std::string name(each);
    if (ImGui::Selectable(name.c_str(), name == now)) controls.change(key, '"' + name + '"');
  }
  ImGui::EndCombo();
}

void check(const char* label, bool now, const char* key, const LiveControls& controls) {
  if (ImGui::Checkbox(label, &now)) controls.change(key, now ? "true" : "false");
}

void slide(const char* label, double now, float low, float high, const char* key,
           const LiveControls& controls) {
  auto value = static_cast<float>(now);
  if (ImGui::SliderFloat(label, &value, low, high, "%.1f")) {
    controls.change(key, tomlNumber(std::clamp(value, low, high)));
  }
}

std::string metresText(double focus_D) {
  if (focus_D < -0.005) return "behind the eye";
  return focus_D < 0.005 ? "infinity" : decimal(1.0 / focus_D, 2) + " m";
}

/// Prescription and chromatic aberration.
void eyeControls(const Study::Observer& observer, const LiveControls& controls) {
  if (!ImGui::CollapsingHeader("The observer's eye")) return;
  check("wears glasses", observer.corrected, "observer.corrected", controls);
  ImGui::SameLine();
  check("chromatic aberration", observer.chromatic, "observer.chromatic", controls);
  const auto quarters = [](float value) { return std::round(4.0f * value) / 4.0f; };
  const auto power = [&](const char* label, double now, float max, const char* key) {
    auto value = static_cast<float>(now);
    if (ImGui::SliderFloat(label, &value, -max, max, "%+.2f")) {
      controls.change(key, tomlNumber(std::clamp(quarters(value), -max, max)));
    }
  };
  power("sphere, D", observer.sphere_D, 8.0f, "observer.sphere_D");
  power("cylinder, D", observer.cylinder_D, 6.0f, "observer.cylinder_D");
  auto axis_deg = static_cast<int>(std::lround(observer.axis_deg));
  if (ImGui::SliderInt("axis, deg", &axis_deg, 0, 180)) {
    controls.change("observer.axis_deg", std::to_string(std::clamp(axis_deg, 0, 180)));
  }
}

/// `cut 0.21, project 0.35, ...`
std::string stageText(const GpuTimes& times) {
  std::string text;
  for (std::size_t stage = 0; stage < kGpuStages.size(); ++stage) {
    if (stage > 0) text += ", ";
    text.append(kGpuStages.at(stage)).append(" ").append(decimal(times.stage_ms.at(stage), 2));
  }
  return text;
}

/// The objects of interest. Each change makes a new list.
void objectControls(std::vector<NamedShape> objects, const LiveControls& controls) {
  if (objects.empty() || !ImGui::CollapsingHeader("Objects", ImGuiTreeNodeFlags_DefaultOpen))
    return;
  std::optional<std::size_t> removed;
  bool changed = false;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    NamedShape& object = objects[i];
    ImGui::PushID(static_cast<int>(i));
    std::array<char, 64> name{};
    object.name.copy(name.data(), name.size() - 1);
    ImGui::InputText("##name", name.data(), name.size());
    if (ImGui::IsItemDeactivatedAfterEdit() && name[0] != '\0') {
      object.name = name.data();
      changed = true;
    }
    ImGui::SameLine();
    if (ImGui::Button(object.size_m ? "box" : "sphere")) {
      changeKind(object);
      changed = true;
    }
    ImGui::SameLine();
    if (ImGui::Button("remove")) removed = i;
    const auto drag = [&](const char* label, double* values, int count, float least) {
      std::array<float, 3> now{};
      std::copy_n(values, count, now.begin());
      const float speed = 0.01f * static_cast<float>(object.radius_m.value_or(0.1));
      if (!ImGui::DragScalarN(label, ImGuiDataType_Float, now.data(), count, speed, &least, nullptr,
                              "%.3f")) {
        return;
      }
      std::transform(now.begin(), now.begin() + count, values,
                     [&](float value) { return std::max(value, least); });
      changed = true;
    };
    drag("centre, m", &object.center_m.x, 3, -1e6f);
    if (object.size_m) drag("edges, m", &object.size_m->x, 3, 1e-3f);
    if (object.radius_m) drag("radius, m", &*object.radius_m, 1, 1e-3f);
    ImGui::PopID();
  }
  if (removed) objects.erase(objects.begin() + static_cast<std::ptrdiff_t>(*removed));
  if (changed || removed) controls.set_objects(std::move(objects));
}

/// What method auto may spend on a frame.
void qualityControls(const QualitySettings& quality, const LiveControls& controls) {
  if (!ImGui::CollapsingHeader("Quality (method auto)")) return;
  slide("tolerance, jnd", quality.tolerance, 0.1f, 10.0f, "quality.tolerance", controls);
  bool budget = quality.frame_ms.has_value();
  if (ImGui::Checkbox("frame-time budget", &budget)) {
    controls.change("quality.frame_ms", budget ? "20" : "null");
  }
  ImGui::SameLine();
  check("foveated", quality.foveated, "quality.foveated", controls);
  if (quality.frame_ms) {
    slide("budget, ms", *quality.frame_ms, 1.0f, 100.0f, "quality.frame_ms", controls);
  }
}

}  // namespace

void FrameGraph::draw() const {
  const ImVec2 size(ImGui::GetContentRegionAvail().x, 60.0f);
  const auto plot = [&](const char* name, const std::array<float, kFrames>& values) {
    const float max = std::max(40.0f, *std::max_element(values.begin(), values.end()));
    char text[80];
    std::snprintf(text, sizeof text, "%s, ms; up to %.0f", name, static_cast<double>(max));
    ImGui::PlotLines("##graph", values.data(), kFrames, next_, text, 0.0f, max, size);
  };
  ImGui::PushID(0);
  plot("gaze to screen", sample_to_swap_);
  ImGui::PopID();
  ImGui::PushID(1);
  plot("rendering", render_);
  ImGui::PopID();
  ImGui::PushID(2);
  plot("waiting for the screen", wait_);
  ImGui::PopID();
}

void drawPanel(const PanelContent& content, const LiveControls& controls, bool& open) {
  const Study& study = content.state.study;
  ImGui::SetNextWindowPos({16.0f, 16.0f}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({430.0f, 0.0f});  // as high as what is open in it
  ImGui::SetNextWindowBgAlpha(0.9f);
  if (ImGui::Begin("foci live", &open, ImGuiWindowFlags_NoSavedSettings)) {
    ImGui::PushItemWidth(220.0f);
    slide("pupil, mm", study.observer.pupil_mm, 1.0f, 8.0f, "observer.pupil_mm", controls);
    focusControls(content, controls);
    combo("method", study.render.method, content.state.methods, "render.method", controls);
    combo("view", studyWord(study.output.view), studyWords<StereoView>(), "output.view", controls);
    if (study.output.view != StereoView::mono) {
      slide("interpupillary distance, mm", study.observer.ipd_mm, 50.0f, 75.0f, "observer.ipd_mm",
            controls);
    }
    check("show the gaze", study.output.marker, "output.marker", controls);
    ImGui::SameLine();
    check("left half sharp", study.output.split, "output.split", controls);
    eyeControls(study.observer, controls);
    qualityControls(study.quality, controls);
    objectControls(study.scene.objects, controls);
    ImGui::PopItemWidth();
    if (ImGui::Button(content.state.record ? "End the record" : "Record")) {
      controls.toggle_record();
    }
    ImGui::SameLine();
    if (ImGui::Button("Event marker")) controls.add_marker();
    if (ImGui::Button("Save image")) controls.screenshot();
    ImGui::SameLine();
    if (ImGui::Button("Save study")) controls.save_study();
    ImGui::Separator();
    ImGui::TextWrapped("%s", content.source.c_str());
    if (const auto& clock = content.state.reception.clock) {
      ImGui::TextWrapped("sender's clock: %s", clockText(*clock).c_str());
    }
    if (const std::size_t dropped = content.state.reception.dropped; dropped > 0) {
      ImGui::TextWrapped("samples dropped: %zu", dropped);
    }
    if (content.frame) {
      const EyeNow& eye = content.frame->record.eye;
      ImGui::Text("%s; focus %.2f D (%s); %s", std::string(nameOf(eye.state)).c_str(), eye.focus_D,
                  metresText(eye.focus_D).c_str(), content.frame->record.method.c_str());
    }
    if (study.eye.position_m) {
      const glm::dvec3 &eye = *study.eye.position_m, &at = *study.eye.look_at_m;
      ImGui::Text("eye at %.3g, %.3g, %.3g m, looks at %.3g, %.3g, %.3g", eye.x, eye.y, eye.z, at.x,
                  at.y, at.z);
    }
    ImGui::Text("%.1f ms gaze to screen (95 %%: %.1f); %llu refreshes repeated",
                content.summary.sample_to_swap.quantile_ms(0.5),
                content.summary.sample_to_swap.quantile_ms(0.95),
                static_cast<unsigned long long>(content.summary.repeated));
    if (content.frame && content.frame->record.stats.gpu) {
      ImGui::TextWrapped("GPU, ms: %s", stageText(*content.frame->record.stats.gpu).c_str());
    }
    content.graph.draw();
  }
  ImGui::End();
}

void drawHelp(bool& open) {
  const ImVec2 area = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5f * area.x, 0.5f * area.y}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowBgAlpha(0.92f);
  if (ImGui::Begin("Keys", &open,
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings)) {
    if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
      for (const HelpLine& line : kHelp) {
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

void drawNotices(const PanelContent& content, const std::string& notice, bool first) {
  const ImVec2 area = ImGui::GetIO().DisplaySize;
  float y = 14.0f;
  const float x = 0.5f * area.x;
  if (!content.frame) {
    noticeAt(x, 0.5f * area.y, kQuiet, "opening the scene");
    return;
  }
  const GazeReception& reception = content.state.reception;
  if (!reception.remark.empty()) {
    y = noticeAt(x, y, kWarning, "G" + reception.remark.substr(1) + ". Focus stays where it was");
  } else if (content.frame->record.eye.state == GazeState::lost) {
    y = noticeAt(x, y, kWarning, "No gaze: focus stays where it was (" + content.source + ")");
  }
  if (reception.clock && !reception.clock->latest_steps.empty()) {
    const ClockStep& step = reception.clock->latest_steps.back();
    if (content.now_s - step.time_s < kStep_s) {
      y = noticeAt(x, y, kWarning,
                   "The clock of the gaze's sender has stepped by " + decimal(step.ahead_s, 3) +
                       " s: foci follows it");
    }
  }
  if (!content.state.in_view) {
    y = noticeAt(x, y, kWarning,
                 "Nothing of the scene is in view. Home: the eye back to its start");
  }
  if (content.state.record) {
    const auto failure = content.state.record->failure();
    if (failure) y = noticeAt(x, y, kWarning, "The record has failed: " + *failure);
    ImGui::GetForegroundDrawList()->AddCircleFilled({area.x - 24.0f, 24.0f}, 9.0f, kRecording);
  }
  if (!notice.empty()) noticeAt(x, y, kQuiet, notice);
  if (first) noticeAt(x, area.y - 40.0f, kQuiet, "F1: panel    ?: keys    Escape: leave");
}

void drawSyncPatch(int side_px, int level) {
  const ImVec2 area = ImGui::GetIO().DisplaySize;
  const auto side = static_cast<float>(side_px);
  const int code = 255 * level / (kSyncLevels - 1);
  ImGui::GetForegroundDrawList()->AddRectFilled({area.x - side, area.y - side}, area,
                                                IM_COL32(code, code, code, 255));
}

void drawObjects(const std::vector<glm::dvec2>& ends_px, const glm::ivec2& image_px) {
  const ImVec2 area = ImGui::GetIO().DisplaySize;
  const glm::vec2 scale = glm::vec2(area.x, area.y) / glm::vec2(image_px);
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  for (std::size_t i = 0; i + 1 < ends_px.size(); i += 2) {
    const glm::vec2 from = scale * glm::vec2(ends_px[i]), to = scale * glm::vec2(ends_px[i + 1]);
    list.AddLine({from.x, from.y}, {to.x, to.y}, kVeil, 3.0f);
    list.AddLine({from.x, from.y}, {to.x, to.y}, kWarning, 1.0f);
  }
}

void drawGazeRings(const std::vector<glm::dvec2>& points_px, bool broken,
                   const glm::ivec2& image_px) {
  const ImVec2 area = ImGui::GetIO().DisplaySize;
  const glm::vec2 scale = glm::vec2(area.x, area.y) / glm::vec2(image_px);
  const float radius = std::max(10.0f, static_cast<float>(image_px.y) / 36.0f) * scale.y;
  const float width = std::max(2.0f, std::floor(static_cast<float>(image_px.y) / 360.0f)) * scale.y;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const int arcs = broken ? 8 : 1;
  constexpr float kTurn_rad = 6.2831853f;
  const float arc_rad = broken ? kTurn_rad / 16.0f : kTurn_rad;
  for (const glm::dvec2& point_px : points_px) {
    const glm::vec2 at = glm::vec2(point_px) * scale;
    for (const auto& [colour, wide] : {std::pair{IM_COL32(0, 0, 0, 255), 2.0f * width + 1.0f},
                                       std::pair{IM_COL32(255, 214, 10, 255), width}}) {
      for (int arc = 0; arc < arcs; ++arc) {
        const float from_rad = kTurn_rad * static_cast<float>(arc) / static_cast<float>(arcs);
        list.PathArcTo({at.x, at.y}, radius, from_rad, from_rad + arc_rad);
        list.PathStroke(colour, 0, wide);
      }
    }
  }
}

}  // namespace foci
