#include "render/methods/method.h"

#include <cassert>
#include <charconv>

#include "app/base/nearest.h"

namespace foci {

std::unique_ptr<Method> makeSweep(const SurfelCloud& cloud);
std::unique_ptr<Method> makeAccumulate(const SurfelCloud& cloud, int views);

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
    {{.name = "accumulate",
      .summary = "N pinhole views over the lens, averaged: the reference",
      .source = "Haeberli and Akeley 1990",
      .most = 100000,
      .standard = 200},
     makeAccumulate},
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
  std::vector<std::string> known;
  for (const Entry& entry : kEntries) {
    const MethodInfo& info = entry.info;
    known.emplace_back(info.name);
    if (info.name != name) continue;
    if (colon == std::string_view::npos) return {&entry, info.standard, {}};
    if (info.most == 0) return {nullptr, 0, name + ", which takes no number"};
    int number = 0;
    const char* end = spec.data() + spec.size();
    const auto [rest, error] = std::from_chars(spec.data() + colon + 1, end, number);
    if (error == std::errc() && rest == end && number >= 1 && number <= info.most) {
      return {&entry, number, {}};
    }
    std::string range = name + ":1 to " + name;
    range += ":" + std::to_string(info.most);
    return {nullptr, 0, range};
  }
  return {nullptr, 0, "a known method; the nearest is " + nearest(name, known)};
}

}  // namespace

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
