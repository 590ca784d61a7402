#include "app/replay/alignment_drawing.h"

#include <algorithm>

#include "app/graphics/html.h"
#include "app/replay/scene_plan.h"
#include "app/replay/scene_view.h"
#include "app/study/recorded_head.h"
#include "base/text.h"

namespace foci {
namespace {

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

}  // namespace

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

}  // namespace foci
