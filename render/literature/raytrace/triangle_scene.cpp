#include "render/literature/raytrace/triangle_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/kernel/kernel.h"

namespace foci {
namespace {

constexpr int kMaxSteps = 20;
constexpr double kSettled = 1e-12;  // relative change of v
constexpr double kOnEdge = 1e-9;    // tolerance of barycentric weights, so that edges do not leak
constexpr float kPadding = 1e-5f;   // of bounds, relative
constexpr int kMaxSurfaces = 1000;  // along a ray through transparent ones

/// The triangle's part at depths of `near_m` and more: up to four corners.
std::size_t clipped(const glm::vec3 (&corners)[3], float near_m, std::array<glm::vec3, 4>& out) {
  std::size_t count = 0;
  for (int i = 0; i < 3; ++i) {
    const glm::vec3 &a = corners[i], &b = corners[(i + 1) % 3];
    const bool a_in = -a.z >= near_m, b_in = -b.z >= near_m;
    if (a_in) out[count++] = a;
    if (a_in != b_in) {
      glm::vec3 p = glm::mix(a, b, (-near_m - a.z) / (b.z - a.z));
      p.z = -near_m;
      out[count++] = p;
    }
  }
  return count;
}

}  // namespace

/// A line of image space, and the nearest triangle that it meets, as Embree hands both back.
struct TriangleScene::Line {
  EmbreeContext context;  // first: Embree knows this member only
  const TriangleScene* scene;
  glm::dvec3 d0, d1;         ///< d(v) = d0 + d1 v
  double farther_than_D;     ///< accepts vergences below this
  double vergence_D = -1.0;  ///< of the nearest triangle; negative: none
  MeshPoint place{};
  double cosine = 0.0;  ///< of the angle between the sight and the normal, >= 0
};

TriangleScene::TriangleScene(const TriangleMesh& mesh, const View& view, const Defocus& defocus,
                             const Lighting& lighting)
    : mesh_(mesh), view_(view), defocus_(defocus), lighting_(lighting) {
  const float steepest = std::max(defocus.radius_px_per_D.x, defocus.radius_px_per_D.y);
  px_per_D_ = steepest > 0.0f && std::isfinite(steepest) ? steepest : 1.0f;
  std::array<glm::vec3, 4> inside;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    Seen seen{.corners_eye = {}, .triangle = static_cast<std::uint32_t>(i)};
    for (int k = 0; k < 3; ++k) {
      seen.corners_eye[k] =
          glm::vec3(view.eye_from_world * glm::vec4(mesh.corners_m[3 * i + k], 1.0f));
    }
    if (clipped(seen.corners_eye, view.near_m, inside) > 0) seen_.push_back(seen);
  }
  nearest_D_ = 1.0f / view.near_m;
  RTCGeometry triangles = rtcNewGeometry(scene_.device(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(triangles, static_cast<unsigned>(seen_.size()));
  rtcSetGeometryUserData(triangles, this);
  rtcSetGeometryBoundsFunction(triangles, boundsOf, nullptr);
  rtcSetGeometryIntersectFunction(triangles, meet);
  scene_.build(triangles);
}

void TriangleScene::boundsOf(const RTCBoundsFunctionArguments* arguments) {
  const auto& scene = *static_cast<const TriangleScene*>(arguments->geometryUserPtr);
  const Seen& seen = scene.seen_[arguments->primID];
  std::array<glm::vec3, 4> corners;
  const std::size_t count = clipped(seen.corners_eye, scene.view_.near_m, corners);
  glm::vec2 low(std::numeric_limits<float>::infinity()), high = -low;
  float near_m = std::numeric_limits<float>::infinity(), far_m = 0.0f;
  const bool sight = scene.defocus_.along == DistanceAlong::sight;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec2 at_px = project(scene.view_, corners[i]);
    low = glm::min(low, at_px);
    high = glm::max(high, at_px);
    near_m = std::min(near_m, -corners[i].z);
    far_m = std::max(far_m, sight ? glm::length(corners[i]) : -corners[i].z);
  }
  // An eye's nearest point of a triangle may lie inside it: at least as far as its plane.
  if (sight) {
    const glm::vec3 normal = glm::cross(seen.corners_eye[1] - seen.corners_eye[0],
                                        seen.corners_eye[2] - seen.corners_eye[0]);
    const float plane_m = std::abs(glm::dot(normal, seen.corners_eye[0])) / glm::length(normal);
    if (plane_m > near_m) near_m = plane_m;
  }
  const glm::vec2 pad_px = kPadding * (glm::abs(low) + glm::abs(high)) + kPadding;
  const float pad_D = kPadding * (1.0f / near_m);
  *arguments->bounds_o = {.lower_x = low.x - pad_px.x,
                          .lower_y = low.y - pad_px.y,
                          .lower_z = -scene.px_per_D_ * (1.0f / near_m + pad_D),
                          .align0 = 0.0f,
                          .upper_x = high.x + pad_px.x,
                          .upper_y = high.y + pad_px.y,
                          .upper_z = -scene.px_per_D_ * (1.0f / far_m - pad_D),
                          .align1 = 0.0f};
}

void TriangleScene::meet(const RTCIntersectFunctionNArguments* arguments) {
  if (arguments->valid[0] == 0) return;
  auto& line = *reinterpret_cast<Line*>(arguments->context);
  const double before_D = line.vergence_D;
  line.scene->meet(line, arguments->primID);
  if (line.vergence_D == before_D) return;
  // A little beyond the triangle: floats must not hide another one at almost the same place.
  const double z = line.scene->px_per_D_ * (line.scene->nearest_D_ - line.vergence_D);
  RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, 1), 1, 0) =
      static_cast<float>(z + 1e-5 * line.scene->px_per_D_ * line.scene->nearest_D_);
}

void TriangleScene::meet(Line& line, std::uint32_t index) const {
  const Seen& seen = seen_[index];
  const glm::dvec3 a = seen.corners_eye[0], ab = glm::dvec3(seen.corners_eye[1]) - a,
                   ac = glm::dvec3(seen.corners_eye[2]) - a;
  const glm::dvec3 n = glm::cross(ab, ac);
  const double h = glm::dot(n, a), n0 = glm::dot(n, line.d0), n1 = glm::dot(n, line.d1);
  const bool sight = defocus_.along == DistanceAlong::sight;
  const auto lengthAt = [&](double v) { return sight ? glm::length(line.d0 + v * line.d1) : 1.0; };
  double v = n0 / (h * lengthAt(0.0) - n1);
  for (int step = 0; sight && step < kMaxSteps; ++step) {
    const double next = n0 / (h * lengthAt(v) - n1);
    const bool settled = std::abs(next - v) <= kSettled * std::abs(next);
    v = next;
    if (settled) break;
  }
  if (!(v > line.vergence_D && v < line.farther_than_D && v > 0.0)) return;  // or NaN
  const glm::dvec3 p = (line.d0 + v * line.d1) / (v * lengthAt(v));
  if (-p.z < view_.near_m) return;
  const double area2 = glm::dot(n, n);
  const double w1 = glm::dot(glm::cross(p - a, ac), n) / area2;
  const double w2 = glm::dot(glm::cross(ab, p - a), n) / area2;
  if (!(w1 >= -kOnEdge && w2 >= -kOnEdge && w1 + w2 <= 1.0 + kOnEdge)) return;
  line.vergence_D = v;
  line.place = {seen.triangle, glm::vec2(w1, w2)};
  line.cosine = std::abs(glm::dot(n, p)) / (std::sqrt(area2) * glm::length(p));
}

RayColor TriangleScene::trace(const glm::vec2& point_px, const glm::vec2& lens,
                              std::uint64_t& fragments) const {
  const glm::dvec2 j = defocus_.astigmatism_D, radius = defocus_.radius_px_per_D;
  const glm::dvec2 b = radius * glm::dvec2(lens);
  const glm::dvec2 shift =
      radius * glm::dvec2(j.x * lens.x + j.y * lens.y, j.y * lens.x - j.x * lens.y);
  const glm::dvec2 at = glm::dvec2(point_px) - shift - b * double{defocus_.focus_D};  // v = 0
  const glm::dvec2 focal(view_.focal_px), principal(view_.principal_px);
  Line line{.context = {},
            .scene = this,
            .d0 = {(at.x - principal.x) / focal.x, -(at.y - principal.y) / focal.y, -1.0},
            .d1 = {b.x / focal.x, -b.y / focal.y, 0.0},
            .farther_than_D = std::numeric_limits<double>::infinity()};
  RayColor seen;
  for (int surface = 0; surface < kMaxSurfaces; ++surface) {
    line.vergence_D = -1.0;
    scene_.trace(line.context, {at + b * double{nearest_D_}, -px_per_D_ * nearest_D_},
                 {-b / double{px_per_D_}, 1.0f}, 0.0f, 2.0f * px_per_D_ * nearest_D_);
    if (line.vergence_D < 0.0) break;
    ++fragments;
    const MeshColor color = colorAt(mesh_, line.place, 0.0f);
    const float shade = lighting_.shade(static_cast<float>(line.cosine));
    const float share = seen.transmittance * color.opacity;
    seen.color += share * shade * color.color;
    seen.distance += share / static_cast<float>(line.vergence_D);
    seen.transmittance -= share;
    if (seen.transmittance < kHidden) break;
    line.farther_than_D = line.vergence_D;
  }
  return seen;
}

}  // namespace foci
