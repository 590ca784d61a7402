#include "render/methods/method.h"

#include "app/base/input_error.h"
#include "app/base/nearest.h"

namespace foci {

std::unique_ptr<Method> makeSweep(const SurfelCloud& cloud);

namespace {

struct Entry {
  MethodInfo info;
  std::unique_ptr<Method> (*make)(const SurfelCloud&);
};

constexpr Entry kEntries[] = {
    {{"sweep", "each splat blurred before the image is formed; streamed over tiles, without lists",
      "Krivanek, Zara and Bouatouch 2003, and our own"},
     makeSweep},
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

std::unique_ptr<Method> makeMethod(std::string_view name, const SurfelCloud& cloud) {
  std::vector<std::string> known;
  for (const Entry& entry : kEntries) {
    if (entry.info.name == name) return entry.make(cloud);
    known.emplace_back(entry.info.name);
  }
  throw InputError("method " + std::string(name),
                   "unknown; the nearest known is " + nearest(name, known));
}

}  // namespace foci
