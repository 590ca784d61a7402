#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>

#include "app/cli/commands.h"
#include "app/cli/option_values.h"
#include "app/eye/validation.h"
#include "app/platform/output_files.h"
#include "base/text.h"

namespace foci {
namespace {

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
