#include "calibration/gaze_map/gaze_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/text.h"
#include "calibration/calibration_file.h"

namespace foci {
namespace {

std::string jsonOf(const std::optional<double>& value) {
  return value ? exactText(*value) : "null";
}

std::string shown(const std::optional<double>& value, const char* format = "%.2f") {
  return value ? printed(format, *value) : "n/a";
}

std::string modelOf(const GazeReport& report) {
  return report.model.empty() ? std::string(nameOf(report.fit.map.model)) : report.model;
}

double lossShare(const GazeMeasures& m) {
  return m.samples > 0 ? static_cast<double>(m.missing) / static_cast<double>(m.samples) : 0.0;
}

std::string measuresJson(const GazeMeasures& m, const std::optional<double>& worst_deg) {
  std::string text = "\"samples\": " + std::to_string(m.samples);
  const auto axis = [&](int i) {
    return jsonOf(m.axes_deg ? std::optional((*m.axes_deg)[i]) : std::nullopt);
  };
  text += ", \"accuracy_deg\": " + jsonOf(m.accuracy_deg);
  text += ", \"error_across_deg\": " + axis(0) + ", \"error_down_deg\": " + axis(1);
  if (worst_deg) text += ", \"accuracy_max_deg\": " + jsonOf(worst_deg);
  text += ", \"precision_rms_s2s_deg\": " + jsonOf(m.rms_s2s_deg);
  text += ", \"precision_sd_deg\": " + jsonOf(m.sd_deg);
  text += ", \"lost\": " + exactText(lossShare(m));
  return text;
}

/// Targets as rings, mean gaze as dots, their distance as a line. The targets' extent fills the
/// image.
std::string svgOf(const GazeReport& report) {
  constexpr double kWidth = 720.0, kHeight = 440.0, kMargin = 60.0;
  const GazeFrame& frame = report.fit.map.frame;
  glm::dvec2 low(1e300), high(-1e300);
  for (const TargetMeasures& t : report.accuracy.targets) {
    const glm::dvec2 p = onPlane(frame, t.target);
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec2 extent = glm::max(high - low, glm::dvec2(1e-6));
  const double scale =
      std::min((kWidth - 2 * kMargin) / extent.x, (kHeight - 2 * kMargin) / extent.y);
  const auto place = [&](const glm::dvec2& point) {
    const glm::dvec2 p = onPlane(frame, point) - 0.5 * (low + high);
    return glm::dvec2(0.5 * kWidth + scale * p.x, 0.5 * kHeight - scale * p.y);
  };
  std::string svg =
      "<svg viewBox=\"0 0 720 440\" role=\"img\" aria-label=\"Mean gaze for each target\">"
      "<title>Mean gaze for each target</title><desc>" +
      std::to_string(report.accuracy.targets.size()) + " targets; mean error " +
      shown(report.accuracy.overall.accuracy_deg) + "°, worst " + shown(report.accuracy.worst_deg) +
      "°. The table lists them.</desc>";
  for (const TargetMeasures& t : report.accuracy.targets) {
    const glm::dvec2 at = place(t.target);
    svg += printed(
        "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"9\" class=\"target\"/>"
        "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"1.5\"/>",
        at.x, at.y, at.x, at.y);
    if (!t.mean) continue;
    const glm::dvec2 seen =
        glm::clamp(place(*t.mean), glm::dvec2(0.0), glm::dvec2(kWidth, kHeight));
    // Near the centre of the plane z = 1 a degree is pi / 180.
    const double ring = scale * glm::radians(t.measures.sd_deg.value_or(0.0));
    svg += printed(
        "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>"
        "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" class=\"spread\"/>",
        at.x, at.y, seen.x, seen.y, seen.x, seen.y, ring);
    svg += printed(
        "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\" class=\"gaze\"/>"
        "<text x=\"%.1f\" y=\"%.1f\">%s°</text>",
        seen.x, seen.y, at.x + 12, at.y - 10, shown(t.measures.accuracy_deg).c_str());
  }
  return svg + "</svg>";
}

std::string targetText(const glm::dvec2& p) {
  return significant(p.x, 3) + ", " + significant(p.y, 3);
}

std::string slippedText(const GazeReport& report) {
  return listed(report.fit.refused, ", ",
                [](const glm::dvec2& p) { return "(" + targetText(p) + ")"; });
}

/// Sums from which the measures of one target or of all targets follow.
struct Sums {
  std::size_t rows = 0, missing = 0, pairs = 0, within = 0;
  glm::dvec2 axes{0.0};
  double angle = 0.0, step2 = 0.0, spread2 = 0.0, uncertainty = 0.0;

  void add(const Sums& other) {
    rows += other.rows;
    missing += other.missing;
    pairs += other.pairs;
    within += other.within;
    axes += other.axes;
    angle += other.angle;
    step2 += other.step2;
    spread2 += other.spread2;
    uncertainty += other.uncertainty;
  }

  GazeMeasures measures(bool mapped) const {
    GazeMeasures m{.samples = rows, .missing = missing};
    const std::size_t count = rows - missing;
    const auto valid = static_cast<double>(count);
    if (count > 0) {
      m.accuracy_deg = angle / valid;
      m.axes_deg = axes / valid;
    }
    if (count > 0 && mapped) {
      m.uncertainty_deg = uncertainty / valid;
      m.within = static_cast<double>(within) / valid;
    }
    if (pairs > 0) {
      m.rms_s2s_deg = std::sqrt(step2 / static_cast<double>(pairs));
      m.sd_deg = std::sqrt(spread2 / valid);
    }
    return m;
  }
};

}  // namespace

std::string gazeReportJson(const GazeReport& report) {
  const GazeAccuracy& accuracy = report.accuracy;
  std::string json = "{\"model\": " + quotedText(modelOf(report)) + ", ";
  json += measuresJson(accuracy.overall, accuracy.worst_deg);
  if (!accuracy.worst_deg) json += ", \"accuracy_max_deg\": null";
  json += ", \"grade\": " + quotedText(std::string(nameOf(gradeOf(accuracy))));
  json += ", \"validated\": " + std::string(report.validated ? "true" : "false");
  json += ", \"uncertainty_deg\": " + jsonOf(accuracy.overall.uncertainty_deg);
  json += ", \"within_uncertainty\": " + jsonOf(accuracy.overall.within);
  const auto targetJson = [](const TargetMeasures& t) {
    return "{\"target\": " + exactText(t.target) + ", " + measuresJson(t.measures, std::nullopt) +
           "}";
  };
  json += ", \"slipped_targets\": [" +
          listed(report.fit.refused, ", ", [](const glm::dvec2& p) { return exactText(p); });
  json += "], \"fit_ms\": " + exactText(report.fit.ms);
  json += ", \"targets\": [" + listed(accuracy.targets, ", ", targetJson);
  return json + "], \"warnings\": [" + listed(report.warnings, ", ", quotedText) + "]}\n";
}

std::string gazeReportText(const GazeReport& report) {
  const GazeMeasures& all = report.accuracy.overall;
  std::string text =
      printed("%s calibration (%s): accuracy %s deg, worst target %s deg\n",
              std::string(nameOf(gradeOf(report.accuracy))).c_str(),
              report.validated ? "validated" : "measured on its own samples",
              shown(all.accuracy_deg).c_str(), shown(report.accuracy.worst_deg).c_str());
  text +=
      printed("model %s, precision %s deg RMS-S2S, %s deg SD, data loss %.1f %% of %zu samples\n",
              modelOf(report).c_str(), shown(all.rms_s2s_deg).c_str(), shown(all.sd_deg).c_str(),
              100.0 * lossShare(all), all.samples);
  if (!report.fit.refused.empty())
    text += "left out, since the gaze there does not fit: " + slippedText(report) + "\n";
  text += "          target  accuracy  RMS-S2S     SD   loss\n";
  for (const TargetMeasures& t : report.accuracy.targets) {
    text += printed("%16s %9s %8s %6s %5.1f%%\n", targetText(t.target).c_str(),
                    shown(t.measures.accuracy_deg).c_str(), shown(t.measures.rms_s2s_deg).c_str(),
                    shown(t.measures.sd_deg).c_str(), 100.0 * lossShare(t.measures));
  }
  return text;
}

std::string gazeReportHtml(const GazeReport& report) {
  const GazeMeasures& all = report.accuracy.overall;
  const std::string grade(nameOf(gradeOf(report.accuracy)));
  std::string html =
      "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Gaze calibration: " +
      grade + ", " + modelOf(report) + ", " + shown(all.accuracy_deg) +
      "°</title>\n"
      "<style>body{font:15px/1.5 system-ui,sans-serif;max-width:760px;margin:2em auto;padding:0 "
      "1em}"
      "table{border-collapse:collapse}td,th{padding:.2em .9em;text-align:right;"
      "border-bottom:1px solid #ddd}svg{width:100%;background:#f6f6f6}svg line{stroke:#b22}"
      "svg text{font-size:13px;fill:#444}.target{fill:none;stroke:#222;stroke-width:2}"
      ".gaze{fill:#b22}.spread{fill:#b22;fill-opacity:.15}.good{color:#175}.fair{color:#960}"
      ".poor{color:#b22}</style>\n";
  html += "<h1>Gaze calibration: <span class=\"" + grade + "\">" + grade + "</span></h1>\n";
  for (const std::string& text : report.warnings) html += "<p><b>" + text + "</b></p>\n";
  html +=
      std::string(report.validated
                      ? "<p>Validated on other targets"
                      : "<p>Measured on the samples of the fit: validate on other targets") +
      ". Mean accuracy " + shown(all.accuracy_deg) + "°, worst target " +
      shown(report.accuracy.worst_deg) + "°; precision " + shown(all.rms_s2s_deg) + "° RMS-S2S, " +
      shown(all.sd_deg) + "° SD; data loss " + shown(100.0 * lossShare(all), "%.1f") + " % of " +
      std::to_string(all.samples) + " samples. Model: " + modelOf(report) +
      (all.uncertainty_deg ? "; its own uncertainty is " + shown(all.uncertainty_deg) + "° (68 %)"
                           : "") +
      ".</p>\n";
  if (!report.fit.refused.empty()) {
    html += "<p>Targets left out, since the gaze there does not fit: " + slippedText(report) +
            ".</p>\n";
  }
  html += svgOf(report);
  html += "<table><tr><th>target (" + std::string(nameOf(report.fit.map.frame.units)) +
          ")<th>accuracy °<th>RMS-S2S °<th>SD °<th>data loss</tr>\n";
  for (const TargetMeasures& t : report.accuracy.targets) {
    html += "<tr><td>" + targetText(t.target) + "<td>" + shown(t.measures.accuracy_deg) + "<td>" +
            shown(t.measures.rms_s2s_deg) + "<td>" + shown(t.measures.sd_deg) + "<td>" +
            shown(100.0 * lossShare(t.measures), "%.1f %%") + "</tr>\n";
  }
  html +=
      "</table><p>Grades: good below 1° on average and 1.5° at the worst target; fair to 1.5° and "
      "2°; else poor.</p></html>\n";
  return html;
}

std::string_view nameOf(Grade grade) {
  constexpr std::array<std::string_view, 3> kGrades{"good", "fair", "poor"};
  return kGrades[static_cast<std::size_t>(grade)];
}

GazeAccuracy measureAccuracy(std::span<const GazePair> pairs, const GazeFrame& frame,
                             const GazeMap* map) {
  struct AtTarget {
    Sums sums;
    glm::dvec2 total{0.0};
    std::vector<glm::dvec2> seen;  // on the plane z = 1
  };
  std::vector<AtTarget> at;
  GazeAccuracy result;
  std::map<std::pair<double, double>, std::size_t> index;
  std::optional<glm::dvec2> previous;
  std::size_t previous_target = 0;
  for (const GazePair& pair : pairs) {
    const auto [found, fresh] = index.try_emplace({pair.target.x, pair.target.y}, at.size());
    if (fresh) {
      at.emplace_back();
      result.targets.push_back({.target = pair.target});
    }
    AtTarget& here = at[found->second];
    ++here.sums.rows;
    if (!pair.gaze) {
      ++here.sums.missing;
      previous.reset();
      continue;
    }
    glm::dvec2 point = *pair.gaze;
    double uncertainty = 0.0;
    if (map) {
      const GazeEstimate estimate = estimateGaze(*map, point);
      point = estimate.point;
      uncertainty = estimate.uncertainty_deg;
    }
    const glm::dvec2 seen = onPlane(frame, point), target = onPlane(frame, pair.target);
    const double error = angle_deg(seen, target);
    here.sums.angle += error;
    here.sums.axes += glm::abs(glm::degrees(glm::atan(seen) - glm::atan(target)));
    here.sums.uncertainty += uncertainty;
    here.sums.within += error <= uncertainty;
    if (previous && previous_target == found->second) {
      const double step = angle_deg(*previous, seen);
      here.sums.step2 += step * step;
      ++here.sums.pairs;
    }
    previous = seen;
    previous_target = found->second;
    here.total += seen;
    here.seen.push_back(seen);
  }

  Sums all;
  for (std::size_t i = 0; i < at.size(); ++i) {
    AtTarget& here = at[i];
    if (!here.seen.empty()) {
      const glm::dvec2 mean = here.total / static_cast<double>(here.seen.size());
      for (const glm::dvec2& seen : here.seen) {
        const double angle = angle_deg(seen, mean);
        here.sums.spread2 += angle * angle;
      }
      result.targets[i].mean = fromPlane(frame, mean);
    }
    const GazeMeasures measures = here.sums.measures(map != nullptr);
    result.targets[i].measures = measures;
    if (measures.accuracy_deg) {
      result.worst_deg = std::max(result.worst_deg.value_or(0.0), *measures.accuracy_deg);
    }
    all.add(here.sums);
  }
  result.overall = all.measures(map != nullptr);
  return result;
}

Grade gradeOf(const GazeAccuracy& accuracy) {
  if (!accuracy.overall.accuracy_deg) return Grade::poor;
  const double mean = *accuracy.overall.accuracy_deg, worst = *accuracy.worst_deg;
  if (mean < 1.0 && worst < 1.5) return Grade::good;
  return mean <= 1.5 && worst <= 2.0 ? Grade::fair : Grade::poor;
}

}  // namespace foci
