#include "render/scene/sampling/poisson_disk.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "base/random_bits.h"

namespace foci {
namespace {

constexpr std::size_t kRounds = 12;  // with a dart for each point that is wanted
/// The first round of each stage, whose darts are thrown at once.
constexpr std::array<std::size_t, 4> kStages = {0, 1, 3, kRounds};
constexpr int kRoundBit = 60;  // of a dart's order
static_assert(kRounds <= 1u << (64 - kRoundBit));
constexpr double kMostPoints = 3.0;   // times the points wanted; slivers would take all darts
constexpr float kFacingAway = -0.5f;  // cosine of normals
constexpr std::size_t kBlock = 1024;  // darts of a task
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Areas summed up to each triangle, itself included.
/// @param normals  null, or gets those of the triangles
std::vector<double> summedAreas(const std::vector<glm::vec3>& corners_m,
                                std::vector<glm::vec3>* normals = nullptr) {
  std::vector<double> sums(corners_m.size() / 3);
  if (normals != nullptr) normals->resize(sums.size());
  parallelFor(sums.size(), [&](std::size_t i) {
    const glm::dvec3 a = corners_m[3 * i], b = corners_m[3 * i + 1], c = corners_m[3 * i + 2];
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    sums[i] = 0.5 * glm::length(cross);
    if (normals != nullptr) (*normals)[i] = glm::vec3(glm::normalize(cross));
  });
  double sum = 0.0;
  for (double& upto : sums) upto = sum += upto;
  return sums;
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
  // Half of all points are turned into the triangle; a branch would be mispredicted.
  const double turned = weights.x + weights.y > 1.0 ? 1.0 : 0.0;
  return {std::abs(turned - weights.x), std::abs(turned - weights.y)};
}

struct Dart {
  glm::dvec3 p_m;
  glm::vec3 normal;
  MeshPoint point;
  std::uint64_t order;  ///< by round, then at random; the smallest one goes first
};

/// Darts by cells twice as wide as their smallest distance. Cubes of 4 x 4 x 4 cells share hashed
/// pages of lists, so that cells near each other are near in memory.
class Grid {
 public:
  Grid(std::size_t expected, double distance_m)
      : distance_m_(distance_m), heads_(std::bit_ceil(std::max(expected, kPage)), kNone) {
    entries_.reserve(expected);
  }

  /// Darts are numbered in the order in which they are added.
  void add(const Dart& dart) {
    std::uint32_t& head = heads_[slotOf(cellOf(placeOf(dart)))];
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
    for (int k = 0; k < 8; ++k) {                   // its own cell first
      const std::size_t slot =
          slotOf({(k & 1) != 0 ? other.x : cell.x, (k & 2) != 0 ? other.y : cell.y,
                  (k & 4) != 0 ? other.z : cell.z});
      for (std::uint32_t i = heads_[slot]; i != kNone; i = entries_[i].next) {
        if (isNear(dart, i) && body(i)) return true;
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
  static Cell cellOf(const glm::dvec3& place) {  // glm::floor is slow without SSE4.1
    const Cell towards_zero(place);
    return towards_zero - Cell(glm::lessThan(place, glm::dvec3(towards_zero)));
  }

  static constexpr std::size_t kPage = 64;  // lists

  std::size_t slotOf(const Cell& cell) const {
    const glm::vec<3, std::uint64_t> cube(cell >> std::int64_t{2}), in_cube(cell & std::int64_t{3});
    const std::uint64_t hash =
        (cube.x * 0xd6e8feb86659fd93 + cube.y * 0xa0761d6478bd642f + cube.z) * 0x9e3779b97f4a7c15;
    return ((hash >> 26) * kPage + in_cube.x + 4 * in_cube.y + 16 * in_cube.z) &
           (heads_.size() - 1);
  }

  double distance_m_;
  std::vector<std::uint32_t> heads_;
  std::vector<Entry> entries_;
};

/// Throws darts at the triangles: one a round at a random place of each equal share of the area.
class Thrower {
 public:
  explicit Thrower(const std::vector<glm::vec3>& corners_m)
      : corners_m_(corners_m), sums_m2_(summedAreas(corners_m, &normals_)) {}

  double area_m2() const { return sums_m2_.empty() ? 0.0 : sums_m2_.back(); }

  /// The darts of some rounds that meet no accepted one, in order of the triangles. Those of a
  /// share are tested together, because they meet the same accepted ones.
  /// @param accepted  those of the rounds before
  /// @param count     shares, the same in each round
  std::vector<Dart> freeDarts(const Grid& accepted, std::size_t from, std::size_t to,
                              std::size_t count) const {
    std::vector<std::vector<Dart>> blocks((count + kBlock - 1) / kBlock);
    parallelFor(blocks.size(), [&](std::size_t b) {
      const std::size_t first = b * kBlock, end = std::min(count, first + kBlock);
      const auto upTo_m2 = [&](std::size_t share, double jitter) {
        return (static_cast<double>(static_cast<std::int64_t>(share)) + jitter) /
               static_cast<double>(static_cast<std::int64_t>(count)) * area_m2();
      };
      auto low = std::upper_bound(sums_m2_.begin(), sums_m2_.end(), upTo_m2(first, 0.0));
      Corners corners;
      Met met = {kNone, kNone, kNone};
      std::array<Dart, kRounds> darts;  // of a share
      for (std::size_t k = first; k < end; ++k) {
        const auto numberOf = [&](std::uint64_t round) { return 2 * (round * count + k); };
        const double from_m2 = upTo_m2(k, 0.0);
        while (low != sums_m2_.end() && *low <= from_m2) ++low;
        // All are thrown before the first is tested: they do not wait for mispredicted tests.
        std::size_t thrown = 0;
        for (std::size_t round = from; round < to; ++round) {
          const auto jitter = static_cast<std::int64_t>(randomBits(numberOf(round) - 1) >> 11);
          const double at_m2 = upTo_m2(k, static_cast<double>(jitter) * 0x1p-53);
          auto triangle = low;
          while (triangle != sums_m2_.end() && *triangle <= at_m2) ++triangle;
          if (triangle == sums_m2_.end()) continue;  // by rounding
          const auto t = static_cast<std::uint32_t>(triangle - sums_m2_.begin());
          if (t != corners.triangle) corners = cornersOf(t);
          darts[thrown] = dartAt(corners, at_m2);
          darts[thrown++].order = round;
        }
        for (std::size_t i = 0; i < thrown; ++i) {
          Dart& dart = darts[i];
          if (meets(dart, accepted, met)) continue;
          const std::uint64_t at_random = randomBits(numberOf(dart.order)) >> (64 - kRoundBit);
          dart.order = dart.order << kRoundBit | at_random;
          blocks[b].push_back(dart);
        }
      }
    });
    std::vector<Dart> free;
    for (const auto& block : blocks) free.insert(free.end(), block.begin(), block.end());
    return free;
  }

 private:
  /// The accepted darts that the last ones met. Shares are small, and consecutive ones near each
  /// other, so the next dart mostly meets one of them, too.
  using Met = std::array<std::uint32_t, 3>;

  struct Corners {
    std::uint32_t triangle = kNone;
    glm::dvec3 a_m{0.0}, ab_m{0.0}, ac_m{0.0};
    glm::vec3 normal{0.0f};
    double before_m2 = 0.0, own_m2 = 0.0;  // areas
  };

  static bool meets(const Dart& dart, const Grid& accepted, Met& met) {
    for (const std::uint32_t i : met) {
      if (i != kNone && accepted.isNear(dart, i)) return true;
    }
    return accepted.anyNear(dart, [&](std::uint32_t i) {
      met = {i, met[0], met[1]};
      return true;
    });
  }

  Corners cornersOf(std::uint32_t triangle) const {
    const std::size_t first = 3 * std::size_t{triangle};
    const glm::dvec3 a = corners_m_[first], ab = glm::dvec3(corners_m_[first + 1]) - a,
                     ac = glm::dvec3(corners_m_[first + 2]) - a;
    const double before_m2 = triangle == 0 ? 0.0 : sums_m2_[triangle - 1];
    return {triangle, a, ab, ac, normals_[triangle], before_m2, sums_m2_[triangle] - before_m2};
  }

  static Dart dartAt(const Corners& corners, double at_m2) {
    const glm::dvec2 weights = weightsAt((at_m2 - corners.before_m2) / corners.own_m2);
    return {corners.a_m + weights.x * corners.ab_m + weights.y * corners.ac_m,
            corners.normal,
            {corners.triangle, glm::vec2(weights)},
            0};
  }

  const std::vector<glm::vec3>& corners_m_;
  std::vector<glm::vec3> normals_;  // of the triangles
  std::vector<double> sums_m2_;
};

/// Keeps the darts that dart throwing accepts if it takes them in their order: a dart is accepted
/// if no accepted one is too near. All darts that nobody open and near precedes are
/// decided at a time (Blelloch et al. 2012), in few turns.
void keepAccepted(std::vector<Dart>& darts, double distance_m) {
  Grid grid(darts.size(), distance_m);
  for (const Dart& dart : darts) grid.add(dart);
  // Near darts that precede each one, block by block.
  struct Preceding {
    std::vector<std::uint32_t> darts, end;
  };
  std::vector<Preceding> blocks((darts.size() + kBlock - 1) / kBlock);
  parallelFor(blocks.size(), [&](std::size_t b) {
    for (std::size_t i = b * kBlock; i < std::min(darts.size(), (b + 1) * kBlock); ++i) {
      grid.anyNear(darts[i], [&](std::uint32_t j) {
        if (darts[j].order < darts[i].order) blocks[b].darts.push_back(j);
        return false;
      });
      blocks[b].end.push_back(static_cast<std::uint32_t>(blocks[b].darts.size()));
    }
  });
  enum : std::uint8_t { open, accepted, rejected };
  std::vector<std::uint8_t> state(darts.size(), open);
  std::vector<std::uint32_t> left(darts.size());
  std::iota(left.begin(), left.end(), 0u);
  for (std::vector<std::uint8_t> next; !left.empty();) {
    next.assign(left.size(), accepted);
    parallelFor(left.size(), [&](std::size_t k) {
      const Preceding& block = blocks[left[k] / kBlock];
      const std::size_t in_block = left[k] % kBlock;
      for (std::size_t n = in_block == 0 ? 0 : block.end[in_block - 1]; n < block.end[in_block];
           ++n) {
        const std::uint8_t other = state[block.darts[n]];
        if (other == accepted) next[k] = rejected;
        if (other == open && next[k] == accepted) next[k] = open;
      }
    });
    for (std::size_t k = 0; k < left.size(); ++k) state[left[k]] = next[k];
    std::erase_if(left, [&](std::uint32_t i) { return state[i] != open; });
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < darts.size(); ++i) {
    if (state[i] == accepted) darts[kept++] = darts[i];
  }
  darts.resize(kept);
}

}  // namespace

double areaOf_m2(const std::vector<glm::vec3>& corners_m) {
  const std::vector<double> sums = summedAreas(corners_m);
  return sums.empty() ? 0.0 : sums.back();
}

std::vector<MeshPoint> poissonDisk(const std::vector<glm::vec3>& corners_m, double spacing_m) {
  assert(spacing_m > 0.0);
  const Thrower thrower(corners_m);
  if (!(thrower.area_m2() > 0.0)) return {};
  const double wanted = std::ceil(thrower.area_m2() / (spacing_m * spacing_m));
  assert(wanted <= 1e8);

  const auto count = static_cast<std::size_t>(wanted);
  const double distance_m = kPoissonDistance * spacing_m;
  Grid grid(count, distance_m);
  std::vector<MeshPoint> points;
  for (std::size_t stage = 0; stage + 1 < kStages.size(); ++stage) {
    std::vector<Dart> darts = thrower.freeDarts(grid, kStages[stage], kStages[stage + 1], count);
    keepAccepted(darts, distance_m);
    for (const Dart& dart : darts) grid.add(dart);
    parallelSort(darts.begin(), darts.end(),
                 [](const Dart& a, const Dart& b) { return a.order < b.order; });
    for (const Dart& dart : darts) {
      if (static_cast<double>(points.size()) >= kMostPoints * wanted) return points;
      points.push_back(dart.point);
    }
  }
  return points;
}

}  // namespace foci
