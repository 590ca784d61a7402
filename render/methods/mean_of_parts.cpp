#include "render/methods/mean_of_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "render/gl/image.h"

namespace foci {
namespace {

float nonlinearOf_px(const std::vector<LensPart>& parts) {
  float squares = 0.0f;
  for (const LensPart& part : parts) squares += part.weight * part.nonlinear_px * part.nonlinear_px;
  return std::sqrt(squares);
}

/// Half a turn in this many directions: those of the rings of 6 and 12 parts.
constexpr int kDirections = 6;

/// Gaussians are applied at a scale where they are at least this wide, in samples.
constexpr double kLeastSigma = 2.5;

int directionOf(const LensPart& part) {
  const double turns = std::atan2(double{part.centre.y}, double{part.centre.x}) / std::numbers::pi;
  const int nearest = static_cast<int>(std::lround(kDirections * turns));
  return (nearest + 2 * kDirections) % kDirections;
}

/// The nearer to the rim, the more of a part's light is in the halos.
float haloWeight(const LensPart& part) { return part.weight * glm::length(part.centre); }

/// `image` with `before_px` more columns and rows at its start, `after_px` at its end. The border
/// goes on beyond the image.
Frame bordered(const Frame& image, const glm::ivec2& before_px, const glm::ivec2& after_px) {
  Frame wide;
  wide.resize(before_px + image.size_px + after_px);
  parallelFor(static_cast<std::size_t>(wide.size_px.y), [&](std::size_t row) {
    const int y = std::clamp(static_cast<int>(row) - before_px.y, 0, image.size_px.y - 1);
    for (int x = 0; x < wide.size_px.x; ++x) {
      wide.rgba[row * static_cast<std::size_t>(wide.size_px.x) + x] =
          image.at(std::clamp(x - before_px.x, 0, image.size_px.x - 1), y);
    }
  });
  return wide;
}

/// Means of blocks of `step` pixels. The border goes on beyond the image.
Frame shrunk(const Frame& image, int step) {
  if (step == 1) return image;
  Frame small;
  small.resize((image.size_px + step - 1) / step);
  const Frame wide = bordered(image, glm::ivec2(0), small.size_px * step - image.size_px);
  parallelFor(static_cast<std::size_t>(small.size_px.y), [&](std::size_t row) {
    for (int x = 0; x < small.size_px.x; ++x) {
      glm::vec4 sum(0.0f);
      for (int dy = 0; dy < step; ++dy) {
        for (int dx = 0; dx < step; ++dx) {
          sum += wide.at(x * step + dx, static_cast<int>(row) * step + dy);
        }
      }
      small.rgba[row * static_cast<std::size_t>(small.size_px.x) + x] =
          sum / static_cast<float>(step * step);
    }
  });
  return small;
}

/// Adds to each pixel of `sum` the linear steps between the blocks of `small`.
void addEnlarged(const Frame& small, int step, Frame& sum) {
  const Frame wide = bordered(small, glm::ivec2(1), glm::ivec2(1));
  const auto place = [&](int pixel) {  // in `wide`
    return (static_cast<float>(pixel) + 0.5f) / static_cast<float>(step) + 0.5f;
  };
  parallelFor(static_cast<std::size_t>(sum.size_px.y), [&](std::size_t row) {
    const float y = place(static_cast<int>(row));
    const int top = static_cast<int>(y);
    const float below = y - static_cast<float>(top);
    for (int column = 0; column < sum.size_px.x; ++column) {
      const float x = place(column);
      const int left = static_cast<int>(x);
      const float share = x - static_cast<float>(left);
      sum.rgba[row * static_cast<std::size_t>(sum.size_px.x) + column] +=
          glm::mix(glm::mix(wide.at(left, top), wide.at(left + 1, top), share),
                   glm::mix(wide.at(left, top + 1), wide.at(left + 1, top + 1), share), below);
    }
  });
}

struct Tap {
  int x, y;
  float weight;
};

/// Adds a Gaussian along a line: samples along the nearer axis, linear between two across it.
void addLine(double direction, double sigma, double share, std::vector<Tap>& taps) {
  const double angle_rad = std::numbers::pi * direction / kDirections;
  const double x = std::cos(angle_rad), y = std::sin(angle_rad);
  const bool steep = std::abs(y) > std::abs(x);
  const double slope = steep ? x / y : y / x, length = std::hypot(1.0, slope);
  const int reach = static_cast<int>(std::ceil(3.5 * sigma / length));
  const std::size_t first = taps.size();
  double sum = 0.0;
  for (int along = -reach; along <= reach; ++along) {
    const double weight = std::exp(-0.5 * std::pow(along * length / sigma, 2));
    sum += weight;
    const int below = static_cast<int>(std::floor(along * slope + 1e-6));
    const double above = std::max(along * slope - below, 0.0);
    for (const auto& [across, part] : {std::pair{below, 1.0 - above}, {below + 1, above}}) {
      if (part < 1e-6) continue;
      taps.push_back(
          {steep ? across : along, steep ? along : across, static_cast<float>(weight * part)});
    }
  }
  for (std::size_t i = first; i < taps.size(); ++i) {
    taps[i].weight *= static_cast<float>(share / sum);
  }
}

/// The halo of one direction. Long lines fan out, or a point of light would be a star.
std::vector<Tap> lineOf(int direction, double sigma, bool fans) {
  std::vector<Tap> taps;
  if (!fans) {
    addLine(direction, sigma, 1.0, taps);
    return taps;
  }
  for (const double aside : {-1.0 / 3.0, 0.0, 1.0 / 3.0}) {
    addLine(direction + aside, sigma, 1.0 / 3.0, taps);
  }
  return taps;
}

/// Adds the image, weighted by the taps.
void addSpread(const Frame& image, const std::vector<Tap>& taps, float share, Frame& sum) {
  int reach = 0;
  for (const Tap& tap : taps) reach = std::max({reach, std::abs(tap.x), std::abs(tap.y)});
  const Frame wide = bordered(image, glm::ivec2(reach), glm::ivec2(reach));
  const glm::ivec2 size_px = image.size_px;
  parallelFor(static_cast<std::size_t>(size_px.y), [&](std::size_t row) {
    constexpr int kBlock = 4;  // pixels whose sums stay in registers
    const int y = static_cast<int>(row);
    glm::vec4* to = &sum.rgba[row * static_cast<std::size_t>(size_px.x)];
    for (int x = 0; x < size_px.x; x += kBlock) {
      const int first = std::min(x, std::max(size_px.x - kBlock, 0));
      const int count = std::min(kBlock, size_px.x);
      glm::vec4 block[kBlock] = {};
      for (const Tap& tap : taps) {
        const glm::vec4* from = &wide.at(first + reach + tap.x, y + reach + tap.y);
        for (int i = 0; i < count; ++i) block[i] += tap.weight * from[i];
      }
      for (int i = x - first; i < count; ++i) to[first + i] += share * block[i];
    }
  });
}

}  // namespace

std::vector<LensPart> partsFor(const Defocus& defocus, const Pupil& pupil, int least) {
  std::vector<LensPart> parts;
  for (const int n : {least, 7, 19, 37, 61}) {
    if (n < least) continue;
    parts = lensParts(defocus, pupil, n);
    if (nonlinearOf_px(parts) <= kNonlinear_px) break;
  }
  return parts;
}

void addPart(Frame& part, float weight, bool first, Frame& sum) {
  const bool depth = !sum.depth_m.empty();
  if (part.gpu && !depth) {
    addOnGpu(part, glm::vec4(weight), first, sum);
    return;
  }
  readFromGpu(part);
  parallelFor(sum.rgba.size(), [&](std::size_t p) {
    const float coverage = part.rgba[p].a;
    sum.rgba[p] = (first ? glm::vec4(0.0f) : sum.rgba[p]) + weight * part.rgba[p];
    if (!depth) return;
    sum.depth_m[p] = (first ? 0.0f : sum.depth_m[p]) + weight * coverage * part.depth_m[p];
  });
}

void finishDepth(Frame& sum) {
  if (sum.depth_m.empty()) return;
  parallelFor(sum.rgba.size(), [&](std::size_t p) {
    if (sum.rgba[p].a > 0.0f) sum.depth_m[p] /= sum.rgba[p].a;
  });
}

Halos::Halos(float diffraction_px, std::vector<LensPart>& parts) {
  const DiffractionHalo halo = diffractionHalo(diffraction_px);
  shown_ = parts.size() > 1 && halo.inHalos() > 0.0f;
  if (!shown_) return;
  std::ranges::stable_sort(parts, {}, directionOf);
  for (const LensPart& part : parts) all_weight_ += haloWeight(part);
  for (std::size_t i = 0; i < halo.halo_px.size(); ++i) {
    // The core is blurred already.
    double variance_px2 = halo.halo_px[i] * halo.halo_px[i] - halo.core_px * halo.core_px;
    int step = 1;
    while (variance_px2 >= std::pow(2.0 * step * kLeastSigma, 2)) step *= 2;
    // The means of blocks and the linear steps between them have the variances (step^2 - 1) / 12
    // and step^2 / 6.
    if (step > 1) variance_px2 -= (step * step - 1) / 12.0 + step * step / 6.0;
    halos_.push_back(
        {.share = halo.halo_share[i], .sigma_px = std::sqrt(variance_px2) / step, .step_px = step});
  }
}

void Halos::add(const LensPart& part, Frame& frame) {
  const int direction = directionOf(part);
  const bool first = direction != direction_;
  if (first) {
    spreadGroup();
    direction_ = direction;
    group_.resize(frame.size_px);
  }
  addPart(frame, haloWeight(part) / all_weight_, first, group_);
}

void Halos::spreadGroup() {
  if (direction_ < 0) return;
  readFromGpu(group_);
  for (Halo& halo : halos_) {
    const Frame small = shrunk(group_, halo.step_px);
    if (halo.light.rgba.empty()) {
      halo.light.resize(small.size_px);
      std::ranges::fill(halo.light.rgba, glm::vec4(0.0f));
    }
    addSpread(small, lineOf(direction_, halo.sigma_px, halo.step_px > 1), halo.share, halo.light);
  }
}

void Halos::spreadInto(Frame& mean) {
  spreadGroup();
  readFromGpu(mean);
  float in_core = 1.0f;
  for (const Halo& halo : halos_) in_core -= halo.share;
  for (glm::vec4& pixel : mean.rgba) pixel *= in_core;
  for (const Halo& halo : halos_) {
    if (halo.step_px > 1) {
      addEnlarged(halo.light, halo.step_px, mean);
    } else {
      for (std::size_t i = 0; i < mean.rgba.size(); ++i) mean.rgba[i] += halo.light.rgba[i];
    }
  }
}

}  // namespace foci
