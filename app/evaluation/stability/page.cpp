#include <cmath>
#include <sstream>
#include <utility>

#include "app/evaluation/evaluated_methods.h"
#include "app/evaluation/evaluation_page.h"
#include "app/evaluation/stability/measure.h"
#include "app/graphics/html.h"
#include "app/graphics/plot.h"
#include "base/text.h"
#include "base/transformed.h"

namespace foci {
namespace {

constexpr double kStepMargin = 0.15;  // free space beside the first and last value, in steps
constexpr double kMinError = 1e-4;    // the logarithmic axis shows smaller errors as this

/// Colours of the observers.
constexpr const char* kObserverColors[] = {"#2f8f5b", "#d9822b", "#7a8190"};

constexpr const char* kStabilityStyle = R"(
.strip { display: flex; flex-wrap: wrap; gap: .5rem; margin: .6rem 0 0; }
.strip figure { width: 128px; } .strip img { image-rendering: pixelated; }
.strip figcaption { font-size: .75rem; overflow-wrap: anywhere; }
.strip figure.good figcaption::before { content: "\2713\00a0"; }
h3 { font-size: 1rem; margin: 0 0 .3rem; } .panel p { margin: 0 0 .3rem; }
.limits td, .limits th { padding: .2rem .5rem .2rem 0; font-size: .8rem; }
)";

std::string scoreText(const StabilityScene& scene, double score) {
  return scene.high_is_good ? decimal(score, 1) : decimal(score, 4);
}

std::string fileOf(const StabilityPlan& plan, const StabilityScene& scene, float value,
                   std::size_t by) {
  return scene.observe ? "" : stabilityImage(scene.name, value, plan.methods[by]);
}

std::string colorOf(const StabilityPlan& plan, const StabilityScene& scene, std::size_t by) {
  return scene.observe ? kObserverColors[by % 3] : familyOf(plan.methods[by].name).color;
}

/// The scores of one scene, by value, then by method.
std::vector<std::vector<double>> scoresOf(const StabilityScene& scene,
                                          const std::vector<StabilityPoint>& points) {
  std::vector<std::vector<double>> scores;
  for (const float value : scene.values) {
    scores.emplace_back();
    for (const StabilityPoint& one : points) {
      if (one.scene == scene.name && one.value == value) scores.back().push_back(one.score);
    }
  }
  return scores;
}

Plot stabilityPanelOf(const StabilityPlan& plan, const StabilityScene& scene,
                      const std::vector<StabilityPoint>& points, bool titled) {
  const auto names = scoredIn(plan, scene);
  const auto scores = scoresOf(scene, points);
  const std::string name = scene.name + ": " + scene.what;
  Plot plot{
      .title = titled ? name : "", .name = name, .end_labels = true, .size_px = {760.0, 400.0}};
  std::vector<double> heights = {scene.good};
  for (std::size_t by = 0; by < names.size(); ++by) {
    PlotSeries line{
        .name = names[by], .color = colorOf(plan, scene, by), .dashed = scene.observe && by >= 3};
    for (std::size_t i = 0; i < scores.size(); ++i) {
      const double score = scores[i][by];
      heights.push_back(score);
      line.points.push_back(
          {.x = static_cast<double>(i),
           .y = score,
           .hollow = !scene.isGood(score),
           .title = names[by] + ", " + scene.dial + " " + dialText(scene.values[i]) + ": " +
                    scoreText(scene, score) + " (" + scene.score + ")",
           .link = fileOf(plan, scene, scene.values[i], by),
           .data = scene.observe ? "" : stabilityReference(scene.name, scene.values[i])});
    }
    plot.series.push_back(std::move(line));
  }
  plot.y = scene.high_is_good ? linearAxis(scene.score, heights)
                              : logarithmicAxis(scene.score, heights, kMinError);
  plot.x = {.title = scene.dial,
            .from = -kStepMargin,
            .to = static_cast<double>(scene.values.size()) - 1.0 + kStepMargin};
  for (std::size_t i = 0; i < scene.values.size(); ++i) {
    plot.x.ticks.push_back({static_cast<double>(i), dialText(scene.values[i])});
  }
  plot.levels.push_back({scene.good, "good"});
  return plot;
}

/// The last value of the dial before a method fails.
std::string limitText(const StabilityScene& scene, const std::vector<std::vector<double>>& scores,
                      std::size_t by) {
  std::size_t good = 0;
  while (good < scores.size() && scene.isGood(scores[good][by])) ++good;
  if (good == scores.size()) return "<b>all</b>";
  if (good == 0) return "<span class=\"quiet\">none</span>";
  return dialText(scene.values[good - 1]);
}

void writeLimits(std::ostream& out, const StabilityPlan& plan,
                 const std::vector<StabilityPoint>& points) {
  out << "<div class=\"scroll\"><table class=\"figures limits\"><tr><th>scene</th><th>dial</th>";
  for (const EvaluatedMethod& method : plan.methods)
    out << "<th>" << escaped(method.spec()) << "</th>";
  out << "</tr>\n";
  for (const StabilityScene& scene : plan.scenes) {
    if (scene.observe) continue;
    out << "<tr>" << cell("<a href=\"#" + scene.name + "\">" + escaped(scene.name) + "</a>")
        << cell(escaped(scene.dial) + ", " + dialText(scene.values.front()) + " to " +
                dialText(scene.values.back()));
    const auto scores = scoresOf(scene, points);
    for (std::size_t by = 0; by < plan.methods.size(); ++by) {
      out << cell(limitText(scene, scores, by));
    }
    out << "</tr>\n";
  }
  out << "</table></div>\n";
}

/// The images of all methods at the last value of the dial.
void writeStrip(std::ostream& out, const StabilityPlan& plan, const StabilityScene& scene,
                const std::vector<StabilityPoint>& points) {
  const float value = scene.values.back();
  const auto figure = [&](const std::string& file, const std::string& caption, const char* kind) {
    out << "<figure class=\"" << kind << "\"><a href=\"" << escaped(file)
        << "\" target=\"_blank\"><img loading=\"lazy\" alt=\"" << escaped(caption) << "\" src=\""
        << escaped(file) << "\"></a><figcaption>" << escaped(caption) << "</figcaption></figure>";
  };
  out << "<div class=\"strip\">";
  figure(stabilityReference(scene.name, value), "reference, " + dialText(value), "");
  const auto scores = scoresOf(scene, points).back();
  for (std::size_t by = 0; by < plan.methods.size(); ++by) {
    figure(stabilityImage(scene.name, value, plan.methods[by]),
           plan.methods[by].spec() + ": " + scoreText(scene, scores[by]),
           scene.isGood(scores[by]) ? "good" : "");
  }
  out << "</div>\n";
}

}  // namespace

std::string stabilityPage(const StabilityPlan& plan, const std::vector<StabilityPoint>& points,
                          const std::string& notice) {
  std::ostringstream out;
  out << pageStart("foci chart --stability: " + listed(plan.scenes, ", ", &StabilityScene::name) +
                       (plan.quick ? " (quick)" : ""),
                   std::string(kEvaluationStyle) + kChartStyle + kStabilityStyle)
      << "<h1>Depth of field: where methods fail</h1>\n<p class=\"quiet\">foci " FOCI_VERSION
      << (plan.quick ? " &middot; a quick look: three values for each dial" : "") << "</p>\n";
  for (const StabilityScene& scene : plan.scenes) out << noticesOf(scene.warnings);
  if (!notice.empty()) out << noticesOf({notice});
  out << "<p>Each scene has one dial, which runs from harmless to extreme. The dashed line "
         "is "
         "the score that counts as good. Hollow points miss it. A scene with a closed form is "
         "scored against it. A scene of flat sheets is scored against rays that meet the sheets "
         "exactly, "
      << 4 * plan.effort.samples
      << " for each pixel. Other scenes are scored against the mean of as many pinhole views "
         "of the same splats (<code>accumulate:"
      << plan.effort.samples << "</code>).</p>\n<p class=\"legend\">";
  writeFamilies(out);
  out << "</p>\n<h2>How far each dial can be turned</h2>\n"
         "<p>The last value up to which every score is good.</p>\n";
  writeLimits(out, plan, points);
  out << "<h2>Score over dial</h2>\n<p class=\"quiet\">Click a point for its image, the "
         "reference and their difference.</p>\n<div class=\"panels\">\n";
  for (const StabilityScene& scene : plan.scenes) {
    out << "<div class=\"panel\" id=\"" << scene.name << "\"><h3>" << scene.name << "</h3><p>"
        << escaped(scene.what) << "</p>\n"
        << svgOf(layOut(stabilityPanelOf(plan, scene, points, false)));
    if (!scene.observe) writeStrip(out, plan, scene, points);
    out << "</div>\n";
  }
  out << "</div>\n<p class=\"quiet\"><code>stability.csv</code> holds all figures and "
         "<code>images/</code> all images. A later run continues from <code>cells/</code>, which "
         "you may remove.</p>\n";
  writeImageDialog(out);
  out << kPageEnd;
  return out.str();
}

Drawing stabilityOverview(const StabilityPlan& plan, const std::vector<StabilityPoint>& points) {
  return layOut(transformed(plan.scenes,
                            [&](const StabilityScene& scene) {
                              return stabilityPanelOf(plan, scene, points, true);
                            }),
                3);
}

}  // namespace foci
