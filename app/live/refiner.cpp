#include "app/live/refiner.h"

#include <sched.h>
#include <sys/resource.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#include <unistd.h>

#include <utility>

#include "app/base/parallel.h"

namespace foci {

struct Refiner::Work {
  tbb::task_group_context context;
  bool busy = false;
};

Refiner::Refiner(Painter painter, unsigned threads)
    : painter_(std::move(painter)),
      threads_(threads),
      work_(std::make_unique<Work>()),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

Refiner::~Refiner() {
  thread_.request_stop();
  rest();
}

void Refiner::want(const PaintJob& job) {
  {
    const std::lock_guard lock(mutex_);
    if (wanted_ == job || (!wanted_ && current_ == job)) return;
    wanted_ = job;
    current_.reset();
    done_.reset();
    if (work_->busy) work_->context.cancel_group_execution();
  }
  changed_.notify_all();
}

void Refiner::rest() {
  const std::lock_guard lock(mutex_);
  wanted_.reset();
  current_.reset();
  done_.reset();
  if (work_->busy) work_->context.cancel_group_execution();
}

std::optional<Painted> Refiner::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(done_, std::nullopt);
}

void Refiner::run(const std::stop_token& stop) {
  // What follows the eye goes first; where the system does not allow it, they share.
  constexpr int kNice = 10;
  const sched_param usual{};
  (void)sched_setscheduler(0, SCHED_BATCH, &usual);
  (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
  tbb::task_arena arena(static_cast<int>(threads_));
  while (!stop.stop_requested()) {
    PaintJob job;
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, stop, [&] { return wanted_.has_value(); })) return;
      job = *std::exchange(wanted_, std::nullopt);
      current_ = job;
      work_->context.reset();
      work_->busy = true;
    }
    Painted painted;
    bool whole = false;
    arena.execute([&] {
      tbb::parallel_for(
          0, 1,
          [&](int) {
            try {
              painter_.paint(job.atLeisure(), painted);
              whole = true;
            } catch (const Cancelled&) {
            }
          },
          work_->context);
    });
    const std::lock_guard lock(mutex_);
    work_->busy = false;
    if (whole && current_ == job) done_ = std::move(painted);
  }
}

}  // namespace foci
