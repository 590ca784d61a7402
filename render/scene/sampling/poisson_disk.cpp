#include "render/scene/sampling/poisson_disk.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/parallel.h"
#include "base/parallel_sort.h"

namespace foci {
namespace {

constexpr std::size_t kRounds = 12;   // with a dart for each point that is wanted
constexpr double kMostPoints = 3.0;   // times the points wanted; slivers would take all darts
constexpr float kFacingAway = -0.5f;  // cosine of normals
constexpr std::size_t kBlock = 1024;  // darts of a task
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

glm::dvec3 crossOf(const std::vector<glm::vec3>& corners_m, std::size_t triangle) {
  const glm::dvec3 a = corners_m[3 * triangle], b = corners_m[3 * triangle + 1],
                   c = corners_m[3 * triangle + 2];
  return glm::cross(b - a, c - a);
}

/// Areas summed up to each triangle, itself included.
std::vector<double> summedAreas(const std::vector<glm::vec3>& corners_m) {
  std::vector<double> sums(corners_m.size() / 3);
  parallelFor(sums.size(),
              [&](std::size_t i) { sums[i] = 0.5 * glm::length(crossOf(corners_m, i)); });
  double sum = 0.0;
  for (double& upto : sums) upto = sum += upto;
  return sums;
}

/// Random bits of a counter: SplitMix64 (Steele et al. 2014).
std::uint64_t randomBits(std::uint64_t counter) {
  std::uint64_t bits = counter * 0x9e3779b97f4a7c15;
  bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9;
  bits = (bits ^ bits >> 27) * 0x94d049bb133111eb;
  return bits ^ bits >> 31;
}

/// Every second bit, the lowest one first.
std::uint32_t everySecondBit(std::uint64_t x) {
  x &= 0x5555555555555555;
  x = (x | x >> 1) & 0x3333333333333333;
  x = (x | x >> 2) & 0x0f0f0f0f0f0f0f0f;
  x = (x | x >> 4) & 0x00ff00ff00ff00ff;
  x = (x | x >> 8) & 0x0000ffff0000ffff;
  return static_cast<std::uint32_t>(x | x >> 16);
}

/// Weights of the place at a share of a triangle's area, 0 to 1, along a Morton curve: consecutive
/// shares are near each other.
glm::dvec2 weightsAt(double share) {
  constexpr double kSteps = 0x1p52;  // 26 bits for each weight
  const auto code = static_cast<std::uint64_t>(std::clamp(share, 0.0, 1.0 - 0x1p-52) * kSteps);
  const glm::dvec2 weights =
      (glm::dvec2(everySecondBit(code), everySecondBit(code >> 1)) + 0.5) * 0x1p-26;
  return weights.x + weights.y > 1.0 ? 1.0 - weights : weights;
}

struct Dart {
  glm::dvec3 p_m;
  glm::vec3 normal;
  MeshPoint point;
  std::uint64_t priority;  ///< the smallest one goes first
};

/// Darts by cells twice as wide as their smallest distance. Cells share hashed lists.
class Grid {
 public:
  Grid(std::size_t expected, double distance_m)
      : distance_m_(distance_m), heads_(std::bit_ceil(expected), kNone) {
    entries_.reserve(expected);
  }

  /// Darts are numbered in the order in which they are added.
  void add(const Dart& dart) {
    const Cell cell = cellOf(placeOf(dart));
    std::uint32_t& head = heads_[slotOf(cell.x, rowOf(cell.y, cell.z))];
    entries_.push_back({dart.p_m, dart.normal, head});
    head = static_cast<std::uint32_t>(entries_.size() - 1);
  }

  /// Whether the dart with this number is too near to `dart`.
  bool isNear(const Dart& dart, std::uint32_t number) const {
    const Entry& entry = entries_[number];
    const glm::dvec3 d = entry.p_m - dart.p_m;
    return glm::dot(d, d) < distance_m_ * distance_m_ &&
           glm::dot(entry.normal, dart.normal) > kFacingAway;
  }

  /// Calls `body(number)` for the darts that are too near to `dart`, until it returns true.
  /// @return whether it did
  template <typename Body>
  bool anyNear(const Dart& dart, const Body& body) const {
    if (entries_.empty()) return false;
    const glm::dvec3 place = placeOf(dart);
    const Cell cell = cellOf(place), low = cellOf(place - 0.5);
    const Cell other = low + low + Cell(1) - cell;  // the neighbour in reach, on each axis
    for (int k = 0; k < 4; ++k) {                   // its own row first
      const std::uint64_t row =
          rowOf((k & 1) != 0 ? other.y : cell.y, (k & 2) != 0 ? other.z : cell.z);
      for (const std::int64_t x : {cell.x, other.x}) {
        for (std::uint32_t i = heads_[slotOf(x, row)]; i != kNone; i = entries_[i].next) {
          if (isNear(dart, i) && body(i)) return true;
        }
      }
    }
    return false;
  }

 private:
  using Cell = glm::vec<3, std::int64_t>;
  struct Entry {
    glm::dvec3 p_m;
    glm::vec3 normal;
    std::uint32_t next;
  };

  glm::dvec3 placeOf(const Dart& dart) const { return dart.p_m * (0.5 / distance_m_); }
  static Cell cellOf(const glm::dvec3& place) { return Cell(glm::floor(place)); }

  static std::uint64_t rowOf(std::int64_t y, std::int64_t z) {
    return randomBits(static_cast<std::uint64_t>(y) * 0xd6e8feb86659fd93 +
                      static_cast<std::uint64_t>(z));
  }
  /// Neighbours along x have neighbouring slots.
  std::size_t slotOf(std::int64_t x, std::uint64_t row) const {
    return (row + static_cast<std::uint64_t>(x)) & (heads_.size() - 1);
  }

  double distance_m_;
  std::vector<std::uint32_t> heads_;
  std::vector<Entry> entries_;
};

/// Throws darts at the triangles: one a round at a random place of each equal share of the area.
class Thrower {
 public:
  explicit Thrower(const std::vector<glm::vec3>& corners_m)
      : corners_m_(corners_m), sums_m2_(summedAreas(corners_m)) {}

  double area_m2() const { return sums_m2_.empty() ? 0.0 : sums_m2_.back(); }

  /// The darts of a round that meet no accepted one, in order of the triangles.
  /// @param accepted  those of the rounds before, and more
  /// @param count     shares, the same in each round
  std::vector<Dart> freeDarts(const Grid& accepted, std::size_t round, std::size_t count) {
    met_.resize(count, {kNone, kNone});
    std::vector<std::vector<Dart>> blocks((count + kBlock - 1) / kBlock);
    parallelFor(blocks.size(), [&](std::size_t b) {
      const std::size_t end = std::min(count, (b + 1) * kBlock);
      auto triangle = sums_m2_.end();
      for (std::size_t k = b * kBlock; k < end; ++k) {
        const std::uint64_t number = 2 * (std::uint64_t{round} * count + k);
        const double jitter = static_cast<double>(randomBits(number) >> 11) * 0x1p-53;
        const double at_m2 =
            (static_cast<double>(k) + jitter) / static_cast<double>(count) * area_m2();
        if (k == b * kBlock) triangle = std::upper_bound(sums_m2_.begin(), sums_m2_.end(), at_m2);
        while (triangle != sums_m2_.end() && *triangle <= at_m2) ++triangle;
        if (triangle == sums_m2_.end()) break;  // by rounding
        Dart dart = dartAt(static_cast<std::size_t>(triangle - sums_m2_.begin()), at_m2);
        if (meets(dart, accepted, met_[k])) continue;
        dart.priority = randomBits(number + 1);
        blocks[b].push_back(dart);
      }
    });
    std::size_t total = 0;
    for (const auto& block : blocks) total += block.size();
    std::vector<Dart> darts;
    darts.reserve(total);
    for (const auto& block : blocks) darts.insert(darts.end(), block.begin(), block.end());
    return darts;
  }

 private:
  /// The accepted darts that a share's last ones met. A share is small, so its next dart mostly
  /// meets one of them, too.
  using Met = std::array<std::uint32_t, 2>;

  static bool meets(const Dart& dart, const Grid& accepted, Met& met) {
    for (const std::uint32_t i : met) {
      if (i != kNone && accepted.isNear(dart, i)) return true;
    }
    return accepted.anyNear(dart, [&](std::uint32_t i) {
      met = {i, met[0]};
      return true;
    });
  }

  Dart dartAt(std::size_t triangle, double at_m2) const {
    const double before_m2 = triangle == 0 ? 0.0 : sums_m2_[triangle - 1];
    const glm::dvec2 weights = weightsAt((at_m2 - before_m2) / (sums_m2_[triangle] - before_m2));
    const glm::dvec3 a = corners_m_[3 * triangle];
    const glm::dvec3 ab = glm::dvec3(corners_m_[3 * triangle + 1]) - a;
    const glm::dvec3 ac = glm::dvec3(corners_m_[3 * triangle + 2]) - a;
    return {a + weights.x * ab + weights.y * ac,
            glm::vec3(glm::normalize(glm::cross(ab, ac))),
            {static_cast<std::uint32_t>(triangle), glm::vec2(weights)},
            0};
  }

  const std::vector<glm::vec3>& corners_m_;
  std::vector<double> sums_m2_;
  std::vector<Met> met_;  ///< by share
};

/// The darts that dart throwing accepts if it takes them by their priority: a dart is accepted if
/// no accepted one is too near. All darts that nobody near precedes are accepted at a time
/// (Blelloch et al. 2012), in few turns.
std::vector<Dart> acceptedOf(const std::vector<Dart>& darts, double distance_m) {
  Grid grid(darts.size(), distance_m);
  for (const Dart& dart : darts) grid.add(dart);
  std::vector<std::uint8_t> accepted(darts.size(), 0), rejected(darts.size(), 0);
  std::vector<std::uint32_t> open(darts.size());
  std::iota(open.begin(), open.end(), 0u);
  while (!open.empty()) {
    parallelFor(open.size(), [&](std::size_t k) {
      const std::uint32_t i = open[k];
      accepted[i] = !grid.anyNear(darts[i], [&](std::uint32_t j) {
        return rejected[j] == 0 && darts[j].priority < darts[i].priority;
      });
    });
    parallelFor(open.size(), [&](std::size_t k) {
      const std::uint32_t i = open[k];
      if (accepted[i] == 0) return;
      grid.anyNear(darts[i], [&](std::uint32_t j) {
        if (j != i) std::atomic_ref(rejected[j]).store(1, std::memory_order_relaxed);
        return false;
      });
    });
    std::erase_if(open, [&](std::uint32_t i) { return (accepted[i] | rejected[i]) != 0; });
  }
  std::vector<Dart> kept;
  for (std::size_t i = 0; i < darts.size(); ++i) {
    if (accepted[i] != 0) kept.push_back(darts[i]);
  }
  return kept;
}

}  // namespace

double areaOf_m2(const std::vector<glm::vec3>& corners_m) {
  const std::vector<double> sums = summedAreas(corners_m);
  return sums.empty() ? 0.0 : sums.back();
}

std::vector<MeshPoint> poissonDisk(const std::vector<glm::vec3>& corners_m, double spacing_m) {
  assert(spacing_m > 0.0);
  Thrower thrower(corners_m);
  if (!(thrower.area_m2() > 0.0)) return {};
  const double wanted = std::ceil(thrower.area_m2() / (spacing_m * spacing_m));
  assert(wanted <= 1e8);

  const auto count = static_cast<std::size_t>(wanted);
  const double distance_m = kPoissonDistance * spacing_m;
  Grid grid(count, distance_m);
  std::vector<MeshPoint> points;
  for (std::size_t round = 0; round < kRounds; ++round) {
    std::vector<Dart> darts = acceptedOf(thrower.freeDarts(grid, round, count), distance_m);
    for (const Dart& dart : darts) grid.add(dart);
    parallelSort(darts.begin(), darts.end(),
                 [](const Dart& a, const Dart& b) { return a.priority < b.priority; });
    for (const Dart& dart : darts) {
      if (static_cast<double>(points.size()) >= kMostPoints * wanted) return points;
      points.push_back(dart.point);
    }
  }
  return points;
}

}  // namespace foci
