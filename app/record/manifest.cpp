#include "app/record/manifest.h"

#include <nlohmann/json.hpp>

#include "app/platform/json_text.h"
#include "app/platform/machine.h"
#include "app/platform/version.h"
#include "app/study/session_settings_of.h"
#include "base/text.h"

namespace foci {
namespace {

using Json = nlohmann::ordered_json;

Json toJson(const RunSummary& summary) {
  return {{"frames", summary.frames},
          {"duration_s", summary.duration_s},
          {"gaze_valid", summary.gaze_valid},
          {"fixations", summary.fixations},
          {"saccades", summary.saccades},
          {"render_ms_median", summary.render_ms_median},
          {"render_ms_p95", summary.render_ms_p95},
          {"frames_rendered", summary.frames_rendered},
          {"rendered_ms_median", summary.rendered_ms_median},
          {"rendered_ms_p95", summary.rendered_ms_p95},
          {"splats", summary.splats},
          {"pupil_mm", summary.pupil_mm},
          {"out", summary.out.string()}};
}

}  // namespace

nlohmann::ordered_json landingsJson(const Landings& landings) {
  const Durations& to_full = landings.toFull();
  return {{"landings", landings.count()},
          {"landings_full", to_full.count()},
          {"landing_to_full_ms_median", to_full.quantile_ms(0.5)},
          {"landing_to_full_ms_p95", to_full.quantile_ms(0.95)},
          {"frames_full", landings.fullShare()}};
}

void addReception(const GazeReception& reception, Json& json) {
  json["dropped"] = reception.dropped;
  json["unused"] = Json::array();
  for (const UnusedGaze& time : reception.unused) {
    json["unused"].push_back({{"from_s", time.from_s}, {"to_s", time.to_s}, {"why", time.why}});
  }
  json["clock"] = nullptr;
  if (!reception.clock) return;
  const ClockFacts& clock = *reception.clock;
  Json steps = Json::array();
  for (const ClockStep& step : clock.latest_steps) {
    steps.push_back({{"time_s", step.time_s}, {"ahead_s", step.ahead_s}});
  }
  json["clock"] = {{"measured", clock.measured},
                   {"offset_s", clock.offset_s},
                   {"drift_ppm", clock.drift_ppm},
                   {"steps", clock.steps},
                   {"latest_steps", steps}};
}

std::string summaryJson(const RunSummary& summary) { return jsonText(toJson(summary)); }

std::string summaryText(const RunSummary& summary) {
  std::string text = counted(summary.frames, "frame") + ", " + decimal(summary.duration_s, 2) +
                     " s; " + decimal(100.0 * summary.gaze_valid, 0) +
                     " % of the gaze samples valid; " + counted(summary.fixations, "fixation") +
                     ", " + counted(summary.saccades, "saccade") + "\n" +
                     counted(summary.frames_rendered, "frame") + " rendered, " +
                     decimal(summary.rendered_ms_median, 1) +
                     " ms each (median; 95 %: " + decimal(summary.rendered_ms_p95, 1) + " ms), " +
                     std::to_string(summary.splats) + " splats";
  if (summary.frames_rendered < summary.frames) {
    text += "; the other frames reuse the previous one; " + decimal(summary.render_ms_median, 1) +
            " ms over all frames (median; 95 %: " + decimal(summary.render_ms_p95, 1) + " ms)";
  }
  return text + "\nreport: " + visible((summary.out / "report.html").string());
}

GazeFacts factsOf(const GazeTrace& trace, const RunEvents& judged) {
  return {.format = trace.format,
          .simulated = trace.simulated,
          .rate_Hz = trace.rate_Hz,
          .samples = trace.samples.size(),
          .assumed = trace.assumed,
          .quality = judged.quality};
}

std::string manifestJson(const Study& study, const RunSummary& summary,
                         const ManifestFacts& facts) {
  Json configuration = Json::object();
  for (const ResolvedKey& key : resolvedKeys(study)) {
    const std::string section(sectionOf(key.name)), name(leafOf(key.name));
    Json& all = section.empty() ? configuration : configuration[section];
    all[name] = Json::parse(key.json, nullptr, false);
  }
  Json inputs = Json::array();
  for (const InputFile& input : facts.inputs) {
    inputs.push_back({{"path", input.path.string()}, {"sha256", input.sha256}});
  }
  const Machine machine = describeMachine();
  Json manifest = {
      {"program", "foci"},
      {"version", versionText()},
      {"command", facts.command},
      {"study", study.file.string()},
      {"inputs", inputs},
      {"configuration", configuration},
      {"screen_is_default", study.screen.is_default},
      {"ellipses_as_circles", ellipsesAsCircles(study)},
      {"gaze",
       {{"format", facts.gaze.format},
        {"simulated", facts.gaze.simulated},
        {"rate_Hz", facts.gaze.rate_Hz},
        {"samples", facts.gaze.samples},
        {"assumed", facts.gaze.assumed},
        {"detector", nameOf(study.gaze.events.detector)},
        {"detector_version", versionOf(study.gaze.events.detector)},
        {"quality", facts.gaze.quality ? toJson(*facts.gaze.quality) : Json(nullptr)}}},
      {"warnings", facts.warnings},
      {"seed", study.seed},
      {"threads", facts.threads},
      {"device", facts.device},
      {"machine",
       {{"cpu", machine.cpu},
        {"cores", machine.cores},
        {"simd", machine.simd},
        {"system", machine.system}}},
      {"frames_sha256", facts.frames_sha256},
      {"summary", toJson(summary)},
  };
  if (facts.gaze.reception) addReception(*facts.gaze.reception, manifest["gaze"]);
  if (facts.landings) manifest["live"] = landingsJson(*facts.landings);
  return jsonText(manifest, 2) + "\n";
}

nlohmann::ordered_json toJson(const RecordingQuality& quality) {
  nlohmann::ordered_json json = {{"rate_Hz", quality.rate_Hz},
                                 {"jitter_s", quality.jitter_s},
                                 {"lost", quality.lost},
                                 {"longest_gap_s", quality.longest_gap_s},
                                 {"rms_s2s_deg", quality.rms_s2s_deg},
                                 {"sd_deg", quality.sd_deg},
                                 {"unjudged", quality.unjudged},
                                 {"main_sequence", nullptr}};
  if (const auto& fit = quality.main_sequence) {
    json["main_sequence"] = {{"saccades", fit->saccades},
                             {"at_1_deg_deg_s", fit->at_1_deg_deg_s},
                             {"exponent", fit->exponent}};
  }
  return json;
}

std::string qualityText(const RecordingQuality& quality) {
  std::string text = "quality: jitter " + decimal(1e3 * quality.jitter_s, 2) + " ms, lost " +
                     decimal(100.0 * quality.lost, 1) + " %, longest gap " +
                     decimal(quality.longest_gap_s, 3) + " s, unjudged " +
                     decimal(100.0 * quality.unjudged, 1) + " %; noise in fixations: RMS-S2S " +
                     orAbsent(quality.rms_s2s_deg, 3) + " deg, SD " + orAbsent(quality.sd_deg, 3) +
                     " deg; main sequence: ";
  if (const auto& fit = quality.main_sequence) {
    return text + decimal(fit->at_1_deg_deg_s, 0) + " deg/s at 1 deg, exponent " +
           decimal(fit->exponent, 2);
  }
  return text + "n/a";
}

}  // namespace foci
