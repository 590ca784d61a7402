#include "render/methods/method.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <chrono>

#include "app/base/nearest.h"

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
    for (const MethodEntry& entry : entries()) all.push_back(entry.info);
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
