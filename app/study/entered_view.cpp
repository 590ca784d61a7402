#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <vector>

#include "app/study/framing.h"
#include "base/quantile.h"

namespace foci {
namespace {

// Chosen by hand on synthetic rooms, streets and hills (tests/unit/app/study).
constexpr double kLeastLength_m = 4.0, kLeastWidth_m = 2.0;  // of what can be entered
constexpr std::size_t kLeastPoints = 1000;
constexpr double kLeastCell_m = 0.25;
constexpr int kMostCells = 400, kMostLayers = 200;  // across, and in height
constexpr std::size_t kMostPlaces = 5000;           // that are looked at
constexpr double kHead_m = 2.0, kKnee_m = 0.7;      // a body is free between them
constexpr double kElbows_m = 0.6;                   // and this far aside
constexpr double kCoarsest_m = 0.5 * kElbows_m;     // between points that tell where a body fits
constexpr double kStep_m = 0.4;                     // the highest that one stands on
constexpr int kTurns = 32;                          // directions around
constexpr std::array kTilts_deg = {-20.0, -10.0, 0.0, 10.0};
constexpr std::size_t kDown = 0, kLevel = 2;  // of the tilts
constexpr double kAroundBelow = 0.7;          // share of lines downwards that must meet something
constexpr double kAroundAll = 0.5;            // the same of all lines
constexpr int kInView = 2;                    // turns to each side that are in view, 22 degrees
constexpr double kNear_m = 3.0, kInTheWay_m = 0.6;
constexpr double kFarEnough_m = 40.0;  // beyond, a longer line shows no more

/// Which cells of a grid hold points. x and y are level, z is upwards, in metres from the box's
/// low corner.
class Cells {
 public:
  Cells(std::span<const glm::vec3> points, const SceneBox& box, const UpAxis& up, double unit_m)
      : axis_(up.axis), sign_(up.negative ? -1.0 : 1.0), unit_m_(unit_m) {
    const glm::dvec3 a = turned(box.low), b = turned(box.high);
    low_ = glm::min(a, b);
    size_m_ = glm::abs(b - a);
    const double spacing_m = std::sqrt(size_m_.x * size_m_.y / static_cast<double>(points.size()));
    const double longest_m = std::max(size_m_.x, size_m_.y);
    cell_m_ = glm::dvec3(std::max({kLeastCell_m, 2.0 * spacing_m, longest_m / kMostCells}));
    cell_m_.z = std::max(kLeastCell_m, size_m_.z / kMostLayers);
    count_ = glm::ivec3(size_m_ / cell_m_) + 1;
    held_.assign(static_cast<std::size_t>(count_.x) * static_cast<std::size_t>(count_.y) *
                     static_cast<std::size_t>(count_.z),
                 false);
    ground_m_.assign(static_cast<std::size_t>(count_.x) * static_cast<std::size_t>(count_.y),
                     std::numeric_limits<float>::infinity());
    for (const glm::vec3& point : points) {
      const glm::dvec3 p = turned(glm::dvec3(point)) - low_;
      const glm::ivec3 at = cellOf(p);
      if (!isInside(at)) continue;
      held_[indexOf(at)] = true;
      ++points_;
      float& ground = ground_m_[columnOf(at)];
      ground = std::min(ground, static_cast<float>(p.z));
    }
  }

  const glm::dvec3& size_m() const { return size_m_; }

  /// Distance of the points as seen from above.
  double spacing_m() const {
    const auto columns = std::ranges::count_if(ground_m_, [](float z) { return std::isfinite(z); });
    return cell_m_.x * std::sqrt(static_cast<double>(columns) / static_cast<double>(points_));
  }
  glm::ivec3 count() const { return count_; }
  glm::dvec3 middleOf(int x, int y) const {
    return {(x + 0.5) * cell_m_.x, (y + 0.5) * cell_m_.y, 0.0};
  }
  float ground_m(int x, int y) const { return ground_m_[columnOf({x, y, 0})]; }
  int cellsIn(double length_m) const { return static_cast<int>(std::lround(length_m / cell_m_.x)); }

  /// The ground around a column: what a tenth of the columns within 3 m are not above.
  double floorAround_m(int x, int y) const {
    const int reach = std::max(1, cellsIn(3.0));
    std::vector<float> heights;
    for (int j = std::max(0, y - reach); j <= std::min(count_.y - 1, y + reach); ++j) {
      for (int i = std::max(0, x - reach); i <= std::min(count_.x - 1, x + reach); ++i) {
        if (std::isfinite(ground_m(i, j))) heights.push_back(ground_m(i, j));
      }
    }
    return double{quantile(heights, 0.1)};
  }

  bool isHeldAt(const glm::dvec3& p) const {
    const glm::ivec3 at = cellOf(p);
    return isInside(at) && held_[indexOf(at)];
  }

  /// Length of a line up to the first cell with points; absent if it leaves the grid.
  std::optional<double> freeAlong_m(const glm::dvec3& from, const glm::dvec3& direction) const {
    const double step_m = 0.5 * std::min(cell_m_.x, cell_m_.z);
    for (double s = step_m;; s += step_m) {
      const glm::ivec3 at = cellOf(from + s * direction);
      if (!isInside(at)) return std::nullopt;
      if (held_[indexOf(at)]) return s;
    }
  }

  /// Length of a line up to the border of the grid.
  double lengthWithin_m(const glm::dvec3& from, const glm::dvec3& direction) const {
    double length_m = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 2; ++axis) {
      if (direction[axis] == 0.0) continue;
      const double end = direction[axis] > 0.0 ? size_m_[axis] : 0.0;
      length_m = std::min(length_m, (end - from[axis]) / direction[axis]);
    }
    return length_m;
  }

  /// Back to the units and axes of the file.
  glm::dvec3 inFile(const glm::dvec3& p) const {
    const glm::dvec3 q = (p + low_) / unit_m_;
    glm::dvec3 out(0.0);
    out[axis_] = sign_ * q.z;
    out[(axis_ + 1) % 3] = q.x;
    out[(axis_ + 2) % 3] = q.y;
    return out;
  }

 private:
  glm::dvec3 turned(const glm::dvec3& p) const {
    return unit_m_ * glm::dvec3(p[(axis_ + 1) % 3], p[(axis_ + 2) % 3], sign_ * p[axis_]);
  }
  glm::ivec3 cellOf(const glm::dvec3& p) const { return {glm::floor(p / cell_m_)}; }
  bool isInside(const glm::ivec3& at) const {
    return glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) &&
           glm::all(glm::lessThan(at, count_));
  }
  std::size_t columnOf(const glm::ivec3& at) const {
    return static_cast<std::size_t>(at.y) * static_cast<std::size_t>(count_.x) +
           static_cast<std::size_t>(at.x);
  }
  std::size_t indexOf(const glm::ivec3& at) const {
    return columnOf(at) * static_cast<std::size_t>(count_.z) + static_cast<std::size_t>(at.z);
  }

  int axis_;
  double sign_, unit_m_;
  glm::dvec3 low_{0.0}, size_m_{0.0}, cell_m_{1.0};
  glm::ivec3 count_{1};
  std::vector<bool> held_;
  std::size_t points_ = 0;       // in cells
  std::vector<float> ground_m_;  // of each column
};

/// Whether a body may stand there, on this floor.
bool isFree(const Cells& cells, int x, int y, double floor_m) {
  if (std::abs(double{cells.ground_m(x, y)} - floor_m) > kStep_m) return false;
  const int reach = cells.cellsIn(kElbows_m);
  for (int j = y - reach; j <= y + reach; ++j) {
    for (int i = x - reach; i <= x + reach; ++i) {
      glm::dvec3 p = cells.middleOf(i, j);
      for (p.z = floor_m + kKnee_m; p.z <= floor_m + kHead_m; p.z += 0.5 * kLeastCell_m) {
        if (cells.isHeldAt(p)) return false;
      }
    }
  }
  return true;
}

/// What lines around the eye meet: by tilt and turn.
using Sights = std::array<std::array<std::optional<double>, kTurns>, kTilts_deg.size()>;

glm::dvec3 directionOf(int turn, double tilt_deg) {
  const double angle = 2.0 * glm::pi<double>() * turn / kTurns, tilt = glm::radians(tilt_deg);
  return {std::cos(tilt) * std::cos(angle), std::cos(tilt) * std::sin(angle), std::sin(tilt)};
}

bool isAround(const Sights& sights) {
  const auto met = [](const auto& turns) {
    return static_cast<double>(
        std::ranges::count_if(turns, [](const auto& s) { return s.has_value(); }));
  };
  double all = 0.0;
  for (const auto& turns : sights) all += met(turns);
  return met(sights[kDown]) >= kAroundBelow * kTurns &&
         all >= kAroundAll * kTurns * static_cast<double>(kTilts_deg.size());
}

/// The nearest thing that an eye sees that looks in this direction.
double nearestInView_m(const Sights& sights, int turn) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t tilt = kDown + 1; tilt < kTilts_deg.size(); ++tilt) {
    for (int aside = -kInView; aside <= kInView; ++aside) {
      const auto& met = sights[tilt][static_cast<std::size_t>((turn + aside + kTurns) % kTurns)];
      if (met) nearest_m = std::min(nearest_m, *met);
    }
  }
  return nearest_m;
}

}  // namespace

std::optional<StandingEye> standIn(std::span<const glm::vec3> points, const SceneBox& box,
                                   const UpAxis& up, double unit_m, double share) {
  if (points.size() < kLeastPoints) return std::nullopt;
  const Cells cells(points, box, up, unit_m);
  const glm::dvec3& size_m = cells.size_m();
  if (std::max(size_m.x, size_m.y) < kLeastLength_m ||
      std::min(size_m.x, size_m.y) < kLeastWidth_m ||
      std::sqrt(share) * cells.spacing_m() > kCoarsest_m) {
    return std::nullopt;
  }
  const glm::ivec3 count = cells.count();
  const std::size_t columns = static_cast<std::size_t>(count.x) * static_cast<std::size_t>(count.y);
  const std::size_t stride = columns / kMostPlaces + 1;
  std::optional<StandingEye> best;
  double best_score = 0.0;
  for (std::size_t column = stride / 2; column < columns; column += stride) {
    const int x = static_cast<int>(column) % count.x, y = static_cast<int>(column) / count.x;
    if (!std::isfinite(cells.ground_m(x, y))) continue;
    const double floor_m = cells.floorAround_m(x, y);
    if (!isFree(cells, x, y, floor_m)) continue;
    glm::dvec3 eye = cells.middleOf(x, y);
    eye.z = floor_m + kStandingEye_m;
    Sights sights;
    for (std::size_t tilt = 0; tilt < kTilts_deg.size(); ++tilt) {
      for (int turn = 0; turn < kTurns; ++turn) {
        sights[tilt][static_cast<std::size_t>(turn)] =
            cells.freeAlong_m(eye, directionOf(turn, kTilts_deg[tilt]));
      }
    }
    if (!isAround(sights)) continue;
    for (int turn = 0; turn < kTurns; ++turn) {
      const glm::dvec3 direction = directionOf(turn, 0.0);
      const double free_m = sights[kLevel][static_cast<std::size_t>(turn)].value_or(
          cells.lengthWithin_m(eye, direction));
      const double nearest_m = nearestInView_m(sights, turn);
      if (nearest_m < kInTheWay_m) continue;
      const double score = std::min(free_m, kFarEnough_m) * std::min(1.0, kNear_m / nearest_m);
      if (score <= best_score) continue;
      best_score = score;
      best = {.position = cells.inFile(eye),
              .look_at = cells.inFile(eye + std::min(free_m, kFarEnough_m) * direction),
              .free_m = free_m,
              .nearest_m = nearest_m};
    }
  }
  return best;
}

}  // namespace foci
