// Paints at leisure, beside the frame loop, what an eye at rest sees or is about to see; and stops
// at once when it is no longer wanted.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "app/session/frame_renderer.h"

namespace foci {

class Refiner {
 public:
  /// @param threads  that render
  Refiner(FrameRenderer renderer, unsigned threads);
  ~Refiner();
  Refiner(const Refiner&) = delete;
  Refiner& operator=(const Refiner&) = delete;

  /// These images are to be rendered, the first of them first, and no others. What their views
  /// need to hold a time is prepared before. Does not wait.
  void want(std::vector<RenderRequest> jobs);

  /// The image of a job that is wanted, once it is there.
  std::optional<RenderedFrame> take(const RenderRequest& job);

  /// How much has been prepared and rendered so far.
  std::uint64_t done() const;

 private:
  struct Work;
  /// What is being done, or was last.
  struct Step {
    RenderRequest job;
    bool prepares = false;
  };

  std::optional<Step> next() const;
  bool isWanted(const Step& step) const;
  bool carryOut(const Step& step, RenderedFrame& rendered);
  void run(const std::stop_token& stop);

  FrameRenderer renderer_;
  unsigned threads_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::vector<RenderRequest> wanted_;
  std::vector<RenderedFrame> rendered_;  // of those
  std::optional<RenderRequest> prepared_;
  Step step_;
  std::uint64_t done_ = 0;
  std::unique_ptr<Work> work_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace foci
