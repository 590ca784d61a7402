// The default method. It picks the cheapest quality level whose predicted error stays within
// `quality.tolerance`. A few squares of the frame at each level are compared with the mean of what
// many small parts of the lens see (spot_check.h), some of them in each frame. Until all are
// compared, `auto` renders at a level that suffices for most scenes. Under a frame-time budget,
// which may force a cheaper level, a table predicts the error from the largest blur in view
// (quality_level_table.cpp). `auto:N` always renders at one level. Source: our own. Known failure:
// a detail that the squares miss exceeds the prediction.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "render/methods/blur_pyramid.h"
#include "render/methods/gaussian_methods.h"
#include "render/methods/lod_splats.h"
#include "render/methods/method.h"
#include "render/methods/quality_level.h"
#include "render/methods/quality_level_table.h"
#include "render/methods/spot_check.h"
#include "render/optics/lens_field.h"

namespace foci {
namespace {

/// `auto` returns to a cheaper level only if its predicted error is this far below the tolerance.
/// This hysteresis avoids flicker. Chosen by hand; bounded by AutoTest.DoesNotFlickerBetweenLevels.
constexpr float kReserve = 0.9f;

/// If no level meets the tolerance, the tolerance is relaxed to this factor times the best level's
/// error. Chosen by hand: with the reserve above, the best level itself must still qualify.
constexpr float kRelaxed = 1.15f;
static_assert(kRelaxed * kReserve > 1.0f);

/// Errors of one blur are used for others within this factor. Changes below the first do not show.
/// Chosen by hand.
constexpr float kInvisible_px = 0.5f, kBlurChange = 1.5f;

/// Age in frames, in all and for each frame that it took, that a check is repeated at. It is no
/// longer used at twice this age. Chosen by hand, so that checks of one blur take part
/// in at most one frame of 20.
constexpr int kMinAge = 60, kStepAge = 20;

/// The prediction over the squares' error: in the middle of 1 and 1.5, so that few predictions are
/// too low or much too high, over .94. So much of the error do the squares tell, on 8 scenes at 3
/// to 25 px, since the truth shares the rest.
constexpr float kOfSquares = 1.3f;

/// The table's errors are exceeded up to so many times on scenes that it was not measured on.
constexpr float kUnmeasured = 4.0f;

/// The levels that squares compare.
constexpr std::array kCompared{QualityLevel::sharp, QualityLevel::coarse,
                               QualityLevel::whole_aperture, QualityLevel::sub_apertures,
                               QualityLevel::fine};

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
                                                    : choose(now, settings, blur_px);
    last_level_ = level;

    const auto start = std::chrono::steady_clock::now();
    RenderStats stats = renderAt(level, view, settings, blur_px, frame);
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
    last_level_ = choose(last_view_, settings, maxBlur_px(view, settings));
  }

 private:
  /// A level's settings under the observer's acuity.
  static LodSettings lodOf(QualityLevel of, const RenderSettings& settings, float blur_px) {
    const Quality& quality = settings.quality;
    const LevelSettings& level = settingsOf(of);
    LodSettings lod = level.lod;
    if (of == QualityLevel::thorough) lod.parts = partsOfTruth(settings, blur_px);
    if (level.lod.cut.acuity == Acuity{}) {
      lod.cut.acuity = quality.acuity;
    } else {  // the softer of both
      lod.cut.acuity.gaze_px = quality.acuity.gaze_px;
      lod.cut.acuity.per_px = quality.acuity.per_px;
    }
    return lod;
  }

  RenderStats renderAt(QualityLevel level, const View& view, const RenderSettings& settings,
                       float blur_px, Frame& frame) {
    if (level == QualityLevel::post_filtered) {
      const auto sharp = sharpViewOf(unblurred(view, settings));
      sharp->pyramid.blur(settings.defocus, frame);
      return sharp->stats;
    }
    return scene_.render(view, settings, lodOf(level, settings, blur_px), frame);
  }

  /// Renders the sharp image where it is not there yet.
  std::shared_ptr<const SharpView> sharpViewOf(const UnblurredView& asked) {
    if (auto there = sharp_views_->find(asked)) return there;
    auto sharp = std::make_shared<SharpView>();
    Frame frame;
    frame.resize(asked.view.size_px, true);
    sharp->stats = scene_.render(
        asked.view, {.defocus = {.along = asked.along}, .lighting = asked.lighting, .depth = true},
        {.cut = kFaithfulCut}, frame);
    readFromGpu(frame);
    sharp->pyramid.set(std::move(frame), asked.view);
    sharp->view = asked;
    sharp_views_->add(sharp);
    return sharp;
  }

  /// The largest blur radius in view, with the aberrations.
  float maxBlur_px(const View& view, const RenderSettings& settings) const {
    const Defocus& defocus = settings.defocus;
    const auto distances = distancesInView(*scene_.tree(), view, defocus);
    if (!distances) return 0.0f;
    const float near_D = 1.0f / distances->first, far_D = 1.0f / distances->second;
    const LensField* field = shownField(defocus);
    const float widest_px =
        field ? std::max(field->maxBlur_px(defocus, near_D), field->maxBlur_px(defocus, far_D))
              : std::max(maxDefocus_D(defocus, near_D), maxDefocus_D(defocus, far_D)) *
                    std::max(defocus.radius_px_per_D.x, defocus.radius_px_per_D.y);
    constexpr float kWidest_px = 1e6f;  // an eye that touches a surface sees an infinite blur
    return std::min(widest_px + aberrationRadius_px(defocus, settings.pupil), kWidest_px);
  }

  QualityLevel choose(const UnblurredView& view, const RenderSettings& settings, float blur_px) {
    const Quality& quality = settings.quality;
    const bool budget = quality.frame_ms && !std::isinf(*quality.frame_ms);
    if (budget) {
      measured_ = {};
      running_.reset();
    } else {
      const QualityLevel first = untilChecked(quality.tolerance, blur_px);
      check(first, view, settings, blur_px);
      if (quality.check == ErrorCheck::of_still)
        return *(wanted_ = levelOfStill(first, quality.tolerance, blur_px));
      if (!measured_.all) return *(wanted_ = first);
    }
    const float allowed = allowedError(quality, blur_px);
    const auto within = [&](float error) {
      return cheapestWithin(error, quality.tolerance, blur_px);
    };
    const QualityLevel cheapest = within(allowed);
    wanted_ = wanted_ ? std::clamp(*wanted_, cheapest, within(kReserve * allowed)) : cheapest;
    return budget ? levelWithin(*quality.frame_ms, view) : *wanted_;
  }

  /// The cheapest level that meets the tolerance on nearly every scene, or `fine`.
  static QualityLevel untilChecked(float tolerance, float blur_px) {
    return *std::ranges::find_if(kToleranceLevels, [&](QualityLevel level) {
      return level == QualityLevel::fine ||
             kUnmeasured * settingsOf(level).error(blur_px) <= tolerance;
    });
  }

  /// A still need not be cheap: it is as the first frame of a run, or better if that exceeds the
  /// tolerance.
  QualityLevel levelOfStill(QualityLevel first, float tolerance, float blur_px) const {
    if (expectedError(first, blur_px) <= tolerance) return first;
    return expectedError(QualityLevel::thorough, blur_px) <
                   expectedError(QualityLevel::fine, blur_px)
               ? QualityLevel::thorough
               : QualityLevel::fine;
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

  /// The error from the squares of the frame where they were compared, and from the table
  /// otherwise.
  float expectedError(QualityLevel level, float blur_px) const {
    const auto& error = measured_.error[static_cast<std::size_t>(level)];
    const float tabled = settingsOf(level).error(blur_px);
    if (!error) return tabled;
    // Errors grow at most with the blur.
    const float grown = std::max(
        std::max(blur_px, kInvisible_px) / std::max(measured_.of.blur_px, kInvisible_px), 1.0f);
    // Blur that shows in a twentieth of the pixels only is rendered, too.
    return std::max(kOfSquares * grown * *error, level == QualityLevel::sharp ? tabled : 0.0f);
  }

  /// The tolerance, relaxed where no level meets it.
  float allowedError(const Quality& quality, float blur_px) const {
    float best = std::numeric_limits<float>::infinity();
    for (const QualityLevel level : kToleranceLevels) {
      best = std::min(best, expectedError(level, blur_px));
    }
    return std::max(quality.tolerance, kRelaxed * best);
  }

  /// A frame that squares are rendered of.
  struct CheckedFrame {
    UnblurredView view;
    Defocus defocus;
    Acuity acuity;
    float blur_px = 0.0f;
    int begin = 0;  ///< number of the first frame that squares were rendered in
    int steps = 0;  ///< frames, or parts of one, that they were rendered in
  };
  struct Measured {
    CheckedFrame of;
    std::array<std::optional<float>, kQualityLevels> error;  ///< by level
    bool all = false;                                        ///< of all levels
  };

  /// Blurs of one bin share their errors.
  static int binOf(float blur_px) {
    return static_cast<int>(std::log(std::max(blur_px, kInvisible_px) / kInvisible_px) /
                            std::log(kBlurChange));
  }

  /// Takes the errors of this blur from an earlier check, or as far as one is done. Renders squares
  /// of this frame, or goes on with those of an earlier one.
  /// @param first  is compared first
  void check(QualityLevel first, const UnblurredView& view, const RenderSettings& settings,
             float blur_px) {
    const bool now = settings.quality.check != ErrorCheck::over_frames;
    const bool still = settings.quality.check == ErrorCheck::of_still;
    const auto isThis = [&](const CheckedFrame& of) {
      return of.view == view && of.defocus == settings.defocus &&
             of.acuity == settings.quality.acuity;
    };
    ++frames_;
    measured_ = {};
    bool holds = false;
    const int bin = binOf(blur_px);
    if (const auto known = checked_.find(bin); known != checked_.end()) {
      const CheckedFrame& of = known->second.of;
      const int age = frames_ - of.begin, old = std::max(kMinAge, kStepAge * of.steps);
      holds = isThis(of) || (!now && age < old);
      if (holds || age < 2 * old) measured_ = known->second;
    }
    if (now && (holds || (running_ && !isThis(running_of_)))) running_.reset();
    if (!running_ && holds) return;
    if (!running_) begin(first, view, settings, blur_px);
    const auto isEnough = [&] { return still ? running_->isFirstDone() : running_->isDone(); };
    while (!isEnough()) {
      try {
        running_->step();
      } catch (...) {  // cancelled: a part is lost
        running_.reset();
        throw;
      }
      ++running_of_.steps;
      if (!now) break;
    }
    const bool all = running_->isDone();
    const int running_bin = binOf(running_of_.blur_px);
    if (all || (!measured_.all && running_bin == bin)) {
      Measured measured{.of = running_of_, .error = {}, .all = all};
      for (std::size_t i = 0; i < (all ? compared_.size() : 1); ++i) {
        measured.error[static_cast<std::size_t>(compared_[i])] = running_->error(i);
      }
      measured.error[static_cast<std::size_t>(QualityLevel::thorough)] = running_->errorOfTruth();
      if (running_bin == bin) measured_ = measured;
      if (all) checked_[running_bin] = measured;
    }
    if (all) running_.reset();
  }

  void begin(QualityLevel first, const UnblurredView& view, const RenderSettings& settings,
             float blur_px) {
    compared_ = {first};
    std::ranges::copy_if(kCompared, std::back_inserter(compared_),
                         [&](QualityLevel level) { return level != first; });
    std::vector<LodSettings> levels;
    for (const QualityLevel level : compared_) {
      levels.push_back(lodOf(level, settings, blur_px));
    }
    running_ =
        std::make_unique<SpotCheck>(scene_.tree(), view.view, settings, blur_px, std::move(levels));
    running_of_ = {.view = view,
                   .defocus = settings.defocus,
                   .acuity = settings.quality.acuity,
                   .blur_px = blur_px,
                   .begin = frames_};
  }

  LodSplats scene_;
  std::shared_ptr<SharpViews> sharp_views_;
  std::optional<QualityLevel> forced_;
  QualityLevel last_level_ = QualityLevel::sharp;  // of the previous render
  std::optional<QualityLevel> wanted_;             // by the tolerance alone
  int frames_ = 0;                                 // that were chosen a level for, without a budget
  Measured measured_;                              // for the frame
  std::map<int, Measured> checked_;                // by the bin of the blur
  std::unique_ptr<SpotCheck> running_;             // the next check
  std::vector<QualityLevel> compared_;             // by it
  CheckedFrame running_of_;
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
