#include "app/evaluation/chart/plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "app/evaluation/timed_runs.h"
#include "app/platform/sha256.h"
#include "app/record/tables.h"
#include "base/input_error.h"
#include "base/nearest.h"
#include "base/text.h"
#include "render/methods/method.h"

namespace foci {
namespace {

ChartPlan full() {
  return {.quick = false,
          .size_px = 512,
          .blurs_px = {1.0, 4.0, 12.0, 40.0},
          .min_views = 256,
          .max_views = 1024,
          .timing_ms = 300.0,
          .max_runs = 7};
}

ChartPlan quick() {
  return {.quick = true,
          .size_px = 256,
          .blurs_px = {4.0, 16.0},
          .min_views = 64,
          .max_views = 128,
          .timing_ms = 60.0,
          .max_runs = 3};
}

/// Settings besides the standard one, where a method's number is a dial worth seeing turned, or
/// where the standard one takes long.
struct Dial {
  std::string_view method;
  std::vector<int> full, quick, stability;
};

const std::vector<Dial>& dials() {
  static const std::vector<Dial> all = {
      {"accumulate", {16, 64, 200}, {16}, {64}}, {"raytrace", {1, 4}, {1}, {16}},
      {"sweep-lod", {1, 7, 19}, {1, 7}, {7}},    {"layered", {4, 8, 32}, {8}, {8}},
      {"rasanen", {4, 16, 64}, {16}, {16}},      {"shinya", {16, 64}, {16}, {16}}};
  return all;
}

std::vector<ChartMethod> everyMethod(std::vector<int> Dial::*settings) {
  std::vector<ChartMethod> all;
  for (const MethodInfo& info : methods()) {
    const std::string name(info.name);
    if (info.default_n == 0) {
      all.push_back({name, {}});
      continue;
    }
    const auto dial = std::find_if(dials().begin(), dials().end(),
                                   [&](const Dial& one) { return one.method == name; });
    if (dial == dials().end()) {
      all.push_back({name, info.default_n});
      continue;
    }
    for (const int setting : (*dial).*settings) all.push_back({name, setting});
  }
  return all;
}

ChartMethod methodOf(const std::string& spec) {
  if (const auto expected = expectedMethod(spec)) {
    throw InputError("--method " + spec, "expected " + *expected);
  }
  const std::size_t colon = spec.find(':');
  if (colon != std::string::npos) return {spec.substr(0, colon), std::stoi(spec.substr(colon + 1))};
  const auto info = std::find_if(methods().begin(), methods().end(),
                                 [&](const MethodInfo& one) { return one.name == spec; });
  return {spec, info->default_n > 0 ? std::optional(info->default_n) : std::nullopt};
}

std::vector<ChartMethod> methodsOf(const ChartChoice& choice, std::vector<int> Dial::*settings) {
  if (choice.methods.empty()) return everyMethod(settings);
  std::vector<ChartMethod> some;
  for (const std::string& spec : choice.methods) some.push_back(methodOf(spec));
  return some;
}

/// Which scenes are wanted. @param known  their names
std::set<std::string> chosenOf(const ChartChoice& choice, const std::vector<std::string>& known) {
  if (choice.scenes.empty()) return {known.begin(), known.end()};
  for (const std::string& id : choice.scenes) {
    if (std::find(known.begin(), known.end(), id) == known.end()) {
      throw InputError("--scene " + id,
                       "expected a known scene; the nearest is " + nearest(id, known));
    }
  }
  return {choice.scenes.begin(), choice.scenes.end()};
}

std::string poseText(const EyePose& pose) {
  std::string text;
  for (const glm::vec3& v : {pose.position_m, pose.target_m, pose.up}) {
    for (int i = 0; i < 3; ++i) text += decimal(v[i], 6) + " ";
  }
  return text;
}

std::vector<ChartScene> everyScene(int size_px, const std::optional<ScanView>& scan) {
  std::vector<ChartScene> all;
  if (scan) {  // first, should there be something wrong with it
    all.push_back({"scan", scan->file.filename().string(), inputOf(*scan),
                   [=, view = *scan] { return scanInView(view, size_px); }});
  }
  all.push_back(
      {"plane", "a textured plane, tilted", "", [=] { return planeInView(512, size_px); }});
  all.push_back({"gallery", "a gallery, things from 0.25 to 6 m", "",
                 [=] { return galleryInView(size_px); }});
  all.push_back({"mask", "a half-transparent mask before a figure in focus", "",
                 [=] { return maskInView(size_px); }});
  all.push_back(
      {"fence", "thin wires before a wall in focus", "", [=] { return fenceInView(size_px); }});
  if (!scan) {
    all.push_back({"statue", "a stone lion", "", [=] { return statueInView(size_px); }});
  }
  return all;
}

}  // namespace

std::string inputOf(const ScanView& scan) {
  return sha256OfFile(scan.file) + " " + poseText(scan.pose);
}

int ChartPlan::views(double blur_px) const {
  const double views = std::ceil(std::numbers::pi * blur_px * blur_px);
  return static_cast<int>(std::clamp(views, double{1.0 * min_views}, double{1.0 * max_views}));
}

ChartPlan planChart(const ChartChoice& choice) {
  ChartPlan plan = choice.quick ? quick() : full();
  plan.size_px = choice.size_px.value_or(plan.size_px);
  plan.threads = threadCounts();
  plan.scenes = everyScene(plan.size_px, choice.scan);
  std::vector<std::string> known;
  for (const ChartScene& one : plan.scenes) known.push_back(one.id);
  std::erase_if(plan.scenes, [wanted = chosenOf(choice, known)](const ChartScene& one) {
    return !wanted.contains(one.id);
  });
  plan.methods = methodsOf(choice, choice.quick ? &Dial::quick : &Dial::full);
  return plan;
}

StabilityPlan planStability(const ChartChoice& choice) {
  StabilityPlan plan{.quick = choice.quick,
                     .effort = choice.quick ? StabilityEffort{.samples = 64, .steps = 3}
                                            : StabilityEffort{.samples = 160, .steps = 8},
                     .scenes = stabilityScenes()};
  if (choice.scan) plan.scenes.push_back(thinnedScan(*choice.scan));
  std::vector<std::string> known;
  for (const StabilityScene& one : plan.scenes) known.push_back(one.name);
  std::erase_if(plan.scenes, [wanted = chosenOf(choice, known)](const StabilityScene& one) {
    return !wanted.contains(one.name);
  });
  plan.methods = methodsOf(choice, &Dial::stability);
  if (!plan.quick) return plan;
  for (StabilityScene& scene : plan.scenes) {
    const std::vector<float>& all = scene.values;
    scene.values = {all.front(), all[all.size() / 2], all.back()};
  }
  return plan;
}

}  // namespace foci
