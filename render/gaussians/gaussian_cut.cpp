#include "render/gaussians/gaussian_cut.h"

#include <algorithm>
#include <cassert>

#include "base/parallel.h"
#include "render/optics/lens_field.h"
#include "render/scene/tree_order.h"

namespace foci {
namespace {

constexpr int kSerialCutLevels = 8;  // below it one task a subtree; fixed, so results are, too

class NodeSelector {
 public:
  NodeSelector(const GaussianCloud& cloud, const View& view, const Defocus& defocus,
               const GaussianCutSettings& settings)
      : tree_(*cloud.tree),
        count_(cloud.size()),
        view_(view),
        defocus_(defocus),
        settings_(settings),
        focal2_(view.focal_px.x * view.focal_px.y),
        blur2_(defocus.radius_px_per_D.x * defocus.radius_px_per_D.y) {}

  /// Selects at and below the `j`-th node of a level. Nodes of `last_level` are left in `pending`.
  void select(int level, std::size_t j, int last_level, GaussianCut& cut,
              std::vector<std::size_t>* pending) const {
    if (level == last_level) {
      pending->push_back(j);
      return;
    }
    const std::size_t node = (std::size_t{1} << level) + j;
    const Seen seen = see(node);
    if (seen == Seen::outside) return;
    if (seen == Seen::fine) {
      cut.nodes.push_back(static_cast<std::uint32_t>(node));
      return;
    }
    if (level + 1 < tree_.levels) {
      select(level + 1, 2 * j, last_level, cut, pending);
      select(level + 1, 2 * j + 1, last_level, cut, pending);
      return;
    }
    const auto [begin, end] = rangeBelow(count_, level, j);
    for (std::size_t i = begin; i < end; ++i) {
      cut.gaussians.push_back(static_cast<std::uint32_t>(i));
    }
  }

 private:
  enum class Seen { outside, fine, coarse };

  Seen see(std::size_t node) const {
    const glm::vec3 p(view_.eye_from_world * glm::vec4(tree_.nodes.position_m[node], 1.0f));
    const float radius = tree_.radius_m[node], depth = -p.z;
    if (depth + radius < view_.near_m) return Seen::outside;
    const float nearest = depth - radius;
    if (!(nearest >= view_.near_m)) return Seen::coarse;
    const float distance = defocus_.along == DistanceAlong::axis ? depth : glm::length(p);
    const float range_D = radius / (distance * std::max(distance - radius, view_.near_m));

    // The node, its blur and the low-pass lie within this box on the image. Twice the blur radius
    // bounds a disc's footprint of 3 sigma.
    const glm::vec2 offset = view_.focal_px * glm::vec2(p.x, -p.y) / depth;
    const glm::vec2 at = view_.principal_px + offset;
    const glm::vec2 spread_px = radius / nearest * (view_.focal_px + glm::abs(offset));
    const OffFocus off =
        offFocus(defocus_, offset, glm::length(spread_px), 1.0f / distance, range_D);
    const glm::vec2 reach =
        spread_px + 2.0f * off.max_D * defocus_.radius_px_per_D + kLowPassReach_px;
    const glm::vec2 size(view_.size_px);
    if (at.x + reach.x < 0.0f || at.y + reach.y < 0.0f || at.x - reach.x > size.x ||
        at.y - reach.y > size.y) {
      return Seen::outside;
    }
    const glm::vec2 from_gaze = glm::max(glm::abs(at - settings_.acuity.gaze_px) - reach, 0.0f);
    const float finest_px = settings_.acuity.finest_px(glm::length(from_gaze));
    const float allowed_px2 =
        std::min(settings_.per_blur2 * blur2_ * off.min_D * off.min_D, settings_.max_px2) +
        settings_.per_pixel2 + settings_.per_acuity2 * (finest_px * finest_px - 1.0f);
    const float spread_px2 = tree_.spread_m2[node] * focal2_ / (depth * depth);
    return spread_px2 <= allowed_px2 ? Seen::fine : Seen::coarse;
  }

  const GaussianTree& tree_;
  std::size_t count_;
  const View& view_;
  const Defocus& defocus_;
  const GaussianCutSettings& settings_;
  float focal2_, blur2_;
};

}  // namespace

void selectCut(const GaussianCloud& cloud, const View& view, const Defocus& defocus,
               const GaussianCutSettings& settings, GaussianCut& cut) {
  assert(cloud.tree);
  cut.nodes.clear();
  cut.gaussians.clear();
  const NodeSelector selector(cloud, view, defocus, settings);
  const int serial = std::min(kSerialCutLevels, cloud.tree->levels - 1);
  std::vector<std::size_t> pending;
  selector.select(0, 0, serial, cut, &pending);
  std::vector<GaussianCut> parts(pending.size());
  parallelFor(pending.size(), [&](std::size_t i) {
    selector.select(serial, pending[i], cloud.tree->levels, parts[i], nullptr);
  });
  for (const GaussianCut& part : parts) {
    cut.nodes.insert(cut.nodes.end(), part.nodes.begin(), part.nodes.end());
    cut.gaussians.insert(cut.gaussians.end(), part.gaussians.begin(), part.gaussians.end());
  }
}

}  // namespace foci
