#include "app/replay/scene_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/graphics/html.h"
#include "app/graphics/image.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr float kWidth_px = 960.0f, kMaxHeight_px = 640.0f;
constexpr float kMargin = 0.2f, kNearMargin = 0.05f;  // about the box, over its longest side
constexpr float kMaxDisc_px = 24.0f;
constexpr float kPale = 0.4f;  // share of white in the image, on which lines are legible
constexpr std::size_t kMaxNumbered = 60;

/// Places of the scene on paper.
struct Paper {
  SceneSide from;
  float px_per_m = 0.0f;
  glm::ivec2 size_px{0};
  glm::vec2 corner_m{0.0f};  ///< top left
  float nearest_m = 0.0f;    ///< what is nearer to the viewer would hide the gaze

  Paper(const SceneView& view, SceneSide side) : from(side) {
    const glm::vec3 extent_m = view.high_m - view.low_m;
    const float longest_m = std::max({extent_m.x, extent_m.y, extent_m.z});
    const glm::vec3 margin_m(kMargin * longest_m), sides_m = extent_m + 2.0f * margin_m;
    px_per_m = std::min(kWidth_px / sides_m.z, kMaxHeight_px / std::max(sides_m.x, sides_m.y));
    const glm::vec3 one = seen(view.low_m - margin_m), other = seen(view.high_m + margin_m);
    corner_m = glm::min(one, other);
    size_px = glm::ivec2(glm::ceil(px_per_m * glm::vec2(glm::abs(one - other))));
    nearest_m = std::max(one.z, other.z) + (kNearMargin - kMargin) * longest_m;
  }

  /// To the right and down on the paper, and towards the viewer.
  glm::vec3 seen(const glm::vec3& p) const {
    return from == SceneSide::above ? glm::vec3(-p.z, p.x, p.y) : glm::vec3(-p.z, -p.y, p.x);
  }
  glm::vec2 at_px(const glm::vec3& p) const { return px_per_m * (glm::vec2(seen(p)) - corner_m); }
};

/// The points as discs, nearer ones over farther ones, on white.
Image imageOn(const Paper& paper, const std::vector<SceneView::Point>& points) {
  const glm::ivec2 size = paper.size_px;
  Image image = filledImage(size, 255);
  std::vector<float> depth_m(image.rgb.size() / 3, -std::numeric_limits<float>::infinity());
  for (const SceneView::Point& point : points) {
    const float near_m = paper.seen(point.at_m).z;
    if (near_m > paper.nearest_m) continue;
    const glm::vec2 at = paper.at_px(point.at_m);
    const float radius = std::clamp(paper.px_per_m * point.radius_m, 0.71f, kMaxDisc_px);
    const glm::ivec2 low = glm::max(glm::ivec2(glm::ceil(at - radius - 0.5f)), 0);
    const glm::ivec2 high = glm::min(glm::ivec2(glm::floor(at + radius - 0.5f)), size - 1);
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) {
        const std::size_t pixel = std::size_t(y) * std::size_t(size.x) + std::size_t(x);
        const glm::vec2 off = glm::vec2(x, y) + 0.5f - at;
        if (near_m <= depth_m[pixel] || glm::dot(off, off) > radius * radius) continue;
        depth_m[pixel] = near_m;
        const glm::vec3 pale = glm::mix(glm::vec3(point.color), glm::vec3(255.0f), kPale);
        for (int c = 0; c < 3; ++c) {
          image.rgb[3 * pixel + std::size_t(c)] = static_cast<std::uint8_t>(pale[c]);
        }
      }
    }
  }
  return image;
}

std::string pair(const glm::vec2& at) {
  return decimal(double{at.x}, 1) + "," + decimal(double{at.y}, 1);
}

/// `name="x"` and `name="y"` of a place.
std::string xy(const char* x, const char* y, const glm::vec2& at) {
  return concat(" ", x, "=\"", decimal(double{at.x}, 1), "\" ", y, "=\"", decimal(double{at.y}, 1),
                "\"");
}

std::string fixationsOn(const Paper& paper, const std::vector<SceneView::Fixation>& fixations) {
  std::string sights, circles;
  for (const SceneView::Fixation& fixation : fixations) {
    const glm::vec2 at = paper.at_px(fixation.point_m);
    const double radius_px = 4.0 + 7.0 * std::sqrt(std::min(fixation.duration_s, 2.0));
    sights += "<line" + xy("x1", "y1", paper.at_px(fixation.eye_m)) + xy("x2", "y2", at) + "/>";
    circles += "<circle" + xy("cx", "cy", at) + " r=\"" + decimal(radius_px, 1) + "\"/>";
    if (fixations.size() > kMaxNumbered) continue;
    circles += concat("<text stroke=\"none\" fill=\"#111\" dy=\"4\"", xy("x", "y", at), ">",
                      fixation.number, "</text>");
  }
  return "<g stroke=\"#8a4a00\" stroke-opacity=\".5\">" + sights +
         "</g><g fill=\"#ffb347\" fill-opacity=\".9\" stroke=\"#5a3000\" font-size=\"11\" "
         "text-anchor=\"middle\">" +
         circles + "</g>";
}

std::string linesOn(const Paper& paper, const std::vector<SightLine>& lines) {
  std::string met, unmet;
  for (const SightLine& line : lines) {
    (line.met ? met : unmet) += "<line" + xy("x1", "y1", paper.at_px(glm::vec3(line.eye_m))) +
                                xy("x2", "y2", paper.at_px(glm::vec3(line.end_m))) + "/>";
  }
  return "<g stroke=\"#8a4a00\" stroke-opacity=\".4\">" + met +
         "</g><g stroke=\"#b00020\" stroke-opacity=\".4\" stroke-dasharray=\"5 4\">" + unmet +
         "</g>";
}

/// The length of a round number of metres.
std::string scaleBar(const Paper& paper) {
  const double widest_m = 0.25 * paper.size_px.x / double{paper.px_per_m};
  const double decade_m = std::pow(10.0, std::floor(std::log10(widest_m)));
  double length_m = decade_m;
  for (const double more : {2.0, 5.0}) {
    if (more * decade_m <= widest_m) length_m = more * decade_m;
  }
  const glm::vec2 left(14.0f, static_cast<float>(paper.size_px.y) - 14.0f);
  const glm::vec2 right = left + glm::vec2(static_cast<float>(length_m) * paper.px_per_m, 0.0f);
  return "<line stroke-width=\"3\" stroke=\"#111\"" + xy("x1", "y1", left) + xy("x2", "y2", right) +
         "/><text font-size=\"14\"" + xy("x", "y", left - glm::vec2(0.0f, 8.0f)) + ">" +
         significant(length_m, 2) + " m</text>";
}

}  // namespace

glm::ivec2 scenePlanSize_px(const SceneView& view, SceneSide from) {
  return Paper(view, from).size_px;
}

std::string scenePlanSvg(const SceneView& view, SceneSide from) {
  const Paper paper(view, from);
  std::string path;
  for (const SceneView::Sight& sight : view.path) path += pair(paper.at_px(sight.eye_m)) + " ";
  const std::string size = concat("\"", paper.size_px.x, "\" height=\"", paper.size_px.y, "\"");
  return concat("<svg class=\"plan\" style=\"width:", paper.size_px.x, "px\" viewBox=\"0 0 ",
                paper.size_px.x, " ", paper.size_px.y, "\" role=\"img\" aria-label=\"",
                from == SceneSide::above ? "plan" : "side view", " of the scene, with ",
                counted(view.fixations.size(), "fixation"), "\"><image width=", size, " href=\"",
                imageUri(jpegOf(imageOn(paper, view.points))), "\"/>", linesOn(paper, view.lines),
                fixationsOn(paper, view.fixations),
                "<polyline fill=\"none\" stroke=\"#1f5fa8\" stroke-width=\"2\" points=\"", path,
                "\"/><circle fill=\"#1f5fa8\" r=\"5\"",
                xy("cx", "cy", paper.at_px(view.path[0].eye_m)), "/>", scaleBar(paper), "</svg>\n");
}

}  // namespace foci
