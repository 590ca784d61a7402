#include "app/evaluation/growth/growth_fit.h"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "base/text.h"

namespace foci {
namespace {

struct FittedLine {
  double slope, residual;  ///< the residual is a sum of squares
};

FittedLine lineThrough(std::span<const glm::dvec2> points) {
  glm::dvec2 mean(0.0);
  for (const glm::dvec2& one : points) mean += one / static_cast<double>(points.size());
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const glm::dvec2& one : points) {
    const glm::dvec2 d = one - mean;
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
  }
  assert(xx > 0.0);
  return {xy / xx, yy - xy * xy / xx};
}

}  // namespace

GrowthFit fitGrowth(const std::vector<glm::dvec2>& curve) {
  std::vector<glm::dvec2> logs;
  for (const glm::dvec2& one : curve) {
    if (one.x > 0.0) logs.push_back(glm::log(one));
  }
  const std::span<const glm::dvec2> all(logs);
  GrowthFit fit{.exponent = lineThrough(all).slope};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; all.size() >= 4 && k + 1 < all.size(); ++k) {
    const FittedLine before = lineThrough(all.first(k + 1)), after = lineThrough(all.subspan(k));
    if (before.residual + after.residual >= least) continue;
    least = before.residual + after.residual;
    fit.bend = {.at = std::exp(all[k].x), .before = before.slope, .after = after.slope};
  }
  if (fit.bend && std::abs(fit.bend->after - fit.bend->before) <= kMinBend) fit.bend.reset();
  return fit;
}

std::string growthText(const GrowthFit& fit, double unit) {
  std::string text = decimal(fit.exponent, 2);
  if (fit.bend) {
    text += "; " + decimal(fit.bend->before, 2) + " up to " + significant(fit.bend->at / unit, 2) +
            ", then " + decimal(fit.bend->after, 2);
  }
  return text;
}

double costAt(const std::vector<glm::dvec2>& curve, double size) {
  std::size_t end = 1;
  while (end + 1 < curve.size() && curve[end].x < size) ++end;
  const glm::dvec2 from = glm::log(curve[end - 1]), to = glm::log(curve[end]);
  return std::exp(glm::mix(from.y, to.y, (std::log(size) - from.x) / (to.x - from.x)));
}

}  // namespace foci
