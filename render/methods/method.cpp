#include "render/methods/method.h"

#include <algorithm>
#include <cassert>
#include <chrono>

#include "base/nearest.h"
#include "base/number.h"

namespace foci {

#define FOCI_METHOD(entry) MethodEntry entry();
#include "render/methods/every_method.inc"
#undef FOCI_METHOD

namespace {

const std::vector<MethodEntry>& entries() {
  static const std::vector<MethodEntry> all = {
#define FOCI_METHOD(entry) entry(),
#include "render/methods/every_method.inc"
#undef FOCI_METHOD
  };
  return all;
}

/// A spec as understood, or what was expected.
struct Choice {
  const MethodEntry* entry = nullptr;
  int number = 0;
  std::string expected;
};

Choice parse(std::string_view spec) {
  const std::size_t colon = spec.find(':');
  const std::string name(spec.substr(0, colon));
  const auto found = std::find_if(entries().begin(), entries().end(),
                                  [&](const MethodEntry& one) { return one.info.name == name; });
  if (found == entries().end()) {
    std::vector<std::string> known;
    for (const MethodEntry& one : entries()) known.emplace_back(one.info.name);
    return {nullptr, 0, "a known method; the nearest is " + nearest(name, known)};
  }
  const MethodEntry* entry = &*found;
  if (colon == std::string_view::npos) return {entry, entry->info.standard, {}};
  if (entry->info.most == 0) return {nullptr, 0, name + ", which takes no number"};
  const auto number = parseInteger<int>(spec.substr(colon + 1));
  if (number && *number >= 1 && *number <= entry->info.most) return {entry, *number, {}};
  return {nullptr, 0, name + ":1 to " + name + ":" + std::to_string(entry->info.most)};
}

const MethodInfo& infoOf(std::string_view spec) {
  const Choice choice = parse(spec);
  assert(choice.entry);
  return choice.entry->info;
}

}  // namespace

RenderStats Method::render(const View& view, const RenderSettings& settings, Frame& frame) {
  const auto start = std::chrono::steady_clock::now();
  frame.resize(view.size_px, settings.depth);
  const Defocus& lens = settings.defocus;
  const bool colored =
      lens.chromatic_D != glm::vec3(0.0f) && lens.radius_px_per_D != glm::vec2(0.0f);
  RenderStats stats =
      colored ? renderPrimaries(view, settings, frame) : renderFrame(view, settings, frame);
  stats.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return stats;
}

RenderStats Method::renderPrimaries(const View& view, const RenderSettings& settings,
                                    Frame& frame) {
  constexpr int kRed = 0, kGreen = 1, kBlue = 2;
  RenderSettings primary = settings;
  primary.defocus.chromatic_D = glm::vec3(0.0f);
  if (primary.quality.frame_ms) *primary.quality.frame_ms /= 3.0f;
  std::vector<glm::vec2> red_blue(frame.rgba.size());
  RenderStats all;
  // Blue, the most out of focus, decides how closely all are rendered; green, the most of the
  // light, tells coverage and depth.
  for (const int channel : {kBlue, kRed, kGreen}) {
    primary.defocus.focus_D = settings.defocus.focus_D + settings.defocus.chromatic_D[channel];
    primary.quality.as_before = settings.quality.as_before || channel != kBlue;
    const RenderStats stats = renderFrame(view, primary, frame);
    all.splats += stats.splats;
    all.fragments += stats.fragments;
    const auto worse = [](auto& of_all, const auto& of_one, auto pick) {
      if (of_one) of_all = of_all ? pick(*of_all, *of_one) : *of_one;
    };
    worse(all.tolerance_error, stats.tolerance_error,
          [](double a, double b) { return std::max(a, b); });
    worse(all.split_half_psnr_dB, stats.split_half_psnr_dB,
          [](double a, double b) { return std::min(a, b); });
    all.rendered_as = stats.rendered_as;
    if (channel == kGreen) break;
    for (std::size_t p = 0; p < red_blue.size(); ++p) {
      red_blue[p][channel == kRed ? 0 : 1] = frame.rgba[p][channel];
    }
  }
  for (std::size_t p = 0; p < red_blue.size(); ++p) {
    frame.rgba[p].r = red_blue[p].x;
    frame.rgba[p].b = red_blue[p].y;
  }
  return all;
}

const std::vector<MethodInfo>& methods() {
  static const auto infos = [] {
    std::vector<MethodInfo> all;
    for (const MethodEntry& entry : entries()) all.push_back(entry.info);
    return all;
  }();
  return infos;
}

bool rendersEllipses(std::string_view spec) { return infoOf(spec).ellipses; }

bool goesOn(std::string_view spec) { return infoOf(spec).goes_on; }

std::optional<std::string> expectedMethod(std::string_view spec) {
  const Choice choice = parse(spec);
  return choice.entry ? std::nullopt : std::optional(choice.expected);
}

std::unique_ptr<Method> makeMethod(std::string_view spec, const SurfelCloud& cloud) {
  const Choice choice = parse(spec);
  assert(choice.entry);
  return choice.entry->make(cloud, choice.number);
}

}  // namespace foci
