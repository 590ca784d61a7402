#include "app/session/frame_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/session/auto_method.h"

namespace foci {
namespace {

constexpr std::string_view kAutoNumbered = "auto:";

/// Adds what one view of an image cost. The error of an image is its largest.
void addView(const RenderStats& view, RenderStats& all) {
  all.splats += view.splats;
  all.fragments += view.fragments;
  all.ms += view.ms;
  all.in_full = all.in_full && view.in_full;
  if (view.tolerance_error) {
    all.tolerance_error = std::max(all.tolerance_error.value_or(0.0), *view.tolerance_error);
  }
}

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
  const std::string name = spec.starts_with(kAutoNumbered) ? "auto" : spec;
  std::unique_ptr<Method>& method = methods_[name];
  if (!method) method = makeMethod(name, *cloud_);
  return *method;
}

FrameRenderer FrameRenderer::cloneSharingScene() const {
  FrameRenderer other(*cloud_);
  for (const auto& [name, method] : methods_) {
    if (auto its = method->cloneSharingScene()) other.methods_[name] = std::move(its);
  }
  return other;
}

void FrameRenderer::prepare(const RenderRequest& job) {
  Method& method = methodNamed(job.method);
  for (const auto& [eye, settings] : job.eyes) method.prepare(eye.view, settings);
}

void FrameRenderer::render(const RenderRequest& job, RenderedFrame& rendered) {
  const bool mono = job.stereo == StereoView::mono;
  const int way = job.method.starts_with(kAutoNumbered)
                      ? std::stoi(job.method.substr(kAutoNumbered.size()))
                      : 0;
  Method& method = methodNamed(job.method);
  Frame& frame = rendered.frame;
  frame.size_px = job.size_px;
  frame.rgba.resize(static_cast<std::size_t>(job.size_px.x) * job.size_px.y);
  rendered.method = job.method;
  rendered.stats = {};
  const auto renders = static_cast<float>(job.eyes.size() * (job.split ? 2 : 1));
  bool first = true;
  for (const auto& [eye, asked] : job.eyes) {
    RenderSettings settings = asked;
    settings.quality.way = way;
    // Every view of a frame uses the same quality level, so that the log has one value per frame.
    settings.quality.as_before = !std::exchange(first, false);
    if (settings.quality.frame_ms) *settings.quality.frame_ms /= renders;
    Frame& seen = mono ? frame : eye_frame_;
    const RenderStats stats = method.render(eye.view, settings, seen);
    addView(stats, rendered.stats);
    if (!stats.rendered_as.empty()) rendered.method = stats.rendered_as;
    if (job.split) {
      settings.defocus = {};
      settings.depth = false;
      settings.quality.as_before = true;
      method.render(eye.view, settings, sharp_);
      splitWithSharp(seen, sharp_);
    }
    if (!mono) putEye(job.stereo, eye, seen, frame);
  }
  rendered.request = job;
}

}  // namespace foci
