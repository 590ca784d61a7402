// Renders at full quality, on a thread beside the frame loop, what an eye at rest sees or will see.
// A frame that is no longer wanted is cancelled within a few milliseconds.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "app/session/frame_renderer.h"
#include "base/parallel.h"

namespace foci {

class Refiner {
 public:
  /// @param threads  that render
  Refiner(FrameRenderer renderer, unsigned threads);
  ~Refiner();
  Refiner& operator=(Refiner&&) = delete;  // nor copied

  /// Renders these requests in their order, and cancels all others. First it prepares their views
  /// for a frame-time budget. Does not wait.
  void want(std::vector<RenderRequest> requests);

  /// The frame of a wanted request, once it is rendered.
  std::optional<RenderedFrame> take(const RenderRequest& request);

  /// The next frame is rendered into this one's memory: a new one costs the system milliseconds.
  void reuse(RenderedFrame&& rendered);

  /// Hold it while the frame loop renders: both threads wait for the same memory.
  Gate& gate() { return gate_; }

  /// How many steps have been completed: views prepared, frames rendered.
  std::uint64_t done() const;

 private:
  struct Work;
  /// A unit of work.
  struct Step {
    RenderRequest request;
    bool prepares = false;
  };

  std::optional<Step> next() const;
  bool isWanted(const Step& step) const;
  bool carryOut(const Step& step, RenderedFrame& rendered);
  void run(const std::stop_token& stop);

  FrameRenderer renderer_;
  unsigned threads_;
  Gate gate_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::vector<RenderRequest> wanted_;
  std::vector<RenderedFrame> rendered_;  // wanted ones
  RenderedFrame spare_;
  std::optional<RenderRequest> prepared_;
  Step step_;  // in work, or done last
  std::uint64_t done_ = 0;
  std::unique_ptr<Work> work_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace foci
