// Paints at leisure, beside the frame loop, what an eye at rest sees; and stops at once when it is
// no longer wanted.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "app/painter.h"

namespace foci {

class Refiner {
 public:
  /// @param threads  that paint
  Refiner(Painter painter, unsigned threads);
  ~Refiner();
  Refiner(const Refiner&) = delete;
  Refiner& operator=(const Refiner&) = delete;

  /// The picture to be painted is this one, and no other. Does not wait.
  void want(const PaintJob& job);
  /// None is to be painted.
  void rest();

  /// The picture wanted, once it is there.
  std::optional<Painted> take();

 private:
  struct Work;
  void run(const std::stop_token& stop);

  Painter painter_;
  unsigned threads_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<PaintJob> wanted_, current_;  // to be begun; being painted or painted
  std::optional<Painted> done_;
  std::unique_ptr<Work> work_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace foci
