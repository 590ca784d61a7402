// The limits are those of eyes and screens, chosen by hand so that no recording of ../shared/data
// with its own screen raises a doubt that is not true; the test TraceDoubts bounds them.
#include "gaze/sources/trace_doubts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "base/quantile.h"
#include "base/text.h"
#include "base/transformed.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/sources/recording_formats.h"

namespace foci {
namespace {

constexpr std::size_t kMinPositions = 100;  // fewer show neither range nor shares

constexpr double kManyLost = 0.5, kManyOff = 0.1;  // shares of samples
// Of one number twice, where no screen is or at its corner; and of any position off the screen,
// where rounded gaze may come again. Trackers lose some samples of a thousand.
constexpr double kCode = 0.002, kCodeOff = 0.01;
constexpr std::size_t kMinCodes = 5;
constexpr double kManyZeros = 0.05;
constexpr double kOtherScale = 20.0;  // times the range of the other eye
constexpr double kStill = 0.005;      // of the screen: smaller than the fixation of one letter
constexpr double kStill_deg = 0.2;
constexpr double kApart = 0.2;  // of the screen: eyes that look at one point are less apart
constexpr double kLookedAround_s = 5.0;  // in this time gaze leaves a fixation, and a quarter
constexpr double kMinUsualPupil_mm = 1.0, kMaxUsualPupil_mm = 9.5;  // of people
constexpr double kMinRun = 1.8, kMaxRun = 20.0;                     // rows of one position
// A measured position has noise, so it does not repeat for longer.
constexpr std::size_t kMinHeld = 4, kMinHeldWhole = 8;
constexpr double kMinHeld_s = 0.06, kManyHeld = 0.002, kMoving = 0.8;
// Positions of two people or eyes in turn: farther from the last than from the one before it, and
// faster than one eye can go to and fro. A third may be spikes.
constexpr double kFar_px = 10.0, kFarther = 5.0, kManyAlternate = 0.4, kToAndFro_Hz = 10.0;
constexpr double kLongGap_s = 60.0, kMaxBlink_s = 3.0;
constexpr double kMinScreen_deg = 4.0, kMaxScreen_deg = 130.0;  // a telephone; a wall
constexpr double kMaxScreen_px = 8192.0;
constexpr double kSquare = 1.2;  // pixels are as wide as high, to this factor

double shareOf(std::size_t part, std::size_t all) {
  return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(all, 1));
}

/// The range without the outermost hundredths.
glm::dvec2 rangeOf(std::vector<double> values) {
  return {quantile(values, 0.01), quantile(values, 0.99)};
}
double widthOf(const glm::dvec2& range) { return range.y - range.x; }

/// The positions of a recording, in the file's unit.
struct Positions {
  std::vector<double> x{}, y{};
  const char* unit = "";
  bool degrees = false;    // from the screen's centre; else from its corner
  glm::dvec2 screen{0.0};  // its size in that unit; 0: unknown

  glm::dvec2 low() const { return degrees ? -0.5 * screen : glm::dvec2(0.0); }
  glm::dvec2 high() const { return low() + screen; }
  bool hasScreen() const { return screen.x > 0.0 && screen.y > 0.0; }
};

bool hasMetricScreen(const TraceHeader& header) {
  return !header.nominal_screen && isMetric(*header.screen);
}

Positions positionsOf(const std::vector<glm::dvec2>& points_px, const TraceHeader& header) {
  const Screen& screen = *header.screen;
  const bool fractions = header.units == GazeUnits::normalised;
  const glm::dvec2 size_px(screen.size_px);
  Positions at{.degrees = header.units == GazeUnits::deg};
  at.unit = at.degrees ? " deg" : fractions ? " of the screen" : " px";
  if (fractions) {
    at.screen = glm::dvec2(1.0);
  } else if (at.degrees && hasMetricScreen(header)) {
    at.screen = 2.0 * glm::degrees(glm::atan(0.5 * screen.size_m / screen.distance_m));
  } else if (!at.degrees && !header.nominal_screen) {
    at.screen = size_px;
  }
  for (const glm::dvec2& point_px : points_px) {
    const glm::dvec2 p = at.degrees  ? eccentricity_deg(screen, point_px)
                         : fractions ? point_px / size_px
                                     : point_px;
    at.x.push_back(p.x);
    at.y.push_back(p.y);
  }
  return at;
}

/// Gaze at rest may be one fixation, but not at the origin: metres or fractions lie there.
bool isStill(const Positions& at, bool may_rest, Doubts& doubts) {
  const glm::dvec2 all_x = rangeOf(at.x), all_y = rangeOf(at.y);
  const double x = widthOf(all_x), y = widthOf(all_y);
  const bool at_origin = std::min(all_x.x, all_y.x) >= -1.0 && std::max(all_x.y, all_y.y) <= 1.0;
  if (may_rest && !at_origin) return false;
  const glm::dvec2 limit = at.hasScreen() ? kStill * at.screen : glm::dvec2(kStill_deg);
  const std::string keys = "; is its unit right (gaze.units, gaze.scale), and its column";
  const std::string still = "gaze does not move along ";
  return doubts.add(x <= limit.x && y <= limit.y, "gaze hardly moves: 98 % of it lies within " +
                                                      significant(x) + " x " + significant(y) +
                                                      at.unit + keys + "?") ||
         doubts.add(x <= 0.01 * y, still + "x" + keys + " (gaze.x)?") ||
         doubts.add(y <= 0.01 * x, still + "y" + keys + " (gaze.y)?");
}

bool isSameColumn(const Positions& at, Doubts& doubts) {
  for (std::size_t i = 0; i < at.x.size(); ++i) {
    if (std::abs(at.x[i] - at.y[i]) > 1e-9 * (1.0 + std::abs(at.x[i]))) return false;
  }
  return doubts.add(
      true, "x and y are the same in every sample: name their columns with gaze.x and gaze.y");
}

double shareOff(const std::vector<double>& values, double low, double high) {
  const auto off =
      std::ranges::count_if(values, [&](double value) { return value < low || value > high; });
  return shareOf(static_cast<std::size_t>(off), values.size());
}

bool isOffScreen(const Positions& at, Doubts& doubts) {
  const glm::dvec2 low = at.low(), high = at.high();
  const double x = shareOff(at.x, low.x, high.x), y = shareOff(at.y, low.y, high.y);
  const double share = std::max(x, y);
  const bool exchanged =
      std::max(shareOff(at.x, low.y, high.y), shareOff(at.y, low.x, high.x)) < 0.02;
  const bool negative = !at.degrees && shareOff(x >= y ? at.x : at.y, 0.0, 1e300) > 0.5 * share;
  return doubts.add(
      share >= kManyOff,
      percent(share) + " of the gaze lies off the screen along " + (x >= y ? "x" : "y") + ": " +
          (exchanged  ? "are x and y exchanged (gaze.x, gaze.y)?"
           : negative ? "is the origin the top-left corner, with y down (gaze.offset, gaze.scale)?"
                      : "are its unit (gaze.units) and the screen (screen.size_px, screen.size_m, "
                        "screen.distance_m) right?"));
}

void judgePositions(const Positions& at, bool looked_around, bool may_rest, Doubts& doubts) {
  if (isStill(at, may_rest || !looked_around, doubts) || isSameColumn(at, doubts)) return;
  const glm::dvec2 x = rangeOf(at.x), y = rangeOf(at.y);
  if (at.degrees &&
      doubts.add(looked_around && std::min(x.x, y.x) >= -1.0 && std::max(x.y, y.y) <= 1.0,
                 "all gaze lies within a degree: is its unit right (gaze.units; gaze.scale = "
                 "[57.3, 57.3] for radians)?")) {
    return;
  }
  if (!at.hasScreen() || isOffScreen(at, doubts) || at.degrees) return;
  // Millimetres, per cent, or pixels of a smaller screen.
  doubts.add(looked_around && x.x >= 0.0 && y.x >= 0.0 && x.y <= 0.5 * at.screen.x &&
                 y.y <= 0.5 * at.screen.y,
             "all gaze lies in the upper left quarter of the screen: are its unit (gaze.units, "
             "gaze.scale) and screen.size_px right?");
}

/// A position that cannot be looked at and comes often.
/// @param among  so many
/// @param whose  "", or " of the left eye"
bool isCodeOfLoss(const Positions& at, std::size_t among, const std::string& whose,
                  Doubts& doubts) {
  constexpr double kZero = 1e-9;  // degrees come from pixels
  const glm::dvec2 low = at.low(), high = at.high();
  const auto limitOf = [&](double x, double y) -> std::optional<double> {
    if (x == 0.0 && y == 0.0 && at.degrees) {  // where one eye is not for long
      return whose.empty() ? std::nullopt : std::optional(kManyZeros);
    }
    const bool far = x == y && (x < 0.0 || x > kMaxScreen_px);
    if (!at.degrees && (far || (x == 0.0 && y == 0.0))) return kCode;
    const bool off = at.hasScreen() && (x < low.x || y < low.y || x > high.x || y > high.y);
    return off ? std::optional(kCodeOff) : std::nullopt;
  };
  std::map<std::pair<double, double>, std::size_t> counts;
  std::pair<double, double> code;
  double most = 0.0;
  for (std::size_t i = 0; i < at.x.size(); ++i) {
    std::pair p(at.x[i], at.y[i]);
    if (std::abs(p.first) < kZero && std::abs(p.second) < kZero) p = {0.0, 0.0};
    const auto limit = limitOf(p.first, p.second);
    if (!limit) continue;
    const std::size_t count = ++counts[p];
    const double share = shareOf(count, among);
    if (count < kMinCodes || share < *limit || share <= most) continue;
    most = share;
    code = p;
  }
  constexpr int kDigits = 9;  // the code as the file has it: -32768, and not -3.277e+04
  const std::string x = significant(code.first, kDigits), y = significant(code.second, kDigits);
  return doubts.add(most > 0.0, "the position (" + x + ", " + y + ")" + whose + " is in " +
                                    decimal(100.0 * most, most < 0.01 ? 1 : 0) +
                                    " % of the samples with gaze: if it means data loss, give "
                                    "gaze.missing" +
                                    (x == y ? " = " + x : ""));
}

/// A coordinate of exactly 0 that comes often while the other one moves.
bool hasZerosOfOneAxis(const Positions& at, Doubts& doubts) {
  const auto zeros = [](const std::vector<double>& values) {
    return shareOf(static_cast<std::size_t>(std::ranges::count(values, 0.0)), values.size());
  };
  const double x = zeros(at.x), y = zeros(at.y), share = std::max(x, y);
  return doubts.add(!at.degrees && share >= kManyZeros && std::min(x, y) <= 0.5 * share,
                    std::string(x > y ? "x" : "y") + " is 0 in " + percent(share) +
                        " of the samples with gaze: if it means data loss, give gaze.missing = 0");
}

}  // namespace

std::vector<std::string> screenDoubts(const Screen& screen, const ScreenNames& names) {
  std::vector<std::string> sentences;
  Doubts doubts(sentences);
  const glm::dvec2 pixel_m = screen.size_m / glm::dvec2(screen.size_px);
  const double ratio = pixel_m.x / pixel_m.y;
  doubts.add(ratio > kSquare || ratio < 1.0 / kSquare,
             "pixels are " + significant(ratio) +
                 " times as wide as high: are the screen's pixels and metres of one screen (" +
                 names.size_px + ", " + names.size_m + ")?");
  const double deg = glm::degrees(2.0 * std::atan(0.5 * screen.size_m.x / screen.distance_m));
  doubts.add(deg < kMinScreen_deg || deg > kMaxScreen_deg,
             "the screen is " + significant(deg) + " deg wide: are its metres right (" +
                 names.size_m + ", " + names.distance_m + ")?");
  return sentences;
}

std::string percent(double share) { return decimal(100.0 * share, 0) + " %"; }

void TraceDoubts::addClock(double time_s) {
  if (samples_ == 0) first_s_ = last_s_ = time_s;
  longest_gap_s_ = std::max(longest_gap_s_, time_s - last_s_);
  last_s_ = time_s;
  const double rate_Hz = watch_.rate_Hz();
  if (const auto begun = watch_.push(time_s)) {
    if (rates_.empty()) first_rate_Hz_ = rate_Hz;
    rates_.push_back(*begun);
  }
}

void TraceDoubts::addPoint(const GazeSample& sample) {
  const glm::dvec2 point_px = *sample.point_px;
  if (present_ == 0 || point_px != last_px_) {
    ++changes_;
    run_ = 0;
    run_s_ = sample.time_s;
  } else if (++run_ >= (whole_px_ ? kMinHeldWhole : kMinHeld) &&
             sample.time_s - run_s_ >= kMinHeld_s) {
    ++held_;
    longest_hold_s_ = std::max(longest_hold_s_, sample.time_s - run_s_);
  }
  const double moved_px = glm::distance(point_px, last_px_);
  alternations_ +=
      moved_px > kFar_px && moved_px > kFarther * glm::distance(point_px, before_last_px_);
  before_last_px_ = std::exchange(last_px_, point_px);
  ++present_;
  kept_.add([&] {
    whole_px_ = whole_px_ && point_px == glm::floor(point_px);
    return Kept{point_px, {sample.eyes[0].point_px, sample.eyes[1].point_px}};
  });
}

void TraceDoubts::add(const GazeSample& sample) {
  if (sample.after_pause) {
    paused_s_ += sample.time_s - last_s_;
    last_s_ = sample.time_s;
  }
  addClock(sample.time_s);
  ++samples_;
  if (!blinks_ || sample.after_pause) blink_s_ = sample.time_s;
  blinks_ = sample.blink;
  if (blinks_) longest_blink_s_ = std::max(longest_blink_s_, sample.time_s - blink_s_);
  if (sample.point_px) addPoint(sample);
  space_.add(sample);
  outside_ += sample.direction && !sample.point_px;
  away_ += !sample.point_px && !sample.direction &&
           (sample.eyes[0].direction || sample.eyes[1].direction);
  if (sample.pupil_mm) pupils_mm_.add([&] { return *sample.pupil_mm; });
}

std::vector<glm::dvec2> TraceDoubts::points_px() const {
  return transformed(kept_.kept(), &Kept::point_px);
}

/// Doubts about data loss, the clock and the pupil.
void TraceDoubts::stateRows(Doubts& doubts) const {
  const double lost = 1.0 - shareOf(present_ + outside_, samples_), away = shareOf(away_, samples_);
  doubts.add(away > kManyOff,
             percent(away) +
                 " of the lines of sight lead away from the screen: are the axes x right, y "
                 "up, and z towards the observer?") ||
      doubts.add(samples_ >= kMinPositions && lost > kManyLost,
                 percent(lost) +
                     " of the samples have no gaze: are gaze.confidence, gaze.blink and "
                     "gaze.missing right?");
  const double span_s = last_s_ - first_s_ - paused_s_;
  const double rate_Hz = static_cast<double>(samples_ - 1) / span_s;
  doubts.add(
      samples_ >= kMinPositions && (rate_Hz < kMinRate_Hz || rate_Hz > kMaxRate_Hz),
      significant(rate_Hz) + " samples a second: is the unit of time right (gaze.time_scale_s)?");
  doubts.add(longest_gap_s_ > kLongGap_s && 2.0 * longest_gap_s_ > span_s,
             "a gap of " + significant(longest_gap_s_) +
                 " s: is the clock right (gaze.time, gaze.time_scale_s)?");
  std::vector<double> pupils_mm = pupils_mm_.kept();
  if (pupils_mm.size() < kMinPositions) return;
  const double usual_mm = quantile(pupils_mm, 0.5);
  doubts.add(usual_mm < kMinUsualPupil_mm || usual_mm > kMaxUsualPupil_mm,
             "the pupil's usual diameter is " + significant(usual_mm) +
                 " mm: is gaze.pupil_scale_mm right?");
}

void TraceDoubts::stateRates(Doubts& doubts) const {
  constexpr double kMaxUsual_Hz = 2050.0;
  constexpr std::size_t kMaxTold = 4;
  doubts.add(watch_.rate_Hz() > kMaxUsual_Hz && rates_.empty(),
             significant(watch_.rate_Hz()) +
                 " samples a second, more than eye trackers take: is the unit of time right "
                 "(gaze.time_scale_s)?");
  std::string text = "the rate changes: " + significant(first_rate_Hz_) + " Hz";
  for (std::size_t i = 0; i < std::min(rates_.size(), kMaxTold); ++i) {
    text += ", from " + decimal(rates_[i].time_s - first_s_, 3) + " s on " +
            significant(rates_[i].rate_Hz) + " Hz";
  }
  doubts.add(!rates_.empty(), text + (rates_.size() > kMaxTold ? ", ..." : "") +
                                  "; foci judges each stretch by its own rate");
}

/// A code for data loss: of the gaze, else of one eye, whose code the mean with the other hides.
void TraceDoubts::stateLoss(const TraceHeader& header, Doubts& doubts) const {
  const Positions all = positionsOf(points_px(), header);
  if (isCodeOfLoss(all, all.x.size(), "", doubts) || hasZerosOfOneAxis(all, doubts)) return;
  // In degrees, both eyes may be in the middle.
  const auto areTogether = [&](const Kept& kept) {
    constexpr double kTogether_deg = 1.0;
    const auto& [left, right] = kept.eyes_px;
    return header.units == GazeUnits::deg && left && right &&
           glm::distance(eccentricity_deg(*header.screen, *left),
                         eccentricity_deg(*header.screen, *right)) <= kTogether_deg;
  };
  for (const std::size_t side : {0, 1}) {
    std::size_t seen = 0;
    std::vector<glm::dvec2> of_eye_px;
    for (const Kept& kept : kept_.kept()) {
      if (!kept.eyes_px[side]) continue;
      ++seen;
      if (!areTogether(kept)) of_eye_px.push_back(*kept.eyes_px[side]);
    }
    if (seen < kMinPositions) continue;
    isCodeOfLoss(positionsOf(of_eye_px, header), seen,
                 side == 0 ? " of the left eye" : " of the right eye", doubts);
  }
}

void TraceDoubts::stateEyes(const TraceHeader& header, Doubts& doubts) const {
  const double width_px = header.screen->size_px.x;
  std::vector<double> apart_px;
  std::array<std::vector<double>, 2> xs;
  for (const Kept& kept : kept_.kept()) {
    if (!kept.eyes_px[0] || !kept.eyes_px[1]) continue;
    apart_px.push_back(glm::distance(*kept.eyes_px[0], *kept.eyes_px[1]));
    for (const std::size_t side : {0, 1}) xs[side].push_back(kept.eyes_px[side]->x);
  }
  if (apart_px.size() < kMinPositions) return;
  doubts.add(
      width_px > 0.0 && quantile(apart_px, 0.5) / width_px > kApart && !header.nominal_screen,
      "the eyes look at points far apart: are the columns of the left and the right "
      "eye right, and of one unit (gaze.left_x, left_y, right_x, right_y)?");
  constexpr double kMostTold = 100.0;  // times; the other eye may stand still
  const double left = widthOf(rangeOf(xs[0])), right = widthOf(rangeOf(xs[1]));
  const double wide = std::max(left, right), narrow = std::min(left, right);
  doubts.add(wide > kOtherScale * narrow,
             std::string("the ") + (left > right ? "left" : "right") + " eye moves over " +
                 significant(wide / std::max(narrow, wide / kMostTold), 3) +
                 " times the range of the other: are their columns of one unit "
                 "(gaze.left_x, left_y, right_x, right_y)?");
}

/// Positions that repeat in a row. A still eye, or whole pixels, give longer runs.
void TraceDoubts::stateRepeats(Doubts& doubts) const {
  const double run = shareOf(present_, changes_);
  doubts.add(!whole_px_ && run > kMinRun && run < kMaxRun,
             "each position comes " + significant(run) +
                 " times in a row, so the tracker was slower than the rows, and velocities are "
                 "wrong: keep one row of each (gaze.time names the column of the time)");
  doubts.add(shareOf(alternations_, present_) > kManyAlternate && watch_.rate_Hz() > kToAndFro_Hz,
             "positions alternate between two places, as of two people or eyes in turn: if a "
             "column tells them apart, choose one with gaze.rows");
  const double share = shareOf(held_, present_);
  doubts.add(share > kManyHeld && shareOf(changes_, present_ - held_) > kMoving,
             "positions stay the same to the last digit for up to " +
                 significant(longest_hold_s_, 2) + " s (" + decimal(100.0 * share, 1) +
                 " % of the samples), as where the last one stands for data loss: if a column "
                 "tells, name it with gaze.confidence or gaze.blink");
}

bool TraceDoubts::hasPositions() const { return kept_.kept().size() >= kMinPositions; }

bool TraceDoubts::statePositions(TraceHeader& header, bool may_rest) const {
  const std::size_t before = header.warnings.size();
  Doubts doubts(header.warnings);
  judgePositions(positionsOf(points_px(), header), last_s_ - first_s_ >= kLookedAround_s, may_rest,
                 doubts);
  return header.warnings.size() > before;
}

void TraceDoubts::state(const TraceColumns& columns, TraceHeader& header) const {
  Doubts doubts(header.warnings);
  if (hasMetricScreen(header)) {
    for (const std::string& doubt : screenDoubts(*header.screen)) doubts.add(true, doubt);
  }
  stateRows(doubts);
  const auto isBlink = [](const ColumnReading& column) { return column.meaning == "blink"; };
  doubts.add(longest_blink_s_ > kMaxBlink_s && std::ranges::any_of(header.columns, isBlink),
             "a blink lasts " + significant(longest_blink_s_) + " s: is gaze.blink right?");
  stateRates(doubts);
  space_.state(header.gaze_in_world, header.world_y_up, doubts);
  if (!hasPositions() || columns.mapped_later || columns.space.from_head) return;
  stateLoss(header, doubts);
  const bool doubtful = statePositions(header);
  stateEyes(header, doubts);
  stateRepeats(doubts);
  constexpr std::string_view kCertain = "certain: a column of ";
  for (ColumnReading& reading : header.columns) {
    if (!doubtful || !reading.why.starts_with(kCertain)) continue;
    reading.why = "doubtful: as a column of " + reading.why.substr(kCertain.size()) +
                  ", but its positions are not usual (see the warnings)";
  }
}

}  // namespace foci
