// A bounding hierarchy, walked front to back along a cone: the scene's tree where it has one, or
// one over surfels in Morton order.
#include "render/lod/surface_query.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "render/lod/gaussian_in_cone.h"
#include "render/lod/moment_tree.h"
#include "render/scene/gaussian_cloud.h"
#include "render/scene/neighbours.h"

namespace foci {
namespace {

constexpr std::size_t kLeafSurfels = 8;
constexpr float kReach = 3.0f;         // support of a surfel's kernel, standard deviations
constexpr float kDepthReach = 2.0f;    // half of its depth range, standard deviations along the ray
constexpr float kNearest_m = 0.001f;   // surfels that begin nearer are ignored
constexpr double kFullCoverage = 0.9;  // kernels of an opaque surface sum to one within 0.1

struct Sphere {
  glm::vec3 center{0.0f};
  float radius = -1.0f;  // empty
};

struct Box {
  glm::vec3 low{std::numeric_limits<float>::max()};
  glm::vec3 high{std::numeric_limits<float>::lowest()};

  void add(const glm::vec3& a, const glm::vec3& b) {
    low = glm::min(low, a);
    high = glm::max(high, b);
  }
};

constexpr std::uint32_t kNode = ~std::uint32_t{0};

/// A node or a surfel that the walk has yet to visit, nearest first.
struct Visit {
  float near_m;
  std::uint32_t id;
  std::uint32_t met;  ///< a surfel's place among those that the walk has met, or kNode

  bool operator>(const Visit& other) const {
    return near_m != other.near_m ? near_m > other.near_m : id > other.id;
  }
};

/// One surfel's share of the cone.
struct Share {
  float depth_m, near_m, far_m;
  double coverage;
};

/// `SurfelShare::per_m2` of a Gaussian.
double outlinePer_m2(const ConeFrame& cone, const GaussianInCone& gaussian) {
  const double window = 0.25 * static_cast<double>(cone.radius * cone.radius);
  const double xx = static_cast<double>(gaussian.xx) + window,
               xy = static_cast<double>(gaussian.xy),
               yy = static_cast<double>(gaussian.yy) + window, det = xx * yy - xy * xy;
  const glm::dvec2 m(gaussian.middle);
  const double squared = (yy * m.x * m.x - 2.0 * xy * m.x * m.y + xx * m.y * m.y) / det;
  const double depth_m = static_cast<double>(gaussian.near_m);
  return std::exp(-0.5 * squared) / (glm::two_pi<double>() * std::sqrt(det) * depth_m * depth_m);
}

struct Cone : ConeFrame {
  float cos_half, sin_half;

  Cone(const glm::dvec3& origin, const glm::dvec3& direction, double half_angle_rad)
      : ConeFrame(origin, direction, half_angle_rad),
        cos_half(static_cast<float>(std::cos(half_angle_rad))),
        sin_half(static_cast<float>(std::sin(half_angle_rad))) {}

  /// Nearest depth at which the sphere may meet the cone; absent if they do not meet.
  std::optional<float> nearestIn(const Sphere& sphere) const {
    if (sphere.radius < 0.0f) return std::nullopt;
    const glm::vec3 d(glm::dvec3(sphere.center) - origin_m);
    const float depth = glm::dot(d, z);
    const float aside = std::sqrt(std::max(glm::dot(d, d) - depth * depth, 0.0f));
    const bool apart =
        aside * cos_half - depth * sin_half > sphere.radius * 1.0001f || depth < -sphere.radius;
    if (apart) return std::nullopt;
    return depth - sphere.radius;
  }

  /// The share of the cone's cross-section that the surfel covers: its kernel, convolved with the
  /// cone's disc, at the cone's middle. The convolution is (1 - q)^n, see
  /// docs/formulas.md, section 3.
  std::optional<Share> shareOf(const SurfelCloud& cloud, std::size_t i) const {
    const glm::vec3 d(glm::dvec3(cloud.position_m[i]) - origin_m);
    const glm::vec3 &u = cloud.axis_u_m[i], &v = cloud.axis_v_m[i];
    const float depth = glm::dot(d, z);
    const float sigma = largestSigma(cloud, i);
    const float uz = glm::dot(u, z), vz = glm::dot(v, z);
    // At least one sigma, so that the noise of samples does not divide a surface seen head-on.
    const float half_range = std::max(kDepthReach * std::sqrt(uz * uz + vz * vz), sigma);
    if (!(depth - half_range >= kNearest_m)) return std::nullopt;

    const float inverse = 1.0f / depth;
    const glm::vec2 m(glm::dot(d, x) * inverse, glm::dot(d, y) * inverse);
    const auto toTangents = [&](const glm::vec3& axis, float along) {
      return (glm::vec2(glm::dot(axis, x), glm::dot(axis, y)) - m * along) * inverse;
    };
    const glm::vec2 a = toTangents(u, uz), b = toTangents(v, vz);
    const float area =
        std::abs(a.x * b.y - a.y * b.x) / (glm::length(u) * glm::length(v)) * cloud.area_m2[i];
    const float window = 0.25f * radius * radius;
    const float xx = a.x * a.x + b.x * b.x + window;
    const float yy = a.y * a.y + b.y * b.y + window;
    const float xy = a.x * a.y + b.x * b.y;
    const float det = xx * yy - xy * xy;
    const float mahalanobis = (yy * m.x * m.x - 2.0f * xy * m.x * m.y + xx * m.y * m.y) / det;
    const float t = (0.5f * (xx + yy) - window) / (4.0f * window);
    const float n = 24.0f * t * (1.0f + 2.0f * t);
    const float gauss = 1.0f / (glm::two_pi<float>() * std::sqrt(det));
    float kernel = 0.0f;
    if (n > 20.0f) {
      kernel = gauss * std::exp(-0.5f * mahalanobis);
    } else if (const float q = mahalanobis / (2.0f * (n + 2.0f)); q < 1.0f) {
      kernel = gauss * (n + 1.0f) / (n + 2.0f) * std::pow(1.0f - q, n);
    }
    const float opacity = opacityOf(cloud, i);
    return Share{depth, depth - half_range, depth + half_range,
                 static_cast<double>(opacity * area * kernel)};
  }
};

}  // namespace

/// A complete binary tree. Node k has the children 2k and 2k + 1; the root is 1. The nodes of the
/// last level, from `leaves` on, hold surfels.
class SurfaceQuery::Impl {
 public:
  virtual ~Impl() = default;
  /// @param met  gets what the cone meets, with shares that need not sum to one; null: not wanted
  virtual std::optional<double> distance(const Cone& cone, double needed,
                                         std::vector<SurfelShare>* met) const = 0;
  /// Adds what a hit tells of surfaces.
  virtual void addSurface(const glm::dvec3& direction, SurfaceHit& hit) const = 0;

 protected:
  explicit Impl(std::shared_ptr<const MomentTree> tree) : tree_(std::move(tree)) {
    if (tree_) leaves_ = tree_->nodes().size() / 2;
  }

  void buildNodes(const auto& cloud) {
    order_ = mortonOrder(cloud.position_m);
    leaves_ =
        std::bit_ceil(std::max<std::size_t>((order_.size() + kLeafSurfels - 1) / kLeafSurfels, 1));
    std::vector<Box> boxes(2 * leaves_);
    parallelFor(leaves_, [&](std::size_t leaf) {
      Box& box = boxes[leaves_ + leaf];
      const std::size_t end = std::min((leaf + 1) * kLeafSurfels, order_.size());
      for (std::size_t at = leaf * kLeafSurfels; at < end; ++at) {
        const glm::vec3 p = cloud.position_m[order_[at]];
        const glm::vec3 reach(kReach * largestSigma(cloud, order_[at]));
        box.add(p - reach, p + reach);
      }
    });
    for (std::size_t i = leaves_; i-- > 1;) {
      boxes[i].add(boxes[2 * i].low, boxes[2 * i].high);
      boxes[i].add(boxes[2 * i + 1].low, boxes[2 * i + 1].high);
    }
    nodes_.resize(boxes.size());
    parallelFor(boxes.size(), [&](std::size_t i) {
      const Box& box = boxes[i];
      if (box.low.x <= box.high.x) {
        nodes_[i] = {0.5f * (box.low + box.high), 0.5f * glm::length(box.high - box.low)};
      }
    });
  }

  Sphere sphereOf(std::size_t node) const {
    if (!tree_) return nodes_[node];
    const LodNode& of = tree_->nodes()[node];
    return {of.position_m, of.radius_m};
  }

  /// The surfels of a leaf, as places in `order_`, or by their numbers where the scene has a tree.
  std::pair<std::size_t, std::size_t> rangeOf(std::size_t node) const {
    if (tree_) return tree_->range(tree_->levels() - 1, node - leaves_);
    const std::size_t begin = (node - leaves_) * kLeafSurfels;
    return {begin, std::min(begin + kLeafSurfels, order_.size())};
  }

  /// Walks the tree in order of distance. `meet(i)` is what the cone meets of surfel i, beginning
  /// at `near_m`; absent if it is not in the cone. `take(visit, met)` sees every node and surfel on
  /// the way, with what `meet` has returned, null for a node. It stops the walk by false.
  template <typename Met, typename Meet, typename Take>
  void walk(const Cone& cone, const Meet& meet, const Take& take) const {
    thread_local std::vector<Visit> heap;
    thread_local std::vector<Met> met;
    heap.clear();
    met.clear();
    const auto push = [&](const Visit& visit) {
      heap.push_back(visit);
      std::push_heap(heap.begin(), heap.end(), std::greater<>());
    };
    const auto pushNode = [&](std::size_t node) {
      if (const auto near_m = cone.nearestIn(sphereOf(node))) {
        push({*near_m, static_cast<std::uint32_t>(node), kNode});
      }
    };
    pushNode(1);
    while (!heap.empty()) {
      std::pop_heap(heap.begin(), heap.end(), std::greater<>());
      const Visit visit = heap.back();
      heap.pop_back();
      const bool is_surfel = visit.met != kNode;
      if (!take(visit, is_surfel ? &met[visit.met] : nullptr)) return;
      if (is_surfel) continue;
      if (visit.id < leaves_) {
        pushNode(2 * std::size_t{visit.id});
        pushNode(2 * std::size_t{visit.id} + 1);
        continue;
      }
      const auto [begin, end] = rangeOf(visit.id);
      for (std::size_t at = begin; at < end; ++at) {
        const std::uint32_t i = tree_ ? static_cast<std::uint32_t>(at) : order_[at];
        if (const auto each = meet(i)) {
          push({each->near_m, i, static_cast<std::uint32_t>(met.size())});
          met.push_back(*each);
        }
      }
    }
  }

 private:
  std::shared_ptr<const MomentTree> tree_;  // null: `order_` and `nodes_` replace it
  std::vector<std::uint32_t> order_;
  std::size_t leaves_ = 1;
  std::vector<Sphere> nodes_;
};

namespace {

class SurfelQuery final : public SurfaceQuery::Impl {
 public:
  explicit SurfelQuery(const SurfelCloud& surfels) : Impl(builtTree(surfels)), cloud_(surfels) {
    if (!builtTree(surfels)) buildNodes(surfels);
  }

  /// The surfels of the surface are met, with their coverage.
  std::optional<double> distance(const Cone& cone, double needed,
                                 std::vector<SurfelShare>* surface) const override {
    // Surfels come in order of their near ends, so a layer is a running union of depth ranges.
    double covered = 0.0, vergence = 0.0;
    float layer_far_m = std::numeric_limits<float>::lowest();
    const auto meet = [&](std::size_t i) {
      auto share = cone.shareOf(cloud_, i);
      if (share && !(share->coverage > 0.0)) share.reset();
      return share;
    };
    walk<Share>(cone, meet, [&](const Visit& visit, const Share* share) {
      if (visit.near_m > layer_far_m) {
        if (covered >= needed) return false;
        covered = vergence = 0.0;
        if (surface) surface->clear();
        layer_far_m = std::numeric_limits<float>::max();
      }
      if (!share) return true;
      const bool opens = layer_far_m == std::numeric_limits<float>::max();
      layer_far_m = opens ? share->far_m : std::max(layer_far_m, share->far_m);
      covered += share->coverage;
      vergence += share->coverage / static_cast<double>(share->depth_m);
      if (surface) surface->push_back({visit.id, share->coverage});
      return true;
    });
    if (covered < needed) return std::nullopt;
    return covered / vergence;
  }

  void addSurface(const glm::dvec3& direction, SurfaceHit& hit) const override {
    glm::dvec3 normal(0.0);
    for (SurfelShare& each : hit.surfels) {
      each.per_m2 = each.share / static_cast<double>(cloud_.area_m2[each.surfel]);
      const glm::dvec3 own = glm::normalize(glm::cross(glm::dvec3(cloud_.axis_u_m[each.surfel]),
                                                       glm::dvec3(cloud_.axis_v_m[each.surfel])));
      normal += (glm::dot(own, direction) > 0.0 ? -each.share : each.share) * own;
    }
    if (normal != glm::dvec3(0.0)) hit.normal = glm::normalize(normal);
  }

 private:
  const SurfelCloud& cloud_;
};

class GaussianQuery final : public SurfaceQuery::Impl {
 public:
  explicit GaussianQuery(const GaussianCloud& gaussians) : Impl(nullptr), cloud_(gaussians) {
    buildNodes(gaussians);
  }

  /// Where the opacity of what lies in front reaches `needed`. The Gaussians up to full coverage
  /// are met, with what each adds to the opacity.
  std::optional<double> distance(const Cone& cone, double needed,
                                 std::vector<SurfelShare>* surface) const override {
    ConeOpacity opacity(cone.radius);
    std::optional<double> distance_m;
    double before = 0.0;
    const auto meet = [&](std::size_t i) { return gaussianInCone(cone, cloud_, i, kNearest_m); };
    walk<GaussianInCone>(cone, meet, [&](const Visit& visit, const GaussianInCone* gaussian) {
      if (!gaussian) return true;
      opacity.add(*gaussian);
      const double after = opacity.mean();
      if (surface && after > before) {
        surface->push_back({visit.id, after - before, outlinePer_m2(cone, *gaussian)});
      }
      before = after;
      if (!distance_m && after >= needed) distance_m = static_cast<double>(visit.near_m);
      return after < (surface ? kFullCoverage : needed);
    });
    return distance_m;
  }

  void addSurface(const glm::dvec3& /*direction*/, SurfaceHit& /*hit*/) const override {}

 private:
  const GaussianCloud& cloud_;
};

}  // namespace

SurfaceQuery::SurfaceQuery(const SurfelCloud& cloud)
    : impl_(std::make_unique<SurfelQuery>(cloud)) {}
SurfaceQuery::SurfaceQuery(const GaussianCloud& cloud)
    : impl_(std::make_unique<GaussianQuery>(cloud)) {}
SurfaceQuery::SurfaceQuery(const Scene& scene)
    : SurfaceQuery(
          std::visit([](const auto& cloud) { return SurfaceQuery(cloud); }, scene.splats)) {}
SurfaceQuery::~SurfaceQuery() = default;
SurfaceQuery::SurfaceQuery(SurfaceQuery&&) noexcept = default;
SurfaceQuery& SurfaceQuery::operator=(SurfaceQuery&&) noexcept = default;

std::optional<double> SurfaceQuery::distance(const glm::dvec3& origin_m,
                                             const glm::dvec3& direction, double half_angle_rad,
                                             double coverage) const {
  assert(half_angle_rad > 0.0 && half_angle_rad < glm::quarter_pi<double>());
  assert(coverage > 0.0 && coverage <= 1.0);
  const Cone cone(origin_m, direction, half_angle_rad);
  const double needed = std::min(coverage, kFullCoverage);
  return impl_->distance(cone, needed, nullptr);
}

std::optional<SurfaceHit> SurfaceQuery::hit(const glm::dvec3& origin_m, const glm::dvec3& direction,
                                            double half_angle_rad, double coverage) const {
  assert(half_angle_rad > 0.0 && half_angle_rad < glm::quarter_pi<double>());
  assert(coverage > 0.0 && coverage <= 1.0);
  const Cone cone(origin_m, direction, half_angle_rad);
  const double needed = std::min(coverage, kFullCoverage);
  SurfaceHit hit;
  const auto distance_m = impl_->distance(cone, needed, &hit.surfels);
  if (!distance_m) return std::nullopt;
  hit.distance_m = *distance_m;
  std::sort(hit.surfels.begin(), hit.surfels.end(),
            [](const SurfelShare& a, const SurfelShare& b) { return a.surfel < b.surfel; });
  double sum = 0.0;
  for (const SurfelShare& each : hit.surfels) sum += each.share;
  for (SurfelShare& each : hit.surfels) each.share /= sum;
  impl_->addSurface(direction, hit);
  return hit;
}

}  // namespace foci
