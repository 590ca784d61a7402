#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/cli/commands.h"
#include "app/platform/output_files.h"
#include "app/platform/version.h"
#include "base/text.h"

namespace foci {
namespace {

/// A file of the manual: its path below the folder, and its text.
using ManualFile = std::pair<std::string, std::string>;

/// A text for roff: `\` and `-` escaped, and no line that begins with a request.
std::string roff(const std::string& text) {
  const std::string escaped = "\n" + replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  return replaced(replaced(escaped, "\n.", "\n\\&."), "\n'", "\n\\&'").substr(1);
}

/// The description without its examples, and the examples.
struct Description {
  std::string text, examples;
};

Description descriptionOf(const CLI::App& app) {
  const std::string all = app.get_description();
  const std::size_t at = all.find("\nExample: ");
  if (at == std::string::npos) return {all, ""};
  return {all.substr(0, at), all.substr(at + 10)};
}

bool takesValue(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

std::string optionEntry(const CLI::Option& option) {
  const bool positional = option.get_positional() && option.get_lnames().empty();
  std::string names = positional ? option.get_name(true) : option.get_name(false, true);
  std::string entry = ".TP\n\\fB" + roff(names) + "\\fR";
  if (takesValue(option) && !positional) entry += " \\fI" + roff(option.get_type_name()) + "\\fR";
  return entry + "\n" + roff(option.get_description()) + "\n";
}

std::string synopsis(const std::string& name, const CLI::App& app) {
  std::string text = ".B " + roff(name) + "\n";
  if (!commandsByName(app).empty()) text += "\\fICOMMAND\\fR\n";
  bool options = false;
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_positional()) {
      options = true;
      continue;
    }
    text += "\\fI" + roff(option->get_name(true)) + "\\fR" +
            (option->get_items_expected_max() > 1 ? "...\n" : "\n");
  }
  return text + (options ? "[\\fIOPTIONS\\fR]\n" : "");
}

/// @param name  "foci replay"
std::string manPage(const std::string& name, const CLI::App& app) {
  std::string title = name;
  std::ranges::replace(title, ' ', '-');
  std::string upper = title;
  std::ranges::transform(upper, upper.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  const Description description = descriptionOf(app);
  std::string page = ".TH \"" + roff(upper) + "\" 1 \"\" \"foci " + roff(versionText()) +
                     "\" \"foci\"\n.SH NAME\n" + roff(title) + " \\- " +
                     roff(firstSentence(description.text)) + "\n.SH SYNOPSIS\n" +
                     synopsis(name, app) + ".SH DESCRIPTION\n" + roff(description.text) + "\n";
  const auto commands = commandsByName(app);
  if (!commands.empty()) page += ".SH COMMANDS\n";
  for (const CLI::App* command : commands) {
    page += ".TP\n\\fB" + roff(title + "-" + command->get_name()) + "\\fR(1)\n" +
            roff(descriptionOf(*command).text) + "\n";
  }
  page += ".SH OPTIONS\n";
  for (const CLI::Option* option : app.get_options()) page += optionEntry(*option);
  if (!description.examples.empty()) {
    page += ".SH EXAMPLES\n.nf\n" + roff(description.examples) + "\n.fi\n";
  }
  page +=
      ".SH EXIT STATUS\n0: done. 1: the run failed. 2: bad input; one line says what is wrong and "
      "what to do.\n";
  if (name != "foci") page += ".SH SEE ALSO\n\\fBfoci\\fR(1)\n";
  return page;
}

void addPages(const std::string& name, const CLI::App& app, std::vector<ManualFile>& files) {
  std::string title = name;
  std::ranges::replace(title, ' ', '-');
  files.emplace_back("man1/" + title + ".1", manPage(name, app));
  for (const CLI::App* command : commandsByName(app)) {
    addPages(name + " " + command->get_name(), *command, files);
  }
}

/// man1/foci.1, man1/foci-COMMAND.1 for each command, and completions for bash (foci), zsh (_foci)
/// and fish (foci.fish), from the same source as --help.
std::vector<ManualFile> manualOf(const CLI::App& app) {
  std::vector<ManualFile> files;
  addPages("foci", app, files);
  for (const auto& [name, text] : completionScripts()) {
    files.emplace_back("completions/" + name, text);
  }
  return files;
}

struct ManualOptions {
  std::string out{};
  bool overwrite = false;
};

void runManual(const CLI::App& app, const ManualOptions& options) {
  const std::filesystem::path out = options.out;
  const std::vector<ManualFile> manual = manualOf(app);
  std::vector<std::filesystem::path> outputs;
  outputs.reserve(manual.size());
  for (const auto& [name, text] : manual) outputs.push_back(out / name);
  OutputFiles files(OutputGuard(outputs, {}, options.overwrite));
  for (const auto& [name, text] : manual) files.write(out / name, text);
  files.commit();
  std::printf("%zu files: man %s\n", manual.size(),
              visible((out / "man1/foci.1").string()).c_str());
}

}  // namespace

void addManualCommand(CLI::App& app) {
  const auto options = std::make_shared<ManualOptions>();
  CLI::App* command = app.add_subcommand(
      "manual",
      "Write a man page for each command, and completions for bash, zsh and fish.\n"
      "Example: foci manual --out manual");
  addOption(*command, "--out", options->out, "DIR", "folder of the pages")->required();
  addOverwriteFlag(*command, options->overwrite);
  onceParsed(*command, [&app, options] { runManual(app, *options); });
}

}  // namespace foci
