#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "app/cli/commands.h"
#include "app/graphics/html.h"
#include "app/platform/json_text.h"
#include "app/platform/output_files.h"
#include "app/replay/alignment.h"
#include "app/replay/scene_view.h"
#include "app/study/inputs.h"
#include "app/study/load_scene.h"
#include "app/study/study_request.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

Study alignedStudy(const std::string& recording, const TraceOptions& trace,
                   const AlignmentOptions& options) {
  Study study = trace.study.empty() ? studyOfScene(options.scene) : readStudy(trace.study);
  if (!trace.study.empty() && !options.scene.empty()) {
    overrideKey(study, "scene.file", options.scene, "--scene");
  }
  overrideKey(study, "gaze.source", recording, "the recording");
  study.gaze.columns = descriptionOf(trace).columns;
  if (!study.scene.file) throw InputError(trace.study, "has no scene.file: give --scene FILE");
  return study;
}

/// The vertical: of Gaussians, whose files often do not say, and of a study that turns the
/// recording, as the recording stands.
UpAxis upOfScene(const Study& study, const SceneFacts& facts, const std::string& asked) {
  if (const auto up = upOf(asked)) return *up;
  const bool turned = glm::length(glm::dvec3(study.gaze.alignment.rotation)) > 1e-6;
  if (!turned && facts.kind != SceneKind::gaussians) return upAxisOf(facts, boxOf(facts));
  const glm::dvec3 y = sceneFromRecording(study.gaze.alignment) * glm::dvec3(0.0, 1.0, 0.0);
  int axis = 0;
  for (int i = 1; i < 3; ++i) axis = std::abs(y[i]) > std::abs(y[axis]) ? i : axis;
  return {axis, y[axis] < 0.0, "as the recording stands; if not: --up AXIS"};
}

nlohmann::ordered_json jsonOf(const AlignmentFit& fit) {
  const SceneAlignment& a = fit.alignment;
  return {{"score", fit.score},
          {"meets_surface", fit.met},
          {"scene_rotation", {a.rotation.x, a.rotation.y, a.rotation.z, a.rotation.w}},
          {"scene_scale", a.scale},
          {"scene_offset_m", {a.offset_m.x, a.offset_m.y, a.offset_m.z}}};
}

/// In the order of `AlignmentSearch::Verdict`.
constexpr std::array kVerdicts{"keep", "propose", "ambiguous", "nothing-fits"};

nlohmann::ordered_json jsonOf(const AlignmentSearch& found) {
  nlohmann::ordered_json json = {
      {"verdict", kVerdicts.at(static_cast<std::size_t>(found.verdict()))},
      {"as_it_stands", jsonOf(found.now)},
      {"best", jsonOf(found.best)},
      {"poses_as_good", found.rivals}};
  if (found.sigma_D > 0.0) json["vergence_error_D"] = found.sigma_D;
  if (found.rival) json["second_best"] = jsonOf(*found.rival);
  for (const AlignmentNeighbour& each : found.neighbours) json["drop"][each.step] = each.drop;
  return json;
}

std::string fitText(const AlignmentFit& fit) {
  return "score " + decimal(fit.score, 3) + "; " + decimal(100.0 * fit.met, 0) +
         " % of the gaze meets a surface";
}

void print(const AlignmentSearch& found, const Study& study, const std::string& up,
           const std::string& out) {
  const auto line = [](const char* name, const std::string& text) {
    std::printf("%-15s %s\n", name, visible(text).c_str());
  };
  line("upwards", up);
  line("vergence", found.sigma_D > 0.0
                       ? "counts, with an error of " + decimal(found.sigma_D, 2) + " D"
                       : "the recording has none: any surface at 0.1 to 100 m counts");
  line("as it stands", fitText(found.now));
  line("best pose", fitText(found.best));
  if (found.rival) line("second best", fitText(*found.rival));
  for (const AlignmentNeighbour& each : found.neighbours) {
    line("drop", decimal(each.drop, 3) + " by " + each.step);
  }
  line("verdict", verdictText(found));
  line("drawing", out);
  if (found.verdict() != AlignmentSearch::Verdict::propose) return;
  std::printf("\nFor the study:\n\n[scene]\nscale_m = %s\n\n%s",
              significant(study.scene.scale_m, 6).c_str(),
              alignmentToml(found.best.alignment).c_str());
}

constexpr int kTop_px = 34, kGap_px = 24, kLegend_px = 40;

std::vector<SightLine> linesOf(const std::vector<Sight>& sights, const AlignmentFit& fit) {
  const SceneAlignment& by = fit.alignment;
  const glm::dquat r = sceneFromRecording(by);
  std::vector<SightLine> lines;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const glm::dvec3 eye_m = by.offset_m + by.scale * (r * sights[i].eye_m);
    const double length_m = fit.met_m[i].value_or(by.scale * probableDistance_m(sights[i]));
    lines.push_back(
        {eye_m, eye_m + length_m * (r * sights[i].direction), fit.met_m[i].has_value()});
  }
  return lines;
}

std::string textAt(int x, int y, int size_px, const std::string& words) {
  return concat("<text x=\"", x, "\" y=\"", y, "\" font-size=\"", size_px, "\">", escaped(words),
                "</text>\n");
}

/// An SVG file: for each alignment a caption, and plan and side view of scene, head path and lines
/// of sight. Lines that meet no surface are dashed, and end where the eyes converge.
std::string alignmentSvg(const Scene& scene, const std::vector<Sight>& sights,
                         const std::vector<std::pair<std::string, const AlignmentFit*>>& fits,
                         const glm::dvec3& up) {
  std::string body;
  int width = 0, y = 0;
  for (const auto& [caption, fit] : fits) {
    const SceneView view = sceneViewOf(scene, linesOf(sights, *fit), up);
    body += textAt(kGap_px, y + 24, 18, caption);
    int x = kGap_px, tallest = 0;
    for (const auto& [side, name] :
         {std::pair(SceneSide::above, "plan"), std::pair(SceneSide::right, "from the right")}) {
      const glm::ivec2 size_px = scenePlanSize_px(view, side);
      body += concat("<svg x=\"", x, "\" y=\"", y + kTop_px, "\" width=\"", size_px.x,
                     "\" height=\"", size_px.y, "\">", scenePlanSvg(view, side), "</svg>\n") +
              textAt(x + 8, y + kTop_px + 20, 14, name);
      x += size_px.x + kGap_px;
      tallest = std::max(tallest, size_px.y);
    }
    width = std::max(width, x);
    y += kTop_px + tallest + kGap_px;
  }
  body += textAt(kGap_px, y + 8, 14,
                 "blue: path of the eye, from the dot; brown: lines of sight to surfaces; dashed: "
                 "lines that meet no surface");
  const int height = y + kLegend_px;
  return concat("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"", width, "\" height=\"", height,
                "\" viewBox=\"0 0 ", width, " ", height,
                "\" font-family=\"sans-serif\">\n<rect width=\"100%\" height=\"100%\" "
                "fill=\"#fff\"/>\n",
                body, "</svg>\n");
}

}  // namespace

void addAlignmentOptions(CLI::App& command, AlignmentOptions& options) {
  addOption(command, "--scene", options.scene, "FILE",
            "of a headset's recording: draw it in this scene, and propose offset, scale and "
            "rotation about the vertical");
  addOption(command, "--up", options.up, "AXIS",
            "upward axis of the scene: x, y or z, or -x, -y or -z");
  addOption(command, "--out", options.out, "FILE.svg",
            "the drawing in the scene (SVG); default: alignment.svg");
  addOverwriteFlag(command, options.overwrite);
}

void showAlignment(const std::string& recording, const TraceOptions& trace,
                   const AlignmentOptions& options, bool json) {
  if (!options.out.ends_with(".svg")) {
    throw InputError("--out " + options.out, "expected a name that ends in .svg");
  }
  Study study = alignedStudy(recording, trace, options);
  const OutputGuard guard({options.out}, inputFiles(study), options.overwrite);
  Warnings warnings;
  const GazeTrace gaze = loadGaze(study, warnings);
  if (trace.study.empty() && gaze.scene_scale_m) study.scene.scale_m = *gaze.scene_scale_m;
  study = withRecordedHead(std::move(study), gaze);
  const auto sights = sightsOf(gaze, *gaze.screen, study.observer.ipd_mm / 1000.0);
  if (sights.sights.size() < 2) {
    throw InputError(recording,
                     "--scene: expected a recording of a headset, with poses of the head and gaze");
  }
  SceneFile file = readScene(*study.scene.file);
  const UpAxis axis = upOfScene(study, factsOf(file), options.up);
  glm::dvec3 up(0.0);
  up[axis.axis] = axis.negative ? -1.0 : 1.0;
  const Scene scene = loadScene(study, warnings, std::move(file));
  say("searching all rotations about the vertical, scales and places");
  const AlignmentSearch found = searchAlignment(scene, sights, study.gaze.alignment, up);
  std::vector<std::pair<std::string, const AlignmentFit*>> fits = {
      {"As it stands: " + fitText(found.now), &found.now}};
  if (found.verdict() == AlignmentSearch::Verdict::propose) {
    fits.emplace_back("Proposed: " + fitText(found.best), &found.best);
  }
  writeOutput(options.out, alignmentSvg(scene, sights.sights, fits, up), guard);
  if (json) {
    std::puts(jsonText(jsonOf(found)).c_str());
  } else {
    print(found, study, nameOf(axis) + " (" + axis.why + ")", options.out);
  }
}

}  // namespace foci
