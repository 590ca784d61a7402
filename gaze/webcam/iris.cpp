#include "gaze/webcam/iris.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace foci {
namespace {

constexpr double kCoarseRadius_px = 6.0;    // larger irises are searched for in a smaller image
constexpr double kNear = 0.7, kFar = 1.35;  // band of edges around a centre, radii
constexpr double kRowsAbove = 0.45, kRowsBelow = 0.65;  // of the fit, radii from the centre
constexpr double kInner = 0.55, kOuter = 1.6;
constexpr double kRadiusSd = 0.08;  // of what is known of the radius, share
constexpr double kMinContrast = 6.0;

struct Edge {
  float x, y, gx, gy, weight;
};

}  // namespace

std::vector<IrisCandidate> coarseIrises(const cv::Mat& grey, const glm::dvec2& near_px,
                                        const glm::dvec2& reach_px, double radius_px,
                                        std::size_t most) {
  assert(grey.type() == CV_8UC1 && radius_px > 0.0);
  // Cut out what matters, shrink it to the usual size.
  const double margin = kFar * radius_px + 2.0;
  const glm::dvec2 low = near_px - reach_px - margin, high = near_px + reach_px + margin;
  const cv::Rect box = cv::Rect(cv::Point(cvFloor(low.x), cvFloor(low.y)),
                                cv::Point(cvCeil(high.x), cvCeil(high.y))) &
                       cv::Rect({0, 0}, grey.size());
  if (box.width < 8 || box.height < 8) return {};
  const double shrink = std::max(1.0, radius_px / kCoarseRadius_px);
  cv::Mat part, smooth, dx, dy;
  if (shrink > 1.0) {
    cv::resize(grey(box), part, {}, 1.0 / shrink, 1.0 / shrink, cv::INTER_AREA);
  } else {
    part = grey(box);
  }
  cv::GaussianBlur(part, smooth, {3, 3}, 0.8, 0.8, cv::BORDER_REPLICATE);
  cv::Sobel(smooth, dx, CV_32F, 1, 0, 3, 1.0, 0.0, cv::BORDER_REPLICATE);
  cv::Sobel(smooth, dy, CV_32F, 0, 1, 3, 1.0, 0.0, cv::BORDER_REPLICATE);
  const auto r = static_cast<float>(radius_px / shrink);

  // The stronger half of the gradients; beyond a point stronger says no more.
  cv::Mat strength;
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

  cv::Mat dark;
  cv::GaussianBlur(part, dark, {5, 5}, 0.35 * static_cast<double>(r), 0.0, cv::BORDER_REPLICATE);
  double darkest = 0.0, brightest = 255.0;
  cv::minMaxLoc(dark, &darkest, &brightest);
  const float range = std::max(1.0f, static_cast<float>(brightest - darkest));
  // Each edge votes for the centres that it may belong to.
  cv::Mat1f votes(part.rows, part.cols, 0.0f);
  const float near2 = static_cast<float>(kNear * kNear) * r * r;
  const float far2 = static_cast<float>(kFar * kFar) * r * r;
  const int reach = cvCeil(kFar * static_cast<double>(r));
  for (const Edge& e : edges) {
    const int x0 = std::max(0, static_cast<int>(e.x) - reach);
    const int x1 = std::min(part.cols - 1, static_cast<int>(e.x) + reach);
    const int y0 = std::max(0, static_cast<int>(e.y) - reach);
    const int y1 = std::min(part.rows - 1, static_cast<int>(e.y) + reach);
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
  const glm::dvec2 start = (near_px - glm::dvec2(box.x, box.y)) / shrink - 0.5;
  cv::Mat1f score(part.rows, part.cols, 0.0f);
  for (int y = 0; y < part.rows; ++y) {
    for (int x = 0; x < part.cols; ++x) {
      const glm::dvec2 off = glm::abs(glm::dvec2(x, y) - start) * shrink / (reach_px + 1e-9);
      if (off.x > 1.0 || off.y > 1.0) continue;
      const float darkness =
          (static_cast<float>(brightest) - static_cast<float>(dark.at<unsigned char>(y, x))) /
          range;
      score(y, x) = votes(y, x) * (0.15f + darkness) *
                    (1.0f - 0.35f * static_cast<float>(0.5 * glm::dot(off, off)));
    }
  }
  std::vector<IrisCandidate> found;
  double first = 0.0;
  while (found.size() < most) {
    double best = 0.0;
    cv::Point at;
    cv::minMaxLoc(score, nullptr, &best, nullptr, &at);
    if (!(best > 0.0)) break;
    if (found.empty()) first = best;
    found.push_back(
        {.centre_px = glm::dvec2(box.x, box.y) + (glm::dvec2(at.x, at.y) + 0.5) * shrink,
         .score = best / first});
    cv::circle(score, at, cvCeil(static_cast<double>(r)), cv::Scalar(0.0), cv::FILLED);
  }
  return found;
}

std::optional<Iris> refineIris(const cv::Mat& grey, const glm::dvec2& near_px, double radius_px) {
  assert(grey.type() == CV_8UC1 && radius_px > 0.0);
  enum : int { cx, cy, radius, in, left, right, slope, kUnknowns };
  using Vector = cv::Vec<double, kUnknowns>;
  Vector p;
  p[cx] = near_px.x - 0.5;  // pixel (i, j) is at i, j here
  p[cy] = near_px.y - 0.5;
  p[radius] = radius_px;
  const double soft = 0.35 + 0.12 * radius_px;  // how blurred the limbus is, px

  const auto outside = [&](double x, double y) {
    return x < 1.0 || y < 1.0 || x > grey.cols - 2.0 || y > grey.rows - 2.0;
  };
  const double reach = kOuter * 1.2 * radius_px + 1.0;
  if (outside(p[cx] - reach, p[cy] - reach) || outside(p[cx] + reach, p[cy] + reach)) {
    return std::nullopt;
  }
  double spread = 0.0;
  double residual2 = 0.0, total = 0.0;
  for (int round = 0; round < 8; ++round) {
    // Levels from the present place: medians would do, means with weights are smoother.
    const int x0 = cvFloor(p[cx] - kOuter * p[radius]), x1 = cvCeil(p[cx] + kOuter * p[radius]);
    const int y0 = cvCeil(p[cy] - kRowsAbove * p[radius]);
    const int y1 = cvFloor(p[cy] + kRowsBelow * p[radius]);
    if (outside(x0, y0) || outside(x1, y1)) return std::nullopt;
    if (round == 0) {
      std::array<double, 3> sum{}, count{};
      for (int y = y0; y <= y1; ++y) {
        const auto* row = grey.ptr<unsigned char>(y);
        for (int x = x0; x <= x1; ++x) {
          const double rho = std::hypot(x - p[cx], y - p[cy]) / p[radius];
          const std::size_t which = rho < 0.9 ? 0 : x < p[cx] ? 1 : 2;
          if (rho > 0.9 && rho < 1.1) continue;
          sum[which] += row[x];
          ++count[which];
        }
      }
      for (std::size_t i = 0; i < 3; ++i)
        p[in + static_cast<int>(i)] = sum[i] / std::max(1.0, count[i]);
    }
    cv::Matx<double, kUnknowns, kUnknowns> normal = cv::Matx<double, kUnknowns, kUnknowns>::zeros();
    Vector rhs = Vector::all(0.0);
    residual2 = total = 0.0;
    const double limit = round < 2 ? 1e9 : 2.5 * spread;  // Huber's
    for (int y = y0; y <= y1; ++y) {
      const auto* row = grey.ptr<unsigned char>(y);
      for (int x = x0; x <= x1; ++x) {
        const double vx = x - p[cx], vy = y - p[cy];
        const double rho = std::hypot(vx, vy);
        if (rho < kInner * p[radius] || rho > kOuter * p[radius]) continue;
        const double edge = (rho - p[radius]) / soft;
        const double share = 1.0 / (1.0 + std::exp(-2.0 * edge));
        const bool is_left = vx < 0.0;
        const double contrast = (is_left ? p[left] : p[right]) - p[in];
        const double shade = 1.0 + p[slope] * vy / p[radius];
        const double level = p[in] + contrast * share;
        const double off = row[x] - shade * level;
        const double steep = shade * contrast * 2.0 * share * (1.0 - share) / soft;
        Vector j = Vector::all(0.0);
        j[cx] = -steep * vx / rho;
        j[cy] = -steep * vy / rho - level * p[slope] / p[radius];
        j[radius] = -steep;
        j[in] = shade * (1.0 - share);
        j[is_left ? left : right] = shade * share;
        j[slope] = level * vy / p[radius];
        // Rows near the lids count less: they come and go.
        const double from_lid =
            1.0 - std::abs(vy) / ((vy < 0.0 ? kRowsAbove : kRowsBelow) * p[radius] + 1.0);
        double weight = std::min(1.0, 3.0 * from_lid);
        residual2 += weight * off * off;
        total += weight;
        if (std::abs(off) > limit) weight *= limit / std::abs(off);
        for (int a = 0; a < kUnknowns; ++a) {
          rhs[a] += weight * j[a] * off;
          for (int b = 0; b <= a; ++b) normal(a, b) += weight * j[a] * j[b];
        }
      }
    }
    if (total < 12.0) return std::nullopt;
    spread = std::max(1.0, std::sqrt(residual2 / total));
    // What is known of the radius, and that shading is even.
    const double sure = spread * spread / std::pow(kRadiusSd * radius_px, 2);
    normal(radius, radius) += sure;
    rhs[radius] += sure * (radius_px - p[radius]);
    const double even = spread * spread / std::pow(0.25, 2);
    normal(slope, slope) += even;
    rhs[slope] -= even * p[slope];
    for (int a = 0; a < kUnknowns; ++a) {
      normal(a, a) += 1e-3 * normal(a, a) + 1e-9;
      for (int b = 0; b < a; ++b) normal(b, a) = normal(a, b);
    }
    Vector change;
    if (!cv::solve(normal, rhs, change, cv::DECOMP_CHOLESKY)) return std::nullopt;
    const double longest = 0.4 * radius_px;
    for (int a : {cx, cy, radius}) change[a] = std::clamp(change[a], -longest, longest);
    p += change;
    const double moved = std::hypot(p[cx] + 0.5 - near_px.x, p[cy] + 0.5 - near_px.y);
    if (!(moved < 1.2 * radius_px)) return std::nullopt;
    p[radius] = std::clamp(p[radius], 0.75 * radius_px, 1.3 * radius_px);
    if (round >= 3 && std::hypot(change[cx], change[cy]) < 0.003) break;
  }
  const double contrast = std::min(p[left], p[right]) - p[in];
  if (contrast < kMinContrast) return std::nullopt;
  Iris iris{.centre_px = {p[cx] + 0.5, p[cy] + 0.5}, .radius_px = p[radius], .contrast = contrast};
  const double explained = contrast / (contrast + 2.5 * std::sqrt(residual2 / total));
  iris.confidence = std::clamp(explained, 0.0, 1.0);
  return iris;
}

}  // namespace foci
