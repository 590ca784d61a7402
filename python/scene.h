// A scene as Python holds it: surfels, and what looks at them and renders them. A rendered image
// with its eye, and the frames that images give back when Python drops them.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "app/session/frame_record.h"
#include "app/session/frame_renderer.h"
#include "app/session/session.h"
#include "render/scene/io/open_scene.h"

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

/// Not copied: sessions and images keep it alive.
class PythonScene {
 public:
  explicit PythonScene(OpenedScene&& opened);

  const Scene& scene() const { return opened_.scene; }
  const OpenedScene& opened() const { return opened_; }
  FramePool& frames() { return *frames_; }

  /// What the eye sees after a long look at a point of the screen. One thread at a time renders;
  /// others wait.
  EyeImage render(const SessionSettings& settings, const glm::dvec2& gaze_px, bool depth);

 private:
  OpenedScene opened_;
  std::shared_ptr<FramePool> frames_ = std::make_shared<FramePool>();
  std::mutex mutex_{};
  std::optional<Session> looking_{};  // made at the first image: it indexes the surfels
  FrameRenderer renderer_;
};

/// Renders a request into a frame of the scene's own, and fills the image's record.
void renderInto(FrameRenderer& renderer, const RenderRequest& request,
                const std::shared_ptr<RenderedFrame>& frame, FrameRecord& record);

}  // namespace foci
