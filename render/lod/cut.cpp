#include "render/lod/cut.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "render/lod/back_faces.h"
#include "render/optics/lens_field.h"

namespace foci {
namespace {

constexpr int kSerialCutLevels = 8;      // below it one task a subtree; fixed, so results are, too
constexpr int kMiddleLevel = 10;         // about a thousand nodes
constexpr float kWidestSupport = 2.83f;  // the same, no wider than needed (kWidestSupport2)
constexpr int kRangeSurfels = 512;       // largest subtree that is taken as one range of surfels
constexpr int kBorderRanges = 8;  // parts of such a subtree where the image's border may cut it

struct Pending {
  std::size_t node;
  float weight;
};

class Selector {
 public:
  Selector(const MomentTree& tree, const View& view, const Defocus& defocus,
           const CutSettings& settings)
      : tree_(tree), view_(view), defocus_(defocus), settings_(settings) {
    focal2_ = view.focal_px.x * view.focal_px.y;
    blur2_ = defocus.radius_px_per_D.x * defocus.radius_px_per_D.y;
    first_range_node_ = firstRangeNode(tree.surfels().size());
    eye_m_ = -glm::transpose(glm::mat3(view.eye_from_world)) * glm::vec3(view.eye_from_world[3]);
    lens_m_ = lensRadius_m(view, defocus);
    outside_ = bodiesFromOutside(tree.surfels().bodies, view, defocus);
  }

  /// Bounds of size over coarseness, for all nodes below a node.
  struct Bounds {
    float min = 0.0f, max = std::numeric_limits<float>::infinity();
    bool in_view = false;  ///< all of their centres are on the image
    bool seen = false;     ///< none of their surfels is a hidden back face
  };

  /// Selects nodes at and below `node`, which has the given weight. Nodes from `last_node` on are
  /// left in `pending`.
  /// @param above  the bounds that an ancestor gives
  void select(std::size_t node, float weight, Bounds above, std::size_t last_node, Cut& cut,
              std::vector<Pending>* pending) const {
    if (node >= last_node) {
      pending->push_back({node, weight});
      return;
    }
    if (!outside_.empty() && !above.seen) {
      const FacingSide side = sideOfNode(node);
      if (side == FacingSide::backs) return;
      above.seen = side == FacingSide::fronts;
    }
    const bool seen = above.seen;
    const Coarseness coarse = tree_.coarseness()[node];
    float size = coarse.now_m2 * above.min;
    const bool known = size >= 1.0f + kCutFade || coarse.now_m2 * above.max <= 1.0f;
    if (!above.in_view || !known) {
      size = sizeOf(node, above);
      if (size == kOutside) return;
      above.seen = seen;
    }
    const std::size_t first_range = first_range_node_ * (above.in_view ? 1 : kBorderRanges);
    if (weight == 1.0f && (node >= first_range || tree_.isCluster(node)) &&
        coarse.min_m2 * above.min >= 1.0f + kCutFade) {
      takeAll(node, cut);
      return;
    }
    const float children = std::min((size - 1.0f) * (1.0f / kCutFade), 1.0f);
    if (children < 1.0f) {
      const float own = children > 0.0f ? 1.0f - children : 1.0f;
      cut.nodes.push_back({static_cast<std::uint32_t>(node), weight * own});
    }
    if (children <= 0.0f) return;
    weight *= children;
    if (!tree_.isCluster(node)) {
      select(2 * node, weight, above, last_node, cut, pending);
      select(2 * node + 1, weight, above, last_node, cut, pending);
      return;
    }
    const int level = tree_.levels() - 1;
    const auto [begin, end] = tree_.range(level, node - (std::size_t{1} << level));
    for (std::size_t i = begin; i < end; ++i) {
      cut.surfels.push_back({static_cast<std::uint32_t>(i), weight});
    }
  }

  static constexpr float kOutside = -1.0f;

 private:
  /// Surfels that are not on a body, or on one that the eye is inside of, count as fronts.
  FacingSide sideOfNode(std::size_t index) const {
    const Facing facing = tree_.facing()[index];
    if (facing.body == Facing::kSeveral) return FacingSide::both;
    if (outside_[facing.body] == 0) return FacingSide::fronts;
    const LodNode& node = tree_.nodes()[index];
    return sideOf(facing, unpackNormal(node.normal), node.position_m - eye_m_, node.radius_m,
                  lens_m_);
  }

  /// All surfels below a node.
  void takeAll(std::size_t node, Cut& cut) const {
    const int level = static_cast<int>(std::bit_width(node)) - 1;
    const auto [begin, end] = tree_.range(level, node - (std::size_t{1} << level));
    auto* last = cut.ranges.empty() ? nullptr : &cut.ranges.back();
    if (last && last->end == begin && end - last->begin <= Cut::kLongestRange) {
      last->end = static_cast<std::uint32_t>(end);
      return;
    }
    cut.ranges.push_back({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)});
  }

  /// Variance that merging added to the node, over the allowed variance; kOutside if the node
  /// cannot touch the image.
  /// @param below  output
  float sizeOf(std::size_t index, Bounds& below) const {
    constexpr float kRefine = 1e30f;
    below = {};
    const LodNode& node = tree_.nodes()[index];
    const glm::vec3 p = glm::vec3(view_.eye_from_world * glm::vec4(node.position_m, 1.0f));
    const float radius = node.radius_m;
    const float depth = -p.z;
    if (depth + radius < view_.near_m) return kOutside;
    const float nearest = depth - radius;
    if (nearest < view_.near_m) return kRefine;

    // The node and its blur lie within this box on the image. A distance along the line of sight is
    // never below the one along the axis.
    const float distance =
        defocus_.along == DistanceAlong::axis ? depth : std::sqrt(glm::dot(p, p));
    const float inv = 1.0f / distance, inv_nearest = 1.0f / nearest;
    const float range_D = radius * inv / std::max(distance - radius, view_.near_m);
    const glm::vec2 offset = view_.focal_px * glm::vec2(p.x, -p.y) / depth;
    const glm::vec2 at = view_.principal_px + offset;
    const glm::vec2 spread = radius * inv_nearest * (view_.focal_px + glm::abs(offset));
    const float finest_px = settings_.acuity.finest_px(glm::length(at - settings_.acuity.gaze_px));
    const OffFocus off = offFocus(defocus_, offset, glm::length(spread), inv, range_D);
    const glm::vec2 blur_px = off.max_D * defocus_.radius_px_per_D;
    const glm::vec2 reach = kWidestReach * (0.5f * spread + 0.6f * blur_px + finest_px);
    const glm::vec2 size(view_.size_px), outside = glm::max(-at, at - size);
    const auto margin = static_cast<float>(settings_.margin_px);
    const float widest_px = finest_px + settings_.acuity.per_px * std::max(spread.x, spread.y);
    const glm::vec2 touches = spread + kWidestSupport * (0.5f * blur_px + widest_px);
    if (outside.x > touches.x + margin || outside.y > touches.y + margin) return kOutside;
    const float allowed = min_px2(off, at, reach);
    const float blurred = blurred_px2(off.min_D);
    const float coarseness = settings_.foreshortened
                                 ? coarsenessInView(index, 1.0f - blurred / allowed)
                                 : tree_.coarseness()[index].now_m2;
    const float now = coarseness * perCoarseness(depth, allowed);

    // A descendant's centre lies within the radius, and the descendant's radius is at most twice
    // it.
    const float around = 3.0f * radius;
    if (depth - around < view_.near_m) return now;
    const float around_D = around * inv / std::max(distance - around, view_.near_m);
    const float shows = settings_.foreshortened ? kEdgeOn : 1.0f;
    const OffFocus off_around =
        offFocus(defocus_, offset, 3.0f * glm::length(spread), inv, around_D);
    below = {.min = shows * perCoarseness(depth + around, max_px2(off_around, at, 3.0f * reach)),
             .max = perCoarseness(depth - around, min_px2(off_around, at, 3.0f * reach)),
             .in_view = at.x > spread.x && at.y > spread.y && at.x + spread.x < size.x &&
                        at.y + spread.y < size.y};
    return now;
  }

  /// A node's coarseness on the image. Seen at the cosine c to its normal, a flat node adds the
  /// variance 1 across the tilt and c^2 along it. A low-pass of the variances a and b changes an
  /// image of an isotropic spectrum by sqrt((3 a^2 + 3 b^2 + 2 a b) / 8) of what a = b = 1 changes.
  /// A lens sees depth, too, so in the share that blur allows a node counts as if it faced the eye.
  /// @param sharp  share of the allowed variance that blur does not allow
  float coarsenessInView(std::size_t index, float sharp) const {
    const LodNode& node = tree_.nodes()[index];
    const glm::vec3 from_eye = node.position_m - eye_m_;
    const float along = glm::dot(unpackNormal(node.normal), from_eye);
    const float cos2 = along * along / glm::dot(from_eye, from_eye);
    const float shows = std::sqrt((3.0f + cos2 * (2.0f + 3.0f * cos2)) * (1.0f / 8.0f));
    return tree_.coarseness()[index].now_m2 - sharp * (1.0f - shows) * node.added_m2();
  }

  float perCoarseness(float depth, float allowed_px2) const {
    return focal2_ / (depth * depth * allowed_px2);
  }

  /// Smallest and largest allowed variance within a range of dioptres and pixels. finest_px grows
  /// with the distance from the gaze.
  float min_px2(const OffFocus& off, const glm::vec2& at, const glm::vec2& reach) const {
    const glm::vec2 from_px = glm::max(glm::abs(at - settings_.acuity.gaze_px) - reach, 0.0f);
    return allowed_px2(off.min_D, settings_.acuity.finest_px(glm::length(from_px)));
  }
  float max_px2(const OffFocus& off, const glm::vec2& at, const glm::vec2& reach) const {
    const glm::vec2 from_px = glm::abs(at - settings_.acuity.gaze_px) + reach;
    return allowed_px2(off.max_D, settings_.acuity.finest_px(glm::length(from_px)));
  }
  float blurred_px2(float defocus_D) const {
    return settings_.per_blur2 * blur2_ * defocus_D * defocus_D;
  }
  float allowed_px2(float defocus_D, float finest_px) const {
    return blurred_px2(defocus_D) + settings_.per_pixel2 +
           settings_.per_acuity2 * (finest_px * finest_px - 1.0f);
  }

  const MomentTree& tree_;
  const View& view_;
  const Defocus& defocus_;
  const CutSettings& settings_;
  float focal2_, blur2_;
  std::size_t first_range_node_;
  glm::vec3 eye_m_;
  float lens_m_;
  std::vector<std::uint8_t> outside_;  // `bodiesFromOutside`
};

constexpr float kThinnest = 1e-3f;  // lower bound of a kernel's shorter axis over the longer

}  // namespace

std::size_t firstRangeNode(std::size_t surfels) {
  return std::bit_ceil(surfels / kRangeSurfels + 1);
}

std::optional<std::pair<float, float>> distancesInView(const MomentTree& tree, const View& view,
                                                       const Defocus& defocus) {
  if (tree.levels() == 0) return std::nullopt;
  const std::size_t first = std::size_t{1} << std::min(kMiddleLevel, tree.levels() - 1);
  float nearest_m = std::numeric_limits<float>::infinity(), farthest_m = 0.0f;
  for (std::size_t node = first; node < 2 * first; ++node) {
    const glm::vec3 p(view.eye_from_world * glm::vec4(tree.nodes()[node].position_m, 1.0f));
    if (!(-p.z >= view.near_m)) continue;
    const glm::vec2 at = project(view, p);
    const glm::vec2 size(view.size_px);
    if (at.x < 0.0f || at.y < 0.0f || at.x > size.x || at.y > size.y) continue;
    const float distance_m = defocus.along == DistanceAlong::axis ? -p.z : glm::length(p);
    nearest_m = std::min(nearest_m, distance_m);
    farthest_m = std::max(farthest_m, distance_m);
  }
  if (farthest_m == 0.0f) return std::nullopt;
  return std::pair(nearest_m, farthest_m);
}

void selectCut(const MomentTree& tree, const View& view, const Defocus& defocus,
               const CutSettings& settings, Cut& cut) {
  cut.nodes.clear();
  cut.surfels.clear();
  cut.ranges.clear();
  if (tree.levels() == 0) return;
  const Selector selector(tree, view, defocus, settings);
  std::vector<Pending> pending;
  selector.select(1, 1.0f, {}, std::size_t{1} << std::min(kSerialCutLevels, tree.levels() - 1), cut,
                  &pending);
  std::vector<Cut> parts(pending.size());
  parallelFor(pending.size(), [&](std::size_t i) {
    selector.select(pending[i].node, pending[i].weight, {}, tree.nodes().size(), parts[i], nullptr);
  });
  for (const Cut& part : parts) {
    cut.nodes.insert(cut.nodes.end(), part.nodes.begin(), part.nodes.end());
    cut.surfels.insert(cut.surfels.end(), part.surfels.begin(), part.surfels.end());
    cut.ranges.insert(cut.ranges.end(), part.ranges.begin(), part.ranges.end());
  }
}

LevelKernels levelKernels(const MomentTree& tree, int level) {
  assert(level >= 0 && level < tree.levels());
  LevelKernels kernels;
  const std::size_t first = std::size_t{1} << level;
  for (std::size_t i = first; i < 2 * first; ++i) {
    const LodNode& node = tree.nodes()[i];
    const glm::vec3 normal = unpackNormal(node.normal);
    const glm::vec3 x = tangentTo(normal), y = glm::cross(normal, x);

    // The variance in the plane across the normal, and its axes.
    const float xx = node.covariance_m2(x, x), yy = node.covariance_m2(y, y);
    const float xy = node.covariance_m2(x, y);
    const auto angle = static_cast<float>(0.5 * std::atan2(2.0 * xy, double{xx - yy}));
    const float middle = 0.5f * (xx + yy), apart = std::hypot(0.5f * (xx - yy), xy);
    const float own = static_cast<float>(node.own) * (1.0f / 65535.0f);
    const float u = std::sqrt(own * (middle + apart));
    const float v = std::max(std::sqrt(own * std::max(middle - apart, 0.0f)), kThinnest * u);

    kernels.surfels.position_m.push_back(node.position_m);
    kernels.surfels.axis_u_m.push_back(u * (std::cos(angle) * x + std::sin(angle) * y));
    kernels.surfels.axis_v_m.push_back(v * (std::cos(angle) * y - std::sin(angle) * x));
    kernels.surfels.color.push_back(node.color);
    kernels.surfels.area_m2.push_back(node.density * std::sqrt(std::max(xx * yy - xy * xy, 0.0f)));
    kernels.added_m2.push_back(0.5f * (1.0f - own) * node.trace_m2());
  }
  return kernels;
}

}  // namespace foci
