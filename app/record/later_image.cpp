#include "app/record/later_image.h"

#include <cassert>
#include <utility>

namespace foci {

LaterImage readyImage(Image image) {
  std::promise<std::shared_ptr<const Image>> promise;
  promise.set_value(std::make_shared<const Image>(std::move(image)));
  return promise.get_future().share();
}

LaterImage FrameReading::start(FrameRenderer& renderer, std::shared_ptr<RenderedFrame> on_gpu,
                               std::optional<double> gamma) {
  assert(!done_);
  frame_ = std::move(on_gpu);
  renderer.startRead(*frame_);
  done_.emplace();
  const auto make = [done = done_->get_future().share(), frame = frame_, gamma] {
    done.get();
    compose(*frame);
    return std::make_shared<const Image>(imageOf(frame->frame, gamma));
  };
  return std::async(std::launch::deferred, make).share();
}

void FrameReading::finish(FrameRenderer& renderer) {
  if (!done_) return;
  try {
    renderer.finishRead(*frame_);
    done_->set_value();
  } catch (...) {
    done_->set_exception(std::current_exception());
  }
  done_.reset();
  frame_.reset();
}

}  // namespace foci
