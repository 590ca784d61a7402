#include "app/evaluation/stability/page.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "app/evaluation/chart/panel.h"
#include "app/evaluation/chart_html.h"
#include "app/graphics/html.h"
#include "app/graphics/plot.h"
#include "app/record/tables.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr glm::dvec2 kPanel_px{760.0, 400.0};
constexpr double kMargin = 0.15;  // of a step, beside the first and the last value
constexpr double kLeast = 1e-4;   // errors below it are drawn as it
constexpr const char* kColumns[] = {"#2f8f5b", "#d9822b", "#7a8190"};  // of observers

constexpr const char* kStyle = R"(
.strip { display: flex; flex-wrap: wrap; gap: .5rem; margin: .6rem 0 0; }
.strip figure { width: 128px; } .strip img { image-rendering: pixelated; }
.strip figcaption { font-size: .75rem; overflow-wrap: anywhere; }
.strip figure.good figcaption::before { content: "\2713\00a0"; }
h3 { font-size: 1rem; margin: 0 0 .3rem; } .panel p { margin: 0 0 .3rem; }
.holds td, .holds th { padding: .2rem .5rem .2rem 0; font-size: .8rem; }
)";

std::string scoreText(const StabilityScene& scene, double score) {
  return scene.high_is_good ? decimal(score, 1) : decimal(score, 4);
}

std::string fileOf(const StabilityPlan& plan, const StabilityScene& scene, float value,
                   std::size_t by) {
  return scene.observe ? "" : stabilityImage(scene.name, value, plan.methods[by]);
}

std::string colorOf(const StabilityPlan& plan, const StabilityScene& scene, std::size_t by) {
  return scene.observe ? kColumns[by % 3] : familyOf(plan.methods[by].name).color;
}

/// Of one scene, by value, then by method.
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

Plot panelOf(const StabilityPlan& plan, const StabilityScene& scene,
             const std::vector<StabilityPoint>& points, bool titled) {
  const auto names = scoredIn(plan, scene);
  const auto scores = scoresOf(scene, points);
  Plot plot{.title = titled ? scene.name + ": " + scene.what : "",
            .end_labels = true,
            .size_px = kPanel_px};
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
                              : logarithmicAxis(scene.score, heights, kLeast);
  plot.x = {.title = scene.dial,
            .from = -kMargin,
            .to = static_cast<double>(scene.values.size()) - 1.0 + kMargin};
  for (std::size_t i = 0; i < scene.values.size(); ++i) {
    plot.x.ticks.push_back({static_cast<double>(i), dialText(scene.values[i])});
  }
  plot.levels.push_back({scene.good, "wanted"});
  return plot;
}

/// How far the dial can be turned before a method gives way.
std::string holdsText(const StabilityScene& scene, const std::vector<std::vector<double>>& scores,
                      std::size_t by) {
  std::size_t good = 0;
  while (good < scores.size() && scene.isGood(scores[good][by])) ++good;
  if (good == scores.size()) return "<b>all</b>";
  if (good == 0) return "<span class=\"quiet\">none</span>";
  return dialText(scene.values[good - 1]);
}

void writeHolds(std::ostream& out, const StabilityPlan& plan,
                const std::vector<StabilityPoint>& points) {
  out << "<div class=\"scroll\"><table class=\"figures holds\"><tr><th>scene</th><th>dial</th>";
  for (const ChartMethod& method : plan.methods) out << "<th>" << escaped(method.spec()) << "</th>";
  out << "</tr>\n";
  for (const StabilityScene& scene : plan.scenes) {
    if (scene.observe) continue;
    out << "<tr>" << cell("<a href=\"#" + scene.name + "\">" + escaped(scene.name) + "</a>")
        << cell(escaped(scene.dial) + ", " + dialText(scene.values.front()) + " to " +
                dialText(scene.values.back()));
    const auto scores = scoresOf(scene, points);
    for (std::size_t by = 0; by < plan.methods.size(); ++by) {
      out << cell(holdsText(scene, scores, by));
    }
    out << "</tr>\n";
  }
  out << "</table></div>\n";
}

/// The dial's end as each method draws it.
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

void writeStabilityPage(const std::filesystem::path& file, const StabilityPlan& plan,
                        const std::vector<StabilityPoint>& points) {
  std::ofstream out(file, std::ios::binary);
  out << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width\">\n"
         "<title>foci chart --stability</title>\n<style>"
      << kPageStyle << kChartStyle << kStyle
      << "</style></head><body><main>\n<h1>Depth of field: where methods give way</h1>\n"
         "<p class=\"quiet\">foci " FOCI_VERSION
      << (plan.quick ? " &middot; a quick look: three values a dial" : "")
      << "</p>\n<p>Each scene has one dial from harmless to extreme. The dashed line is the score "
         "that is wanted; hollow points miss it. Where the image is known in closed form the "
         "score is against that; scenes of flat sheets are held against rays that meet the sheets "
         "exactly, "
      << 4 * plan.effort.samples
      << " a pixel; others against as many pinhole views of the same splats (<code>accumulate:"
      << plan.effort.samples << "</code>).</p>\n<p class=\"legend\">";
  writeFamilies(out);
  out << "</p>\n<h2>How far each dial can be turned</h2>\n"
         "<p>The last value at which the score is still what is wanted.</p>\n";
  writeHolds(out, plan, points);
  out << "<h2>Score over dial</h2>\n<p class=\"quiet\">Click a point for its image, the "
         "reference and their difference.</p>\n<div class=\"panels\">\n";
  for (const StabilityScene& scene : plan.scenes) {
    out << "<div class=\"panel\" id=\"" << scene.name << "\"><h3>" << scene.name << "</h3><p>"
        << escaped(scene.what) << "</p>\n"
        << svgOf(layOut(panelOf(plan, scene, points, false)));
    if (!scene.observe) writeStrip(out, plan, scene, points);
    out << "</div>\n";
  }
  out << "</div>\n<p class=\"quiet\"><code>stability.csv</code> holds every figure, "
         "<code>images/</code> every image; <code>cells/</code> what a later run need not "
         "measure again, and may be removed.</p>\n";
  writeImageDialog(out);
  out << "</main></body></html>\n";
  out.close();
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

Drawing stabilityOverview(const StabilityPlan& plan, const std::vector<StabilityPoint>& points) {
  constexpr int kAcross = 3;
  const int rows = (static_cast<int>(plan.scenes.size()) + kAcross - 1) / kAcross;
  Drawing all{.size_px = glm::dvec2(kAcross, rows) * kPanel_px};
  for (std::size_t i = 0; i < plan.scenes.size(); ++i) {
    const auto at = static_cast<int>(i);
    all.add(layOut(panelOf(plan, plan.scenes[i], points, true)),
            glm::dvec2(at % kAcross, at / kAcross) * kPanel_px);
  }
  return all;
}

}  // namespace foci
