#include "app/live/panel.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "app/live/objects.h"
#include "app/live/words.h"
#include "app/study/study_words.h"
#include "base/text.h"
#include "render/methods/method.h"

namespace foci {
namespace {

constexpr ImU32 kWarning = IM_COL32(255, 214, 10, 255), kQuiet = IM_COL32(235, 235, 235, 255),
                kVeil = IM_COL32(0, 0, 0, 150), kRecording = IM_COL32(230, 60, 50, 255);

constexpr double kStep_s = 6.0;  // how long the notice of a step of a clock stays

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

/// Shows what a key means, with its unit and range, for the item under the mouse.
void tip(const Study& study, std::string_view name) {
  if (!ImGui::IsItemHovered()) return;
  for (const ResolvedKey& key : resolvedKeys(study)) {
    if (key.name != name) continue;
    const std::string text = std::string(key.meaning) +
                             (key.allowed.empty() ? "" : "\nexpected: " + key.allowed) + "\n" +
                             std::string(name);
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(26.0f * ImGui::GetFontSize());
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
  }
}

/// The items of a panel that change keys of a study.
class KeyItems {
 public:
  KeyItems(const Study& study, const LiveControls& controls) : study_(study), controls_(controls) {}

  template <class Names>
  void combo(const char* label, std::string_view now, const Names& names, const char* key) const {
    const bool open = ImGui::BeginCombo(label, std::string(now).c_str());
    if (!open) tip(study_, key);
    if (!open) return;
    for (const auto& each : names) {
      const std::string name(each);
      if (ImGui::Selectable(name.c_str(), name == now)) controls_.change(key, '"' + name + '"');
    }
    ImGui::EndCombo();
  }

  void check(const char* label, bool now, const char* key) const {
    if (ImGui::Checkbox(label, &now)) controls_.change(key, now ? "true" : "false");
    tip(study_, key);
  }

  /// @param step  that values are rounded to
  void slide(const char* label, double now, double low, double high, const char* key,
             double step = 0.1) const {
    auto value = static_cast<float>(now);
    const char* format = step < 0.1 || step == 0.25 ? "%.2f" : step < 1.0 ? "%.1f" : "%.0f";
    if (ImGui::SliderFloat(label, &value, static_cast<float>(low), static_cast<float>(high),
                           format)) {
      const double rounded = step * std::round(static_cast<double>(value) / step);
      controls_.change(key, tomlNumber(std::clamp(rounded, low, high)));
    }
    tip(study_, key);
  }

  const Study& study() const { return study_; }
  const LiveControls& controls() const { return controls_; }

 private:
  const Study& study_;
  const LiveControls& controls_;
};

bool group(const char* name, bool opens = true) {
  return ImGui::CollapsingHeader(name, opens ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

/// Pupil, focus and prescription.
void eyeControls(const KeyItems& items, const PanelContent& content) {
  const Study::Observer& observer = items.study().observer;
  const auto& fixed_D = items.study().focus.fixed_D;
  items.slide("pupil, mm", observer.pupil_mm, 1.0, 8.0, "observer.pupil_mm");
  const double now_D = content.frame ? content.frame->record.eye.focus_D : 1.0;
  int fixed = fixed_D ? 1 : 0;
  const auto& change = items.controls().change;
  if (ImGui::RadioButton("focus follows", &fixed, 0)) change("focus.fixed_D", "null");
  ImGui::SameLine();
  if (ImGui::RadioButton("fixed", &fixed, 1)) change("focus.fixed_D", tomlNumber(now_D));
  if (fixed_D) items.slide("focus, D", *fixed_D, 0.0, 6.0, "focus.fixed_D", 0.01);
  items.check("wears glasses", observer.corrected, "observer.corrected");
  items.slide("sphere, D", observer.sphere_D, -8.0, 8.0, "observer.sphere_D", 0.25);
  items.slide("cylinder, D", observer.cylinder_D, -6.0, 6.0, "observer.cylinder_D", 0.25);
  items.slide("axis, deg", observer.axis_deg, 0.0, 180.0, "observer.axis_deg", 1.0);
  if (observer.corrected && (observer.sphere_D != 0.0 || observer.cylinder_D != 0.0)) {
    ImGui::TextWrapped("The glasses correct this: without them the eye sees its blur.");
  }
  items.check("chromatic aberration", observer.chromatic, "observer.chromatic");
}

void displayControls(const KeyItems& items, const PanelContent& content) {
  const Study& study = items.study();
  items.combo("view", studyWord(study.output.view), studyWords<StereoView>(), "output.view");
  if (study.output.view != StereoView::mono) {
    items.slide("IPD, mm", study.observer.ipd_mm, 50.0, 75.0, "observer.ipd_mm");
  }
  items.check("left half sharp", study.output.split, "output.split");
  bool outside = content.outside;
  if (ImGui::Checkbox("scene from outside", &outside)) items.controls().show_outside();
  if (ImGui::IsItemHovered()) {
    ImGui::SetTooltip("key X: the head, its path, the line of sight and the fixations");
  }
  if (study.eye.position_m && !study.eye.recorded) {
    const glm::dvec3 &eye = *study.eye.position_m, &at = *study.eye.look_at_m;
    ImGui::TextWrapped("eye at %.3g, %.3g, %.3g m, looks at %.3g, %.3g, %.3g", eye.x, eye.y, eye.z,
                       at.x, at.y, at.z);
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

/// The method, what auto may spend on a frame, and what frames take.
void qualityControls(const KeyItems& items, const PanelContent& content) {
  const QualitySettings& quality = items.study().quality;
  items.combo("method", items.study().render.method, content.state.methods, "render.method");
  items.slide("tolerance, JND", quality.tolerance, 0.1, 10.0, "quality.tolerance");
  bool budget = quality.frame_ms.has_value();
  if (ImGui::Checkbox("frame-time budget", &budget)) {
    items.controls().change("quality.frame_ms", budget ? "20" : "null");
  }
  tip(items.study(), "quality.frame_ms");
  ImGui::SameLine();
  items.check("foveated", quality.foveated, "quality.foveated");
  if (quality.frame_ms) {
    items.slide("budget, ms", *quality.frame_ms, 1.0, 100.0, "quality.frame_ms");
  }
  ImGui::TextWrapped("%.1f ms gaze to screen (95 %%: %.1f); %llu refreshes repeated",
                     content.summary.sample_to_swap.quantile_ms(0.5),
                     content.summary.sample_to_swap.quantile_ms(0.95),
                     static_cast<unsigned long long>(content.summary.repeated));
  if (const Durations& display = content.summary.sample_to_display; display.count() > 0) {
    ImGui::TextWrapped("%.1f ms old when the headset shows it (95 %%: %.1f)",
                       display.quantile_ms(0.5), display.quantile_ms(0.95));
  }
  if (content.frame && content.frame->record.stats.gpu) {
    ImGui::TextWrapped("GPU, ms: %s", stageText(*content.frame->record.stats.gpu).c_str());
  }
  content.graph.draw();
}

void recordControls(const PanelContent& content, const LiveControls& controls) {
  const auto button = [](const char* label, const char* key) {
    const bool pressed = ImGui::Button(label);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("key %s", key);
    return pressed;
  };
  if (button(content.state.record ? "End the record" : "Record", "R")) controls.toggle_record();
  ImGui::SameLine();
  if (button("Event marker", "T")) controls.add_marker();
  if (button("Save image", "P")) controls.screenshot();
  ImGui::SameLine();
  if (button("Save study", "F2")) controls.save_study();
}

void gazeControls(const KeyItems& items, const PanelContent& content) {
  items.check("show the gaze", items.study().output.marker, "output.marker");
  ImGui::SameLine();
  bool holds = content.holds_gaze;
  if (ImGui::Checkbox("hold gaze", &holds)) items.controls().hold_gaze();
  if (ImGui::IsItemHovered()) {
    ImGui::SetTooltip("key G: the observer looks where they looked last");
  }
  ImGui::TextWrapped("%s", content.source.c_str());
  if (const auto& clock = content.state.reception.clock) {
    ImGui::TextWrapped("sender's clock: %s", clockText(*clock).c_str());
  }
  if (const std::size_t dropped = content.state.reception.dropped; dropped > 0) {
    ImGui::TextWrapped("samples dropped: %zu", dropped);
  }
  if (content.frame) {
    const EyeNow& eye = content.frame->record.eye;
    ImGui::TextWrapped("%s; focus %.2f D (%s); %s", std::string(nameOf(eye.state)).c_str(),
                       eye.focus_D, metresText(eye.focus_D).c_str(),
                       content.frame->record.method.c_str());
  }
}

}  // namespace

void FrameGraph::draw() const {
  const ImVec2 size(ImGui::GetContentRegionAvail().x, 2.5f * ImGui::GetFontSize());
  const auto plot = [&](const char* name, const std::array<float, kFrames>& values) {
    const float max = std::max(40.0f, *std::ranges::max_element(values));
    ImGui::Text("%s, 0 to %.0f ms", name, static_cast<double>(max));
    ImGui::PushID(name);
    ImGui::PlotLines("##graph", values.data(), kFrames, next_, nullptr, 0.0f, max, size);
    ImGui::PopID();
  };
  plot("gaze to screen", sample_to_swap_);
  plot("rendering", render_);
  plot("waiting for the screen", wait_);
}

void drawPanel(const PanelContent& content, const LiveControls& controls, float lower_px,
               bool& open) {
  constexpr float kWide = 23.0f, kItem = 11.0f;  // of the font's size: whole texts
  const Study& study = content.state.study;
  const ImVec2 area = ImGui::GetIO().DisplaySize;
  const float em = ImGui::GetFontSize(), gap = 0.6f * em;
  const float font = std::min(1.0f, (area.x - 2.0f * gap) / (kWide * em));
  ImGui::SetNextWindowPos({gap, gap}, ImGuiCond_FirstUseEver);
  const float width = font * kWide * em;
  ImGui::SetNextWindowSizeConstraints({width, 0.0f},
                                      {width, std::max(area.y - lower_px - 2.0f * gap, 4.0f * em)});
  ImGui::SetNextWindowBgAlpha(0.92f);
  if (ImGui::Begin("foci live", &open,
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize)) {
    ImGui::SetWindowFontScale(font);
    ImGui::PushItemWidth(font * kItem * em);
    const KeyItems items(study, controls);
    if (group("Eye")) eyeControls(items, content);
    if (group("Display")) displayControls(items, content);
    if (group("Gaze")) gazeControls(items, content);
    if (group("Record")) recordControls(content, controls);
    if (group("Quality", false)) qualityControls(items, content);
    objectControls(study.scene.objects, controls);
    ImGui::PopItemWidth();
  }
  ImGui::End();
}

void drawNotices(const PanelContent& content, const std::string& notice, bool first,
                 float lower_px) {
  const ImVec2 area = ImGui::GetIO().DisplaySize;
  float y = 14.0f;
  const float x = 0.5f * area.x;
  if (!content.frame) {
    noticeAt(x, 0.5f * area.y, kQuiet,
             content.state.opening + ": " + decimal(content.now_s, 0) + " s");
    return;
  }
  const GazeReception& reception = content.state.reception;
  if (!reception.remark.empty()) {
    y = noticeAt(x, y, kWarning, "G" + reception.remark.substr(1) + ". Focus stays where it was");
  } else if (content.frame->record.eye.state == GazeState::lost) {
    y = noticeAt(x, y, kWarning, "No gaze: focus stays where it was (" + content.source + ")");
  } else if (!reception.doubt.empty()) {
    y = noticeAt(x, y, kWarning, "G" + reception.doubt.substr(1));
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
                 "Nothing of the scene is in view. Backspace: the eye back to its start");
  }
  if (content.state.record) {
    const auto failure = content.state.record->failure();
    if (failure) y = noticeAt(x, y, kWarning, "The record has failed: " + *failure);
    ImGui::GetForegroundDrawList()->AddCircleFilled({area.x - 24.0f, 24.0f}, 9.0f, kRecording);
  }
  if (!notice.empty()) noticeAt(x, y, kQuiet, notice);
  if (first)
    noticeAt(x, area.y - lower_px - 2.0f * ImGui::GetFontSize(), kQuiet,
             "F1: panel    ?: keys    Escape: leave");
}

}  // namespace foci
