// The methods that an evaluation compares, each with its number, and their families.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/evaluation/scene_in_view.h"
#include "base/input_error.h"
#include "base/nearest.h"
#include "base/text.h"
#include "base/transformed.h"
#include "render/methods/method.h"

namespace foci {

/// A method with the number that it is made with, if it takes one.
struct EvaluatedMethod {
  std::string name;  ///< with the variant, if it has one: "inflate:spark"
  std::optional<int> setting;

  /// As `makeMethod` takes it: "sweep", "accumulate:16".
  std::string spec() const { return name + (setting ? ":" + std::to_string(*setting) : ""); }
  /// A part of a file name: "sweep", "accumulate-16".
  std::string fileName() const;
};

/// How many settings an evaluation takes of a method whose number is worth varying.
enum class SettingRange {
  full,   ///< several, which span what the method can do
  quick,  ///< mostly one, and a cheap one
  one,    ///< exactly one
};

/// The methods that the user chose, or all of them.
/// @param specs  `name` or `name:N`; empty: every method, with the settings of `range`
/// @throws InputError for an unknown method or a number that it does not take
std::vector<EvaluatedMethod> evaluatedMethods(const std::vector<std::string>& specs,
                                              SettingRange range);

/// How charts show the methods of a family.
struct FamilyStyle {
  MethodFamily family;
  std::string name;
  std::string color;
};

std::span<const FamilyStyle> methodFamilies();
/// The colour of other renderers, whose points are imported, and its name in keys.
inline constexpr const char* kImportedColor = "#b23a3a";
inline constexpr const char* kImportedName = "other renderers";
/// @param method  a name, with or without number or variant; it must exist (asserted)
const FamilyStyle& familyOf(const std::string& method);

// Times of runs that take turns, so that other load on the machine slows all of them alike.

struct TimedRun {
  std::function<double()> run_ms;  ///< runs once and returns its time
  int runs = 1;                    ///< number of runs, > 0
  std::vector<double> ms = {};     ///< their times
};

/// Runs every entry once, in order; then every entry that has runs left; until none has.
void runInTurn(std::vector<TimedRun>& runs);

/// Apertures of consecutive timed frames differ by this share, so that no method can reuse its
/// previous frame. Chosen by eye: too small to change the time. None is larger than the one that
/// errors are measured with: it might ask `auto` for a better quality level.
inline constexpr double kAperturesApart = 1e-3;

/// The first frame of a method finds cold buffers, so its time does not count. It counts if it
/// takes this many times as long as all timed frames may. Chosen by eye: such a method is timed
/// once.
inline constexpr double kSlowFirst = 4.0;

/// The middle value, or the mean of the two middle ones. @param values  not empty (asserted)
double median(std::vector<double> values);

/// Numbers of threads to measure times with: one, and as many as TBB may use now.
std::vector<unsigned> threadCounts();

// What the user chose to evaluate, and what it gives.

struct EvaluationChoice {
  bool quick = false;
  std::optional<ScanView> scan = {};      ///< instead of the statue
  std::optional<int> size_px = {};        ///< width of the images
  std::vector<std::string> scenes = {};   ///< names; empty: all scenes
  std::vector<std::string> methods = {};  ///< `name` or `name:N`; empty: all methods
};

/// Called with the number of steps done since the last call.
using OnSteps = std::function<void(std::size_t)>;

/// What an evaluation has measured.
template <class Row>
struct Measured {
  std::vector<Row> rows = {};
  std::size_t computed = 0, kept = 0;      ///< cells that this run measured, and found complete
  std::vector<std::string> warnings = {};  ///< of the scan
};

/// Removes the scenes that the user did not choose.
/// @param nameOf  the name of a scene
/// @throws InputError if the user chose an unknown scene
template <class Scene, class NameOf>
void keepChosen(std::vector<Scene>& scenes, const EvaluationChoice& choice, const NameOf& nameOf) {
  if (choice.scenes.empty()) return;
  const std::vector<std::string> known = transformed(scenes, nameOf);
  const auto contains = [](const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
  };
  for (const std::string& name : choice.scenes) {
    if (!contains(known, name)) {
      const auto near = nearWord(name, known);
      throw InputError("--scene " + name, near ? "expected a known scene; the nearest is " + *near
                                               : "expected one of " + listed(known));
    }
  }
  std::erase_if(scenes,
                [&](const Scene& scene) { return !contains(choice.scenes, nameOf(scene)); });
}

}  // namespace foci
