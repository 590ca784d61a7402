#include "app/live/gaze_watch.h"

#include <algorithm>
#include <utility>

#include "base/text.h"

namespace foci {
namespace {

constexpr double kUnused_s = 1.0;        // which is said
constexpr double kQuiet_s = 10.0;        // of use, before the log has another line
constexpr std::size_t kMaxTimes = 1000;  // that are listed; the last then goes on

std::string countOf(std::size_t count, const char* what) {
  return std::to_string(count) + (count == 1 ? " sample " : " samples ") + what;
}

}  // namespace

std::string GazeWatch::arrive(double now_s, const std::vector<GazeSample>& samples,
                              std::size_t dropped, const std::string& why) {
  all_dropped_ += dropped;
  if (!looked_ || (samples.empty() && dropped == 0)) return "";
  if (!since_s_) since_s_ = now_s;
  dropped_ += dropped;
  if (dropped > 0) why_ = why;
  for (const GazeSample& sample : samples) {
    const bool has_point = sample.point_px && !sample.blink;
    ++(has_point ? pointed_ : pointless_);
    if (has_point) oldest_s_ = std::max(oldest_s_, now_s - sample.time_s);
  }
  if (now_s - *since_s_ <= kUnused_s) return "";
  const std::string reasons = this->reasons(now_s);
  remark_ = "gaze arrives, but none of it has been used for " + decimal(now_s - *since_s_, 0) +
            " s: " + reasons;
  const bool begins = !std::exchange(unused_now_, true);
  if (begins && unused_.size() < kMaxTimes)
    unused_.push_back({.from_s = *since_s_, .to_s = now_s, .why = {}});
  unused_.back().to_s = now_s;
  unused_.back().why = reasons;
  if (!begins) return "";
  logs_ = !logged_s_ || now_s - *logged_s_ > kQuiet_s;
  return logs_ ? remark_ : "";
}

std::string GazeWatch::look(double now_s, bool uses_gaze) {
  looked_ = true;
  looked_s_ = now_s;
  if (!uses_gaze) return "";
  const bool ends = std::exchange(unused_now_, false);
  const double lasted_s = now_s - since_s_.value_or(now_s);
  since_s_.reset();
  dropped_ = pointless_ = pointed_ = 0;
  oldest_s_ = 0.0;
  remark_.clear();
  if (!ends) return "";
  logged_s_ = now_s;
  return logs_ ? "gaze is used again, after " + decimal(lasted_s, 1) + " s" : "";
}

/// Why none of the gaze since `since_s_` is used.
std::string GazeWatch::reasons(double now_s) const {
  std::string text;
  const auto add = [&](const std::string& reason) { text += (text.empty() ? "" : "; ") + reason; };
  if (dropped_ > 0) add(countOf(dropped_, "dropped, because ") + why_);
  if (pointless_ > 0) add(countOf(pointless_, "without a gaze point"));
  if (pointed_ > 0 && looked_s_ <= *since_s_) {
    add("no frame for " + decimal(now_s - looked_s_, 0) + " s");
  } else if (pointed_ > 0) {
    add(countOf(pointed_, "up to ") + decimal(oldest_s_, 1) + " s old, or too far apart");
  }
  return text;
}

}  // namespace foci
