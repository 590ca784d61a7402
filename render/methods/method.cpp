#include "render/methods/method.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "base/input_error.h"
#include "base/nearest.h"
#include "base/text.h"
#include "render/gl/image.h"

namespace foci {

// Each at the end of its file.
MethodEntry autoMethod();
MethodEntry sweepMethod();
MethodEntry sweepLodMethod();
MethodEntry accumulateMethod();
MethodEntry pinholeMethod();

namespace {

struct Registry {
  std::vector<MethodEntry> entries{};
  std::vector<MethodInfo> infos{};  // of the entries

  Registry() {
    for (const auto entry :
         {autoMethod, sweepMethod, sweepLodMethod, accumulateMethod, pinholeMethod}) {
      add(entry());
    }
  }
  void add(const MethodEntry& entry) {
    entries.push_back(entry);
    entries.back().info.gaussians = entry.make_of_gaussians != nullptr;
    infos.push_back(entries.back().info);
  }
};

Registry& registry() {
  static Registry all;
  return all;
}

/// Null: there is none.
const MethodEntry* entryOf(std::string_view name) {
  const auto& all = registry().entries;
  const auto found =
      std::ranges::find(all, name, [](const MethodEntry& one) { return one.info.name; });
  return found == all.end() ? nullptr : &*found;
}

bool renders(const MethodInfo& /*method*/, const SurfelCloud& /*cloud*/) { return true; }
bool renders(const MethodInfo& method, const GaussianCloud& /*cloud*/) { return method.gaussians; }

bool rendersOnGpu(const MethodInfo& method, const SurfelCloud& /*cloud*/) { return method.gpu; }
bool rendersOnGpu(const MethodInfo& method, const GaussianCloud& /*cloud*/) {
  return method.gaussians;
}

/// A parsed spec.
struct Choice {
  const MethodEntry* entry = nullptr;  ///< null: the spec is invalid
  int n = 0;
  std::string expected;  ///< of an invalid spec
};

Choice parse(std::string_view spec) {
  const std::size_t colon = spec.find(':');
  const std::string name(spec.substr(0, colon));
  const MethodEntry* entry = entryOf(name);
  if (!entry) {
    std::vector<std::string> known;
    for (const MethodInfo& one : methods()) known.emplace_back(one.name);
    const auto near = nearWord(name, known);
    return {nullptr, 0,
            near ? "a known method; the nearest is " + *near
                 : std::string("a known method; foci methods lists them")};
  }
  if (colon == std::string_view::npos) return {entry, entry->info.default_n, {}};
  if (const auto& variants = entry->info.variants; !variants.empty()) {
    const auto variant = std::ranges::find(variants, spec.substr(colon + 1));
    if (variant != variants.end()) {
      return {entry, static_cast<int>(variant - variants.begin()) + 1, {}};
    }
    std::string expected = name;
    for (const std::string_view one : variants) {
      expected.append(", ").append(name).append(":").append(one);
    }
    return {nullptr, 0, std::move(expected)};
  }
  if (entry->info.max_n == 0) return {nullptr, 0, name + ", which takes no number"};
  const auto n = parseInteger<int>(spec.substr(colon + 1));
  if (n && *n >= 1 && *n <= entry->info.max_n) return {entry, *n, {}};
  return {nullptr, 0, name + ":1 to " + name + ":" + std::to_string(entry->info.max_n)};
}

bool isColored(const RenderSettings& settings) {
  return !settings.colours.empty() && settings.defocus.radius_px_per_D != glm::vec2(0.0f);
}

/// The colours in the order of rendering. The most out of focus goes first, and decides the quality
/// level of all. The one with most of the green goes last: it carries most of the light, so depth
/// is its own.
std::vector<Colour> inOrder(std::vector<Colour> colours) {
  const auto green =
      std::ranges::max_element(colours, {}, [](const Colour& c) { return c.share.g; });
  std::rotate(green, green + 1, colours.end());
  std::stable_sort(colours.begin(), colours.end() - 1, [](const Colour& a, const Colour& b) {
    return std::abs(a.nearer_D) > std::abs(b.nearer_D);
  });
  return colours;
}

/// The settings of one of several colours.
RenderSettings settingsOf(const RenderSettings& settings, const Colour& colour, bool first) {
  RenderSettings of_colour = settings;
  of_colour.colours.clear();
  if (of_colour.quality.frame_ms) {
    *of_colour.quality.frame_ms /= static_cast<float>(settings.colours.size());
  }
  of_colour.pupil.offset_m = glm::dvec2(0.0);
  of_colour.defocus.focus_D += colour.nearer_D;
  of_colour.quality.keep_level = settings.quality.keep_level || !first;
  return of_colour;
}

}  // namespace

void RenderStats::add(const RenderStats& other) {
  splats += other.splats;
  fragments += other.fragments;
  ms += other.ms;
  if (other.tolerance_error) {
    tolerance_error = std::max(*other.tolerance_error, tolerance_error.value_or(0.0));
  }
  if (other.tolerance_met) tolerance_met = *other.tolerance_met && tolerance_met.value_or(true);
  if (other.split_half_psnr_dB) {
    split_half_psnr_dB =
        std::min(*other.split_half_psnr_dB,
                 split_half_psnr_dB.value_or(std::numeric_limits<double>::infinity()));
  }
  if (other.quality_level) quality_level = other.quality_level;
  if (other.gpu) {
    if (!gpu) gpu.emplace();
    *gpu += *other.gpu;
  }
  full_quality = full_quality && other.full_quality;
}

RenderStats Method::render(const View& view, const RenderSettings& settings, Frame& frame) {
  const auto start = std::chrono::steady_clock::now();
  RenderStats stats = renderKept(view, settings, frame);
  readFromGpu(frame);
  stats.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return stats;
}

RenderStats Method::renderKept(const View& view, const RenderSettings& settings, Frame& frame) {
  const auto start = std::chrono::steady_clock::now();
  frame.gpu.reset();
  frame.resize(view.size_px, settings.depth);
  RenderStats stats = isColored(settings) ? renderColours(view, settings, frame)
                                          : renderFrame(view, settings, frame);
  if (stats.tolerance_error) {
    stats.tolerance_met = *stats.tolerance_error <= settings.quality.tolerance;
  }
  stats.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return stats;
}

void Method::pass(const View& view, const RenderSettings& settings) {
  passFrame(view, isColored(settings)
                      ? settingsOf(settings, inOrder(settings.colours).front(), true)
                      : settings);
}

RenderStats Method::renderColours(const View& view, const RenderSettings& settings, Frame& frame) {
  Frame sum;
  RenderStats all;
  bool first = true;
  for (const Colour& colour : inOrder(settings.colours)) {
    View seen = view;
    seen.principal_px += view.focal_px * colour.nearer_D * glm::vec2(settings.pupil.offset_m);
    all.add(renderFrame(seen, settingsOf(settings, colour, first), frame));
    const glm::vec4 share(colour.share, colour.share.g);
    if (settings.depth && frame.gpu) {
      Frame pixels{
          .size_px = frame.size_px, .rgba = {}, .depth_m = {}, .gpu = std::move(frame.gpu)};
      readFromGpu(pixels);
      frame.rgba = std::move(pixels.rgba);
      if (first) frame.depth_m = std::move(pixels.depth_m);
    }
    if (frame.gpu) {
      addOnGpu(frame, share, first, sum);
    } else {
      sum.rgba.resize(frame.rgba.size(), glm::vec4(0.0f));
      for (std::size_t p = 0; p < sum.rgba.size(); ++p) sum.rgba[p] += share * frame.rgba[p];
    }
    first = false;
  }
  frame.gpu = std::move(sum.gpu);
  if (!frame.gpu) frame.rgba = std::move(sum.rgba);
  return all;
}

void registerMethod(const MethodEntry& entry) {
  if (entryOf(entry.info.name)) {
    throw std::invalid_argument("method " + std::string(entry.info.name) + ": registered twice");
  }
  registry().add(entry);
}

const std::vector<MethodInfo>& methods() { return registry().infos; }

const MethodInfo& methodInfo(std::string_view spec) {
  const Choice choice = parse(spec);
  assert(choice.entry);
  return choice.entry->info;
}

std::optional<std::string> expectedMethod(std::string_view spec) {
  const Choice choice = parse(spec);
  return choice.entry ? std::nullopt : std::optional(choice.expected);
}

std::vector<std::string_view> methodsFor(const Scene& scene) {
  std::vector<std::string_view> names;
  for (const MethodInfo& method : methods()) {
    if (std::visit([&](const auto& cloud) { return renders(method, cloud); }, scene.splats)) {
      names.push_back(method.name);
    }
  }
  return names;
}

bool rendersOnGpu(std::string_view spec, const Scene& scene) {
  const MethodInfo& method = methodInfo(spec);
  return std::visit([&](const auto& cloud) { return rendersOnGpu(method, cloud); }, scene.splats);
}

std::unique_ptr<Method> makeMethod(std::string_view spec, const SurfelCloud& cloud,
                                   const SharedGpu& gpu) {
  const Choice choice = parse(spec);
  assert(choice.entry);
  return choice.entry->make(cloud, choice.n, choice.entry->info.gpu ? gpu : nullptr);
}

std::unique_ptr<Method> makeMethod(std::string_view spec, const GaussianCloud& cloud,
                                   const SharedGpu& gpu) {
  const Choice choice = parse(spec);
  assert(choice.entry);
  if (choice.entry->make_of_gaussians != nullptr) {
    return choice.entry->make_of_gaussians(cloud, choice.n, gpu);
  }
  throw InputError("method " + std::string(spec),
                   "renders surfaces, and the scene holds Gaussians: expected one of ",
                   listed(methodsFor(Scene{GaussianCloud{}})));
}

std::unique_ptr<Method> makeMethod(std::string_view spec, const Scene& scene,
                                   const SharedGpu& gpu) {
  return std::visit([&](const auto& cloud) { return makeMethod(spec, cloud, gpu); }, scene.splats);
}

}  // namespace foci
