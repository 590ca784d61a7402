// A scene as Python holds it: surfels, and what looks at them and renders them.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "app/session/frame_renderer.h"
#include "app/session/session.h"
#include "python/image.h"
#include "render/scene/io/open_scene.h"

namespace foci {

/// Not copied: sessions and images keep it alive.
class Scene {
 public:
  explicit Scene(OpenedScene&& opened);

  const SurfelCloud& cloud() const { return opened_.cloud; }
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
