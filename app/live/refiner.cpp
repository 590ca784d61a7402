#include "app/live/refiner.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <utility>

#include "app/platform/machine.h"

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

void Refiner::want(std::vector<RenderRequest> requests) {
  {
    const std::lock_guard lock(mutex_);
    if (requests == wanted_) return;
    wanted_ = std::move(requests);
    std::erase_if(rendered_, [&](const RenderedFrame& each) { return !isWanted({each.request}); });
    if (work_->busy && !isWanted(step_)) work_->context.cancel_group_execution();
  }
  changed_.notify_all();
}

bool Refiner::isWanted(const Step& step) const {
  return std::ranges::any_of(wanted_, [&](const RenderRequest& request) {
    return step.prepares ? request.sameViews(step.request) : request == step.request;
  });
}

std::optional<RenderedFrame> Refiner::take(const RenderRequest& request) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(rendered_, request, &RenderedFrame::request);
  if (found == rendered_.end()) return std::nullopt;
  std::optional<RenderedFrame> rendered = std::move(*found);
  rendered_.erase(found);
  std::erase(wanted_, request);
  return rendered;
}

void Refiner::reuse(RenderedFrame&& rendered) {
  const std::lock_guard lock(mutex_);
  if (!rendered.on_gpu) spare_ = std::move(rendered);
}

std::uint64_t Refiner::done() const {
  const std::lock_guard lock(mutex_);
  return done_;
}

std::optional<Refiner::Step> Refiner::next() const {
  if (!wanted_.empty() && wanted_.front().hasTimeBudget() &&
      !(prepared_ && prepared_->sameViews(wanted_.front()))) {
    return Step{.request = wanted_.front(), .prepares = true};
  }
  for (const RenderRequest& request : wanted_) {
    if (std::ranges::find(rendered_, request, &RenderedFrame::request) == rendered_.end())
      return Step{.request = request};
  }
  return std::nullopt;
}

/// @return false if it was cancelled
bool Refiner::carryOut(const Step& step, RenderedFrame& rendered) {
  bool completed = false;
  tbb::parallel_for(
      0, 1,
      [&](int) {
        try {
          if (step.prepares) {
            renderer_.prepare(step.request);
          } else {
            renderer_.render(step.request.withoutTimeBudget(), rendered);
            rendered.request = step.request;
          }
          completed = true;
        } catch (const Cancelled&) {
        }
      },
      work_->context);
  return completed;
}

void Refiner::run(const std::stop_token& stop) {
  // The frame loop goes first. If the system does not allow that, both share the cores.
  yieldToOtherThreads();
  passBeforeRanges(&gate_);
  tbb::task_arena arena(static_cast<int>(threads_), 1, tbb::task_arena::priority::low);
  RenderedFrame rendered;
  while (!stop.stop_requested()) {
    Step step;
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, stop, [&] { return next().has_value(); })) return;
      step = step_ = *next();
      work_->context.reset();
      work_->busy = true;
    }
    bool completed = false;
    arena.execute([&] { completed = carryOut(step, rendered); });
    const std::lock_guard lock(mutex_);
    work_->busy = false;
    if (!completed) continue;
    ++done_;
    if (step.prepares) {
      prepared_ = step.request;
    } else if (isWanted(step)) {
      rendered_.push_back(std::exchange(rendered, std::exchange(spare_, {})));
    }
  }
}

}  // namespace foci
