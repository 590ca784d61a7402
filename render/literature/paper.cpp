// The published baseline: Krivanek, Zara and Bouatouch, Fast Depth of Field Rendering with Surface
// Splatting (2003), with and without level of detail. The splats go to an A-buffer with z-ranges
// (section 6.4). Known failure, which the paper states: the z-range is that of the blurred splat.
// So surfaces that are close together, or that cross, merge where one should hide the other.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "render/literature/paper/abuffer.h"
#include "render/literature/paper/hierarchy.h"
#include "render/literature/paper/project.h"
#include "render/methods/method.h"
#include "render/splat/splat.h"

namespace foci {
namespace {

/// Bins the splats and renders them. The caller keeps `lists` between frames for their memory.
RenderStats renderPaper(const PaperSplats& splats, PaperTileLists& lists, const View& view,
                        const RenderSettings& settings, bool transparent, Frame& frame) {
  lists.build(splats, view.size_px);
  RenderStats stats;
  stats.splats = splats.total();
  stats.fragments = renderABuffer(splats, lists, settings.lighting.background, transparent,
                                  settings.depth, frame);
  return stats;
}

/// Every splat is blurred by its own circle of confusion (Eq. 11) and becomes a truncated Gaussian.
/// The cost grows with the square of the blur.
class PaperMethod final : public Method {
 public:
  explicit PaperMethod(const SurfelCloud& cloud) : cloud_(cloud) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    const std::size_t n = cloud_.size();
    const std::size_t chunk = chunkSize(n);
    splats_.reserve(n);
    splats_.chunks.assign((n + chunk - 1) / chunk, {});
    parallelFor(splats_.chunks.size(), [&](std::size_t c) {
      const std::size_t begin = c * chunk;
      splats_.chunks[c].begin = begin;
      splats_.chunks[c].count =
          projectPaper({.count = std::min(n - begin, chunk),
                        .position_m = cloud_.position_m.data() + begin,
                        .axis_u_m = cloud_.axis_u_m.data() + begin,
                        .axis_v_m = cloud_.axis_v_m.data() + begin,
                        .color = cloud_.color.data() + begin,
                        .opacity = cloud_.opacity.empty() ? nullptr : cloud_.opacity.data() + begin,
                        .area_m2 = cloud_.area_m2.data() + begin},
                       view, settings.defocus, settings.lighting, splats_.splats.get() + begin,
                       splats_.tiles.get() + begin);
    });
    return renderPaper(splats_, lists_, view, settings, !cloud_.opacity.empty(), frame);
  }

 private:
  const SurfelCloud& cloud_;
  PaperSplats splats_;
  PaperTileLists lists_;
};

/// Surfels or nodes that wait for projection, in the layout that projectPaper reads.
struct Batch {
  static constexpr std::size_t kMax = 256;  // chosen by hand
  std::size_t count = 0;
  std::array<glm::vec3, kMax> position_m, axis_u_m, axis_v_m, spread_u_m, spread_v_m, color;
  std::array<float, kMax> opacity, area_m2;
};

/// Where the kernels of a bounding sphere lie: outside the image, across its border, or inside.
enum class Reach { outside, border, inside };

/// Traverses one subtree and projects the nodes and surfels where the traversal stops.
class Traversal {
 public:
  Traversal(const SurfelCloud& cloud, const PaperHierarchy& hierarchy, const View& view,
            const RenderSettings& settings, PaperSplat* splats, PaperSplatTiles* tiles)
      : cloud_(cloud),
        hierarchy_(hierarchy),
        view_(view),
        settings_(settings),
        splats_(splats),
        tiles_(tiles) {}

  /// @return the number of splats
  std::uint32_t run(int level, std::size_t node) {
    visit(level, node, Reach::border);
    flush(nodes_, true);
    flush(surfels_, false);
    return rendered_;
  }

  /// Whether the node is rendered in place of its children: its projected diameter is below the
  /// radius of its circle of confusion, or below a pixel. The paper says "size". With the diameter,
  /// the number of points agrees with the paper's Table 1.
  bool stops(const PaperNode& node, const glm::vec3& center) const {
    const float depth = -center.z;
    if (!(depth - node.radius_m > view_.near_m)) return false;
    const glm::vec2 diameter_px = 2.0f * node.radius_m / depth * view_.focal_px;
    if (diameter_px.x < 1.0f && diameter_px.y < 1.0f) return true;
    const glm::vec2 blur_px = settings_.defocus.radius_px_per_D *
                              minDefocus_D(settings_.defocus, 1.0f / distance(center));
    return diameter_px.x < blur_px.x && diameter_px.y < blur_px.y;
  }

  /// Where the kernels of the node and of its descendants lie. Conservative: `outside` is certain.
  Reach reach(const PaperNode& node, const glm::vec3& center) const {
    const float r = node.radius_m, nearest = -center.z - r;
    if (-center.z + r < view_.near_m) return Reach::outside;
    if (!(nearest > view_.near_m)) return Reach::border;
    const float min_m = std::max(distance(center) - r, nearest), max_m = distance(center) + r;
    const glm::vec2 blur_px =
        settings_.defocus.radius_px_per_D * std::max(maxDefocus_D(settings_.defocus, 1.0f / min_m),
                                                     maxDefocus_D(settings_.defocus, 1.0f / max_m));
    bool inside = true;
    for (int axis = 0; axis < 2; ++axis) {
      const float at = axis == 0 ? center.x : -center.y;
      const float low = (at - r) / (at < r ? nearest : -center.z + r);
      const float high = (at + r) / (at > -r ? nearest : -center.z + r);
      const float tangent = std::max(std::abs(low), std::abs(high));
      const float scale = view_.focal_px[axis] / nearest;
      const float variance = 1.0f + kGaussianVariancePerRadius2 * blur_px[axis] * blur_px[axis] +
                             scale * scale * (1.0f + tangent * tangent) *
                                 (r * r + node.widest_m * node.widest_m) * 2.0f;
      const float support = std::sqrt(2.0f * kPaperCutoff * variance);
      const float from = view_.principal_px[axis] + view_.focal_px[axis] * low;
      const float to = view_.principal_px[axis] + view_.focal_px[axis] * high;
      const auto size = static_cast<float>(view_.size_px[axis]);
      if (from - support > size || to + support < 0.0f) return Reach::outside;
      inside = inside && from >= 0.0f && to <= size;
    }
    return inside ? Reach::inside : Reach::border;
  }

  glm::vec3 inEye(const glm::vec3& p_world) const {
    return glm::vec3(view_.eye_from_world * glm::vec4(p_world, 1.0f));
  }

 private:
  float distance(const glm::vec3& p_eye) const {
    return settings_.defocus.along == DistanceAlong::axis ? -p_eye.z : glm::length(p_eye);
  }

  void visit(int level, std::size_t index, Reach known) {
    const PaperNode& node = hierarchy_.level(level)[index];
    const glm::vec3 center = inEye(node.center_m);
    if (known != Reach::inside) known = reach(node, center);
    if (known == Reach::outside) return;
    if (stops(node, center)) {
      add(node);
    } else if (level + 1 < hierarchy_.levels()) {
      for (std::size_t child = 4 * index; child < 4 * index + 4; ++child) {
        visit(level + 1, child, known);
      }
    } else {
      const auto [begin, end] = hierarchy_.surfels(level, index);
      for (std::size_t i = begin; i < end; ++i) addSurfel(hierarchy_.order()[i]);
    }
  }

  void add(const PaperNode& node) {
    const std::size_t i = nodes_.count++;
    nodes_.position_m[i] = node.position_m;
    nodes_.axis_u_m[i] = node.axis_u_m;
    nodes_.axis_v_m[i] = node.axis_v_m;
    nodes_.spread_u_m[i] = node.spread_u_m;
    nodes_.spread_v_m[i] = node.spread_v_m;
    nodes_.color[i] = node.color;
    nodes_.opacity[i] = node.opacity;
    nodes_.area_m2[i] = node.area_m2;
    if (nodes_.count == Batch::kMax) flush(nodes_, true);
  }

  void addSurfel(std::size_t surfel) {
    const std::size_t i = surfels_.count++;
    surfels_.position_m[i] = cloud_.position_m[surfel];
    surfels_.axis_u_m[i] = cloud_.axis_u_m[surfel];
    surfels_.axis_v_m[i] = cloud_.axis_v_m[surfel];
    surfels_.color[i] = cloud_.color[surfel];
    surfels_.opacity[i] = opacityOf(cloud_, surfel);
    surfels_.area_m2[i] = cloud_.area_m2[surfel];
    if (surfels_.count == Batch::kMax) flush(surfels_, false);
  }

  void flush(Batch& batch, bool low_passed) {
    rendered_ += projectPaper({.count = batch.count,
                               .position_m = batch.position_m.data(),
                               .axis_u_m = batch.axis_u_m.data(),
                               .axis_v_m = batch.axis_v_m.data(),
                               .spread_u_m = low_passed ? batch.spread_u_m.data() : nullptr,
                               .spread_v_m = low_passed ? batch.spread_v_m.data() : nullptr,
                               .color = batch.color.data(),
                               .opacity = batch.opacity.data(),
                               .area_m2 = batch.area_m2.data()},
                              view_, settings_.defocus, settings_.lighting, splats_ + rendered_,
                              tiles_ + rendered_);
    batch.count = 0;
  }

  const SurfelCloud& cloud_;
  const PaperHierarchy& hierarchy_;
  const View& view_;
  const RenderSettings& settings_;
  PaperSplat* splats_;
  PaperSplatTiles* tiles_;
  std::uint32_t rendered_ = 0;
  Batch nodes_, surfels_;
};

/// Level of detail (sections 5.3 and 6.2). If the circle of confusion of a hierarchy node is larger
/// than the node, the node is rendered in place of its surfels. Its low-passed texture already has
/// some of the blur, which is not added again. Known failure, which the paper states: the texture
/// is low-passed but the shape is not, so outlines and relief change with the level. Nodes do not
/// fade into each other, so levels pop as the focus moves.
class PaperLodMethod final : public Method {
 public:
  explicit PaperLodMethod(const SurfelCloud& cloud) : cloud_(cloud), hierarchy_(cloud) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    splats_.reserve(hierarchy_.order().size());
    splats_.chunks.clear();
    // Traverse subtrees in parallel. If the traversal stops at a node above their roots, the first
    // subtree of that node renders the node.
    const int level = std::min(kSubtreeLevel, hierarchy_.levels() - 1);
    splats_.chunks.assign(level < 0 ? 0 : hierarchy_.level(level).size(), {});
    parallelFor(splats_.chunks.size(), [&](std::size_t c) {
      const std::size_t begin = hierarchy_.surfels(level, c).begin;
      splats_.chunks[c].begin = begin;
      Traversal traversal(cloud_, hierarchy_, view, settings, splats_.splats.get() + begin,
                          splats_.tiles.get() + begin);
      for (int above = 0; above < level; ++above) {
        const std::size_t index = c >> (2 * (level - above));
        const PaperNode& node = hierarchy_.level(above)[index];
        const glm::vec3 center = traversal.inEye(node.center_m);
        if (traversal.reach(node, center) == Reach::outside) return;
        if (!traversal.stops(node, center)) continue;
        const bool first = c == index << (2 * (level - above));
        splats_.chunks[c].count = first ? traversal.run(above, index) : 0;
        return;
      }
      splats_.chunks[c].count = traversal.run(level, c);
    });
    return renderPaper(splats_, lists_, view, settings, !cloud_.opacity.empty(), frame);
  }

 private:
  static constexpr int kSubtreeLevel = 4;  // 256 subtrees; chosen by hand, above most thread counts

  const SurfelCloud& cloud_;
  PaperHierarchy hierarchy_;
  PaperSplats splats_;
  PaperTileLists lists_;
};

}  // namespace

MethodEntry paperMethod() {
  return {
      .info = {.name = "paper",
               .summary = "the published baseline: each splat blurred, an A-buffer of fragments",
               .source = "Krivanek, Zara and Bouatouch 2003",
               .family = MethodFamily::paper},
      .make = makeAs<PaperMethod>};
}

MethodEntry paperLodMethod() {
  return {.info = {.name = "paper-lod",
                   .summary = "paper with level of detail chosen by the blur",
                   .source =
                       "Krivanek, Zara and Bouatouch 2003; hierarchy: Rusinkiewicz and Levoy 2000",
                   .family = MethodFamily::paper},
          .make = makeAs<PaperLodMethod>};
}

}  // namespace foci
