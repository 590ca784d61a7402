#include "app/study/framing.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <vector>

#include "app/study/study.h"
#include "base/quantile.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr double kStraysShare = 0.01;     // on each end of each axis
constexpr double kMostStrays = 0.03;      // the same, if the core then is
constexpr double kDenseCore = 1.0 / 3.0;  // this much shorter
constexpr double kStrayDistance = 0.25;   // of the longest side of the box
constexpr double kFlat = 1.0 / 3.0;
constexpr double kEdgeOn = 0.02;  // of the width that the other side shows

/// Unit vectors of a scene: upwards, and from it towards somebody who sees its front.
struct SceneAxes {
  glm::dvec3 up, front, right;  ///< right as somebody in front sees it
};

SceneAxes axesOf(const UpAxis& up) {
  const double sign = up.negative ? -1.0 : 1.0;
  glm::dvec3 upwards(0.0), front(0.0);
  upwards[up.axis] = sign;
  // glTF: y up, the front towards z. Surveys and CAD: z up, seen from -y.
  if (up.axis == 2) {
    front.y = -sign;
  } else {
    front.z = sign;
  }
  return {upwards, front, glm::cross(upwards, front)};
}

/// Why an axis was chosen that the file does not state, and the option for the other usual one.
std::string guess(const std::string& why, int axis) {
  return why + "; if not: --up " + (axis == 2 ? "y" : "z");
}

/// The side that shows a scene of this size: the front, if that is not its edge.
Look lookAt(const SceneAxes& axes, const glm::dvec3& size) {
  const double across_front = std::abs(glm::dot(axes.right, size));
  const double across_left = std::abs(glm::dot(axes.front, size));
  return across_front < kEdgeOn * across_left ? Look::left : Look::front;
}

/// `x` with `digits` significant digits of `of`, so that a study is easy to read.
double rounded(double x, double of, int digits) {
  const double power = std::floor(std::log10(of)) - (digits - 1);
  const double step = std::pow(10.0, std::abs(power));
  return power < 0.0 ? std::round(x * step) / step : std::round(x / step) * step;
}

glm::dvec3 rounded(const glm::dvec3& p, double of, int digits) {
  return {rounded(p.x, of, digits), rounded(p.y, of, digits), rounded(p.z, of, digits)};
}

bool isIn(const SceneBox& box, const glm::dvec3& p) {
  return glm::all(glm::greaterThanEqual(p, box.low)) && glm::all(glm::lessThanEqual(p, box.high));
}

glm::dvec3 reachOf(std::span<const glm::vec3> reach, std::size_t i) {
  return reach.empty() ? glm::dvec3(0.0) : glm::dvec3(reach[i]);
}

/// Distance from the middle of the box, units of the file. A point at (x, y, z) in the eye's axes
/// from the middle, z towards the eye, has the tangents x / (d - z) and y / (d - z).
/// A Gaussian reaches farther along a direction, as if its axes were those of the file.
/// @param tangent  of the half angles that the points fill
double distanceOf(const SceneFacts& facts, const SceneBox& box, const glm::dmat3& eye_from_scene,
                  const glm::dvec2& tangent) {
  std::array<glm::dvec3, 4> planes;  // those through the borders of the view, in the file's axes
  for (int k = 0; k < 4; ++k) {
    glm::dvec3 along(0.0, 0.0, 1.0);
    along[k / 2] = (k % 2 == 0 ? -1.0 : 1.0) / tangent[k / 2];
    planes[static_cast<std::size_t>(k)] = glm::transpose(eye_from_scene) * along;
  }
  double distance = 0.0;
  for (std::size_t i = 0; i < facts.position.size(); ++i) {
    const glm::dvec3 p = glm::dvec3(facts.position[i]);
    if (!isIn(box, p)) continue;
    glm::dvec3 reach = reachOf(facts.reach, i);
    if (!isIn(box, p - reach) || !isIn(box, p + reach)) reach = glm::dvec3(0.0);
    for (const glm::dvec3& along : planes) {
      double needed = glm::dot(along, p - box.middle());
      if (!facts.reach.empty()) needed += glm::length(reach * along);
      distance = std::max(distance, needed);
    }
  }
  const double one_point = 1.0;  // a scene of a single point has no size
  return distance > 0.0 ? distance : one_point;
}

/// How far the points in the box reach towards the eye (y) and away from it (x), from its middle.
glm::dvec2 depthsOf(const SceneFacts& facts, const SceneBox& box, const glm::dvec3& to_eye) {
  glm::dvec2 depths(0.0);
  for (const glm::vec3& p : facts.position) {
    if (!isIn(box, glm::dvec3(p))) continue;
    const double z = glm::dot(glm::dvec3(p) - box.middle(), to_eye);
    depths = {std::max(depths.x, -z), std::max(depths.y, z)};
  }
  return depths;
}

/// Brings the eye nearer, so that blur shows. See kWholeShare.
/// @param distance  of the whole scene at kFilledShare
double nearerDistance(const SceneFacts& facts, const glm::dmat3& eye_from_scene,
                      const glm::dvec3& to_eye, const Screen& screen, double distance,
                      Framing& framing) {
  const auto filling = [&](const glm::dvec2& tangent) {
    return framing.scale_m * distanceOf(facts, framing.box, eye_from_scene, tangent);
  };
  const double wide_m = filling(glm::dvec2(std::tan(glm::radians(0.5 * kVisibleAngle_deg))));
  const double whole_m = filling(kWholeShare * 0.5 * screen.size_m / screen.distance_m);
  const glm::dvec2 depths_m = framing.scale_m * depthsOf(facts, framing.box, to_eye);
  // 1 / (d - near) - 1 / (d + far) = kVisibleDepth_D
  const double far_m = depths_m.x, near_m = depths_m.y, sum_m = far_m + near_m;
  const double deep_m = 0.5 * (near_m - far_m + std::sqrt(sum_m * (sum_m + 4.0 / kVisibleDepth_D)));
  const double fitting_m = framing.scale_m * distance;
  const double least_m = std::max({wide_m, whole_m, kNearest_m});
  const double chosen_m = std::min(fitting_m, std::max(deep_m, least_m));
  const double nearest_m = std::max(chosen_m - near_m, 0.01);
  const double span_D = 1.0 / nearest_m - 1.0 / (chosen_m + far_m);
  framing.why_look += (framing.why_look.empty() ? "" : ", ") + std::string("depth in view spans ") +
                      significant(span_D, 2) + " D";
  if (chosen_m == wide_m) framing.why_look += ", and it fills 40 degrees";
  return chosen_m / framing.scale_m;
}

std::string sizeText(const glm::dvec3& size) {
  const auto text = [](double x) {
    return x > 0.0 ? exactText(rounded(x, x, 3)) : std::string("0");
  };
  return text(size.x) + " x " + text(size.y) + " x " + text(size.z);
}

std::string sourceOfUnit(const SceneFacts& facts) {
  return facts.unit_m ? "as the " + whatStatesUnit(facts) + " states"
                      : "a unit is taken for a metre, since the file states none";
}

void chooseScale(const SceneFacts& facts, double distance, Framing& framing) {
  const double stated = facts.unit_m.value_or(1.0);
  framing.scale_m = stated;
  framing.why_scale = sourceOfUnit(facts);
  const double stated_m = stated * distance;
  if (facts.large || (stated_m >= kNearest_m && stated_m <= kMostDistant_m)) return;
  const double middle_m = std::sqrt(0.5 * 5.0);
  const double power = std::round(std::log10(middle_m / stated_m));
  const double ten = std::pow(10.0, std::abs(power));
  framing.scale_m = std::clamp(power < 0.0 ? stated / ten : stated * ten, kMinScale_m, kMaxScale_m);
  framing.why_scale = "with " + exactText(stated) + " the eye would be " +
                      exactText(rounded(stated_m, stated_m, 2)) + " m away";
}

/// Places the eye in a scan of a room, a street or a landscape. @return whether it is one
bool enterScan(const SceneFacts& facts, const FramingRequest& request, Framing& framing) {
  // Of captures and of COLMAP's points, nobody knows the unit. Corners of meshes are too few.
  const bool is_scan = facts.points > 0 && facts.kind != SceneKind::gaussians && !facts.y_is_down;
  const bool is_prepared = facts.kind == SceneKind::prepared && !facts.samples_of_mesh;
  if (!is_scan && !is_prepared) return false;
  const double unit_m = request.scale_m.value_or(facts.unit_m.value_or(1.0));
  const auto all = static_cast<double>(facts.points + facts.surfels);
  const double share = static_cast<double>(facts.position.size()) / all;
  const auto eye = standIn(facts.position, framing.box, framing.up_axis, unit_m, share);
  if (!eye) return false;
  framing.entered = true;
  framing.scale_m = unit_m;
  framing.why_scale = request.scale_m ? "as --scale says (default: 1)" : sourceOfUnit(facts);
  const double eye_m = std::max(1.0, unit_m * glm::length(eye->position));
  framing.position_m = rounded(unit_m * eye->position, eye_m, 6);
  framing.look_at_m = rounded(unit_m * eye->look_at, eye_m, 6);
  framing.up = axesOf(framing.up_axis).up;
  framing.why_look = "the eye stands in it, " + decimal(kStandingEye_m, 1) +
                     " m above the ground, and looks " +
                     exactText(rounded(eye->free_m, eye->free_m, 2)) + " m far past what is " +
                     exactText(rounded(eye->nearest_m, eye->nearest_m, 2)) +
                     " m away; --look outside shows all of it";
  return true;
}

}  // namespace

double SceneBox::longest() const {
  const glm::dvec3 sides = size();
  return std::max({sides.x, sides.y, sides.z});
}

SceneBox boxWithoutStrays(std::span<const glm::vec3> points, std::span<const glm::vec3> reach) {
  assert(!points.empty() && (reach.empty() || reach.size() == points.size()));
  SceneBox core, dense;
  std::vector<float> along(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    const auto fill = [&](double side) {
      for (std::size_t i = 0; i < points.size(); ++i) {
        along[i] = static_cast<float>(points[i][axis] + side * reachOf(reach, i)[axis]);
      }
    };
    fill(-1.0);
    core.low[axis] = quantile(along, kStraysShare);
    dense.low[axis] = quantile(along, kMostStrays);
    fill(1.0);
    core.high[axis] = quantile(along, 1.0 - kStraysShare);
    dense.high[axis] = quantile(along, 1.0 - kMostStrays);
  }
  if (dense.longest() < kDenseCore * core.longest()) core = dense;
  const glm::dvec3 margin(kStrayDistance * core.longest());
  const SceneBox wide{core.low - margin, core.high + margin};
  SceneBox box = core;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3 p(points[i]);
    if (!isIn(wide, p)) {
      ++box.strays;
      continue;
    }
    glm::dvec3 low = p - reachOf(reach, i), high = p + reachOf(reach, i);
    if (!isIn(wide, low) || !isIn(wide, high)) low = high = p;
    box.low = glm::min(box.low, low);
    box.high = glm::max(box.high, high);
  }
  return box;
}

SceneBox boxOf(const SceneFacts& facts) {
  if (!facts.isMesh() && !facts.samples_of_mesh) {
    return boxWithoutStrays(facts.position, facts.reach);
  }
  SceneBox box{facts.position.front(), facts.position.front()};
  for (const glm::vec3& p : facts.position) {
    box.low = glm::min(box.low, glm::dvec3(p));
    box.high = glm::max(box.high, glm::dvec3(p));
  }
  return box;
}

std::optional<UpAxis> upAxisNamed(std::string_view name) {
  const bool negative = name.starts_with('-');
  if (negative) name.remove_prefix(1);
  if (name != "x" && name != "y" && name != "z") return std::nullopt;
  return UpAxis{name[0] - 'x', negative, "as --up says"};
}

std::string nameOf(const UpAxis& up) {
  return (up.negative ? "-" : "") + std::string(1, static_cast<char>('x' + up.axis));
}

UpAxis upAxisOf(const SceneFacts& facts, const SceneBox& box) {
  if (facts.up_axis) {
    return {*facts.up_axis, *facts.up_axis == 1 && facts.y_is_down,
            "as the " + nameOf(facts) + " states"};
  }
  if (facts.kind == SceneKind::gltf) return {1, false, "the convention of glTF"};
  if (facts.kind == SceneKind::obj) return {1, false, guess("the convention of OBJ", 1)};
  if (facts.y_is_down) {
    return {1, true, "y points down in captured scenes; if not: --up y"};
  }
  if (facts.kind == SceneKind::gaussians) {
    return {1, false, "the convention of the format; if not: --up -y"};
  }
  if (facts.kind == SceneKind::fbx) return {1, false, "the convention of FBX"};
  const glm::dvec3 size = box.size();
  for (const int axis : {2, 1}) {
    const double least_other = std::min(size[(axis + 1) % 3], size[(axis + 2) % 3]);
    if (size[axis] < kFlat * least_other) {
      return {axis, false, guess("the scene is flat across it", axis)};
    }
  }
  if (facts.kind == SceneKind::ply_mesh) return {1, false, guess("as usual in PLY meshes", 1)};
  if (facts.kind == SceneKind::off_mesh) return {1, false, guess("as usual in OFF meshes", 1)};
  return {2, false,
          guess(facts.kind == SceneKind::stl ? "as usual in STL" : "as usual in scans", 2)};
}

Framing framingOf(const SceneFacts& facts, const FramingRequest& request) {
  Framing framing{.box = boxOf(facts)};
  framing.up_axis = request.up ? *request.up : upAxisOf(facts, framing.box);
  const SceneAxes axes = axesOf(framing.up_axis);
  const double raise_rad = glm::radians(kRaise_deg);
  if (!request.look && enterScan(facts, request, framing)) return framing;
  const bool chooses = !request.look || request.look == Look::outside;
  const Look look = chooses ? lookAt(axes, framing.box.size()) : *request.look;
  if (chooses && look != Look::front) framing.why_look = "it is flat: seen from the left";
  glm::dvec3 to_eye = axes.up, image_up = -axes.front;
  if (look != Look::above) {
    const glm::dvec3 level = look == Look::front ? axes.front : -axes.right;
    to_eye = std::cos(raise_rad) * level + std::sin(raise_rad) * axes.up;
    image_up = axes.up;
  }
  const glm::dvec3 right = glm::normalize(glm::cross(image_up, to_eye));
  const glm::dmat3 eye_from_scene =
      glm::transpose(glm::dmat3(right, glm::cross(to_eye, right), to_eye));
  const Screen& screen = request.screen;
  double distance = distanceOf(facts, framing.box, eye_from_scene,
                               kFilledShare * 0.5 * screen.size_m / screen.distance_m);
  if (request.scale_m) {
    framing.scale_m = *request.scale_m;
    framing.why_scale = "as --scale says (default: 1)";
  } else {
    chooseScale(facts, distance, framing);
  }
  if (!request.look) {
    distance = nearerDistance(facts, eye_from_scene, to_eye, screen, distance, framing);
  }
  const double distance_m = framing.scale_m * distance;
  const glm::dvec3 middle_m = framing.scale_m * framing.box.middle();
  framing.look_at_m = rounded(middle_m, distance_m, 4);
  framing.position_m = rounded(middle_m + distance_m * to_eye, distance_m, 4);
  framing.up = image_up;
  return framing;
}

std::string framingText(const Framing& framing) {
  std::string text = sizeText(framing.box.size()) + " units";
  if (framing.box.strays > 0) {
    text += " without " + std::to_string(framing.box.strays) + " strays";
  }
  if (framing.entered) {
    return text + ", " + nameOf(framing.up_axis) + " is up (" + framing.up_axis.why +
           "); scene.scale_m = " + exactText(framing.scale_m) + " (" + framing.why_scale + "); " +
           framing.why_look;
  }
  const double distance_m = framing.distance_m();
  return text + ", " + nameOf(framing.up_axis) + " is up (" + framing.up_axis.why +
         "); scene.scale_m = " + exactText(framing.scale_m) + " (" + framing.why_scale +
         "), the eye is " + exactText(rounded(distance_m, distance_m, 3)) + " m away" +
         (framing.why_look.empty() ? "" : "; " + framing.why_look);
}

}  // namespace foci
