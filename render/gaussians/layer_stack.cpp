#include "render/gaussians/layer_stack.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace foci {

LensPairs pairLensDiscs(const std::vector<LensDisc>& front, std::vector<LensDisc> behind) {
  const std::size_t n = front.size(), m = behind.size();
  // The weights fall off as a Gaussian that is about as wide as a sub-aperture of the fewer views.
  const auto fewer = static_cast<double>(std::min(n, m));
  std::vector<double> weights(n * m);
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const glm::vec2 apart = behind[i].centre - front[j].centre;
      weights[i * n + j] = std::exp(-2.0 * fewer * double{glm::dot(apart, apart)});
    }
  }
  constexpr int kRounds = 200;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < m; ++i) {
      double sum = 0.0;
      for (std::size_t j = 0; j < n; ++j) sum += weights[i * n + j];
      const double share = static_cast<double>(n) / static_cast<double>(m) / sum;
      for (std::size_t j = 0; j < n; ++j) weights[i * n + j] *= share;
    }
    for (std::size_t j = 0; j < n; ++j) {
      double sum = 0.0;
      for (std::size_t i = 0; i < m; ++i) sum += weights[i * n + j];
      for (std::size_t i = 0; i < m; ++i) weights[i * n + j] /= sum;
    }
  }
  return {std::move(behind), {weights.begin(), weights.end()}};
}

LensPairs eachWithItself(std::vector<LensDisc> discs) {
  const std::size_t n = discs.size();
  std::vector<float> weights(n * n, 0.0f);
  for (std::size_t i = 0; i < n; ++i) weights[i * n + i] = 1.0f;
  return {std::move(discs), std::move(weights)};
}

std::uint64_t LayerStack::render(const ProjectedGaussian* gaussians,
                                 std::span<const std::uint32_t> list, const TileLayers& layers,
                                 int apron, const TileLens& lens, const CompositeJob& job,
                                 TileSums& sums, SampledErrors* errors) {
  layers_ = layers;
  lens_ = lens;
  fragments_ = 0;
  const TileLayer& front = layers.layers[0];
  // The tile's corner, with its aprons.
  const glm::vec2 corner_px = job.first_px - 0.5f * job.step_px;
  for (std::size_t k = 0; k < layers.count; ++k) {
    Layer& layer = stack_[k];
    const TileLayer& own = layers.layers[k];
    layer.gaussians.begin(gaussians, list.first(own.size), shownField(*job.defocus),
                          job.principal_px);
    list = list.subspan(own.size);
    layer.job = job;
    layer.job.gaussians = &layer.gaussians;
    layer.is_seen = k == 0;
    if (k == 0) {
      layer.discs = lens.discs;
    } else {
      layer.discs = &lens.pairs[k - 1]->behind;
      layer.job.first_px = corner_px;
      layer.job.step_px = static_cast<float>(own.step_px);
      layer.job.samples = own.samples;
    }
    if (!errors) {
      layer.spread.beginNone();
    } else if (k == 0) {
      layer.spread.begin(front.samples, apron);
    } else {
      layer.spread.beginBehind(stack_[0].spread, front, own);
    }
  }
  Layer& first = stack_[0];
  for (std::size_t view = 0; view < first.discs->size(); ++view) {
    first.job.lens = (*first.discs)[view];
    first.job.behind = behindOf(0, view);
    fragments_ += compositeTile(first.job, sums, first.spread.places(), first.spread.next());
  }
  if (errors) {
    if (lens.judges && first.discs->size() == 1) judge();
    *errors = this->errors();
  }
  return fragments_;
}

void LayerStack::judge() {
  const Layer& first = stack_[0];
  CompositeJob job = first.job;
  const auto [from, apart] = judging_.beginBeside(first.spread);
  job.first_px += static_cast<float>(from) * job.step_px;
  job.step_px *= static_cast<float>(apart);
  job.samples = judging_.along();
  for (const LensDisc& disc : *lens_.judges) {
    job.lens = disc;
    fragments_ += seeTile(job, judging_.places(), judging_.next());
  }
}

std::function<const BehindPlanes&()> LayerStack::behindOf(std::size_t layer, std::size_t view) {
  if (layer + 1 == layers_.count) return nullptr;
  return [this, layer, view]() -> const BehindPlanes& { return behind(layer + 1, view); };
}

const BehindPlanes& LayerStack::behind(std::size_t layer, std::size_t view) {
  if (!std::exchange(stack_[layer].is_seen, true)) composite(layer);
  return stack_[layer].behind[view];
}

void LayerStack::composite(std::size_t k) {
  Layer& layer = stack_[k];
  const std::size_t n = stack_[k - 1].discs->size();
  if (layer.samples.size() < n) {
    layer.samples.resize(n);
    layer.behind.resize(n);
  }
  const std::span views = std::span(layer.samples).first(n);
  for (BehindPlanes& each : views) {
    for (auto& plane : each.planes) std::fill_n(plane, placesOf(layer.job.samples), 0.0f);
  }
  const std::span weights(lens_.pairs[k - 1]->weights);
  for (std::size_t i = 0; i < layer.discs->size(); ++i) {
    layer.job.lens = (*layer.discs)[i];
    layer.job.behind = behindOf(k, i);
    fragments_ += compositeBehind(layer.job, weights.subspan(i * n, n), views,
                                  layer.spread.places(), layer.spread.next());
  }
  const TileLayer& before = layers_.layers[k - 1];
  const float step =
      static_cast<float>(before.step_px) / static_cast<float>(layers_.layers[k].step_px);
  const Resampling resampling{.from_samples = layer.job.samples,
                              .to_samples = before.samples,
                              .first = k == 1 ? 0.5f * step : 0.0f,
                              .step = step};
  for (std::size_t j = 0; j < n; ++j) {
    interpolateBehind(resampling, layer.samples[j], layer.behind[j]);
  }
}

BehindSample LayerStack::meanBehind(std::size_t layer, std::size_t place) const {
  const std::size_t next = layer + 1;
  if (next == layers_.count || !stack_[next].is_seen) {
    return {.display = stack_[layer].job.background};
  }
  const std::size_t n = stack_[layer].discs->size();
  BehindSample mean;
  for (const BehindPlanes& each : std::span(stack_[next].behind).first(n)) {
    for (int c = 0; c < 3; ++c) {
      const auto channel = static_cast<std::size_t>(c);
      mean.display[c] += each.planes[BehindPlanes::red + channel][place];
      mean.light[c] += each.planes[BehindPlanes::light_red + channel][place];
    }
  }
  const float share = 1.0f / static_cast<float>(n);
  return {share * mean.display, share * mean.light};
}

SampledErrors LayerStack::errors() const {
  const std::size_t count = stack_[0].spread.places().size();
  SampledErrors errors{.layers_jnd = {}, .count = count};
  std::array<float, SampledErrors::kMost> through;
  through.fill(1.0f);
  for (std::size_t k = 0; k < layers_.count && stack_[k].is_seen; ++k) {
    const ViewSpread& spread = stack_[k].spread;
    auto& own = errors.layers_jnd[k];
    const float radius_px = layers_.layers[k].blur.radius_px;
    std::array<BehindSample, SampledErrors::kMost> samples;
    for (std::size_t i = 0; i < count; ++i) samples[i] = meanBehind(k, spread.places()[i]);
    const auto behind = std::span(samples).first(count);
    if (stack_[k].discs->size() > 1) {
      own = spread.errorsOfMean(*stack_[k].discs, radius_px, behind);
    } else if (lens_.judges && k == 0) {
      own = spread.errorsOfOne(judging_, behind);
    }
    for (std::size_t i = 0; i < count; ++i) {
      own[i] *= through[i];
      through[i] *= spread.transmittance(i);
    }
  }
  return errors;
}

}  // namespace foci
