#include "render/gaussians/view_spread.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "render/image/srgb.h"
#include "render/image/visible_difference.h"

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

void ViewSpread::begin(int samples, int apron) {
  const int apart = apron > 0 ? 2 : 4;
  along_.clear();
  for (int i = apron + apart / 2; i < samples - apron; i += apart) {
    along_.push_back(static_cast<std::size_t>(i));
  }
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

std::array<float, SampledErrors::kMost> ViewSpread::standardErrors(
    std::span<const BehindSample> behind) const {
  assert(views() >= 2 && behind.size() == places_.size());
  const auto n = static_cast<float>(views());
  std::array<float, SampledErrors::kMost> errors{};
  std::vector<glm::vec3> lights(views());
  for (std::size_t i = 0; i < places_.size(); ++i) {
    glm::vec3 mean(0.0f);
    for (std::size_t view = 0; view < lights.size(); ++view) {
      lights[view] = lightOver(seen_[view * places_.size() + i], behind[i]);
      mean += lights[view] / n;
    }
    const glm::mat3 jnd = visibleDifferencePerLight(mean);
    float sum = 0.0f;
    for (const glm::vec3& light : lights) {
      const glm::vec3 apart = jnd * (light - mean);
      sum += glm::dot(apart, apart);
    }
    errors[i] = std::sqrt(sum / (n * (n - 1.0f)));
  }
  return errors;
}

float ViewSpread::transmittance(std::size_t place) const {
  float sum = 0.0f;
  for (std::size_t at = place; at < seen_.size(); at += places_.size()) sum += seen_[at].a;
  return sum / static_cast<float>(views());
}

}  // namespace foci
