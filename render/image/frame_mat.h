// Frames as OpenCV matrices.
#pragma once

#include <opencv2/core.hpp>

#include "render/image/frame.h"

namespace foci {

/// The frame's linear RGBA, four floats a pixel. The matrix refers to the frame's memory: read it
/// only, and only while the frame lives.
inline cv::Mat rgbaMat(const Frame& frame) {
  return {frame.size_px.y, frame.size_px.x, CV_32FC4, const_cast<glm::vec4*>(frame.rgba.data())};
}

}  // namespace foci
