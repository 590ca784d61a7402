// EyeLink ASC, the text format that edf2asc writes. Samples are passed on a good second late,
// because the end of a blink decides whether it is one. The file gives the screen's size in pixels
// only, from GAZE_COORDS or else DISPLAY_COORDS, and each block may have another. Points are on the
// first one's pixels: all of them fill the same screen. Messages become markers and trials, after
// the rules of Data Viewer (TRIALID, TRIAL_RESULT, !V TRIAL_VAR).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/text.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/sources/column_names.h"
#include "gaze/sources/recording_formats.h"
#include "gaze/sources/row_times.h"
#include "gaze/sources/trace_summary.h"

namespace foci {
namespace {

constexpr double kSecond_ms = 1000.0;
constexpr double kClock_ms = 1e-3;  // above the rounding of seconds, far below an interval

// Both eyelids move together, so a blink of one eye counts as a blink of both. But no blink lasts
// longer than this: then the tracker has lost one eye, and the other eye's gaze is good.
constexpr double kMaxBlink_ms = 1000.0;
constexpr std::size_t kMaxIntervals = 8192;
// Chosen by hand. SR Research advises a mean error below 0.5 deg.
constexpr double kMaxError_deg = 1.0, kMaxDrift_deg = 2.0;
constexpr double kSlack_ms = 100.0;  // the line of an event comes a little after its samples

// Messages that the tracker and its software write themselves.
constexpr std::string_view kOwnMessages[] = {
    "!",          "RECCFG",   "ELCL",         "GAZE_COORDS",     "DISPLAY_COORDS",
    "THRESHOLDS", "VALIDATE", "DRIFTCORRECT", "PUPIL_DATA_TYPE", "RETRACE_INTERVAL"};

struct Interval {
  double first_ms = 0.0, last_ms = 0.0;  // time stamps of the first and last sample
};

/// The coordinates of gaze: those of the screen's first and last pixel.
struct Coordinates {
  glm::dvec2 origin_px{0.0};
  glm::ivec2 size_px{0};
};

/// A recording block, from START to END. Eyes: 0 left, 1 right.
struct Block {
  bool open = false;
  bool has_samples = false;
  std::array<bool, 2> recorded{};
  std::array<std::deque<Interval>, 2> blinks{};
  std::array<std::optional<double>, 2> blink_from_ms{};
  double newest_ms = 0.0;
  std::optional<double> rate_Hz{};  // that the line SAMPLES states
  std::vector<double> intervals_s{};
  bool has_more = false;  // each sample has more values than the eyes'
};

class AscReader {
 public:
  AscReader(LineReader& lines, const TraceColumns& columns, const TakeSample& take)
      : lines_(lines), columns_(columns), take_(take) {}

  TraceHeader read() {
    std::string_view line;
    while (lines_.next(line)) {
      if (line.empty()) continue;
      if (cut_) throw *cut_;
      if (line[0] >= '0' && line[0] <= '9') {
        if (block_.open) {
          readSample(line);
        } else if (!started_) {
          outside_ = true;
        }
      } else if (line[0] >= 'A' && line[0] <= 'Z') {
        readEvent(line);
      }
    }
    if (cut_) {
      header_.warnings.emplace_back(kCutOff);
    } else if (block_.open) {
      header_.warnings.emplace_back(
          "the last recording block has no END, so the file may be cut off: is it complete?");
    }
    endBlock();
    requireSamples();
    double drift_deg = 0.0;
    for (const auto& drift : drifts_deg_) drift_deg = std::max(drift_deg, drift.second);
    if (drift_deg > 0.0) {
      header_.warnings.push_back(
          counted(drifts_deg_.size(), "drift correction") + " over 2 deg, of " +
          significant(drift_deg) +
          " deg at most: the calibration no longer held, so check the gaze nearby");
    }
    header_.trials =
        trialsIn(trial_messages_, kTrialMessage, 1e-3 * std::max(time_ms_, newest_message_ms_));
    if (sizes_.size() > 1) {
      header_.assumed.push_back("screen: one, which blocks of " + sizes_.front() + " and of " +
                                sizes_.back() + " px fill");
    }
    header_.format = "EyeLink ASC, ";
    header_.format += binocular_ ? "binocular" : "monocular";
    if (remote_) header_.format += ", remote";
    return std::move(header_);
  }

 private:
  /// A file that was converted without the lines that foci needs.
  void requireSamples() const {
    if (any_ || (!outside_ && !started_)) return;
    throw InputError(
        lines_.fileName(),
        started_
            ? "no samples between START and END, as edf2asc -e writes it: convert the EDF "
              "file again without -e"
            : "samples without the lines START, SAMPLES, EBLINK and MSG GAZE_COORDS, as "
              "edf2asc -s writes it: they state the eye, the blinks and the screen; convert "
              "the EDF file again without -s, or name the columns (gaze.time = \"#1\", gaze.x, "
              "gaze.y)");
  }

  double number(std::size_t word) const {
    const auto value = word < words_.size() ? parseNumber(words_[word]) : std::nullopt;
    if (!value) {
      throw lines_.error(std::string(words_[0]) + ": " +
                         (word < words_.size() ? shown(words_[word]) : "nothing") +
                         ": expected a number");
    }
    return *value;
  }

  int eye() const {
    const std::string_view letter = words_.size() > 1 ? words_[1] : "";
    if (letter == "L") return 0;
    if (letter == "R") return 1;
    throw lines_.error(std::string(words_[0]) + ": eye " + shown(letter) + ": expected L or R");
  }

  void readEvent(std::string_view line) {
    splitWords(line, words_);
    const std::string_view kind = words_[0];
    // The last line may be cut off. A complete file ends with END.
    if (!lines_.isEnded() && block_.open && any_ && kind != "END") {
      cut_ = lines_.error("a line without an end");
    } else if (kind == "MSG") {
      readMessage(line);
    } else if (kind == "START") {
      endBlock();
      block_ = {.open = true};
      started_ = true;
      setEyes();
    } else if (kind == "SAMPLES" && block_.open) {
      setEyes();
      for (std::size_t i = 1; i < words_.size(); ++i) {
        if (words_[i] == "RATE") block_.rate_Hz = number(i + 1);
        block_.has_more |= isWordOf("VEL RES INPUT BUTTONS STATUS HTARGET", words_[i]);
      }
      remote_ |= std::ranges::find(words_, "HTARGET") != words_.end();
      if (words_.size() > 1 && (words_[1] == "HREF" || words_[1] == "PUPIL")) {
        throw lines_.error("samples in " + shown(words_[1]) +
                           " coordinates: expected GAZE; convert the EDF file again with "
                           "edf2asc -sg");
      }
    } else if (kind == "PUPIL" && words_.size() > 1) {
      header_.pupil_unit = "arbitrary";
      const bool area = words_[1] != "DIAMETER";
      header_.columns = {{.columns = "pupil",
                          .meaning = area ? "area of the pupil, in the tracker's own unit"
                                          : "diameter of the pupil, in the tracker's own unit",
                          .why = "certain: the line PUPIL states it"}};
    } else if (kind == "SBLINK" && block_.open) {
      const int side = eye();
      block_.blink_from_ms[side] = number(2);
    } else if (kind == "EBLINK" && block_.open) {
      const int side = eye();
      block_.blinks[side].push_back({number(2), number(3)});
      block_.blink_from_ms[side].reset();
    } else if (kind == "END") {
      endBlock();
    }
  }

  void setEyes() {
    for (int side : {0, 1}) {
      const char* name = side == 0 ? "LEFT" : "RIGHT";
      block_.recorded[side] |= std::ranges::find(words_, name) != words_.end();
    }
    binocular_ |= block_.recorded[0] && block_.recorded[1];
  }

  void readCoordinates(std::size_t at) {
    const std::string_view key = words_[at];
    if (key == "DISPLAY_COORDS" && gaze_coords_) return;
    if (at + 1 < words_.size() && words_[at + 1] == "=") ++at;
    gaze_coords_ |= key == "GAZE_COORDS";
    Coordinates read{.origin_px = {number(at + 1), number(at + 2)}};
    for (int axis : {0, 1}) {
      const std::size_t last = at + 3 + static_cast<std::size_t>(axis);
      const double pixels = number(last) - read.origin_px[axis] + 1.0;
      if (!(pixels >= 16.0 && pixels <= 16385.0)) {
        throw lines_.error(std::string(key) + ": " + shown(words_[last]) +
                           ": expected a screen of 16 to 16384 px");
      }
      // The size is last pixel minus first, plus one. Some experiments write the size in place of
      // the last pixel. Screens have even sizes, so rounding down corrects this.
      read.size_px[axis] = static_cast<int>(pixels) & ~1;
    }
    coordinates_ = read;
    if (!any_ || !header_.screen) header_.screen = Screen{.size_px = read.size_px};
    per_pixel_ = glm::dvec2(header_.screen->size_px) / glm::dvec2(read.size_px);
  }

  /// Messages may begin with an offset in time (Data Viewer), which the text of a marker keeps.
  void readMessage(std::string_view line) {
    if (words_.size() < 3) return;
    std::size_t first = 2;
    if (parseInteger<int>(words_[first]) && words_.size() > 3) ++first;
    const std::string_view key = words_[first];
    if (key == "GAZE_COORDS" || key == "DISPLAY_COORDS") readCoordinates(first);
    const auto time_ms = parseNumber(words_[1]);
    if (!time_ms) return;
    newest_message_ms_ = *time_ms;
    const double time_s = *time_ms / kSecond_ms;
    const auto textFrom = [&](std::size_t word) {
      if (word >= words_.size()) return std::string();
      return std::string(
          trimmed(line.substr(static_cast<std::size_t>(words_[word].data() - line.data()))));
    };
    const std::string_view second = first + 1 < words_.size() ? words_[first + 1] : "";
    if (key == kTrialMessage || key == "TRIAL_RESULT" || (key == "!V" && second == "TRIAL_VAR")) {
      trial_messages_.push_back({time_s, textFrom(first)});
    } else if (key == "!CAL" && (second == "CALIBRATION" || second == "VALIDATION")) {
      readCalibration(time_s, first + 1);
    } else if (key == "DRIFTCORRECT") {
      const auto offset = std::ranges::find(words_, "OFFSET");
      const auto at = static_cast<std::size_t>(offset - words_.begin()) + 1;
      const double deg = at < words_.size() ? parseNumber(words_[at]).value_or(0.0) : 0.0;
      const bool right = std::ranges::find(words_, "RIGHT") != words_.end();
      if (deg > kMaxDrift_deg) open_drifts_[right ? 1 : 0][*time_ms] = deg;
    }
    const bool own = std::ranges::any_of(
        kOwnMessages, [&](std::string_view start) { return key.starts_with(start); });
    if (!own) header_.markers.push_back({time_s, textFrom(2)});
  }

  /// "CALIBRATION HV9 L LEFT GOOD", "VALIDATION HV9 LR LEFT GOOD ERROR 0.31 avg. 0.75 max ...".
  void readCalibration(double time_s, std::size_t at) {
    TrackerCalibration result{.time_s = time_s};
    const auto lower = [&](std::size_t word) {
      return lowered(word < words_.size() ? words_[word] : "");
    };
    result.kind = lower(at);
    if (at + 1 < words_.size()) result.targets = words_[at + 1];
    for (std::size_t word = at + 2; word < words_.size(); ++word) {
      const std::string text = lower(word);
      if (text == "left" || text == "right") {
        result.eye = text;
        result.grade = lower(word + 1);
      } else if (text == "aborted") {
        result.grade = text;
      } else if (text == "avg." || text == "max") {
        (text == "max" ? result.max_deg : result.mean_deg) = parseNumber(words_[word - 1]);
      }
    }
    if (result.kind == "calibration") open_drifts_ = {};
    header_.calibrations.push_back(std::move(result));
  }

  /// Of each recorded eye, the last validation since its calibration must be good, and the
  /// corrections of drift since then small.
  void noteAccuracy() {
    std::array<bool, 2> judged = inaccurate_;
    for (std::size_t side = 0; side < judged.size(); ++side) {
      if (block_.recorded[side]) drifts_deg_.merge(std::exchange(open_drifts_[side], {}));
      judged[side] |= !block_.recorded[side];
    }
    for (std::size_t i = header_.calibrations.size(); i-- > 0 && !(judged[0] && judged[1]);) {
      const TrackerCalibration& each = header_.calibrations[i];
      const std::size_t side = each.eye == "left" ? 0 : 1;
      if (each.eye.empty() || each.grade == "aborted" || judged[side]) continue;
      judged[side] = true;
      inaccurate_[side] = each.kind == "validation" &&
                          (each.grade == "poor" || each.mean_deg.value_or(0.0) > kMaxError_deg);
      if (!inaccurate_[side]) continue;
      const std::string error =
          each.mean_deg ? ", with a mean error of " + significant(*each.mean_deg) + " deg" : "";
      header_.warnings.push_back("the last validation of the " + each.eye +
                                 " eye before a recording block was " + each.grade + error +
                                 ": gaze may lie far beside its target");
    }
  }

  /// A sample is the time, then x, y and pupil of each recorded eye. The fields behind them
  /// (velocity, target, flags) are not read.
  void readSample(std::string_view line) {
    splitWords(line, words_, 7);
    const int eyes = (block_.recorded[0] ? 1 : 0) + (block_.recorded[1] ? 1 : 0);
    if (eyes == 0) throw lines_.error("a sample of no eye: expected LEFT or RIGHT after START");
    if (words_.size() < 1 + 3 * static_cast<std::size_t>(eyes)) {
      cut_ = lines_.error(std::to_string(words_.size()) + " values in a sample: expected " +
                          std::to_string(1 + 3 * eyes) + " at least");
      if (!any_) throw *cut_;
      return;  // the last line may be cut off; a line behind it throws
    }
    if (!block_.has_samples) {
      requireStatedEyes(line, eyes);
      noteAccuracy();
    }
    const double stamp_ms = number(0);
    double time_ms = stamp_ms;
    if (stamp_ms == last_stamp_ms_ && time_ms_ == stamp_ms) time_ms = stamp_ms + 0.5;
    if (any_ && time_ms <= time_ms_) {
      const char* const advice =
          block_.has_samples ? "" : ": another recording begins here, so write a file for each";
      throw lines_.error("time " + shown(words_[0]) + " ms is not after the sample before" +
                         advice);
    }
    if (block_.has_samples && block_.intervals_s.size() < kMaxIntervals) {
      block_.intervals_s.push_back((time_ms - time_ms_) / kSecond_ms);
    }
    last_stamp_ms_ = stamp_ms;
    time_ms_ = time_ms;
    block_.newest_ms = stamp_ms;

    GazeSample sample{.time_s = time_ms / kSecond_ms, .after_pause = any_ && !block_.has_samples};
    any_ = block_.has_samples = true;
    noteSize();
    std::size_t at = 1;
    for (std::size_t side : {0, 1}) {
      if (!block_.recorded[side]) continue;
      if (!isAbsent(words_[at]) && !isAbsent(words_[at + 1])) {
        const glm::dvec2 point(number(at), number(at + 1));
        const bool missing = point.x == columns_.missing || point.y == columns_.missing;
        if (!missing) sample.eyes[side].point_px = pointOnScreen_px(at, point);
      }
      if (const auto pupil = parseNumber(words_[at + 2]); pupil && *pupil > 0.0) {
        sample.eyes[side].pupil_own = *pupil;
        if (header_.pupil_unit.empty()) header_.pupil_unit = "arbitrary";
      }
      at += 3;
    }
    sample.point_px =
        cyclopean_.combine(sample.time_s, sample.eyes[0].point_px, sample.eyes[1].point_px);
    held_.push_back(sample);
    while (stamp_ms - held_.front().time_s * kSecond_ms > kMaxBlink_ms + kSlack_ms) release();
  }

  /// The flags behind the values have three characters for one eye and five for two.
  void requireStatedEyes(std::string_view line, int eyes) const {
    const auto words = wordsOf(line);
    const auto flags = std::ranges::find_if(words, [](std::string_view word) {
      return (word.size() == 3 || word.size() == 5) && word.find_first_not_of(".CRI") == word.npos;
    });
    const bool has_more = !block_.has_more && flags == words.end() && words.size() >= 7;
    const int found = flags == words.end() ? (has_more ? 2 : eyes) : flags->size() == 3 ? 1 : 2;
    if (found == eyes) return;
    throw lines_.error("a sample of " + std::to_string(found) +
                       " eyes, but START and SAMPLES state " + std::to_string(eyes) +
                       ": expected LEFT and RIGHT there for two eyes");
  }

  glm::dvec2 pointOnScreen_px(std::size_t word, const glm::dvec2& point) const {
    const glm::dvec2 point_px =
        per_pixel_ * (columns_.scale * point + columns_.offset - coordinates_.origin_px);
    for (int axis : {0, 1}) {
      if (std::abs(point_px[axis]) <= kFarthestGaze_px) continue;
      throw lines_.error("position " + shown(words_[word + static_cast<std::size_t>(axis)]) +
                         ": too far from any screen; is it gaze.missing?");
    }
    return point_px;
  }

  /// Remembers the sizes of screens under the samples, each once.
  void noteSize() {
    const glm::ivec2& size_px = coordinates_.size_px;
    if (size_px == newest_size_px_) return;
    newest_size_px_ = size_px;
    std::string text = std::to_string(size_px.x) + " x " + std::to_string(size_px.y);
    if (std::ranges::find(sizes_, text) == sizes_.end()) sizes_.push_back(std::move(text));
  }

  /// Passes on the oldest sample, and marks it if it belongs to a blink.
  void release() {
    GazeSample& sample = held_.front();
    const double stamp_ms = sample.time_s * kSecond_ms + kClock_ms;
    bool all = true, any = false;
    for (std::size_t side : {0, 1}) {
      if (!block_.recorded[side]) continue;
      auto& blinks = block_.blinks[side];
      // A time stamp covers a millisecond, which holds two samples at 2000 Hz.
      while (!blinks.empty() && stamp_ms >= blinks.front().last_ms + 1.0) blinks.pop_front();
      const bool closed = !blinks.empty() && stamp_ms >= blinks.front().first_ms;
      const bool open_end = block_.blink_from_ms[side] && stamp_ms >= *block_.blink_from_ms[side];
      all &= closed || open_end;
      any |= closed && blinks.front().last_ms - blinks.front().first_ms <= kMaxBlink_ms;
    }
    if (all || any) {
      sample.blink = true;
      sample.point_px.reset();
    }
    take_(sample);
    held_.pop_front();
  }

  void endBlock() {
    if (!block_.open) return;
    for (std::size_t side : {0, 1}) {
      if (block_.blink_from_ms[side]) {
        block_.blinks[side].push_back({*block_.blink_from_ms[side], block_.newest_ms});
        block_.blink_from_ms[side].reset();
      }
    }
    while (!held_.empty()) release();
    if (block_.rate_Hz) warnOfRate(*block_.rate_Hz, std::move(block_.intervals_s), header_);
    block_.open = false;
  }

  LineReader& lines_;
  const TraceColumns& columns_;
  const TakeSample& take_;
  std::vector<std::string_view> words_{};
  TraceHeader header_{};
  Block block_{};
  Cyclopean cyclopean_{};
  std::deque<GazeSample> held_{};
  bool any_ = false;
  std::optional<InputError> cut_{};  // of the latest line
  Coordinates coordinates_{};
  glm::dvec2 per_pixel_{1.0};  // pixels of the header's screen
  glm::ivec2 newest_size_px_{0};
  std::vector<std::string> sizes_{};
  std::vector<TraceMarker> trial_messages_{};
  double newest_message_ms_ = 0.0;
  std::array<bool, 2> inaccurate_{};  // eyes that a warning names
  // Corrections of drift above the limit, by time: of each eye since its calibration, and of all.
  std::array<std::map<double, double>, 2> open_drifts_{};
  std::map<double, double> drifts_deg_{};
  bool gaze_coords_ = false, binocular_ = false, remote_ = false;
  bool started_ = false, outside_ = false;  // a START line; samples before any
  double last_stamp_ms_ = -1.0, time_ms_ = -1.0;
};

/// A sample: an integer time, numbers, and flags such as "..." or ".C.".
bool isEyeLinkSample(std::string_view line) {
  constexpr std::size_t kFewest = 5;
  const auto words = wordsOf(line);
  return words.size() >= kFewest && line.find('\t') != line.npos &&
         parseInteger<std::uint64_t>(words.front()) && words.back().size() >= 3 &&
         words.back().find_first_not_of(".CRIML") == std::string_view::npos;
}

bool isEyeLinkAsc(const RecordingFile& file) {
  const std::string& line = file.firstLine();
  return line.starts_with("** ") || line.starts_with("MSG\t") || line.starts_with("START\t") ||
         (file.isUndescribed() && isEyeLinkSample(line));
}

}  // namespace

/// Of the study's columns, only `missing`, `scale` and `offset` count.
const RecordingFormat kEyeLinkAsc{
    .name = "EyeLink ASC",
    .is = isEyeLinkAsc,
    .read = [](const RecordingFile& file, const Screen&, const TakeSample& take) {
      LineReader lines(file.path());
      return AscReader(lines, file.columns(), take).read();
    }};

}  // namespace foci
