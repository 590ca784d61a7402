#include "render/gaussians/view_spread.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "render/image/metrics.h"
#include "render/image/srgb.h"

namespace foci {
namespace {

/// Linear light of Gaussians over what lies behind them (composite.h).
glm::vec3 lightOver(const SeenLight& seen, const BehindSample& behind) {
  const glm::vec3 shown =
      glm::clamp(glm::vec3(seen) + seen.a * behind.display, glm::vec3(0.0f), glm::vec3(1.0f));
  const glm::vec3 light(linearFromSrgb(shown.r), linearFromSrgb(shown.g), linearFromSrgb(shown.b));
  return light + seen.a * seen.a * behind.light;
}

}  // namespace

std::vector<std::vector<float>> polynomialsOver(std::span<const LensDisc> discs) {
  using Polynomial = float (*)(const glm::vec2&);
  constexpr std::array<Polynomial, 6> kPolynomials{
      [](const glm::vec2&) { return 1.0f; },        [](const glm::vec2& p) { return p.x; },
      [](const glm::vec2& p) { return p.y; },       [](const glm::vec2& p) { return p.x * p.x; },
      [](const glm::vec2& p) { return p.x * p.y; }, [](const glm::vec2& p) { return p.y * p.y; }};
  std::vector<std::vector<float>> basis;
  for (const Polynomial& polynomial : kPolynomials) {
    std::vector<float> values;
    values.reserve(discs.size());
    for (const LensDisc& disc : discs) values.push_back(polynomial(disc.centre));
    const auto dot = [&](const std::vector<float>& a) {
      return std::inner_product(a.begin(), a.end(), values.begin(), 0.0f);
    };
    const float before = dot(values);
    for (const std::vector<float>& other : basis) {
      const float along = dot(other);
      for (std::size_t i = 0; i < values.size(); ++i) values[i] -= along * other[i];
    }
    constexpr float kRounding = 1e-6f;
    const float rest = dot(values);
    if (rest <= kRounding * before) continue;
    for (float& value : values) value /= std::sqrt(rest);
    basis.push_back(std::move(values));
  }
  basis.erase(basis.begin());
  return basis;
}

std::array<float, SampledErrors::kMost> errorsOfMean(std::span<const SpreadSquares> samples,
                                                     std::size_t discs, std::size_t polynomials,
                                                     float radius_px) {
  assert(discs >= 3 && samples.size() <= SampledErrors::kMost);
  const auto n = static_cast<float>(discs);
  const float free = n - 1.0f - static_cast<float>(polynomials);
  float all = 0.0f, rest = 0.0f;
  for (const SpreadSquares& each : samples) {
    all += each.all;
    rest += each.rest;
  }
  std::array<float, SampledErrors::kMost> errors{};
  if (free == 0.0f) {
    constexpr float kOfThree = 1.2f, kSmooth_px = 4.0f;
    const float r2 = radius_px * radius_px;
    const float share = kOfThree * r2 / (r2 + kSmooth_px * kSmooth_px);
    std::ranges::transform(samples, errors.begin(), [&](const SpreadSquares& each) {
      return share * std::sqrt(each.all / (n * (n - 1.0f)));
    });
    return errors;
  }
  // (R / S)^2 of the tile.
  const float rough = rest / free * (n - 1.0f) / std::max(all, 1e-20f);
  const float by_radius = 1.4f * radius_px / (radius_px + 4.0f);
  const float share =
      by_radius * std::min(std::pow(n / 19.0f, -0.18f), 1.0f) * std::pow(rough, 0.75f);
  std::ranges::transform(samples, errors.begin(), [&](const SpreadSquares& each) {
    return share * std::sqrt(each.rest / (n * free));
  });
  return errors;
}

FollowedAlong followedAlong(int samples, int apron) {
  const int apart = apron > 0 ? 2 : 4, first = apron + apart / 2;
  return {first, apart, (samples - apron - first + apart - 1) / apart};
}

void ViewSpread::begin(int samples, int apron) {
  const auto [first, apart, count] = followedAlong(samples, apron);
  along_.clear();
  for (int i = 0; i < count; ++i) along_.push_back(static_cast<std::size_t>(first + i * apart));
  assert(along_.size() * along_.size() <= SampledErrors::kMost);
  followSquare(samples);
}

void ViewSpread::beginBehind(const ViewSpread& first, const TileLayer& first_layer,
                             const TileLayer& layer) {
  // Sample i of the first layer lies at (i + 1/2) steps, those of others at i steps.
  const auto ratio = static_cast<std::size_t>(layer.step_px / first_layer.step_px);
  along_.clear();
  for (const std::size_t i : first.along_) along_.push_back((2 * i + 1 + ratio) / (2 * ratio));
  followSquare(layer.samples);
}

std::pair<std::size_t, std::size_t> ViewSpread::beginBeside(const ViewSpread& other) {
  along_.resize(other.along_.size());
  std::iota(along_.begin(), along_.end(), std::size_t{0});
  followSquare(along());
  return {other.along_[0], other.along_[1] - other.along_[0]};
}

void ViewSpread::beginNone() {
  along_.clear();
  followSquare(0);
}

void ViewSpread::followSquare(int samples) {
  places_.clear();
  for (const std::size_t y : along_) {
    for (const std::size_t x : along_) places_.push_back(placeOf(samples, x, y));
  }
  seen_.clear();
}

std::span<SeenLight> ViewSpread::next() {
  seen_.resize(seen_.size() + places_.size());
  return std::span(seen_).last(places_.size());
}

glm::vec3 ViewSpread::lightOf(std::size_t view, std::size_t place,
                              const BehindSample& behind) const {
  return lightOver(seen_[view * places_.size() + place], behind);
}

std::array<float, SampledErrors::kMost> ViewSpread::errorsOfMean(
    std::span<const LensDisc> discs, float radius_px, std::span<const BehindSample> behind) const {
  assert(views() >= 3 && discs.size() == views() && behind.size() == places_.size());
  const std::vector<std::vector<float>> basis = polynomialsOver(discs);
  std::array<SpreadSquares, SampledErrors::kMost> samples;
  std::vector<glm::vec3> apart(views());
  for (std::size_t i = 0; i < places_.size(); ++i) {
    glm::vec3 mean(0.0f);
    for (std::size_t view = 0; view < apart.size(); ++view) {
      apart[view] = lightOf(view, i, behind[i]);
      mean += apart[view] / static_cast<float>(views());
    }
    const glm::mat3 jnd = visibleDifferencePerLight(mean);
    for (glm::vec3& each : apart) {
      each = jnd * (each - mean);
      samples[i].all += glm::dot(each, each);
    }
    float smooth = 0.0f;
    for (const std::vector<float>& polynomial : basis) {
      glm::vec3 along(0.0f);
      for (std::size_t view = 0; view < apart.size(); ++view) {
        along += polynomial[view] * apart[view];
      }
      smooth += glm::dot(along, along);
    }
    samples[i].rest = std::max(samples[i].all - smooth, 0.0f);
  }
  return foci::errorsOfMean(std::span(samples).first(places_.size()), views(), basis.size(),
                            radius_px);
}

std::array<float, SampledErrors::kMost> ViewSpread::errorsOfOne(
    const ViewSpread& judges, std::span<const BehindSample> behind) const {
  assert(views() == 1 && judges.places_.size() == places_.size());
  std::array<float, SampledErrors::kMost> errors{};
  for (std::size_t i = 0; i < places_.size(); ++i) {
    glm::vec3 mean(0.0f);
    for (std::size_t view = 0; view < judges.views(); ++view) {
      mean += judges.lightOf(view, i, behind[i]) / static_cast<float>(judges.views());
    }
    const glm::vec3 apart = visibleDifferencePerLight(mean) * (lightOf(0, i, behind[i]) - mean);
    errors[i] = errorOfOne(glm::length(apart));
  }
  return errors;
}

float ViewSpread::transmittance(std::size_t place) const {
  float sum = 0.0f;
  for (std::size_t at = place; at < seen_.size(); at += places_.size()) sum += seen_[at].a;
  return sum / static_cast<float>(views());
}

}  // namespace foci
