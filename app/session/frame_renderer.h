// Images from all that they hang on: the views and lenses of a frame, and how it is to be rendered.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "app/session/stereo.h"
#include "render/image/frame.h"
#include "render/methods/method.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// What is to be rendered. Equal jobs one after the other have equal images, but where method
/// `auto` must hold a time, and where one goes on with the image before (`isIncremental`).
struct RenderRequest {
  struct Eye {
    EyeView eye;
    RenderSettings settings;
    bool operator==(const Eye&) const = default;
  };
  std::string method;
  StereoView stereo = StereoView::mono;
  glm::ivec2 size_px{0};
  bool split = false;  ///< the left half of each view without blur
  std::vector<Eye> eyes;
  bool operator==(const RenderRequest&) const = default;

  /// Whether what is rendered hangs on what it takes.
  bool holdsTime() const;
  /// Whether it is seen from the same place.
  bool sameViews(const RenderRequest& other) const;
  /// The same without haste.
  RenderRequest atLeisure() const;
};

struct RenderedFrame {
  RenderRequest job;
  Frame frame;
  std::string method;  ///< that renders the same again on any machine
  RenderStats stats;   ///< of all views together
};

/// Keeps a method of each name, and their buffers. One thread at a time.
class FrameRenderer {
 public:
  /// @param cloud  outlives it
  explicit FrameRenderer(const SurfelCloud& cloud) : cloud_(&cloud) {}

  /// Paints into `rendered.frame`, and fills the rest.
  void render(const RenderRequest& job, RenderedFrame& rendered);

  /// Does at leisure what lets jobs of the same views hold a time, also those of twins.
  void prepare(const RenderRequest& job);

  /// The method of that name, which is right (asserted); `auto:N` is `auto`.
  Method& methodNamed(const std::string& spec);

  /// Another one, as if just made, that may render at the same time.
  FrameRenderer cloneSharingScene() const;

 private:
  const SurfelCloud* cloud_;
  std::map<std::string, std::unique_ptr<Method>> methods_;
  Frame eye_frame_, sharp_;  // of one eye; kept for their memory
};

/// Adds what one of its views cost to what all of an image's do; the larger error is that of all.
void addView(const RenderStats& view, RenderStats& all);

}  // namespace foci
