// Renders a frame from all that it depends on: views, lenses, method and quality.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/session/stereo.h"
#include "render/image/frame.h"
#include "render/methods/method.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// All that a frame depends on. Equal requests give equal frames, with two exceptions: `auto` under
/// a frame-time budget, and methods that go on with the frame before (`isIncremental`).
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

  /// Whether a frame-time budget decides how well it is rendered.
  bool hasTimeBudget() const;
  /// Whether the eyes stand at the same places as in `other`.
  bool sameViews(const RenderRequest& other) const;
  /// The same request at full quality.
  RenderRequest withoutTimeBudget() const;
};

struct RenderedFrame {
  RenderRequest request;
  Frame frame;
  std::string method;  ///< that renders the same frame again on any machine
  RenderStats stats;   ///< of all views together
};

/// Renders requests, one at a time. Keeps a method of each name, with its buffers.
class FrameRenderer {
 public:
  /// @param cloud  outlives it
  /// @param gpu  renders the methods that can (`rendersOnGpu`); null: the CPU renders
  explicit FrameRenderer(const SurfelCloud& cloud, SharedGpu gpu = nullptr)
      : cloud_(&cloud), gpu_(std::move(gpu)) {}

  /// Renders into `rendered.frame`, and fills the rest.
  void render(const RenderRequest& request, RenderedFrame& rendered);

  /// Passes over the request: later frames are as if it had been rendered (`Method::pass`).
  void pass(const RenderRequest& request);

  /// Renders the request that `pass` was last called with. The renderer is then as after `pass`.
  void renderPassed(const RenderRequest& request, RenderedFrame& rendered);

  /// Takes the time to compute what lets later requests of the same views keep a frame-time budget.
  /// Clones profit, too.
  void prepare(const RenderRequest& request);

  /// The method of that name, which must exist (asserted); `auto:N` is `auto`.
  Method& methodNamed(const std::string& spec);

  /// Whether a GPU can render the method in this scene.
  bool suitsGpu(const std::string& spec) const { return rendersOnGpu(spec, *cloud_); }

  /// What renders a method, for people: the GPU and its driver, or the CPU.
  std::string deviceOf(const std::string& spec) const;

  /// Why the CPU renders from then on, after the GPU failed; empty: it did not.
  const std::string& gpuFailure() const { return gpu_failure_; }

  /// A clone, as if just made, that may render at the same time.
  FrameRenderer cloneSharingScene() const;

 private:
  Method& made(const std::string& name);
  void fallBack(const GpuError& error);
  /// @param keep_level  the first view, too, is rendered at the level of the last render
  void renderViews(const RenderRequest& request, bool keep_level, RenderedFrame& rendered);
  void renderOnAnyDevice(const RenderRequest& request, bool keep_level, RenderedFrame& rendered);

  const SurfelCloud* cloud_;
  SharedGpu gpu_;
  std::string gpu_failure_;
  std::map<std::string, std::unique_ptr<Method>> methods_;
  Frame eye_frame_, sharp_;  // of one eye; kept for their memory
};

}  // namespace foci
