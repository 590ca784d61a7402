#include "render/methods/mean_of_parts.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "render/gl/image.h"

namespace foci {

namespace {

float nonlinearOf_px(const std::vector<LensPart>& parts) {
  float squares = 0.0f;
  for (const LensPart& part : parts) squares += part.weight * part.nonlinear_px * part.nonlinear_px;
  return std::sqrt(squares);
}

}  // namespace

std::vector<LensPart> partsFor(const Defocus& defocus, const Pupil& pupil, int least) {
  std::vector<LensPart> parts;
  for (const int n : {least, 7, 19, 37, 61}) {
    if (n < least) continue;
    parts = lensParts(defocus, pupil, n);
    if (nonlinearOf_px(parts) <= kNonlinear_px) break;
  }
  return parts;
}

void addPart(Frame& part, float weight, bool first, Frame& sum) {
  const bool depth = !sum.depth_m.empty();
  if (part.gpu && !depth) {
    addOnGpu(part, glm::vec4(weight), first, sum);
    return;
  }
  readFromGpu(part);
  parallelFor(sum.rgba.size(), [&](std::size_t p) {
    const float coverage = part.rgba[p].a;
    sum.rgba[p] = (first ? glm::vec4(0.0f) : sum.rgba[p]) + weight * part.rgba[p];
    if (!depth) return;
    sum.depth_m[p] = (first ? 0.0f : sum.depth_m[p]) + weight * coverage * part.depth_m[p];
  });
}

void finishDepth(Frame& sum) {
  if (sum.depth_m.empty()) return;
  parallelFor(sum.rgba.size(), [&](std::size_t p) {
    if (sum.rgba[p].a > 0.0f) sum.depth_m[p] /= sum.rgba[p].a;
  });
}

}  // namespace foci
