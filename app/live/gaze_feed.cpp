#include "app/live/gaze_feed.h"

#include <chrono>
#include <stdexcept>
#include <utility>

#include "base/input_error.h"

namespace foci {
namespace {

constexpr double kPolls_Hz = 500.0;         // samples of a tracker wait 2 ms at most
constexpr std::size_t kMaxWaiting = 65536;  // bounds memory if nobody takes samples

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
    try {
      source_.source->poll(clock_.now_s(), news);
      status = source_.source->status();
    } catch (const std::exception& error) {
      status = error.what();  // focus stays where it is
    }
    const std::lock_guard lock(mutex_);
    if (waiting_.size() < kMaxWaiting) {
      waiting_.insert(waiting_.end(), news.begin(), news.end());
    }
    status_ = std::move(status);
    polls_ended_ = polls_begun_;
    polled_.notify_all();
  }
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

std::string GazeFeed::push(std::string_view samples) {
  if (source_.pushed == nullptr) return "error gaze: expected foci live --source socket";
  try {
    return "ok " + std::to_string(source_.pushed->push(samples));
  } catch (const InputError& error) {
    return std::string("error ") + error.what();
  }
}

void GazeFeed::take(std::vector<GazeSample>& samples) {
  const std::lock_guard lock(mutex_);
  samples.insert(samples.end(), waiting_.begin(), waiting_.end());
  waiting_.clear();
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

}  // namespace foci
