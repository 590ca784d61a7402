#include "app/evaluation/stability/trial.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "base/quantile.h"
#include "render/image/metrics.h"

namespace foci {
namespace {

constexpr double kMax_dB = 99.0;          // PSNR of equal frames is infinite: charts need a number
constexpr double kShareOfPixels = 0.999;  // whose change a popping score bounds; chosen by eye

Frame minus(Frame frame, const Frame& without) {
  for (std::size_t i = 0; i < frame.rgba.size(); ++i) frame.rgba[i] -= without.rgba[i];
  return frame;
}

}  // namespace

StabilityTrial::StabilityTrial(const StabilityScene& scene, float value,
                               const StabilityEffort& effort)
    : setup_(scene.setup(value)), effort_(effort) {
  assert(!scene.observe);
}

Frame StabilityTrial::render(std::string_view method, const SurfelCloud& cloud) const {
  Frame frame;
  makeMethod(method, cloud)->render(setup_.view, setup_.settings, frame);
  return frame;
}

const std::vector<Frame>& StabilityTrial::references() {
  if (!references_.empty()) return references_;
  View view = setup_.view;
  RenderSettings settings = setup_.settings;
  for (int k = 0; k <= (setup_.step ? effort_.steps : 0); ++k) {
    if (k > 0) setup_.step(view, settings);
    if (setup_.truth) {
      references_.push_back(setup_.truth(view, settings, effort_.samples));
    } else {
      makeMethod("accumulate:" + std::to_string(effort_.samples), setup_.cloud)
          ->render(view, settings, references_.emplace_back());
    }
  }
  return references_;
}

const Frame& StabilityTrial::reference() { return references().back(); }

double StabilityTrial::popping(std::string_view method) {
  const auto tested = makeMethod(method, setup_.cloud);
  View view = setup_.view;
  RenderSettings settings = setup_.settings;
  double max = 0.0;
  tested->render(view, settings, rendered_);
  for (std::size_t k = 1; k < references().size(); ++k) {
    const Frame before = rendered_, &exact = references()[k], &exact_before = references()[k - 1];
    setup_.step(view, settings);
    tested->render(view, settings, rendered_);
    std::vector<double> extra;
    for (std::size_t i = 0; i < rendered_.rgba.size(); ++i) {
      const glm::vec3 change = glm::abs(glm::vec3(rendered_.rgba[i] - before.rgba[i]));
      const glm::vec3 own = glm::abs(glm::vec3(exact.rgba[i] - exact_before.rgba[i]));
      const glm::vec3 beyond = glm::max(change - own, glm::vec3(0.0f));
      extra.push_back(std::max({beyond.x, beyond.y, beyond.z}));
    }
    max = std::max(max, quantile(extra, kShareOfPixels));
  }
  return max;
}

double StabilityTrial::score(std::string_view method) {
  if (setup_.step) return popping(method);
  rendered_ = render(method, setup_.cloud);
  if (setup_.without) rendered_ = minus(std::move(rendered_), render(method, *setup_.without));
  if (setup_.score) return setup_.score(rendered_);
  return std::min(psnr_dB(rendered_, reference()), kMax_dB);
}

}  // namespace foci
