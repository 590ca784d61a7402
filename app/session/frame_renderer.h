// Renders a frame from all that it depends on: views, lenses, method and quality.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/session/stereo.h"
#include "render/gl/texture.h"
#include "render/image/frame.h"
#include "render/methods/method.h"
#include "render/scene/scene.h"

namespace foci {

/// All that a frame depends on. Equal requests give equal frames, with two exceptions: `auto` under
/// a frame-time budget, and methods that go on with the frame before (`MethodInfo::incremental`).
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
  std::vector<Eye> eyes{};
  bool operator==(const RenderRequest&) const = default;

  /// Whether a frame-time budget decides how well it is rendered.
  bool hasTimeBudget() const;
  /// Whether the eyes stand at the same places as in `other`.
  bool sameViews(const RenderRequest& other) const;
  /// The same request at full quality.
  RenderRequest withoutTimeBudget() const;
};

struct RenderedFrame {
  /// A view of the frame.
  struct Layer {
    Frame frame;
    std::size_t eye = 0;
    bool sharp = false;  ///< shows in the left half (`RenderRequest::split`)
  };
  RenderRequest request;
  Frame frame{};                ///< without meaning while `on_gpu`
  std::vector<Layer> layers{};  ///< in the order of rendering; without meaning unless `on_gpu`
  bool on_gpu = false;          ///< the pixels of all layers lie there
  std::string method;           ///< that renders the same frame again on any machine
  RenderStats stats;            ///< of all views together
};

/// Puts the layers that have been read from the GPU together. Any thread may.
void compose(RenderedFrame& rendered);

/// Another frame with the same pixels on the GPU.
RenderedFrame cloneOnGpu(const RenderedFrame& rendered);

/// Renders requests, one at a time. Keeps a method of each name, with its buffers.
class FrameRenderer {
 public:
  /// @param scene  outlives it
  /// @param gpu    renders the methods that can (`rendersOnGpu`); null: the CPU renders
  explicit FrameRenderer(const Scene& scene, SharedGpu gpu = nullptr)
      : scene_(&scene), gpu_(std::move(gpu)) {}

  /// Renders into `rendered.frame`, and fills the rest.
  void render(const RenderRequest& request, RenderedFrame& rendered);

  /// The same, but what the GPU renders stays there. Then `startRead`, `finishRead` and `compose`,
  /// or `read`, bring the pixels to `rendered.frame`.
  void renderKept(const RenderRequest& request, RenderedFrame& rendered);

  /// Begins to copy the pixels, and does not wait.
  void startRead(RenderedFrame& rendered);
  /// Waits for them. Where the GPU fails, renders the frame on the CPU, at the same quality level.
  void finishRead(RenderedFrame& rendered);
  void read(RenderedFrame& rendered);

  /// What a window shows of a frame on the GPU. Null where the GPU fails: the CPU then has rendered
  /// the frame.
  /// @param gamma  as `codesOf`
  std::shared_ptr<GpuTexture> textureOf(RenderedFrame& rendered, std::optional<double> gamma);

  /// Passes over the request: later frames are as if it had been rendered (`Method::pass`).
  void pass(const RenderRequest& request);

  /// Renders the request that `pass` was last called with. The renderer is then as after `pass`.
  void renderPassed(const RenderRequest& request, RenderedFrame& rendered);

  /// Takes the time to compute what lets later requests of the same views keep a frame-time budget.
  /// Clones profit, too.
  void prepare(const RenderRequest& request);

  /// Renders one view by a method, on any device.
  void renderView(const std::string& method, const View& view, const RenderSettings& settings,
                  Frame& frame);

  /// Null: the CPU renders.
  const SharedGpu& gpu() const { return gpu_; }

  /// The method of that name, which must exist (asserted); `auto:N` is `auto`.
  Method& methodNamed(const std::string& spec);

  /// Whether a GPU can render the method in this scene.
  bool suitsGpu(const std::string& spec) const { return rendersOnGpu(spec, *scene_); }

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
  template <class Action>
  void onAnyDevice(const Action& action);
  template <class Action>
  void onLayers(RenderedFrame& rendered, const Action& action);
  void renderAgain(const GpuError& error, RenderedFrame& rendered);

  const Scene* scene_;
  SharedGpu gpu_;
  std::string gpu_failure_;
  std::map<std::string, std::unique_ptr<Method>> methods_;
};

}  // namespace foci
