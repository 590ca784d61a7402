#include "app/evaluation/chart/motion.h"

#include <algorithm>
#include <iterator>
#include <sstream>
#include <utility>

#include "app/evaluation/chart/chart.h"
#include "app/evaluation/evaluated_methods.h"
#include "app/evaluation/evaluation_page.h"
#include "app/graphics/html.h"
#include "app/graphics/image.h"
#include "app/graphics/plot.h"
#include "app/platform/machine.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr double kMinExcess = 1e-4;  // the logarithmic axis shows smaller ones as this
constexpr const char* kStripStyle = ".panel img { width: 100%; image-rendering: pixelated; }";

std::string motionText(const MotionPoint& point) {
  return point.by() + ": " + decimal(point.light_worst, 4) + " (median " +
         decimal(point.light_median, 4) + "), " + decimal(point.jnd_worst, 2) + " JND (" +
         decimal(point.jnd_median, 2) + "), " + milliseconds(point.ms_median) + " ms";
}

/// @param points  of one scene and path
void writeMotionPanel(std::ostream& out, const std::string& title,
                      const std::vector<MotionPoint>& points) {
  std::vector<double> ms, excess, steadiness;
  for (const MotionPoint& one : points) {
    ms.push_back(one.ms_median);
    excess.push_back(std::max(one.light_worst, kMinExcess));
    steadiness.push_back(-one.light_worst);
  }
  Plot plot{.title = title, .size_px = {620.0, 400.0}};
  plot.x = timeAxis("time per frame, logarithmic", ms);
  plot.y = logarithmicAxis("excess change, worst frame", excess, kMinExcess);
  const std::vector<bool> on = paretoFrontier(ms, steadiness);
  for (std::size_t i = 0; i < points.size(); ++i) {
    plot.series.push_back({.color = familyOf(points[i].method.name).color,
                           .points = {{.x = ms[i],
                                       .y = excess[i],
                                       .label = points[i].by(),
                                       .hollow = !on[i],
                                       .title = motionText(points[i]),
                                       .link = points[i].strip()}}});
  }
  const MotionPoint& first = points.front();
  const std::string strip = escaped(first.strip());
  out << "<div class=\"panel\" data-path=\"" << first.path << "\">\n"
      << svgOf(layOut(plot)) << "<a href=\"" << strip
      << "\" target=\"_blank\"><img loading=\"lazy\" alt=\"\" src=\"" << strip
      << "\"></a><p class=\"quiet\">" << escaped(motionText(first)) << "</p></div>\n";
}

}  // namespace

std::string motionPage(const MotionPlan& plan, const Measured<MotionPoint>& measured) {
  std::vector<std::pair<std::string, std::string>> paths;
  paths.reserve(kMotionPaths.size());
  for (const std::string_view path : kMotionPaths) paths.emplace_back(path, path);
  const Machine machine = describeMachine();
  std::ostringstream out;
  out << pageStart("foci chart --motion", std::string(kEvaluationStyle) + kChartStyle + kStripStyle)
      << "<h1>Depth of field: motion against time</h1>\n<p class=\"quiet\">foci " FOCI_VERSION
         " &middot; images "
      << plan.size_px << " px wide, blur radius up to " << decimal(plan.blur_px, 0) << " px"
      << (plan.quick ? " &middot; a quick look" : "") << "</p>\n"
      << noticesOf(measured.warnings)
      << "<p>The excess change is the change from frame to frame less that of the reference, "
         "<code>accumulate:"
      << plan.views
      << "</code>. 99.9 % of the pixels stay below it, in linear light. Down is steadier, left is "
         "faster. No other method is both steadier and faster than a full point. A name with a "
         "time is <code>auto</code> within this frame-time budget. foci's own methods render "
      << plan.frames << " frames of a path, the others " << plan.other_frames << ", and all "
      << kMotionFrames << " of a saccade. Times: " << escaped(machine.cpu) << ", "
      << threadsText(threadCounts().back()) << ".</p>\n<p class=\"legend\">";
  writeFamilies(out);
  out << "</p>\n<div class=\"dials\">" << dialHtml("path", "what moves", paths, paths[0].first)
      << "</div>\n<p class=\"quiet\">Below a panel: the worst frame of its first method, the next "
         "frame (of stereo: the other eye's), and their excess change times "
      << decimal(kDifferenceGain, 0)
      << ". Click a point for those of its method.</p>\n<div class=\"panels\">\n";
  for (const ChartScene& scene : plan.scenes) {
    for (const std::string_view path : kMotionPaths) {
      std::vector<MotionPoint> members;
      std::ranges::copy_if(measured.rows, std::back_inserter(members), [&](const MotionPoint& one) {
        return one.scene == scene.id && one.path == path;
      });
      writeMotionPanel(out, scene.title, members);
    }
  }
  out << "</div>\n<p class=\"quiet\"><code>motion.csv</code> holds all figures. A later run "
         "continues from <code>cells/</code>, which you may remove.</p>\n<script>"
      << kPanelScript << "</script>\n"
      << kPageEnd;
  return out.str();
}

}  // namespace foci
