#include "app/session/frame_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/methods/quality_level.h"
#include "render/splat/sweep.h"

namespace foci {
namespace {

/// Replaces the left half by a frame without blur, with a white line between.
void splitWithSharp(Frame& frame, const Frame& sharp) {
  const auto width = static_cast<std::size_t>(frame.size_px.x);
  for (std::size_t y = 0; y < static_cast<std::size_t>(frame.size_px.y); ++y) {
    const auto row = static_cast<std::ptrdiff_t>(y * width);
    std::copy_n(sharp.rgba.begin() + row, width / 2, frame.rgba.begin() + row);
    frame.rgba[y * width + width / 2] = glm::vec4(1.0f);
  }
}

/// Puts the layers' pixels together.
void putTogether(RenderedFrame& rendered) {
  const RenderRequest& request = rendered.request;
  Frame& frame = rendered.frame;
  const bool single = request.eyes.size() == 1;
  if (!single) frame.resize(request.size_px);
  for (auto layer = rendered.layers.begin(); layer != rendered.layers.end(); ++layer) {
    Frame& seen = layer->frame;
    const EyeView& eye = request.eyes.at(layer->eye).eye;
    if (request.split) splitWithSharp(seen, (++layer)->frame);
    if (single) {
      std::swap(frame, seen);
    } else {
      putEye(request.stereo, eye, seen, frame);
    }
  }
}

}  // namespace

void compose(RenderedFrame& rendered) {
  if (!rendered.on_gpu) return;
  for (auto& layer : rendered.layers) {
    layer.frame.gpu->copyTo(layer.frame);
    layer.frame.gpu.reset();
  }
  rendered.on_gpu = false;
  putTogether(rendered);
}

RenderedFrame cloneOnGpu(const RenderedFrame& rendered) {
  RenderedFrame clone{.request = rendered.request,
                      .on_gpu = true,
                      .method = rendered.method,
                      .stats = rendered.stats};
  for (const auto& [frame, eye, sharp] : rendered.layers) {
    clone.layers.push_back(
        {{.size_px = frame.size_px, .rgba = {}, .depth_m = {}, .gpu = frame.gpu}, eye, sharp});
  }
  return clone;
}

bool RenderRequest::hasTimeBudget() const {
  return choosesQuality(method) && !eyes.empty() && eyes.front().settings.quality.frame_ms &&
         std::isfinite(*eyes.front().settings.quality.frame_ms);
}

bool RenderRequest::sameViews(const RenderRequest& other) const {
  return std::ranges::equal(eyes, other.eyes, {}, &Eye::eye, &Eye::eye);
}

RenderRequest RenderRequest::withoutTimeBudget() const {
  RenderRequest request = *this;
  for (Eye& each : request.eyes) {
    each.settings.quality.frame_ms = std::numeric_limits<float>::infinity();
  }
  return request;
}

Method& FrameRenderer::methodNamed(const std::string& spec) {
  const std::string name(qualityLevelFrom(spec) ? kAutoMethod : spec);
  try {
    return made(name);
  } catch (const GpuError& error) {
    fallBack(error);
    return made(name);
  }
}

Method& FrameRenderer::made(const std::string& name) {
  std::unique_ptr<Method>& method = methods_[name];
  if (!method) method = makeMethod(name, *scene_, gpu_);
  return *method;
}

void FrameRenderer::fallBack(const GpuError& error) {
  gpu_failure_ = std::string(error.what()) + "; the CPU renders";
  methods_.clear();
  gpu_.reset();
}

/// Does it again on the CPU where the GPU fails.
template <class Action>
void FrameRenderer::onAnyDevice(const Action& action) {
  try {
    action();
  } catch (const GpuError& error) {
    fallBack(error);
    action();
  }
}

std::string FrameRenderer::deviceOf(const std::string& spec) const {
  const std::string name(qualityLevelFrom(spec) ? kAutoMethod : spec);
  if (gpu_ && rendersOnGpu(name, *scene_)) return gpu_->text();
  return std::string("the CPU, ") + simdTarget();
}

FrameRenderer FrameRenderer::cloneSharingScene() const {
  FrameRenderer other(*scene_, gpu_);
  other.gpu_failure_ = gpu_failure_;
  for (const auto& [name, method] : methods_) {
    if (auto its = method->cloneSharingScene()) other.methods_[name] = std::move(its);
  }
  return other;
}

void FrameRenderer::prepare(const RenderRequest& request) {
  onAnyDevice([&] {
    Method& method = methodNamed(request.method);
    for (const auto& [eye, settings] : request.eyes) method.prepare(eye.view, settings);
  });
}

void FrameRenderer::renderView(const std::string& method, const View& view,
                               const RenderSettings& settings, Frame& frame) {
  onAnyDevice([&] { methodNamed(method).render(view, settings, frame); });
}

void FrameRenderer::pass(const RenderRequest& request) {
  if (request.eyes.empty()) return;
  const auto& [eye, asked] = request.eyes.front();  // it decides the level of the others
  RenderSettings settings = asked;
  settings.quality.quality_level = qualityLevelFrom(request.method);
  onAnyDevice([&, view = eye.view] { methodNamed(request.method).pass(view, settings); });
}

void FrameRenderer::render(const RenderRequest& request, RenderedFrame& rendered) {
  renderKept(request, rendered);
  read(rendered);
}

void FrameRenderer::renderKept(const RenderRequest& request, RenderedFrame& rendered) {
  onAnyDevice([&] { renderViews(request, false, rendered); });
}

void FrameRenderer::renderPassed(const RenderRequest& request, RenderedFrame& rendered) {
  onAnyDevice([&] { renderViews(request, true, rendered); });
  read(rendered);
}

void FrameRenderer::startRead(RenderedFrame& rendered) {
  onLayers(rendered, [](auto& image) { image.startRead(); });
}

void FrameRenderer::finishRead(RenderedFrame& rendered) {
  onLayers(rendered, [](auto& image) { image.finishRead(); });
}

template <class Action>
void FrameRenderer::onLayers(RenderedFrame& rendered, const Action& action) {
  if (!rendered.on_gpu) return;
  try {
    const GpuDevice::Use use(*rendered.layers.front().frame.gpu->device());
    for (const RenderedFrame::Layer& layer : rendered.layers) action(*layer.frame.gpu);
  } catch (const GpuError& error) {
    renderAgain(error, rendered);
  }
}

void FrameRenderer::read(RenderedFrame& rendered) {
  startRead(rendered);
  finishRead(rendered);
  compose(rendered);
}

std::shared_ptr<GpuTexture> FrameRenderer::textureOf(RenderedFrame& rendered,
                                                     std::optional<double> gamma) {
  std::vector<GpuLayer> layers;
  for (const auto& [frame, eye, sharp] : rendered.layers) {
    const EyeView& view = rendered.request.eyes.at(eye).eye;
    GpuLayer layer{.image = frame.gpu, .corner_px = view.corner_px, .columns = frame.size_px.x};
    if (sharp) {
      layer.white_column = frame.size_px.x / 2;
      layer.columns = layer.white_column + 1;
    }
    if (rendered.request.stereo == StereoView::anaglyph && !view.isLeft()) {
      layer.channels.r = false;  // of the left eye, which comes first
    }
    layers.push_back(std::move(layer));
  }
  try {
    const auto& device = layers.front().image->device();
    const GpuDevice::Use use(*device);
    return std::make_shared<GpuTexture>(device, rendered.request.size_px, layers, gamma);
  } catch (const GpuError& error) {
    renderAgain(error, rendered);
    return nullptr;
  }
}

/// Renders on the CPU what the GPU lost. A level that was chosen stays.
void FrameRenderer::renderAgain(const GpuError& error, RenderedFrame& rendered) {
  fallBack(error);
  const RenderRequest request = rendered.request;
  const std::string method = rendered.method;
  RenderRequest at_level = request;
  if (rendered.stats.quality_level) at_level.method = textOf(*rendered.stats.quality_level);
  renderViews(at_level, false, rendered);
  rendered.request = request;
  rendered.method = method;
}

void FrameRenderer::renderViews(const RenderRequest& request, bool keep_level,
                                RenderedFrame& rendered) {
  const std::optional<QualityLevel> level = qualityLevelFrom(request.method);
  Method& method = methodNamed(request.method);
  rendered.method = request.method;
  rendered.stats = {};
  const std::size_t renders = request.eyes.size() * (request.split ? 2 : 1);
  rendered.layers.resize(renders);
  auto layer = rendered.layers.begin();
  for (std::size_t i = 0; i < request.eyes.size(); ++i) {
    const auto& [eye, asked] = request.eyes[i];
    RenderSettings settings = asked;
    settings.quality.quality_level = level;
    // Every view of a frame uses the same quality level, so that the log has one value per frame.
    settings.quality.keep_level = std::exchange(keep_level, true);
    if (settings.quality.frame_ms) *settings.quality.frame_ms /= static_cast<float>(renders);
    layer->eye = i;
    layer->sharp = false;
    const RenderStats stats = method.renderKept(eye.view, settings, (layer++)->frame);
    rendered.stats.add(stats);
    // The budget makes the level depend on the machine, so the record names the level.
    if (stats.quality_level && asked.quality.frame_ms) {
      rendered.method = textOf(*stats.quality_level);
    }
    if (request.split) {
      settings.defocus = {};
      settings.depth = false;
      settings.quality.keep_level = true;
      layer->eye = i;
      layer->sharp = true;
      method.renderKept(eye.view, settings, (layer++)->frame);
    }
  }
  rendered.request = request;
  rendered.on_gpu = std::ranges::all_of(
      rendered.layers, [](const RenderedFrame::Layer& each) { return each.frame.gpu != nullptr; });
  if (rendered.on_gpu) return;
  for (RenderedFrame::Layer& each : rendered.layers) readFromGpu(each.frame);
  putTogether(rendered);
}

}  // namespace foci
