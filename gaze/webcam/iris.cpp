// The constants were chosen by hand. The tests bound them: on rendered faces with known truth, they
// count the irises found within 5 % of the interpupillary distance (iris_test.cpp,
// webcam_tracker_test.cpp).
#include "gaze/webcam/iris.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace foci {
namespace {

// Coarse search.
constexpr double kCoarseRadius_px = 6.0;  // larger irises are searched for in a smaller image
constexpr double kBandInner = 0.7, kBandOuter = 1.35;  // band of edges around a centre, radii

// Fit.
constexpr double kRowsAbove = 0.45, kRowsBelow = 0.65;  // rows of the fit, radii from the centre
constexpr double kRingInner = 0.55, kRingOuter = 1.6;   // ring of the fit, radii
constexpr double kRadiusSd = 0.08;                      // prior of the radius, as a share of it
constexpr double kSlopeSd = 0.25;                       // prior of the shading: even
constexpr double kMinContrast = 6.0;                    // grey levels
constexpr int kMaxRounds = 8;

struct Edge {
  float x, y, gx, gy, weight;  // place, unit gradient
};

/// The stronger half of the gradients, those above the mean. The weight grows with the strength, up
/// to four times the mean.
std::vector<Edge> strongEdgesOf(const cv::Mat& part) {
  cv::Mat smooth, dx, dy, strength;
  cv::GaussianBlur(part, smooth, {3, 3}, 0.8, 0.8, cv::BORDER_REPLICATE);
  cv::Sobel(smooth, dx, CV_32F, 1, 0, 3, 1.0, 0.0, cv::BORDER_REPLICATE);
  cv::Sobel(smooth, dy, CV_32F, 0, 1, 3, 1.0, 0.0, cv::BORDER_REPLICATE);
  cv::magnitude(dx, dy, strength);
  const auto mean = static_cast<float>(cv::mean(strength)[0]);
  std::vector<Edge> edges;
  for (int y = 1; y + 1 < part.rows; ++y) {
    for (int x = 1; x + 1 < part.cols; ++x) {
      const float m = strength.at<float>(y, x);
      if (m < mean) continue;
      edges.push_back({static_cast<float>(x), static_cast<float>(y), dx.at<float>(y, x) / m,
                       dy.at<float>(y, x) / m, std::min(m / mean, 4.0f)});
    }
  }
  return edges;
}

/// Each edge votes for the centres that it may belong to.
cv::Mat1f votesOf(const std::vector<Edge>& edges, const cv::Size& size, float radius) {
  cv::Mat1f votes(size.height, size.width, 0.0f);
  const float near2 = static_cast<float>(kBandInner * kBandInner) * radius * radius;
  const float far2 = static_cast<float>(kBandOuter * kBandOuter) * radius * radius;
  const int reach = cvCeil(kBandOuter * static_cast<double>(radius));
  for (const Edge& e : edges) {
    const int x0 = std::max(0, static_cast<int>(e.x) - reach);
    const int x1 = std::min(size.width - 1, static_cast<int>(e.x) + reach);
    const int y0 = std::max(0, static_cast<int>(e.y) - reach);
    const int y1 = std::min(size.height - 1, static_cast<int>(e.y) + reach);
    for (int y = y0; y <= y1; ++y) {
      float* row = votes[y];
      const float vy = e.y - static_cast<float>(y);
      for (int x = x0; x <= x1; ++x) {
        const float vx = e.x - static_cast<float>(x);
        const float d2 = vx * vx + vy * vy;
        if (d2 < near2 || d2 > far2) continue;
        const float along = vx * e.gx + vy * e.gy;
        if (along <= 0.0f) continue;
        const float lateral = 0.3f + 0.7f * vx * vx / d2;
        row[x] += e.weight * lateral * along * along / d2;
      }
    }
  }
  return votes;
}

/// Votes, weighted by the darkness of the centre and by the distance from the expected place.
/// @param start  expected place, pixels of `part`
/// @param reach  size of the search region, pixels of `part` times `shrink`
cv::Mat1f scoreOf(const cv::Mat& part, const cv::Mat1f& votes, float radius,
                  const glm::dvec2& start, const glm::dvec2& reach, double shrink) {
  cv::Mat dark;
  cv::GaussianBlur(part, dark, {5, 5}, 0.35 * static_cast<double>(radius), 0.0,
                   cv::BORDER_REPLICATE);
  double darkest = 0.0, brightest = 255.0;
  cv::minMaxLoc(dark, &darkest, &brightest);
  const float range = std::max(1.0f, static_cast<float>(brightest - darkest));
  cv::Mat1f score(part.rows, part.cols, 0.0f);
  for (int y = 0; y < part.rows; ++y) {
    for (int x = 0; x < part.cols; ++x) {
      const glm::dvec2 off = glm::abs(glm::dvec2(x, y) - start) * shrink / (reach + 1e-9);
      if (off.x > 1.0 || off.y > 1.0) continue;
      const float darkness =
          (static_cast<float>(brightest) - static_cast<float>(dark.at<unsigned char>(y, x))) /
          range;
      score(y, x) = votes(y, x) * (0.15f + darkness) *
                    (1.0f - 0.35f * static_cast<float>(0.5 * glm::dot(off, off)));
    }
  }
  return score;
}

/// The fit of `refineIris` by Gauss and Newton. Pixel (i, j) has its centre at i, j here.
class IrisFit {
 public:
  IrisFit(const cv::Mat& grey, const glm::dvec2& near_px, double radius_px)
      : grey_(grey),
        start_(near_px - 0.5),
        start_radius_(radius_px),
        softness_(0.35 + 0.12 * radius_px) {
    p_[cx] = start_.x;
    p_[cy] = start_.y;
    p_[radius] = radius_px;
  }

  std::optional<Iris> fit() {
    const double reach = kRingOuter * 1.2 * start_radius_ + 1.0;
    if (isOutside(p_[cx] - reach, p_[cy] - reach) || isOutside(p_[cx] + reach, p_[cy] + reach)) {
      return std::nullopt;
    }
    for (int round = 0; round < kMaxRounds; ++round) {
      if (!placeBox()) return std::nullopt;
      if (round == 0) guessLevels();
      gather(round < 2 ? 1e9 : 2.5 * spread_);
      if (total_ < 12.0) return std::nullopt;
      spread_ = std::max(1.0, std::sqrt(residual2_ / total_));
      addPriors();
      const auto moved = step();
      if (!moved) return std::nullopt;
      if (round >= 3 && *moved < 0.003) break;
    }
    return result();
  }

 private:
  enum Unknown : int { cx, cy, radius, in, left, right, slope, kUnknowns };
  using Vector = cv::Vec<double, kUnknowns>;
  using Matrix = cv::Matx<double, kUnknowns, kUnknowns>;

  bool isOutside(double x, double y) const {
    return x < 1.0 || y < 1.0 || x > grey_.cols - 2.0 || y > grey_.rows - 2.0;
  }

  /// The pixels that the fit uses, around the present centre. False if they leave the image.
  bool placeBox() {
    x0_ = cvFloor(p_[cx] - kRingOuter * p_[radius]);
    x1_ = cvCeil(p_[cx] + kRingOuter * p_[radius]);
    y0_ = cvCeil(p_[cy] - kRowsAbove * p_[radius]);
    y1_ = cvFloor(p_[cy] + kRowsBelow * p_[radius]);
    return !isOutside(x0_, y0_) && !isOutside(x1_, y1_);
  }

  /// First guess of the grey levels: means inside, left and right of the disk.
  void guessLevels() {
    std::array<double, 3> sum{}, count{};
    for (int y = y0_; y <= y1_; ++y) {
      const auto* row = grey_.ptr<unsigned char>(y);
      for (int x = x0_; x <= x1_; ++x) {
        const double rho = std::hypot(x - p_[cx], y - p_[cy]) / p_[radius];
        const std::size_t which = rho < 0.9 ? 0 : x < p_[cx] ? 1 : 2;
        if (rho > 0.9 && rho < 1.1) continue;
        sum[which] += row[x];
        ++count[which];
      }
    }
    for (std::size_t i = 0; i < 3; ++i)
      p_[in + static_cast<int>(i)] = sum[i] / std::max(1.0, count[i]);
  }

  /// Gathers the normal equations.
  /// @param limit  larger residuals weigh less (Huber)
  void gather(double limit) {
    normal_ = Matrix::zeros();
    rhs_ = Vector::all(0.0);
    residual2_ = total_ = 0.0;
    for (int y = y0_; y <= y1_; ++y) {
      const auto* row = grey_.ptr<unsigned char>(y);
      for (int x = x0_; x <= x1_; ++x) addPixel(x, y, row[x], limit);
    }
  }

  void addPixel(int x, int y, double grey, double limit) {
    const double vx = x - p_[cx], vy = y - p_[cy];
    const double rho = std::hypot(vx, vy);
    if (rho < kRingInner * p_[radius] || rho > kRingOuter * p_[radius]) return;
    const double edge = (rho - p_[radius]) / softness_;
    const double share = 1.0 / (1.0 + std::exp(-2.0 * edge));
    const bool is_left = vx < 0.0;
    const double contrast = (is_left ? p_[left] : p_[right]) - p_[in];
    const double shade = 1.0 + p_[slope] * vy / p_[radius];
    const double level = p_[in] + contrast * share;
    const double off = grey - shade * level;
    const double steep = shade * contrast * 2.0 * share * (1.0 - share) / softness_;
    Vector j = Vector::all(0.0);
    j[cx] = -steep * vx / rho;
    j[cy] = -steep * vy / rho - level * p_[slope] / p_[radius];
    j[radius] = -steep;
    j[in] = shade * (1.0 - share);
    j[is_left ? left : right] = shade * share;
    j[slope] = level * vy / p_[radius];
    // Rows near the eyelids weigh less, because the eyelids move.
    const double from_lid =
        1.0 - std::abs(vy) / ((vy < 0.0 ? kRowsAbove : kRowsBelow) * p_[radius] + 1.0);
    double weight = std::min(1.0, 3.0 * from_lid);
    residual2_ += weight * off * off;
    total_ += weight;
    if (std::abs(off) > limit) weight *= limit / std::abs(off);
    for (int a = 0; a < kUnknowns; ++a) {
      rhs_[a] += weight * j[a] * off;
      for (int b = 0; b <= a; ++b) normal_(a, b) += weight * j[a] * j[b];
    }
  }

  /// Prior knowledge: the radius is near the expected one, and the shading is even.
  void addPriors() {
    const double sure = spread_ * spread_ / std::pow(kRadiusSd * start_radius_, 2);
    normal_(radius, radius) += sure;
    rhs_[radius] += sure * (start_radius_ - p_[radius]);
    const double even = spread_ * spread_ / std::pow(kSlopeSd, 2);
    normal_(slope, slope) += even;
    rhs_[slope] -= even * p_[slope];
  }

  /// Solves the normal equations and takes the step.
  /// @return by how much the centre moved, pixels; nothing if the fit leaves the expected place
  std::optional<double> step() {
    for (int a = 0; a < kUnknowns; ++a) {
      normal_(a, a) += 1e-3 * normal_(a, a) + 1e-9;
      for (int b = 0; b < a; ++b) normal_(b, a) = normal_(a, b);
    }
    Vector change;
    if (!cv::solve(normal_, rhs_, change, cv::DECOMP_CHOLESKY)) return std::nullopt;
    const double max_change = 0.4 * start_radius_;
    for (int a : {cx, cy, radius}) change[a] = std::clamp(change[a], -max_change, max_change);
    p_ += change;
    const double off = std::hypot(p_[cx] - start_.x, p_[cy] - start_.y);
    if (!(off < 1.2 * start_radius_)) return std::nullopt;
    p_[radius] = std::clamp(p_[radius], 0.75 * start_radius_, 1.3 * start_radius_);
    return std::hypot(change[cx], change[cy]);
  }

  std::optional<Iris> result() const {
    const double contrast = std::min(p_[left], p_[right]) - p_[in];
    if (contrast < kMinContrast) return std::nullopt;
    const double explained = contrast / (contrast + 2.5 * std::sqrt(residual2_ / total_));
    return Iris{.centre_px = {p_[cx] + 0.5, p_[cy] + 0.5},
                .radius_px = p_[radius],
                .contrast = contrast,
                .confidence = std::clamp(explained, 0.0, 1.0)};
  }

  const cv::Mat& grey_;
  glm::dvec2 start_;
  double start_radius_;
  double softness_;  // width of the limbus' blurred edge, px
  Vector p_{};
  int x0_ = 0, x1_ = 0, y0_ = 0, y1_ = 0;
  Matrix normal_{};
  Vector rhs_{};
  double residual2_ = 0.0, total_ = 0.0;  // weighted sum of squares, sum of weights
  double spread_ = 0.0;                   // of the residuals, grey levels
};

}  // namespace

std::vector<IrisCandidate> coarseIrises(const cv::Mat& grey, const glm::dvec2& near_px,
                                        const glm::dvec2& reach_px, double radius_px,
                                        std::size_t max_count) {
  assert(grey.type() == CV_8UC1 && radius_px > 0.0);
  // Cut out the search region and shrink it to the usual size.
  const double margin = kBandOuter * radius_px + 2.0;
  const glm::dvec2 low = near_px - reach_px - margin, high = near_px + reach_px + margin;
  const cv::Rect box = cv::Rect(cv::Point(cvFloor(low.x), cvFloor(low.y)),
                                cv::Point(cvCeil(high.x), cvCeil(high.y))) &
                       cv::Rect({0, 0}, grey.size());
  if (box.width < 8 || box.height < 8) return {};
  const double shrink = std::max(1.0, radius_px / kCoarseRadius_px);
  cv::Mat part;
  if (shrink > 1.0) {
    cv::resize(grey(box), part, {}, 1.0 / shrink, 1.0 / shrink, cv::INTER_AREA);
  } else {
    part = grey(box);
  }
  const auto radius = static_cast<float>(radius_px / shrink);
  const glm::dvec2 start = (near_px - glm::dvec2(box.x, box.y)) / shrink - 0.5;
  const cv::Mat1f votes = votesOf(strongEdgesOf(part), part.size(), radius);
  cv::Mat1f score = scoreOf(part, votes, radius, start, reach_px, shrink);

  // Take the maxima, each at least a radius from the others.
  std::vector<IrisCandidate> found;
  double first = 0.0;
  while (found.size() < max_count) {
    double best = 0.0;
    cv::Point at;
    cv::minMaxLoc(score, nullptr, &best, nullptr, &at);
    if (!(best > 0.0)) break;
    if (found.empty()) first = best;
    found.push_back(
        {.centre_px = glm::dvec2(box.x, box.y) + (glm::dvec2(at.x, at.y) + 0.5) * shrink,
         .score = best / first});
    cv::circle(score, at, cvCeil(static_cast<double>(radius)), cv::Scalar(0.0), cv::FILLED);
  }
  return found;
}

std::optional<Iris> refineIris(const cv::Mat& grey, const glm::dvec2& near_px, double radius_px) {
  assert(grey.type() == CV_8UC1 && radius_px > 0.0);
  return IrisFit(grey, near_px, radius_px).fit();
}

}  // namespace foci
