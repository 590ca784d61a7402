#include "render/methods/method.h"

#include <charconv>

#include "app/base/input_error.h"
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

}  // namespace

const std::vector<MethodInfo>& methods() {
  static const auto infos = [] {
    std::vector<MethodInfo> all;
    for (const Entry& entry : kEntries) all.push_back(entry.info);
    return all;
  }();
  return infos;
}

std::unique_ptr<Method> makeMethod(std::string_view spec, const SurfelCloud& cloud) {
  const std::size_t colon = spec.find(':');
  const std::string_view name = spec.substr(0, colon);
  const std::string where = "method " + std::string(spec.substr(0, 64));
  std::vector<std::string> known;
  for (const Entry& entry : kEntries) {
    const MethodInfo& info = entry.info;
    known.emplace_back(info.name);
    if (info.name != name) continue;
    if (colon == std::string_view::npos) return entry.make(cloud, info.standard);
    if (info.most == 0) throw InputError(where, std::string(name) + " takes no number");
    int number = 0;
    const char* end = spec.data() + spec.size();
    const auto [rest, error] = std::from_chars(spec.data() + colon + 1, end, number);
    if (error != std::errc() || rest != end || number < 1 || number > info.most) {
      throw InputError(where,
                       "expected " + std::string(name) + ":1 to :" + std::to_string(info.most));
    }
    return entry.make(cloud, number);
  }
  throw InputError(where, "unknown; the nearest known is " + nearest(name, known));
}

}  // namespace foci
