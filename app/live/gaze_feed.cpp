#include "app/live/gaze_feed.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr double kPolls_Hz = 500.0;           // samples of a tracker wait 2 ms at most
constexpr std::size_t kMaxWaiting = 1 << 18;  // 100 MB; a frame of four minutes at 1000 Hz
constexpr double kStepLines_s = 10.0;         // between lines about steps of the sender's clock
constexpr double kJudged_s = 10.0;            // of gaze, whose unit may be wrong
constexpr const char* kOverflow = "foci renders a frame for too long";

void logLine(const std::string& line) {
  if (!line.empty()) std::fprintf(stderr, "foci: %s\n", line.c_str());
}

}  // namespace

GazeFeed::GazeFeed(NamedSource source, const LiveClock& clock)
    : source_(std::move(source)),
      clock_(clock),
      rate_Hz_(source_.source->rate_Hz()),
      status_(source_.source->status()),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

void GazeFeed::run(const std::stop_token& stop) {
  const double period_s = 1.0 / (source_.mouse ? rate_Hz_ : kPolls_Hz);
  std::vector<GazeSample> news;
  for (double due_s = clock_.now_s(); !stop.stop_requested(); due_s += period_s) {
    due_s = std::max(due_s, clock_.now_s() - period_s);  // no burst of polls after a stall
    std::this_thread::sleep_until(clock_.at(due_s));
    {
      const std::lock_guard lock(mutex_);
      ++polls_begun_;
      if (source_.mouse) source_.mouse->moveTo(pointer_px_);
    }
    news.clear();
    std::string status;
    SenderFacts sender;
    double now_s = clock_.now_s();
    try {
      source_.source->poll(now_s, news);
      if (source_.player) now_s = wholeMicroseconds(source_.player->time_s());
      status = source_.source->status();
      sender = source_.source->sender();
    } catch (const std::exception& error) {  // focus stays where it is
      status = error.what();
      sender = {.dropped = sender_.dropped + 1, .why = status, .clock = sender_.clock};
    }
    const std::lock_guard lock(mutex_);
    now_s_ = now_s;
    holdGaze(news);
    status_ = std::move(status);
    note(news, std::move(sender), now_s);
    polls_ended_ = polls_begun_;
    polled_.notify_all();
  }
}

/// Remembers where gaze is, or keeps it there.
void GazeFeed::holdGaze(std::vector<GazeSample>& news) {
  for (GazeSample& sample : news) {
    if (!holds_) {
      if (sample.point_px && !sample.blink) latest_px_ = sample.point_px;
      continue;
    }
    sample.point_px = latest_px_;
    sample.blink = false;
    sample.eyes = {};
  }
}

bool GazeFeed::hold(bool on) {
  const std::lock_guard lock(mutex_);
  if (on && !latest_px_) return false;
  holds_ = on;
  return true;
}

bool GazeFeed::holds() const {
  const std::lock_guard lock(mutex_);
  return holds_;
}

void GazeFeed::begin() {
  if (source_.player && !std::exchange(begun_, true)) source_.player->play(true);
}

/// Takes what a poll has brought.
void GazeFeed::note(const std::vector<GazeSample>& news, SenderFacts&& sender, double now_s) {
  // Pushed samples have been answered: they are kept (`push`).
  const bool keeps = source_.pushed || waiting_.size() < kMaxWaiting;
  if (keeps) waiting_.insert(waiting_.end(), news.begin(), news.end());
  const std::size_t dropped = sender.dropped - std::min(sender.dropped, sender_.dropped);
  const bool may_pause = source_.pushed && news.empty() && dropped == 0;  // between trials
  // A seek brings seconds of gaze at once.
  if (!source_.mouse && !source_.player && !may_pause) {
    logLine(keeps ? watch_.arrive(now_s, news, dropped, dropped > 0 ? sender.why : status_)
                  : watch_.arrive(now_s, {}, dropped + news.size(), kOverflow));
  }
  if (sender.clock && sender_.clock && sender.clock->steps > sender_.clock->steps &&
      (logged_step_s_ == 0.0 || now_s - logged_step_s_ > kStepLines_s)) {
    logged_step_s_ = now_s;
    logLine("the clock of the gaze's sender has stepped by " +
            decimal(sender.clock->latest_steps.back().ahead_s, 3) + " s; foci follows it");
  }
  sender_ = std::move(sender);
  if (!source_.mouse && !source_.player && !holds_ && !looks_right_) judge(news, now_s);
}

/// Says it until gaze looks as if its unit and origin were right. Gaze with a head has neither.
void GazeFeed::judge(const std::vector<GazeSample>& news, double now_s) {
  for (const GazeSample& sample : news) {
    if (!sample.head) doubts_.add(sample);
  }
  if (now_s - judged_s_ < kJudged_s || !doubts_.hasPositions()) return;
  judged_s_ = now_s;
  TraceHeader header;
  header.screen = source_.screen;
  std::exchange(doubts_, {}).statePositions(header, true);
  looks_right_ = header.warnings.empty();
  const bool begins = doubt_.empty();
  doubt_ = looks_right_ ? "" : "gaze may be wrong: " + header.warnings.front();
  if (source_.pushed && !looks_right_) doubt_ += " (expected px from the upper left corner)";
  if (begins) logLine(doubt_);
}

void GazeFeed::look(bool uses_gaze) {
  const std::lock_guard lock(mutex_);
  if (!source_.player) logLine(watch_.look(clock_.now_s(), uses_gaze));
}

GazeReception GazeFeed::reception() const {
  const std::lock_guard lock(mutex_);
  return {.clock = sender_.clock,
          .dropped = watch_.dropped(),
          .unused = watch_.unused(),
          .remark = watch_.remark(),
          .doubt = doubt_};
}

void GazeFeed::pointTo(const std::optional<glm::dvec2>& point_px) {
  const std::lock_guard lock(mutex_);
  pointer_px_ = point_px;
}

std::string GazeFeed::lookedAt(const glm::dvec2& point_px) {
  if (!source_.lookedAt) return "";
  return source_.lookedAt(point_px) ? "the webcam's map has learnt from the click"
                                    : "the webcam sees no eyes: the click is not used";
}

std::string GazeFeed::push(std::string_view text) {
  if (source_.pushed == nullptr) return "error gaze: expected foci live --source socket";
  std::vector<GazeSample> samples;
  try {
    samples = samplesOfText(text);
  } catch (const InputError& error) {
    return std::string("error ") + error.what();
  }
  const double now_s = clock_.now_s();
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= kMaxWaiting) {
      logLine(watch_.arrive(now_s, {}, samples.size(), kOverflow));
      return "error gaze: " + counted(samples.size(), "sample") + " dropped, because " + kOverflow;
    }
  }
  const std::size_t dropped = source_.pushed->push(samples, now_s);
  std::string answer = "ok " + std::to_string(samples.size() - std::min(samples.size(), dropped));
  if (dropped > 0) answer += " dropped " + std::to_string(dropped);
  const std::lock_guard lock(mutex_);
  if (!watch_.remark().empty()) answer += " unused: " + watch_.remark();
  return answer;
}

double GazeFeed::take(std::vector<GazeSample>& samples) {
  const std::lock_guard lock(mutex_);
  samples.insert(samples.end(), waiting_.begin(), waiting_.end());
  waiting_.clear();
  return source_.player ? now_s_ : clock_.now_s();
}

double GazeFeed::now_s() const {
  if (!source_.player) return clock_.now_s();
  const std::lock_guard lock(mutex_);
  return now_s_;
}

void GazeFeed::waitForPoll() {
  std::unique_lock lock(mutex_);
  polled_.wait_for(lock, std::chrono::seconds(1),
                   [this, next = polls_begun_ + 1] { return polls_ended_ >= next; });
}

std::string GazeFeed::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

namespace {

constexpr double kUnused_s = 1.0;        // which is said
constexpr double kQuiet_s = 10.0;        // of use, before the log has another line
constexpr std::size_t kMaxTimes = 1000;  // that are listed; the last then goes on

}  // namespace

std::string GazeWatch::arrive(double now_s, const std::vector<GazeSample>& samples,
                              std::size_t dropped, const std::string& why) {
  all_dropped_ += dropped;
  if (!looked_) return "";
  if (!since_s_) since_s_ = now_s;
  dropped_ += dropped;
  if (dropped > 0) why_ = why;
  if (dropped > 0 || !samples.empty()) arrived_s_ = now_s;
  for (const GazeSample& sample : samples) {
    const bool has_point = sample.point_px && !sample.blink;
    ++(has_point ? pointed_ : pointless_);
    if (has_point) oldest_s_ = std::max(oldest_s_, now_s - sample.time_s);
  }
  if (now_s - *since_s_ <= kUnused_s) return "";
  const bool arrives = now_s - arrived_s_ <= kUnused_s;
  const std::string reasons = arrives ? this->reasons(now_s) : "none arrives (" + why + ")";
  remark_ = (arrives ? "gaze arrives, but none of it has been used for "
                     : "gaze has not been used for ") +
            decimal(now_s - *since_s_, 0) + " s: " + reasons;
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
  if (dropped_ > 0) add(counted(dropped_, "sample") + " dropped, because " + why_);
  if (pointless_ > 0) add(counted(pointless_, "sample") + " without a gaze point");
  if (pointed_ > 0 && looked_s_ <= *since_s_) {
    add("no frame for " + decimal(now_s - looked_s_, 0) + " s");
  } else if (pointed_ > 0) {
    add(counted(pointed_, "sample") + " up to " + decimal(oldest_s_, 1) +
        " s old, or too far apart");
  }
  return text;
}

}  // namespace foci
