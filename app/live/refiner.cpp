#include "app/live/refiner.h"

#include <sched.h>
#include <sys/resource.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "base/parallel.h"

namespace foci {

struct Refiner::Work {
  tbb::task_group_context context;
  bool busy = false;
};

Refiner::Refiner(FrameRenderer renderer, unsigned threads)
    : renderer_(std::move(renderer)),
      threads_(threads),
      work_(std::make_unique<Work>()),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

Refiner::~Refiner() {
  thread_.request_stop();
  want({});
}

void Refiner::want(std::vector<RenderRequest> jobs) {
  {
    const std::lock_guard lock(mutex_);
    if (jobs == wanted_) return;
    wanted_ = std::move(jobs);
    std::erase_if(rendered_, [&](const RenderedFrame& each) { return !isWanted({each.job}); });
    if (work_->busy && !isWanted(step_)) work_->context.cancel_group_execution();
  }
  changed_.notify_all();
}

bool Refiner::isWanted(const Step& step) const {
  return std::ranges::any_of(wanted_, [&](const RenderRequest& job) {
    return step.prepares ? job.sameViews(step.job) : job == step.job;
  });
}

std::optional<RenderedFrame> Refiner::take(const RenderRequest& job) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(rendered_, job, &RenderedFrame::job);
  if (found == rendered_.end()) return std::nullopt;
  std::optional<RenderedFrame> rendered = std::move(*found);
  rendered_.erase(found);
  std::erase(wanted_, job);
  return rendered;
}

std::uint64_t Refiner::done() const {
  const std::lock_guard lock(mutex_);
  return done_;
}

std::optional<Refiner::Step> Refiner::next() const {
  if (!wanted_.empty() && !(prepared_ && prepared_->sameViews(wanted_.front()))) {
    return Step{.job = wanted_.front(), .prepares = true};
  }
  for (const RenderRequest& job : wanted_) {
    if (std::ranges::find(rendered_, job, &RenderedFrame::job) == rendered_.end())
      return Step{.job = job};
  }
  return std::nullopt;
}

/// False where it was stopped.
bool Refiner::carryOut(const Step& step, RenderedFrame& rendered) {
  bool whole = false;
  tbb::parallel_for(
      0, 1,
      [&](int) {
        try {
          if (step.prepares) {
            renderer_.prepare(step.job);
          } else {
            renderer_.render(step.job.atLeisure(), rendered);
            rendered.job = step.job;
          }
          whole = true;
        } catch (const Cancelled&) {
        }
      },
      work_->context);
  return whole;
}

void Refiner::run(const std::stop_token& stop) {
  // What follows the eye goes first; where the system does not allow it, they share.
  constexpr int kNice = 10;
  const sched_param usual{};
  (void)sched_setscheduler(0, SCHED_BATCH, &usual);
  (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
  tbb::task_arena arena(static_cast<int>(threads_), 1, tbb::task_arena::priority::low);
  while (!stop.stop_requested()) {
    Step step;
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, stop, [&] { return next().has_value(); })) return;
      step = step_ = *next();
      work_->context.reset();
      work_->busy = true;
    }
    RenderedFrame rendered;
    bool whole = false;
    arena.execute([&] { whole = carryOut(step, rendered); });
    const std::lock_guard lock(mutex_);
    work_->busy = false;
    if (!whole) continue;
    ++done_;
    if (step.prepares) {
      prepared_ = step.job;
    } else if (isWanted(step)) {
      rendered_.push_back(std::move(rendered));
    }
  }
}

}  // namespace foci
