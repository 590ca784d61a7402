#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/commands.h"
#include "app/eye/eye_report.h"
#include "app/eye/validation.h"
#include "app/eye/visual_quality.h"
#include "app/platform/output_files.h"
#include "app/study/inputs.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

struct EyeOptions {
  std::string study{}, out{}, focus{};
  std::vector<std::string> at{}, field{}, set{};
  bool overwrite = false;
};

double fieldOf_deg(const std::string& text) {
  const std::optional<double> deg = parseNumber(text);
  if (!deg || !(std::abs(*deg) <= kMostField_deg)) {
    throw InputError("--field " + text, "expected degrees from -60 to 60");
  }
  return *deg;
}

void runEye(const EyeOptions& options) {
  Study study = readStudy(options.study);
  for (const std::string& assignment : options.set) setKeyByOption(study, assignment);
  checkStudy(study);
  EyeRequest request;
  if (!options.focus.empty()) request.focus_D = vergenceOf_D("--focus", options.focus);
  for (const std::string& at : options.at) request.distances_D.push_back(vergenceOf_D("--at", at));
  if (request.distances_D.size() > kMostDistances) {
    throw InputError("--at", "expected at most " + std::to_string(kMostDistances) + " distances");
  }
  for (const std::string& field : options.field) request.fields_deg.push_back(fieldOf_deg(field));
  if (request.fields_deg.size() > kMostFields) {
    throw InputError("--field", "expected at most " + std::to_string(kMostFields) + " angles");
  }
  const OutputGuard guard(eyeFiles(options.out), inputFiles(study), options.overwrite);
  for (const EyeFigures& eye : reportEye(study, request, options.out, guard)) {
    std::printf(
        "%s: pupil %.2f mm, focus %.2f D, depth of focus %s%.2f D, acuity by optics alone %.2f "
        "logMAR\n",
        eye.name.c_str(), 1000.0 * eye.pupil.diameter_m, eye.focus_D,
        eye.depth.complete ? "" : "more than ", eye.depth.total_D(), eye.acuity.logMAR());
  }
  std::printf("%s\n", visible((std::filesystem::path(options.out) / "eye.html").string()).c_str());
}

struct ValidateOptions {
  std::string out{};
  bool overwrite = false;
};

void runValidate(const ValidateOptions& options) {
  const OutputGuard guard(validationFiles(options.out), {}, options.overwrite);
  const std::vector<ValidationFigure> figures = validate(options.out, guard);
  std::size_t within = 0;
  const ValidationFigure* first = nullptr;
  for (const ValidationFigure& one : figures) {
    within += one.inBounds() ? 1 : 0;
    if (!one.inBounds() && one.known_miss.empty() && !first) first = &one;
  }
  std::printf("%zu of %zu figures within their bounds: %s\n", within, figures.size(),
              visible(validationFiles(options.out).back().string()).c_str());
  if (!first) return;
  throw std::runtime_error(
      first->group + ", " + first->what + ": " + decimal(first->value, first->digits) + " where " +
      decimal(first->expected, first->digits) + " +- " + significant(first->tolerance, 2) +
      " was published (" + first->source + ")");
}

}  // namespace

void addEyeCommand(CLI::App& app) {
  const auto options = std::make_shared<EyeOptions>();
  CLI::App* command = app.add_subcommand(
      "eye",
      "Show the optics of the observer's eye: the image of a point of light, contrast, depth of "
      "focus.\n"
      "Example: foci eye study.toml --out out/eye");
  addOption(*command, "STUDY", options->study, "FILE", "study (TOML)")->required();
  addOption(*command, "--out", options->out, "DIR", "folder of the results")->required();
  addOption(*command, "--focus", options->focus, "METRES",
            "focal distance, metres, or inf; default: the screen");
  addOption(*command, "--at", options->at, "METRES,...",
            "distances of points of light, metres or inf, e.g. 0.5,1,inf; default: within 1 D of "
            "the focus")
      ->delimiter(',');
  addOption(*command, "--field", options->field, "DEG,...",
            "angles to the right of the line of sight, degrees, e.g. 0,10,20; below 0 to the left; "
            "default: none")
      ->delimiter(',');
  addOption(*command, "--set", options->set, "KEY=VALUE",
            "set any key of the study; may be repeated")
      ->allow_extra_args(false);
  addOverwriteFlag(*command, options->overwrite);
  onceParsed(*command, [options] { runEye(*options); });
}

void addValidateCommand(CLI::App& app) {
  const auto options = std::make_shared<ValidateOptions>();
  CLI::App* command = app.add_subcommand(
      "validate",
      "Compare foci with published measurements of blur, pupil, focus and image quality.\n"
      "Example: foci validate --out out/validation");
  addOption(*command, "--out", options->out, "DIR", "folder of the results")->required();
  addOverwriteFlag(*command, options->overwrite);
  onceParsed(*command, [options] { runValidate(*options); });
}

}  // namespace foci
