// The default method. It picks the cheapest quality level whose predicted error stays within
// `quality.tolerance`. A table predicts the error of a level from the largest blur in view
// (quality_level_table.cpp). Where the table asks for sub-apertures, `auto` renders a few squares
// of the frame at each level and measures the error instead (spot_check.h). A frame-time budget may
// force a cheaper level. `auto:N` always renders at one level. Source: our own. Known failure: the
// prediction holds for the scenes of the table and for the squares. A scene that is harder at a
// blur of a few pixels, where no squares are rendered, exceeds the prediction. So does a detail
// that the squares miss.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "render/methods/gaussian_methods.h"
#include "render/methods/lod_splats.h"
#include "render/methods/method.h"
#include "render/methods/quality_level_table.h"
#include "render/methods/sharp_views.h"
#include "render/methods/spot_check.h"
#include "render/methods/time_budget.h"

namespace foci {
namespace {

/// `auto` returns to a cheaper level only if its predicted error is this far below the tolerance.
/// This hysteresis avoids flicker. Chosen by hand; bounded by AutoTest.DoesNotFlickerBetweenLevels.
constexpr float kReserve = 0.9f;

/// If no level meets the tolerance, the tolerance is relaxed to this factor times the best level's
/// error. Chosen by hand: with the reserve above, the best level itself must still qualify.
constexpr float kRelaxed = 1.15f;
static_assert(kRelaxed * kReserve > 1.0f);

/// The squares are rendered anew after this many frames, or where the blur has changed by this
/// factor. Chosen by hand: the squares take at most about as long as one frame, so they cost below
/// 2 % of the time.
constexpr int kFramesBetweenChecks = 60;
constexpr float kBlurChange = 1.5f;

/// If no level fits the budget, blurring the sharp image is preferred to the softest level unless
/// it takes this many times longer. Chosen by hand.
constexpr float kSlower = 2.0f;

class AutoMethod final : public Method {
 public:
  /// @param forced  render every frame at this level; nullopt chooses one per frame
  AutoMethod(const SurfelCloud& cloud, std::optional<QualityLevel> forced, const SharedGpu& gpu)
      : scene_(cloud, gpu), sharp_views_(std::make_shared<SharpViews>()), forced_(forced) {}

  std::unique_ptr<Method> cloneSharingScene() const override {
    return std::make_unique<AutoMethod>(*this, nullptr);
  }
  AutoMethod(const AutoMethod& other, std::nullptr_t)
      : scene_(other.scene_, nullptr), sharp_views_(other.sharp_views_), forced_(other.forced_) {}

  void prepare(const View& view, const RenderSettings& settings) override {
    sharpViewOf(unblurred(view, settings));
  }

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    const Quality& quality = settings.quality;
    const float blur_px = maxBlur_px(view, settings);
    const UnblurredView now = unblurred(view, settings);
    const bool moved = now != last_view_;
    if (!quality.keep_level) last_view_ = now;
    const std::optional<QualityLevel> forced = forced_ ? forced_ : quality.quality_level;
    const QualityLevel level = forced               ? *forced
                               : quality.keep_level ? last_level_
                                                    : choose(now, settings, blur_px, frame);
    last_level_ = level;

    const auto start = std::chrono::steady_clock::now();
    RenderStats stats = renderAt(level, view, settings, frame);
    squares_.reset();
    if (!quality.keep_level && !forced) {
      const std::chrono::duration<float, std::milli> took =
          std::chrono::steady_clock::now() - start;
      time_.took(level, took.count(), moved);
    }
    stats.tolerance_error =
        forced ? settingsOf(level).error(blur_px) : expectedError(level, blur_px);
    stats.full_quality = forced || level == wanted_;
    stats.quality_level = level;
    return stats;
  }

  void passFrame(const View& view, const RenderSettings& settings) override {
    if (forced_ || settings.quality.quality_level || settings.quality.keep_level) return;
    last_view_ = unblurred(view, settings);
    Frame frame;
    frame.resize(view.size_px, settings.depth);
    last_level_ = choose(last_view_, settings, maxBlur_px(view, settings), frame);
    squares_.reset();
  }

 private:
  /// A level's settings under the observer's acuity.
  static LodSettings lodOf(const LevelSettings& level, const Quality& quality) {
    LodSettings lod = level.lod;
    if (level.lod.cut.acuity == Acuity{}) {
      lod.cut.acuity = quality.acuity;
    } else {  // the softer of both
      lod.cut.acuity.gaze_px = quality.acuity.gaze_px;
      lod.cut.acuity.per_px = quality.acuity.per_px;
    }
    return lod;
  }

  RenderStats renderAt(QualityLevel level, const View& view, const RenderSettings& settings,
                       Frame& frame) {
    if (level == QualityLevel::post_filtered) {
      const auto sharp = sharpViewOf(unblurred(view, settings));
      sharp->pyramid.blur(settings.defocus, frame);
      return sharp->stats;
    }
    RenderSettings at_level = settings;
    if (settingsOf(level).sharp) at_level.defocus.radius_px_per_D = glm::vec2(0.0f);
    return scene_.render(view, at_level, lodOf(settingsOf(level), settings.quality), frame);
  }

  /// Renders the sharp image where it is not there yet.
  std::shared_ptr<const SharpView> sharpViewOf(const UnblurredView& asked) {
    if (auto there = sharp_views_->find(asked)) return there;
    auto sharp = std::make_shared<SharpView>();
    Frame frame;
    frame.resize(asked.view.size_px, true);
    sharp->stats = scene_.render(asked.view,
                                 {.defocus = {.along = asked.along},
                                  .background = asked.background,
                                  .shading = asked.shading,
                                  .depth = true},
                                 {.cut = kFaithfulCut}, frame);
    readFromGpu(frame);
    sharp->pyramid.set(std::move(frame), asked.view.focal_px);
    sharp->view = asked;
    sharp_views_->add(sharp);
    return sharp;
  }

  /// The largest blur radius in view, with the aberrations.
  float maxBlur_px(const View& view, const RenderSettings& settings) const {
    const Defocus& defocus = settings.defocus;
    const auto distances = distancesInView(scene_.tree(), view, defocus);
    if (!distances) return 0.0f;
    const float max_D = std::max(maxDefocus_D(defocus, 1.0f / distances->first),
                                 maxDefocus_D(defocus, 1.0f / distances->second));
    return max_D * std::max(defocus.radius_px_per_D.x, defocus.radius_px_per_D.y) +
           aberrationRadius_px(defocus, settings.pupil);
  }

  /// @param frame  of the view's size; its pixels are overwritten until `squares_` ends
  QualityLevel choose(const UnblurredView& view, const RenderSettings& settings, float blur_px,
                      Frame& frame) {
    const Quality& quality = settings.quality;
    const bool budget = quality.frame_ms && !std::isinf(*quality.frame_ms);
    if (budget) {
      checked_.reset();
    } else {
      check(view, settings, blur_px, frame);
    }
    const float allowed = allowedError(quality, blur_px);
    const auto within = [&](float error) {
      return cheapestWithin(error, quality.tolerance, blur_px);
    };
    const QualityLevel cheapest = within(allowed);
    wanted_ = wanted_ ? std::clamp(*wanted_, cheapest, within(kReserve * allowed)) : cheapest;
    return budget ? levelWithin(*quality.frame_ms, view) : *wanted_;
  }

  /// @param tolerance  of the study: no relaxed error allows a frame without blur
  QualityLevel cheapestWithin(float error, float tolerance, float blur_px) const {
    return *std::ranges::find_if(kToleranceLevels, [&](QualityLevel level) {
      const float most = level == QualityLevel::sharp ? std::min(error, tolerance) : error;
      return level == kToleranceLevels.back() || expectedError(level, blur_px) <= most;
    });
  }

  /// The best level that fits the budget, but none better than the tolerance wants.
  QualityLevel levelWithin(float budget_ms, const UnblurredView& view) const {
    // A frame without blur must be wanted: time alone does not justify it.
    const QualityLevel cheapest = std::min(*wanted_, QualityLevel::coarse);
    for (auto level = kToleranceLevels.rbegin(); level != kToleranceLevels.rend(); ++level) {
      if (*level <= *wanted_ && *level >= cheapest && time_.fits(*level, budget_ms)) return *level;
    }
    if (sharp_views_->find(view) && (time_.fits(QualityLevel::post_filtered, budget_ms) ||
                                     time_.expected_ms(QualityLevel::post_filtered) <=
                                         kSlower * time_.expected_ms(QualityLevel::softest))) {
      return QualityLevel::post_filtered;
    }
    return time_.fits(QualityLevel::soft, budget_ms) ? QualityLevel::soft : QualityLevel::softest;
  }

  /// The error from the squares of the frame where they were rendered, and from the table
  /// otherwise.
  float expectedError(QualityLevel level, float blur_px) const {
    const float tabled = settingsOf(level).error(blur_px);
    if (!checked_ || level > kToleranceLevels.back()) return tabled;
    if (level < QualityLevel::whole_aperture) {
      return std::max(tabled, expectedError(QualityLevel::whole_aperture, blur_px));
    }
    const std::optional<float>& difference = checked_->difference[static_cast<std::size_t>(level)];
    return difference ? std::hypot(referenceSettings().error(blur_px), *difference) : tabled;
  }

  /// The tolerance, relaxed where no level meets it.
  float allowedError(const Quality& quality, float blur_px) const {
    float best = std::numeric_limits<float>::infinity();
    for (const QualityLevel level : kToleranceLevels) {
      best = std::min(best, expectedError(level, blur_px));
    }
    return std::max(quality.tolerance, kRelaxed * best);
  }

  /// Renders squares of the frame where the table asks for sub-apertures: surfaces may overlap in
  /// much of the view or in none of it. They also tell how fine an LOD cut the frame needs.
  void check(const UnblurredView& view, const RenderSettings& settings, float blur_px,
             Frame& frame) {
    const Quality& quality = settings.quality;
    const float best = settingsOf(kToleranceLevels.back()).error(blur_px);
    if (settingsOf(QualityLevel::whole_aperture).error(blur_px) <=
        kReserve * std::max(quality.tolerance, kRelaxed * best)) {
      checked_.reset();
      return;
    }
    if (checked_ && stillHolds(*checked_, view, settings.defocus, blur_px)) return;
    const float reference_error = referenceSettings().error(blur_px);
    squares_.emplace(scene_, view.view, settings, lodOf(referenceSettings(), quality), frame);
    checked_ = {.view = view, .defocus = settings.defocus, .blur_px = blur_px, .difference = {}};
    for (const QualityLevel level : kToleranceLevels) {
      if (level < QualityLevel::whole_aperture) continue;
      const float allowed = allowedError(quality, blur_px);
      const float unseen = std::min(reference_error, allowed);  // by the squares
      const float limit = std::sqrt(allowed * allowed - unseen * unseen);
      checked_->difference[static_cast<std::size_t>(level)] =
          squares_->error(lodOf(settingsOf(level), quality), limit);
      if (expectedError(level, blur_px) <= allowedError(quality, blur_px)) break;
    }
  }

  /// The error on squares of a frame.
  struct Checked {
    UnblurredView view;
    Defocus defocus;
    float blur_px = 0.0f;
    int renders = 0;  // since then
    /// Of the levels that were rendered: the error against the reference.
    std::array<std::optional<float>, kToleranceLevels.size()> difference;
  };

  static bool stillHolds(Checked& checked, const UnblurredView& view, const Defocus& defocus,
                         float blur_px) {
    if (checked.view == view && checked.defocus == defocus) return true;
    const float change = blur_px / checked.blur_px;
    return ++checked.renders < kFramesBetweenChecks && change < kBlurChange &&
           change > 1.0f / kBlurChange;
  }

  LodSplats scene_;
  std::shared_ptr<SharpViews> sharp_views_;
  std::optional<QualityLevel> forced_;
  QualityLevel last_level_ = QualityLevel::sharp;  // of the previous render
  std::optional<QualityLevel> wanted_;             // by the tolerance alone
  std::optional<Checked> checked_;
  std::optional<SpotCheck> squares_;  // until their frame is rendered
  TimeBudget time_{relativeTimes(), scene_.isOnGpu()};
  UnblurredView last_view_;  // of the previous render
};

}  // namespace

MethodEntry autoMethod() {
  return {
      .info = {.name = kAutoMethod,
               .summary = "sweep-lod at the cheapest quality level that the tolerance, or the "
                          "frame-time budget, allows",
               .source = "our own",
               .family = MethodFamily::own,
               .max_n = static_cast<int>(kQualityLevels),
               .aberrations = true,
               .gpu = true,
               .lod = true},
      .make = [](const SurfelCloud& cloud, int n, const SharedGpu& gpu) -> std::unique_ptr<Method> {
        return std::make_unique<AutoMethod>(cloud, qualityLevelNumbered(n), gpu);
      },
      .make_of_gaussians = gaussianAuto};
}

}  // namespace foci
