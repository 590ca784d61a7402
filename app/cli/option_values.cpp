#include "app/cli/option_values.h"

#include <cmath>
#include <optional>

#include "base/input_error.h"
#include "base/parallel.h"
#include "base/text.h"

namespace foci {

double vergenceOf_D(const std::string& option, const std::string& text) {
  constexpr double kNearestFocus_m = 0.01;  // nearer than any eye accommodates
  const auto distance_m = text == "inf" ? std::optional(HUGE_VAL) : parseNumber(text);
  if (!distance_m || !(*distance_m >= kNearestFocus_m)) {
    throw InputError(option + " " + text, "expected metres, 0.01 or more, or inf");
  }
  return 1.0 / *distance_m;
}

void onceParsed(CLI::App& command, const std::function<void()>& run) {
  command.callback([&command, run] {
    for (const CLI::Option* option : command.get_options()) {
      if (option->get_type_size() == 0) continue;  // a flag
      if (std::ranges::find(option->results(), "") != option->results().end()) {
        throw InputError(option->get_name(), "expected a value that is not empty");
      }
    }
    run();
  });
}

void addOverwriteFlag(CLI::App& command, bool& overwrite) {
  command.add_flag("--overwrite", overwrite, "also replace files that foci did not make");
}

unsigned threadsOf(const std::string& threads) {
  constexpr unsigned kMaxThreads = 1024;  // chosen by eye: far above the cores of a workstation
  if (threads.empty()) return maxThreads();
  const auto count = parseNumber(threads);
  if (!count || *count < 1 || *count > kMaxThreads || *count != std::floor(*count)) {
    throw InputError("--threads " + threads,
                     "expected an integer, 1 to " + std::to_string(kMaxThreads));
  }
  return static_cast<unsigned>(*count);
}

}  // namespace foci
