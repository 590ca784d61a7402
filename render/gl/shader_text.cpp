#include "render/gl/shader_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <initializer_list>
#include <string_view>

#include "render/gaussians/gaussian_cut.h"
#include "render/gaussians/projected.h"
#include "render/gl/gaussian_layers.h"
#include "render/image/metrics.h"
#include "render/kernel/kernel.h"
#include "render/kernel/pixel_edge.h"
#include "render/lod/back_faces.h"
#include "render/lod/cut.h"
#include "render/optics/defocus.h"
#include "render/scene/harmonics.h"
#include "render/splat/bin.h"
#include "render/splat/constants.h"

namespace foci {

namespace {

std::string literal(float value) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  std::string digits(text, end);
  return digits.find_first_of(".e") == std::string::npos ? digits + ".0" : digits;
}

std::string constant(std::string_view name, float value) {
  return "const float " + std::string(name) + " = " + literal(value) + ";\n";
}
std::string constant(std::string_view name, int value) {
  return "const int " + std::string(name) + " = " + std::to_string(value) + ";\n";
}
std::string constant(std::string_view name, std::uint32_t value) {
  return "const uint " + std::string(name) + " = " + std::to_string(value) + "u;\n";
}
std::string constant(std::string_view name, const glm::mat3& value) {
  std::string text;
  for (int i = 0; i < 9; ++i) text += (i > 0 ? ", " : "") + literal(value[i / 3][i % 3]);
  return "const mat3 " + std::string(name) + " = mat3(" + text + ");\n";
}

/// The constants of the CPU's code that the shaders use, under the same names.
std::string sharedConstants() {
  std::string text = constant("kNone", GpuJob::kNone) +
                     constant("kSeveral", std::uint32_t{Facing::kSeveral}) +
                     constant("kLinearFromBlurred", kBlurredRamp.linear_to) +
                     constant("kOpaqueFromBlurred", kBlurredRamp.opaque_from) +
                     constant("kLinearFromSharp", kSharpRamp.linear_to) +
                     constant("kOpaqueFromSharp", kSharpRamp.opaque_from) +
                     constant("kLinearToHole", kHoleRamp.linear_to) +
                     constant("kOpaqueFromHole", kHoleRamp.opaque_from) +
                     constant("kGroupsARow", static_cast<std::uint32_t>(kGroupsARow));
#define FOCI_SHARED(name) constant(#name, name)
  return text + FOCI_SHARED(kHidden) + FOCI_SHARED(kOverlap) + FOCI_SHARED(kWidestSupport2) +
         FOCI_SHARED(kReach2) + FOCI_SHARED(kLargest_px2) + FOCI_SHARED(kOpaqueWeight) +
         FOCI_SHARED(kNoise) + FOCI_SHARED(kAnother) + FOCI_SHARED(kPartial) +
         FOCI_SHARED(kDensityPeak) + FOCI_SHARED(kDensityBend) + FOCI_SHARED(kArcSine) +
         FOCI_SHARED(kDiscVariancePerRadius2) + FOCI_SHARED(kTile) + FOCI_SHARED(kApron) +
         FOCI_SHARED(kMostSamples) + FOCI_SHARED(kMaxStep_px) + FOCI_SHARED(kKeyBits) +
         FOCI_SHARED(kSigmasAStep) + FOCI_SHARED(kBend) + FOCI_SHARED(kBlurredSteps) +
         FOCI_SHARED(kSubAperturesFrom_px) + FOCI_SHARED(kSubAperturesOnly_px) +
         FOCI_SHARED(kLongAxis) + FOCI_SHARED(kComaOverlap) + FOCI_SHARED(kMinTilt) +
         FOCI_SHARED(kLeastCos2) + FOCI_SHARED(kHighlight) + FOCI_SHARED(kFiner) +
         FOCI_SHARED(kCoarser) + FOCI_SHARED(kFrontCover) + FOCI_SHARED(kTwoSurfaces) +
         FOCI_SHARED(kMeanScale) + FOCI_SHARED(kMeanNoise) + FOCI_SHARED(kFoldScale) +
         FOCI_SHARED(kFoldMean) + FOCI_SHARED(kSegmentBend) + FOCI_SHARED(kChord12) +
         FOCI_SHARED(kChord4) + FOCI_SHARED(kChord0) + FOCI_SHARED(kHalfDiscMoment) +
         FOCI_SHARED(kCutFade) + FOCI_SHARED(kWidestReach) + FOCI_SHARED(kEdgeOn) +
         FOCI_SHARED(kLowPassReach_px) + FOCI_SHARED(kLowPass_px2) +
         FOCI_SHARED(kMaxAlphaOfGaussian) + FOCI_SHARED(kOpaqueTransmittance) +
         FOCI_SHARED(kFieldMargin) + FOCI_SHARED(kSigmaPerBlur) + FOCI_SHARED(kVergenceReach) +
         FOCI_SHARED(kMaxPeakExponent) + FOCI_SHARED(kMinAlpha) + FOCI_SHARED(kHarmonicsStep) +
         FOCI_SHARED(kHarmonic1) + FOCI_SHARED(kHarmonic2a) + FOCI_SHARED(kHarmonic2b) +
         FOCI_SHARED(kHarmonic2c) + FOCI_SHARED(kHarmonic3a) + FOCI_SHARED(kHarmonic3b) +
         FOCI_SHARED(kHarmonic3c) + FOCI_SHARED(kHarmonic3d) + FOCI_SHARED(kHarmonic3e) +
         FOCI_SHARED(kKernelShapes) + FOCI_SHARED(kMaxExponent) + FOCI_SHARED(kJustNoticeable) +
         FOCI_SHARED(kLinearBelow) + FOCI_SHARED(kLinearSlope) + FOCI_SHARED(kXyzOfWhite) +
         FOCI_SHARED(kLabOfCurve) + FOCI_SHARED(kLight);
#undef FOCI_SHARED
}

}  // namespace

bool readsField(std::string_view stage) {
  constexpr std::array<std::string_view, 6> kStages{
      "cut", "gaussian_composite", "gaussian_cut", "gaussian_project", "project", "sweep"};
  return std::ranges::find(kStages, stage) != kStages.end();
}

std::string shaderText(const std::string& stage, const std::string& defines) {
  static const std::string constants = sharedConstants();
  std::string text = "#version 450 core\n" + defines + constants;
  const auto shared = [&](const char* file, std::initializer_list<std::string_view> by) {
    for (const std::string_view each : by) {
      if (each == stage) text += shaderSource(file);
    }
  };
  if (stage != "sum" && stage != "encode") {  // the stages of a frame
    text += shaderSource("frame") + shaderSource("totals");
  }
  if (readsField(stage)) text += shaderSource("field");
  shared("keys", {"project", "gaussian_project"});
  shared("batches", {"sweep", "gaussian_composite"});
  shared("cubic", {"interpolate", "gaussian_composite"});
  shared("layers", {"sweep"});
  shared("gaussian_layers", {"gaussian_composite"});
  shared("gaussian_follow", {"gaussian_composite"});
  return text + shaderSource(stage);
}

}  // namespace foci
