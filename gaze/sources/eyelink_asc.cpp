#include "gaze/sources/eyelink_asc.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "base/number.h"
#include "base/text.h"
#include "gaze/geometry/cyclopean.h"

namespace foci {
namespace {

constexpr double kSecond_ms = 1000.0;
constexpr double kClock_ms = 1e-3;  // above the rounding of seconds, far below an interval

// Both eyelids move together, so a blink of one eye counts as a blink of both. But no blink lasts
// longer than this: then the tracker has lost one eye, and the other eye's gaze is good.
constexpr double kMaxBlink_ms = 1000.0;
constexpr double kSlack_ms = 100.0;  // the line of an event comes a little after its samples

struct Interval {
  double first_ms = 0.0, last_ms = 0.0;  // time stamps of the first and last sample
};

/// A recording block, from START to END. Eyes: 0 left, 1 right.
struct Block {
  bool open = false;
  std::array<bool, 2> recorded{};
  std::array<std::deque<Interval>, 2> blinks{};
  std::array<std::optional<double>, 2> blink_from_ms{};
  double newest_ms = 0.0;
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
        if (block_.open) readSample(line);
      } else if (line[0] >= 'A' && line[0] <= 'Z') {
        readEvent(line);
      }
    }
    if (cut_) {
      header_.warnings.emplace_back("the last line is cut off and left out: is the file complete?");
    } else if (block_.open) {
      header_.warnings.emplace_back(
          "the last recording block has no END, so the file may be cut off: is it complete?");
    }
    endBlock();
    header_.format = "EyeLink ASC, ";
    header_.format += binocular_ ? "binocular" : "monocular";
    if (remote_) header_.format += ", remote";
    return std::move(header_);
  }

 private:
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
      readMessage();
    } else if (kind == "START") {
      endBlock();
      block_ = {.open = true};
      setEyes();
    } else if (kind == "SAMPLES" && block_.open) {
      setEyes();
      remote_ |= std::find(words_.begin(), words_.end(), "HTARGET") != words_.end();
      if (words_.size() > 1 && (words_[1] == "HREF" || words_[1] == "PUPIL")) {
        throw lines_.error("samples in " + shown(words_[1]) +
                           " coordinates: expected GAZE; convert the EDF file again with "
                           "edf2asc -sg");
      }
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
      block_.recorded[side] |= std::find(words_.begin(), words_.end(), name) != words_.end();
    }
    binocular_ |= block_.recorded[0] && block_.recorded[1];
  }

  void readMessage() {
    const std::string_view key = words_.size() > 2 ? words_[2] : "";
    if (key != "GAZE_COORDS" && (key != "DISPLAY_COORDS" || gaze_coords_)) return;
    gaze_coords_ = key == "GAZE_COORDS";
    origin_px_ = {number(3), number(4)};
    Screen screen;
    for (int axis : {0, 1}) {
      const double pixels = number(5 + axis) - origin_px_[axis] + 1.0;
      if (!(pixels >= 16.0 && pixels <= 16385.0)) {
        throw lines_.error(std::string(key) + ": " + shown(words_[5 + axis]) +
                           ": expected a screen of 16 to 16384 px");
      }
      // The size is last pixel minus first, plus one. Some experiments write the size in place of
      // the last pixel. Screens have even sizes, so rounding down corrects this.
      screen.size_px[axis] = static_cast<int>(pixels) & ~1;
    }
    header_.screen = screen;
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
    const double stamp_ms = number(0);
    double time_ms = stamp_ms;
    if (stamp_ms == last_stamp_ms_ && time_ms_ == stamp_ms) time_ms = stamp_ms + 0.5;
    if (any_ && time_ms <= time_ms_) {
      throw lines_.error("time " + shown(words_[0]) + " ms is not after the sample before");
    }
    last_stamp_ms_ = stamp_ms;
    time_ms_ = time_ms;
    block_.newest_ms = stamp_ms;

    any_ = true;
    GazeSample sample{.time_s = time_ms / kSecond_ms};
    std::size_t at = 1;
    for (std::size_t side : {0, 1}) {
      if (!block_.recorded[side]) continue;
      if (!isAbsent(words_[at]) && !isAbsent(words_[at + 1])) {
        const glm::dvec2 point(number(at), number(at + 1));
        const bool missing = point.x == columns_.missing || point.y == columns_.missing;
        if (!missing) {
          sample.eyes[side].point_px = columns_.scale * point + columns_.offset - origin_px_;
        }
      }
      at += 3;
    }
    sample.point_px =
        cyclopean_.combine(sample.time_s, sample.eyes[0].point_px, sample.eyes[1].point_px);
    held_.push_back(sample);
    while (stamp_ms - held_.front().time_s * kSecond_ms > kMaxBlink_ms + kSlack_ms) release();
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
  glm::dvec2 origin_px_{0.0};
  bool gaze_coords_ = false, binocular_ = false, remote_ = false;
  double last_stamp_ms_ = -1.0, time_ms_ = -1.0;
};

}  // namespace

bool startsEyeLinkAsc(std::string_view line) {
  return line.starts_with("** ") || line.starts_with("MSG\t") || line.starts_with("START\t");
}

TraceHeader readEyeLinkAsc(LineReader& lines, const TraceColumns& columns, const TakeSample& take) {
  return AscReader(lines, columns, take).read();
}

}  // namespace foci
