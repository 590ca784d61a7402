#include "render/methods/method.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <chrono>
#include <iterator>

#include "app/base/nearest.h"

namespace foci {

std::unique_ptr<Method> makeSweep(const SurfelCloud& cloud);
std::unique_ptr<Method> makeSweepLod(const SurfelCloud& cloud, int parts);
std::unique_ptr<Method> makePaper(const SurfelCloud& cloud);
std::unique_ptr<Method> makePaperLod(const SurfelCloud& cloud);
std::unique_ptr<Method> makeAccumulate(const SurfelCloud& cloud, int views);
std::unique_ptr<Method> makePinhole(const SurfelCloud& cloud);
std::unique_ptr<Method> makePotmesil(const SurfelCloud& cloud);
std::unique_ptr<Method> makeRokita(const SurfelCloud& cloud);
std::unique_ptr<Method> makeMatthews(const SurfelCloud& cloud);
std::unique_ptr<Method> makeShinya(const SurfelCloud& cloud, int rays);
std::unique_ptr<Method> makeLayered(const SurfelCloud& cloud, int layers);
std::unique_ptr<Method> makeFearing(const SurfelCloud& cloud, int percent);
std::unique_ptr<Method> makeMulder(const SurfelCloud& cloud);
std::unique_ptr<Method> makeRasanen(const SurfelCloud& cloud, int samples);
std::unique_ptr<Method> makeInflate(const SurfelCloud& cloud);
#ifdef FOCI_RAYTRACE
std::unique_ptr<Method> makeRaytrace(const SurfelCloud& cloud, int rays);
#endif

namespace {

struct Entry {
  MethodInfo info;
  std::unique_ptr<Method> (*make)(const SurfelCloud&, int number);
};

constexpr Entry kEntries[] = {
    {{.name = "sweep",
      .summary =
          "each splat blurred before the image is formed; streamed over tiles, without lists",
      .source = "Krivanek, Zara and Bouatouch 2003, and our own"},
     [](const SurfelCloud& cloud, int) { return makeSweep(cloud); }},
    {{.name = "sweep-lod",
      .summary = "sweep from coarser levels and fewer samples where blurred; N parts of the lens "
                 "where surfaces overlap",
      .source = "our own",
      .most = 256,
      .standard = 7},
     makeSweepLod},
    {{.name = "paper",
      .summary = "the published baseline: each splat blurred, an A-buffer of fragments",
      .source = "Krivanek, Zara and Bouatouch 2003"},
     [](const SurfelCloud& cloud, int) { return makePaper(cloud); }},
    {{.name = "paper-lod",
      .summary = "the same with level of detail chosen by the blur",
      .source = "Krivanek, Zara and Bouatouch 2003; hierarchy: Rusinkiewicz and Levoy 2000"},
     [](const SurfelCloud& cloud, int) { return makePaperLod(cloud); }},
    {{.name = "accumulate",
      .summary = "N pinhole views over the lens, averaged: the reference",
      .source = "Haeberli and Akeley 1990",
      .most = 100000,
      .standard = 200},
     makeAccumulate},
    {{.name = "pinhole", .summary = "no depth of field", .source = "the traditional camera"},
     [](const SurfelCloud& cloud, int) { return makePinhole(cloud); }},
    {{.name = "potmesil",
      .summary = "each pixel of the pinhole image spread evenly over its circle of confusion",
      .source = "Potmesil and Chakravarty 1981; Chen 1988"},
     [](const SurfelCloud& cloud, int) { return makePotmesil(cloud); }},
    {{.name = "rokita",
      .summary = "3 x 3 convolutions of the pinhole image, repeated as the blur asks for",
      .source = "Rokita 1993"},
     [](const SurfelCloud& cloud, int) { return makeRokita(cloud); }},
    {{.name = "layered",
      .summary = "N depth layers drawn for themselves, blurred and laid over each other",
      .source = "Scofield 1992",
      .most = 256,
      .standard = 8},
     makeLayered},
    {{.name = "matthews",
      .summary = "spread pixels, kept off sharper things before them and normalised",
      .source = "after Matthews 1998"},
     [](const SurfelCloud& cloud, int) { return makeMatthews(cloud); }},
    {{.name = "shinya",
      .summary = "N rays a pixel of the pinhole image, hiding each other in ray buffers",
      .source = "Shinya 1994",
      .most = 4096,
      .standard = 64},
     makeShinya},
    {{.name = "fearing",
      .summary = "potmesil where something changed, at most N per cent of the frame",
      .source = "Fearing 1996",
      .most = 100,
      .standard = 100},
     makeFearing},
    {{.name = "mulder",
      .summary = "potmesil around the gaze, a pyramid of blurred images elsewhere",
      .source = "Mulder and van Liere 2000"},
     [](const SurfelCloud& cloud, int) { return makeMulder(cloud); }},
    {{.name = "rasanen",
      .summary = "N random samples of each splat's blurred kernel",
      .source = "Rasanen 2002",
      .most = 65536,
      .standard = 16},
     makeRasanen},
    {{.name = "inflate",
      .summary = "splats' covariance grown by the blur, opacity scaled down, sorted over",
      .source = "Kerbl et al. 2023; Spark, PlayCanvas"},
     [](const SurfelCloud& cloud, int) { return makeInflate(cloud); }},
#ifdef FOCI_RAYTRACE
    {{.name = "raytrace",
      .summary = "N rays a pixel through the lens, against discs: the other reference",
      .source = "Cook, Porter and Carpenter 1984",
      .most = 100000,
      .standard = 64},
     makeRaytrace},
#endif
};

/// A spec as understood, or what was expected.
struct Choice {
  const Entry* entry = nullptr;
  int number = 0;
  std::string expected;
};

Choice parse(std::string_view spec) {
  const std::size_t colon = spec.find(':');
  const std::string name(spec.substr(0, colon));
  const auto entry = std::find_if(std::begin(kEntries), std::end(kEntries),
                                  [&](const Entry& one) { return one.info.name == name; });
  if (entry == std::end(kEntries)) {
    std::vector<std::string> known;
    for (const Entry& one : kEntries) known.emplace_back(one.info.name);
    return {nullptr, 0, "a known method; the nearest is " + nearest(name, known)};
  }
  if (colon == std::string_view::npos) return {entry, entry->info.standard, {}};
  if (entry->info.most == 0) return {nullptr, 0, name + ", which takes no number"};
  int number = 0;
  const char* end = spec.data() + spec.size();
  const auto [rest, error] = std::from_chars(spec.data() + colon + 1, end, number);
  if (error == std::errc() && rest == end && number >= 1 && number <= entry->info.most) {
    return {entry, number, {}};
  }
  return {nullptr, 0, name + ":1 to " + name + ":" + std::to_string(entry->info.most)};
}

}  // namespace

RenderStats Method::render(const View& view, const RenderSettings& settings, Frame& frame) {
  const auto start = std::chrono::steady_clock::now();
  const std::size_t pixels = static_cast<std::size_t>(view.size_px.x) * view.size_px.y;
  frame.size_px = view.size_px;
  frame.rgba.resize(pixels);
  frame.depth_m.resize(settings.depth ? pixels : 0);
  RenderStats stats = draw(view, settings, frame);
  stats.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return stats;
}

const std::vector<MethodInfo>& methods() {
  static const auto infos = [] {
    std::vector<MethodInfo> all;
    for (const Entry& entry : kEntries) all.push_back(entry.info);
    return all;
  }();
  return infos;
}

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
