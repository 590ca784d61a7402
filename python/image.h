// A rendered image with its eye, and the frames that images give back when Python drops them.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "app/session/frame_record.h"
#include "app/session/frame_renderer.h"

namespace foci {

/// Frames that no image uses any more. A new frame of 1280x720 costs the system 3,600 pages, which
/// takes longer than everything else between Python and the renderer.
class FramePool : public std::enable_shared_from_this<FramePool> {
 public:
  /// A frame, with what an earlier image left in it. It comes back when its last owner drops it.
  std::shared_ptr<RenderedFrame> take();

 private:
  void giveBack(std::unique_ptr<RenderedFrame> frame);

  /// The image in hand, the next one, and one that a window still shows.
  static constexpr std::size_t kMaxFree = 3;
  std::mutex mutex_{};
  std::vector<std::unique_ptr<RenderedFrame>> free_{};
};

/// Owns its pixels together with every array that Python has of them.
struct EyeImage {
  std::shared_ptr<const RenderedFrame> rendered;
  FrameRecord record{};
};

}  // namespace foci
