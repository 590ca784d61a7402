#include "render/methods/spot_check.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "base/parallel.h"
#include "base/quantile.h"
#include "render/image/metrics.h"
#include "render/methods/lens_samples.h"
#include "render/optics/lens_field.h"
#include "render/splat/sweep.h"

namespace foci {
namespace {

/// Many small squares miss less than few large ones, whose pixels err alike: on 6 frames, 144 of
/// 16 px had .88 to 1.21 of the frame's error, and 64 of 32 px .78 to 1.94.
constexpr int kSquare_px = 16;
constexpr std::size_t kSquares = 144;

/// Fewer squares than one in so many do not tell the error.
constexpr std::size_t kOneInSquares = 4;

/// The error of the truth over the difference of its halves. Parts of each half leave half of the
/// lens open, so the halves err by much more than all parts: on 18 frames of 7 scenes with 3 to 25
/// px of blur, against 400 views, the ratio is .03 to .09. Points: their variance falls at most
/// with the cube of their number, so that the mean of two halves that differ by D errs by
/// D / sqrt(4 (8 - 1)).
constexpr float kPartsOfHalves = 0.09f, kPointsOfHalves = 0.19f;

/// The truth merges so much of what levels merge: on a fence of 96 px, their merging alone errs by
/// .1 just-noticeable differences.
constexpr float kMerged = 0.25f;

/// A level of a square takes about as long as this many views of it.
constexpr std::size_t kViewsALevel = 8;

/// Views of a step over the tiles of the frame: the step takes about a quarter of a frame's time.
constexpr double kShareOfFrame = 0.4;

/// Of `count` different squares, spread evenly by the R2 sequence (Roberts, The Unreasonable
/// Effectiveness of Quasirandom Sequences, 2018).
std::vector<glm::ivec2> tilesIn(const glm::ivec2& tiles, std::size_t count) {
  std::vector<glm::ivec2> found;
  for (int k = 0; found.size() < count; ++k) {
    const glm::dvec2 at =
        glm::fract(0.5 + static_cast<double>(k) * glm::dvec2(0.7548776662, 0.5698402910));
    const glm::ivec2 tile(at * glm::dvec2(tiles));
    if (std::ranges::find(found, tile) == found.end()) found.push_back(tile);
  }
  return found;
}

std::vector<float> apartOf(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  std::vector<float> apart(a.size());
  std::ranges::transform(a, b, apart.begin(), [](const glm::vec3& x, const glm::vec3& y) {
    return glm::distance(x, y) / kJustNoticeable;
  });
  return apart;
}

void addTo(Frame& sum, float weight, const Frame& frame) {
  for (std::size_t p = 0; p < frame.rgba.size(); ++p) sum.rgba[p] += weight * frame.rgba[p];
}

/// Whether the lens is no disc of one vergence.
bool hasWavefront(const RenderSettings& settings) {
  return settings.pupil.hasParts() || shownField(settings.defocus);
}

/// The resolution at which an eye in focus sees as much of an image as an eye of this acuity at the
/// place that it sees best, at least the usual one.
double seenPx_per_deg(const Acuity& acuity, const glm::ivec2& size_px) {
  if (acuity.per_px == 0.0f) return kUsualPx_per_deg;
  const glm::vec2 nearest = glm::clamp(acuity.gaze_px, glm::vec2(0.0f), glm::vec2(size_px));
  const float sigma_px = acuity.eye_px(glm::distance(acuity.gaze_px, nearest));
  return std::max(kUsualPx_per_deg, sigma_px / kEye_deg);
}

}  // namespace

std::vector<LensPart> partsOfTruth(const RenderSettings& settings, float blur_px) {
  const int n = blur_px == 0.0f ? 4 : blur_px <= 12.0f ? 32 : 64;
  if (hasWavefront(settings))
    return lensPoints(settings.defocus, settings.pupil, lensSamples(4 * n));
  return lensParts(settings.defocus, withoutDiffraction(settings.pupil), n);
}

SpotCheck::SpotCheck(std::shared_ptr<const MomentTree> tree, const View& view,
                     const RenderSettings& settings, float blur_px, std::vector<LodSettings> levels)
    : tree_(std::move(tree)),
      settings_(settings),
      blur_px_(blur_px),
      levels_(std::move(levels)),
      parts_(partsOfTruth(settings, blur_px)) {
  settings_.depth = false;
  const glm::ivec2 tiles = (view.size_px + kSquare_px - 1) / kSquare_px;
  const auto all = static_cast<std::size_t>(tiles.x) * static_cast<std::size_t>(tiles.y);
  views_a_step_ = static_cast<std::size_t>(std::ceil(kShareOfFrame * static_cast<double>(all)));
  for (const glm::ivec2& tile : tilesIn(tiles, std::min(kSquares, all))) {
    Square square;
    square.corner_px = tile * kSquare_px;
    square.view = view;
    square.view.size_px = glm::min(glm::ivec2(kSquare_px), view.size_px - square.corner_px);
    square.view.principal_px -= glm::vec2(square.corner_px);
    square.acuity = levels_.front().cut.acuity;
    square.acuity.gaze_px -= glm::vec2(square.corner_px);
    square.px_per_deg = seenPx_per_deg(square.acuity, square.view.size_px);
    for (Frame& each : square.halves) each.resize(square.view.size_px);
    square.apart.resize(levels_.size());
    squares_.push_back(std::move(square));
  }
}

SpotCheck::Job SpotCheck::job(std::size_t number) const {
  const std::size_t first = squares_.size() * firstJobs();
  if (number >= first) {
    const std::size_t others = levels_.size() - 1;
    return {
        .square = (number - first) / others, .level = 1 + (number - first) % others, .view = {}};
  }
  const std::size_t square = number / firstJobs(), of_square = number % firstJobs();
  if (of_square == 0) return {.square = square, .level = 0, .view = {}};
  return {.square = square, .level = {}, .view = of_square - 1};
}

std::unique_ptr<SpotCheck::Buffers> SpotCheck::idleBuffers() {
  const std::lock_guard lock(mutex_);
  if (idle_.empty()) return std::make_unique<Buffers>(tree_);
  auto last = std::move(idle_.back());
  idle_.pop_back();
  return last;
}

/// The cut for all views of a square. It leaves out the surfels that none of them shows: a cut's
/// ranges are much larger than squares.
Cut SpotCheck::cutOf(const Square& square) const {
  const View& view = square.view;
  CutSettings settings = kPixelCut;
  settings.per_pixel2 *= kMerged;
  settings.acuity = widened(square.acuity, settings_.pupil);
  // A wavefront moves light aside of the disc of blur.
  const float margin_px = 1.0f + (hasWavefront(settings_) ? blur_px_ : 0.0f);
  settings.margin_px = static_cast<int>(std::ceil(margin_px));
  Cut all, seen;
  const Defocus& defocus = settings_.defocus;
  selectCut(*tree_, view, defocus, settings, all);
  const SurfelCloud& surfels = tree_->surfels();
  const float focal_px = std::max(view.focal_px.x, view.focal_px.y),
              radius_px_per_D = std::max(defocus.radius_px_per_D.x, defocus.radius_px_per_D.y);
  const auto add = [&](const CutEntry& entry) {
    const glm::vec3 p(view.eye_from_world * glm::vec4(surfels.position_m[entry.index], 1.0f));
    const float sigma_m = largestSigma(surfels, entry.index),
                size_m = 2.0f * kWidestReach * sigma_m;
    const float near_m = std::max(-p.z - size_m, view.near_m), far_m = glm::length(p) + size_m;
    const float blur_px = radius_px_per_D * std::max(maxDefocus_D(defocus, 1.0f / near_m),
                                                     maxDefocus_D(defocus, 1.0f / far_m));
    const glm::vec2 at = project(view, p), size(view.size_px);
    const float finest_px = settings.acuity.finest_px(glm::distance(at, settings.acuity.gaze_px));
    // Aside of the axis, a length along it shows, too.
    const float sigma_px = focal_px * sigma_m / near_m * glm::length(p) / std::abs(p.z);
    const float reach_px = margin_px + blur_px + kWidestReach * std::hypot(finest_px, sigma_px);
    const bool outside = glm::any(glm::lessThan(at, glm::vec2(-reach_px))) ||
                         glm::any(glm::greaterThan(at, size + reach_px));
    if (p.z > -2.0f * view.near_m || !outside) seen.surfels.push_back(entry);
  };
  for (const CutEntry& entry : all.surfels) add(entry);
  for (const CutRange& range : all.ranges) {
    for (std::uint32_t i = range.begin; i < range.end; ++i) add({i, 1.0f});
  }
  seen.nodes = std::move(all.nodes);
  return seen;
}

Frame SpotCheck::render(const Job& job) {
  const Square& square = squares_[job.square];
  Frame frame;
  frame.resize(square.view.size_px);
  auto buffers = idleBuffers();
  if (job.level) {
    LodSettings lod = levels_[*job.level];
    lod.cut.acuity = square.acuity;
    buffers->levels.render(square.view, settings_, lod, frame);
  } else {
    const LensPart& part = parts_[*job.view];
    projectCut(*tree_, square.cut, viewOfPart(square.view, part), part.defocus,
               {.lens = part.centre,
                .aperture = part.radius,
                .acuity = widened(square.acuity, settings_.pupil),
                .lighting = settings_.lighting},
               buffers->chunks);
    buffers->lists.build(buffers->chunks, square.view.size_px);
    sweep(buffers->chunks, buffers->lists,
          {.background = settings_.lighting.background,
           .defocus = part.defocus,
           .principal_px = square.view.principal_px},
          frame);
  }
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(buffers));
  return frame;
}

void SpotCheck::compareViews(Square& square) const {
  const auto labOf = [&](std::initializer_list<std::size_t> halves) {
    Frame mean;
    mean.resize(square.view.size_px);
    float light = 0.0f;
    for (const std::size_t h : halves) {
      for (std::size_t i = h; i < parts_.size(); i += 2) light += parts_[i].weight;
    }
    for (const std::size_t h : halves) addTo(mean, 1.0f / light, square.halves[h]);
    return foci::labOf(mean, square.px_per_deg);
  };
  square.truth = labOf({0, 1});
  square.halves_apart = apartOf(labOf({0}), labOf({1}));
  square.apart[0] = apartOf(square.first, square.truth);
  square.halves = {};
  square.cut = {};
}

void SpotCheck::step() {
  std::vector<Job> jobs;
  for (std::size_t views = 0; views < views_a_step_ && !isDone(); ++done_) {
    jobs.push_back(job(done_));
    views += jobs.back().level ? kViewsALevel : 1;
  }
  parallelFor(jobs.size(), [&](std::size_t i) {
    Square& square = squares_[jobs[i].square];
    if (jobs[i].level == 0u) square.cut = cutOf(square);
  });
  std::vector<Frame> frames(jobs.size());
  parallelFor(jobs.size(), [&](std::size_t i) { frames[i] = render(jobs[i]); });
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const auto& [number, level, view] = jobs[i];
    Square& square = squares_[number];
    if (view) addTo(square.halves[*view % 2], parts_[*view].weight, frames[i]);
    if (level == 0u) square.first = labOf(frames[i], square.px_per_deg);
  }
  parallelFor(jobs.size(), [&](std::size_t i) {
    if (jobs[i].view && *jobs[i].view + 1 == parts_.size()) compareViews(squares_[jobs[i].square]);
  });
  parallelFor(jobs.size(), [&](std::size_t i) {
    if (jobs[i].level.value_or(0) == 0) return;
    Square& square = squares_[jobs[i].square];
    square.apart[*jobs[i].level] = apartOf(labOf(frames[i], square.px_per_deg), square.truth);
  });
}

template <typename ValuesOf>
std::optional<float> SpotCheck::quantileOf(const ValuesOf& valuesOf) const {
  std::vector<float> all;
  std::size_t compared = 0;
  for (const Square& square : squares_) {
    const std::vector<float>& values = valuesOf(square);
    all.insert(all.end(), values.begin(), values.end());
    compared += values.empty() ? 0 : 1;
  }
  if (kOneInSquares * compared < squares_.size()) return std::nullopt;
  return static_cast<float>(quantile(all, 0.95));
}

std::optional<float> SpotCheck::error(std::size_t level) const {
  return quantileOf(
      [&](const Square& square) -> const std::vector<float>& { return square.apart[level]; });
}

std::optional<float> SpotCheck::errorOfTruth() const {
  const auto halves = quantileOf(
      [](const Square& square) -> const std::vector<float>& { return square.halves_apart; });
  if (!halves) return std::nullopt;
  return (hasWavefront(settings_) ? kPointsOfHalves : kPartsOfHalves) * *halves;
}

}  // namespace foci
