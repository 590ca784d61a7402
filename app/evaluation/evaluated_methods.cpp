#include "app/evaluation/evaluated_methods.h"

#include <array>
#include <cassert>
#include <string_view>

#include "base/parallel.h"

namespace foci {
namespace {

/// The settings of a method whose number is worth varying, or whose standard number takes long.
/// Chosen by eye: each list spans the method from fast to accurate.
struct MethodSettings {
  std::string_view method;
  std::vector<int> full, quick, one;

  const std::vector<int>& in(SettingRange range) const {
    return range == SettingRange::full ? full : range == SettingRange::quick ? quick : one;
  }
};

const std::vector<MethodSettings> kVaried = {
    {"accumulate", {16, 64, 200}, {16}, {64}}, {"raytrace", {1, 4}, {1}, {16}},
    {"sweep-lod", {1, 7, 19}, {1, 7}, {7}},    {"layered", {4, 8, 32}, {8}, {8}},
    {"rasanen", {4, 16, 64}, {16}, {16}},      {"shinya", {16, 64}, {16}, {16}}};

std::optional<int> standardSettingOf(const MethodInfo& info) {
  return info.default_n > 0 ? std::optional(info.default_n) : std::nullopt;
}

std::vector<EvaluatedMethod> everyMethod(SettingRange range) {
  std::vector<EvaluatedMethod> all;
  for (const MethodInfo& info : methods()) {
    const std::string name(info.name);
    const auto varied = std::ranges::find(kVaried, name, &MethodSettings::method);
    if (info.default_n == 0 || varied == kVaried.end()) {
      all.push_back({name, standardSettingOf(info)});
      continue;
    }
    for (const int setting : varied->in(range)) all.push_back({name, setting});
  }
  return all;
}

EvaluatedMethod methodOfSpec(const std::string& spec) {
  if (const auto expected = expectedMethod(spec)) {
    throw InputError("--method " + spec, "expected " + *expected);
  }
  const std::size_t colon = spec.find(':');
  const std::string name = spec.substr(0, colon);
  const MethodInfo& info = methodInfo(spec);
  if (!info.variants.empty()) return {spec, std::nullopt};
  if (colon != std::string::npos) return {name, parseInteger<int>(spec.substr(colon + 1))};
  return {name, standardSettingOf(info)};
}

}  // namespace

std::string EvaluatedMethod::fileName() const {
  std::string file = spec();
  std::ranges::replace(file, ':', '-');
  return file;
}

std::vector<EvaluatedMethod> evaluatedMethods(const std::vector<std::string>& specs,
                                              SettingRange range) {
  if (specs.empty()) return everyMethod(range);
  return transformed(specs, methodOfSpec);
}

std::span<const FamilyStyle> methodFamilies() {
  static const std::array<FamilyStyle, 5> all = {
      {{MethodFamily::own, "foci's own", "#2f8f5b"},
       {MethodFamily::paper, "the 2003 paper", "#d9822b"},
       {MethodFamily::splatting, "other splatting", "#b4507c"},
       {MethodFamily::many_views, "many views", "#7a5bb5"},
       {MethodFamily::post_filter, "post-filters of a finished image", "#4f7fb3"}}};
  return all;
}

const FamilyStyle& familyOf(const std::string& method) {
  return *std::ranges::find(methodFamilies(), methodInfo(method).family, &FamilyStyle::family);
}

void runInTurn(std::vector<TimedRun>& runs) {
  int rounds = 0;
  for (const TimedRun& one : runs) rounds = std::max(rounds, one.runs);
  for (int round = 0; round < rounds; ++round) {
    for (TimedRun& one : runs) {
      if (round < one.runs) one.ms.push_back(one.run_ms());
    }
  }
}

double median(std::vector<double> values) {
  assert(!values.empty());
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

std::vector<unsigned> threadCounts() {
  const unsigned all = maxThreads();
  return all > 1 ? std::vector<unsigned>{1, all} : std::vector<unsigned>{1};
}

}  // namespace foci
