#include "render/gl/shader_text.h"

#include <array>
#include <charconv>
#include <initializer_list>

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

/// @param names  with ", " between them
template <typename... Values>
std::string constants(std::string_view names, const Values&... values) {
  std::string text;
  const auto add = [&](const auto& value) {
    text += constant(names.substr(0, names.find(',')), value);
    names.remove_prefix(std::min(names.find(", "), names.size() - 2) + 2);
  };
  (add(values), ...);
  return text;
}

/// The constants of the CPU's code that the shaders use, under the same names.
std::string sharedConstants() {
  std::string text = constant("kNone", GpuJob::kNone) +
                     constant("kSeveral", std::uint32_t{Facing::kSeveral}) +
                     constant("kLinearToBlurred", kBlurredRamp.linear_to) +
                     constant("kOpaqueFromBlurred", kBlurredRamp.opaque_from) +
                     constant("kLinearToSharp", kSharpRamp.linear_to) +
                     constant("kOpaqueFromSharp", kSharpRamp.opaque_from) +
                     constant("kLinearToHole", kHoleRamp.linear_to) +
                     constant("kOpaqueFromHole", kHoleRamp.opaque_from) +
                     constant("kGroupsARow", static_cast<std::uint32_t>(kGroupsARow));
#define FOCI_SHARED(...) constants(#__VA_ARGS__, __VA_ARGS__)
  return text +
         FOCI_SHARED(kHidden, kOverlap, kWidestSupport2, kReach2, kLargest_px2, kOpaqueWeight,
                     kNoise, kAnother, kPartial, kDensityPeak, kDensityBend, kArcSine,
                     kDiscVariancePerRadius2, kTile, kApron, kMostSamples, kMaxStep_px, kKeyBits,
                     kSigmasAStep, kBlurredSteps, kRippleSteps, kSubAperturesFrom_px,
                     kSubAperturesOnly_px, kLongAxis, kComaOverlap, kMinTilt, kLeastCos2, kRounding,
                     kHighlight, kFiner, kCoarser, kFrontCover, kTwoSurfaces, kMeanScale,
                     kMeanNoise, kFoldScale, kFoldMean, kSegmentBend, kChord12, kChord4, kChord0,
                     kHalfDiscMoment, kCutFade, kWidestReach, kEdgeOn, kLowPassReach_px,
                     kLowPass_px2, kMaxAlphaOfGaussian, kOpaqueTransmittance, kFieldMargin,
                     kSigmaPerBlur, kVergenceReach, kMaxPeakExponent, kMinAlpha, kHarmonicsStep,
                     kHarmonic1, kHarmonic2a, kHarmonic2b, kHarmonic2c, kHarmonic3a, kHarmonic3b,
                     kHarmonic3c, kHarmonic3d, kHarmonic3e, kKernelShapes, kMaxExponent,
                     kJustNoticeable, kLinearBelow, kLinearSlope, kXyzOfWhite, kLabOfCurve, kLight);
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
  if (stage != "sum" && stage != "encode") text += shaderSource("frame");
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
