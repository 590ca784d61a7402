#include "app/session/frame_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/session/auto_method.h"
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

}  // namespace

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
  if (!method) method = makeMethod(name, *cloud_, gpu_);
  return *method;
}

void FrameRenderer::fallBack(const GpuError& error) {
  gpu_failure_ = std::string(error.what()) + "; the CPU renders";
  methods_.clear();
  gpu_.reset();
}

std::string FrameRenderer::deviceOf(const std::string& spec) const {
  const std::string name(qualityLevelFrom(spec) ? kAutoMethod : spec);
  if (gpu_ && rendersOnGpu(name, *cloud_)) return gpu_->text();
  return std::string("the CPU, ") + simdTarget();
}

FrameRenderer FrameRenderer::cloneSharingScene() const {
  FrameRenderer other(*cloud_, gpu_);
  other.gpu_failure_ = gpu_failure_;
  for (const auto& [name, method] : methods_) {
    if (auto its = method->cloneSharingScene()) other.methods_[name] = std::move(its);
  }
  return other;
}

void FrameRenderer::prepare(const RenderRequest& request) {
  Method& method = methodNamed(request.method);
  for (const auto& [eye, settings] : request.eyes) method.prepare(eye.view, settings);
}

void FrameRenderer::pass(const RenderRequest& request) {
  if (request.eyes.empty()) return;
  const auto& [eye, asked] = request.eyes.front();  // it decides the level of the others
  RenderSettings settings = asked;
  settings.quality.quality_level = qualityLevelFrom(request.method);
  try {
    methodNamed(request.method).pass(eye.view, settings);
  } catch (const GpuError& error) {
    fallBack(error);
    methodNamed(request.method).pass(eye.view, settings);
  }
}

void FrameRenderer::render(const RenderRequest& request, RenderedFrame& rendered) {
  renderOnAnyDevice(request, false, rendered);
}

void FrameRenderer::renderPassed(const RenderRequest& request, RenderedFrame& rendered) {
  renderOnAnyDevice(request, true, rendered);
}

void FrameRenderer::renderOnAnyDevice(const RenderRequest& request, bool keep_level,
                                      RenderedFrame& rendered) {
  try {
    renderViews(request, keep_level, rendered);
  } catch (const GpuError& error) {
    fallBack(error);
    renderViews(request, keep_level, rendered);
  }
}

void FrameRenderer::renderViews(const RenderRequest& request, bool keep_level,
                                RenderedFrame& rendered) {
  const bool single = request.eyes.size() == 1;
  const std::optional<QualityLevel> level = qualityLevelFrom(request.method);
  Method& method = methodNamed(request.method);
  Frame& frame = rendered.frame;
  frame.size_px = request.size_px;
  frame.rgba.resize(static_cast<std::size_t>(request.size_px.x) * request.size_px.y);
  rendered.method = request.method;
  rendered.stats = {};
  const auto renders = static_cast<float>(request.eyes.size() * (request.split ? 2 : 1));
  for (const auto& [eye, asked] : request.eyes) {
    RenderSettings settings = asked;
    settings.quality.quality_level = level;
    // Every view of a frame uses the same quality level, so that the log has one value per frame.
    settings.quality.keep_level = std::exchange(keep_level, true);
    if (settings.quality.frame_ms) *settings.quality.frame_ms /= renders;
    Frame& seen = single ? frame : eye_frame_;
    const RenderStats stats = method.render(eye.view, settings, seen);
    rendered.stats.add(stats);
    // The budget makes the level depend on the machine, so the record names the level.
    if (stats.quality_level && asked.quality.frame_ms) {
      rendered.method = textOf(*stats.quality_level);
    }
    if (request.split) {
      settings.defocus = {};
      settings.depth = false;
      settings.quality.keep_level = true;
      method.render(eye.view, settings, sharp_);
      splitWithSharp(seen, sharp_);
    }
    if (!single) putEye(request.stereo, eye, seen, frame);
  }
  rendered.request = request;
}

}  // namespace foci
