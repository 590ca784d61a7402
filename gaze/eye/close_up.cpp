#include "gaze/eye/close_up.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace foci {
namespace {

constexpr int kRays = 96;
constexpr double kMinRadius = 0.012, kMaxRadius = 0.2;  // of the image's width
constexpr int kMinContrast = 12;                        // grey levels from pupil to iris
constexpr int kGlint = 200;                             // grey level, at least
constexpr double kOff = 0.06;                           // of the radius: on the outline

struct Seed {
  cv::Point2d centre{};
  double radius = 0.0, score = 0.0;
};

/// Grey level that this share of the image is darker than.
int percentile(const cv::Mat& grey, double share) {
  int counts[256] = {};
  for (int y = 0; y < grey.rows; ++y) {
    const auto* row = grey.ptr<unsigned char>(y);
    for (int x = 0; x < grey.cols; ++x) ++counts[row[x]];
  }
  const double wanted = share * static_cast<double>(grey.total());
  double below = 0.0;
  for (int level = 0; level < 256; ++level) {
    below += counts[level];
    if (below >= wanted) return level;
  }
  return 255;
}

/// The first round dark region as the threshold rises, before the iris joins the pupil; else the
/// roundest of all.
Seed findSeed(const cv::Mat& grey) {
  Seed best;
  const int darkest = percentile(grey, 0.002);
  const double least = kMinRadius * grey.cols, most = kMaxRadius * grey.cols;
  cv::Mat mask, labels, stats, centres;
  const cv::Mat kernel = cv::getStructuringElement(cv::MORPH_ELLIPSE, {7, 7});
  constexpr double kRound = 0.85;
  for (int above = 6; above <= 60 && best.score < kRound; above += 6) {
    cv::threshold(grey, mask, std::min(darkest + above, 254), 255, cv::THRESH_BINARY_INV);
    cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, kernel);
    cv::morphologyEx(mask, mask, cv::MORPH_OPEN, kernel);
    const int count = cv::connectedComponentsWithStats(mask, labels, stats, centres, 4);
    for (int i = 1; i < std::min(count, 256); ++i) {
      const double width = stats.at<int>(i, cv::CC_STAT_WIDTH);
      const double height = stats.at<int>(i, cv::CC_STAT_HEIGHT);
      const double area = stats.at<int>(i, cv::CC_STAT_AREA);
      const double radius = std::sqrt(area / std::numbers::pi);
      if (radius < least || radius > most || width > 2.0 * height || height > 2.0 * width) continue;
      // An ellipse with second moments M has the area 4 pi sqrt|M|; lids and lashes leave ragged
      // regions.
      const cv::Rect box(stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                         stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT));
      const cv::Moments moments = cv::moments(labels(box) == i, true);
      const double spread =
          (moments.mu20 * moments.mu02 - moments.mu11 * moments.mu11) / (area * area);
      const double filled = area / (4.0 * std::numbers::pi * std::sqrt(std::max(spread, 1e-9)));
      const double round = std::min(width, height) / std::max(width, height);
      const double score = std::pow(round, 0.25) * std::min(filled, 1.0 / filled);
      if (score > best.score) {
        best = {{centres.at<double>(i, 0), centres.at<double>(i, 1)}, radius, score};
      }
    }
  }
  return best;
}

double sampled(const cv::Mat& image, double x, double y) {
  const int ix = std::clamp(static_cast<int>(x), 0, image.cols - 2);
  const int iy = std::clamp(static_cast<int>(y), 0, image.rows - 2);
  const double fx = std::clamp(x - ix, 0.0, 1.0), fy = std::clamp(y - iy, 0.0, 1.0);
  const auto* upper = image.ptr<unsigned char>(iy);
  const auto* lower = image.ptr<unsigned char>(iy + 1);
  return (1 - fy) * ((1 - fx) * upper[ix] + fx * upper[ix + 1]) +
         fy * ((1 - fx) * lower[ix] + fx * lower[ix + 1]);
}

/// The steepest rises along rays, off the glint.
std::vector<cv::Point2f> outline(const cv::Mat& grey, const cv::Point2d& centre, double radius) {
  constexpr double kStep_px = 0.5;
  constexpr int kReach = 4;  // steps to both sides that a rise is taken over
  std::vector<cv::Point2f> points;
  std::vector<double> profile;
  for (int ray = 0; ray < kRays; ++ray) {
    const double angle = 2.0 * std::numbers::pi * ray / kRays;
    const double dx = std::cos(angle), dy = std::sin(angle);
    const double from = 0.5 * radius, to = 1.5 * radius + 4.0;
    profile.clear();
    for (double r = from; r <= to; r += kStep_px) {
      profile.push_back(sampled(grey, centre.x + r * dx, centre.y + r * dy));
    }
    double steepest = 0.0;
    std::size_t at = 0;
    const auto rise = [&](std::size_t i) { return profile[i + kReach] - profile[i - kReach]; };
    for (std::size_t i = kReach; i + kReach < profile.size(); ++i) {
      if (profile[i] > kGlint || profile[i + kReach] > kGlint) break;
      if (rise(i) > steepest) {
        steepest = rise(i);
        at = i;
      }
    }
    if (steepest < kMinContrast || at <= kReach || at + kReach + 1 >= profile.size()) continue;
    const double before = rise(at - 1), after = rise(at + 1);
    const double bend = before - 2.0 * steepest + after;
    const double shift = bend < 0.0 ? std::clamp(0.5 * (before - after) / bend, -1.0, 1.0) : 0.0;
    const double r = from + kStep_px * (static_cast<double>(at) + shift);
    points.emplace_back(static_cast<float>(centre.x + r * dx),
                        static_cast<float>(centre.y + r * dy));
  }
  return points;
}

/// Signed distance from the ellipse in units of its mean radius, nearly.
double offEllipse(const cv::RotatedRect& box, const cv::Point2f& point) {
  const double angle = box.angle * std::numbers::pi / 180.0;
  const double x = point.x - box.center.x, y = point.y - box.center.y;
  const double u = (x * std::cos(angle) + y * std::sin(angle)) / (0.5 * box.size.width);
  const double v = (-x * std::sin(angle) + y * std::cos(angle)) / (0.5 * box.size.height);
  return std::hypot(u, v) - 1.0;
}

/// The centre of gravity of bright spots near the pupil.
std::optional<glm::dvec2> findGlint(const cv::Mat& grey, const cv::RotatedRect& box) {
  const cv::Point2d centre = box.center;
  const double reach = 1.5 * 0.5 * std::max(box.size.width, box.size.height);
  const auto bound = [](double value, int size) {
    return std::clamp(static_cast<int>(value), 0, size - 1);
  };
  glm::dvec2 sum{0.0};
  double count = 0.0;
  for (int y = bound(centre.y - reach, grey.rows); y <= bound(centre.y + reach, grey.rows); ++y) {
    const auto* row = grey.ptr<unsigned char>(y);
    for (int x = bound(centre.x - reach, grey.cols); x <= bound(centre.x + reach, grey.cols); ++x) {
      if (row[x] < kGlint || std::hypot(x - centre.x, y - centre.y) > reach) continue;
      sum += glm::dvec2(x + 0.5, y + 0.5);
      count += 1.0;
    }
  }
  return count > 0.0 ? std::optional(sum / count) : std::nullopt;
}

}  // namespace

std::optional<CloseUpPupil> findCloseUpPupil(const cv::Mat& grey) {
  assert(grey.type() == CV_8UC1 && grey.cols >= 32 && grey.rows >= 32);
  constexpr int kSeedWidth = 320;
  cv::Mat smooth, small;
  cv::GaussianBlur(grey, smooth, {5, 5}, 1.2);
  const double scale = std::max(1.0, static_cast<double>(grey.cols) / kSeedWidth);
  cv::resize(smooth, small, {}, 1.0 / scale, 1.0 / scale, cv::INTER_AREA);
  const Seed seed = findSeed(small);
  if (seed.score <= 0.0) return std::nullopt;

  cv::Point2d centre = scale * (seed.centre + cv::Point2d(0.5, 0.5)) - cv::Point2d(0.5, 0.5);
  double radius = scale * seed.radius;
  std::vector<cv::Point2f> points = outline(smooth, centre, radius);
  cv::RotatedRect box;
  std::size_t agreeing = 0;
  for (int round = 0; round < 4; ++round) {
    constexpr std::size_t kFewest = 12;
    if (points.size() < kFewest) return std::nullopt;
    box = cv::fitEllipse(points);
    // What disagrees goes, more strictly from round to round; from the better centre look again.
    std::vector<cv::Point2f> kept;
    const double off = kOff * (round == 0 ? 4.0 : round == 1 ? 2.0 : 1.0);
    for (const cv::Point2f& point : points) {
      if (std::abs(offEllipse(box, point)) < off) kept.push_back(point);
    }
    if (kept.size() < kFewest) return std::nullopt;
    box = cv::fitEllipse(kept);
    agreeing = kept.size();
    if (!(box.size.width > 0.0f) || !(box.size.height > 0.0f)) return std::nullopt;
    const double mean = 0.25 * (box.size.width + box.size.height);
    if (mean < kMinRadius * grey.cols || mean > kMaxRadius * grey.cols) return std::nullopt;
    if (round == 1) {
      centre = box.center;
      radius = mean;
      points = outline(smooth, centre, radius);
    } else {
      points = kept;
    }
  }
  const double shorter = 0.5 * std::min(box.size.width, box.size.height);
  const double longer = 0.5 * std::max(box.size.width, box.size.height);
  constexpr double kFlattest = 0.4;  // seen from 66 degrees aside
  if (shorter < kFlattest * longer) return std::nullopt;
  CloseUpPupil pupil{.centre_px = {box.center.x + 0.5, box.center.y + 0.5},
                     .radii_px = {longer, shorter},
                     .angle_rad = (box.angle + (box.size.width < box.size.height ? 90.0 : 0.0)) *
                                  std::numbers::pi / 180.0,
                     .confidence = static_cast<double>(agreeing) / kRays};
  pupil.glint_px = findGlint(grey, box);
  return pupil;
}

void BlinkCounter::push(double time_s, double confidence) {
  constexpr double kCovered = 0.35, kOpen = 0.5;
  constexpr double kShortest_s = 0.05, kLongest_s = 1.0;
  if (!closed_s_) {
    if (confidence < kCovered) closed_s_ = time_s;
  } else if (confidence > kOpen) {
    const double closed_s = time_s - *closed_s_;
    blinks_ += closed_s >= kShortest_s && closed_s <= kLongest_s;
    closed_s_.reset();
  }
}

}  // namespace foci
