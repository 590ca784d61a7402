// Images of frames whose pixels are still on their way from the GPU.
#pragma once

#include <future>
#include <memory>
#include <optional>

#include "app/graphics/image.h"
#include "app/session/frame_renderer.h"

namespace foci {

/// The first thread that calls `get` waits for the pixels and makes the image.
using LaterImage = std::shared_future<std::shared_ptr<const Image>>;

/// An image that is there.
LaterImage readyImage(Image image);

/// Reads one frame at a time, while the thread that renders goes on.
class FrameReading {
 public:
  /// Begins to read a frame. The frame before has been finished.
  /// @param on_gpu  `cloneOnGpu`
  LaterImage start(FrameRenderer& renderer, std::shared_ptr<RenderedFrame> on_gpu,
                   std::optional<double> gamma);

  /// Waits for the pixels, if a frame is being read, and gives them to the image. Where the GPU
  /// fails, the renderer's CPU renders them.
  void finish(FrameRenderer& renderer);

 private:
  std::shared_ptr<RenderedFrame> frame_;
  std::optional<std::promise<void>> done_;
};

}  // namespace foci
