#include "app/cli/completions.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>

#include "app/study/study.h"
#include "render/methods/method.h"

namespace foci {

std::vector<const CLI::App*> commandsByName(const CLI::App& app) {
  std::vector<const CLI::App*> commands = app.get_subcommands([](const CLI::App*) { return true; });
  std::ranges::sort(commands, {}, [](const CLI::App* command) { return command->get_name(); });
  return commands;
}

std::string firstSentence(const std::string& description) {
  const std::string line = description.substr(0, description.find('\n'));
  const std::size_t stop = line.find(". ");
  return stop == std::string::npos ? line : line.substr(0, stop + 1);
}

namespace {

/// The options of a command, then the names of its own commands.
std::string wordsOf(const CLI::App& app) {
  std::string words;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) words += " --" + name;
  }
  for (const CLI::App* command : commandsByName(app)) words += " " + command->get_name();
  return words.empty() ? words : words.substr(1);
}

/// One line of a `case` for each command: the words after it.
/// @param quotes  around the words
void addCases(const std::string& name, const CLI::App& app, const char* quotes,
              std::string& script) {
  const auto commands = commandsByName(app);
  script += "    \"" + name + "\") offers=" + quotes[0] + wordsOf(app) + quotes[1];
  if (!commands.empty()) script += " group=yes";
  script += " ;;\n";
  for (const CLI::App* command : commands) {
    addCases(name + " " + command->get_name(), *command, quotes, script);
  }
}

void addNames(const std::string& name, const CLI::App& app, std::string& names) {
  names += "|" + name;
  for (const CLI::App* command : commandsByName(app)) {
    addNames(name + " " + command->get_name(), *command, names);
  }
}

/// The values of an option that takes few, between blanks: the type of such an option is "A|B|C".
std::string valuesOf(const CLI::Option& option) {
  std::string values;
  if (option.check_lname("method")) {
    for (const MethodInfo& method : methods()) values.append(" ").append(method.name);
    return values.substr(1);
  }
  values = option.get_type_name();
  if (values.find('|') == values.npos) return "";
  std::ranges::replace(values, '|', ' ');
  return values;
}

/// The options with values, by their values: a pattern of `case` such as "foci replay --view".
using ValuedOptions = std::map<std::string, std::string>;

void addValued(const std::string& name, const CLI::App& app, ValuedOptions& valued) {
  for (const CLI::Option* option : app.get_options()) {
    const std::string values = valuesOf(*option);
    if (values.empty()) continue;
    for (const std::string& word : option->get_lnames()) {
      std::string& pattern = valued[values];
      if (!pattern.empty()) pattern += "|";
      pattern.append("\"").append(name).append(" --").append(word).append("\"");
    }
  }
  for (const CLI::App* command : commandsByName(app)) {
    addValued(name + " " + command->get_name(), *command, valued);
  }
}

/// @param quotes  around the values
std::string valueCases(const CLI::App& app, const char* quotes) {
  ValuedOptions valued;
  addValued("foci", app, valued);
  std::string cases;
  for (const auto& [values, pattern] : valued) {
    cases.append("    ").append(pattern).append(") values=").append(1, quotes[0]);
    cases.append(values).append(1, quotes[1]).append(" ;;\n");
  }
  return cases;
}

/// The keys of a study, each with "=".
std::string keysWithEquals() {
  std::string keys;
  for (const ResolvedKey& key : resolvedKeys(Study{}))
    keys.append(" ").append(key.name).append("=");
  return keys.substr(1);
}

std::string inSingleQuotes(const std::string& text) {
  std::string quoted;
  for (const char c : text) {
    if (c == '\'' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return "'" + quoted + "'";
}

void addFish(const std::string& name, const CLI::App& app, std::string& script) {
  const std::string when = "complete -c foci -n 'test (__foci_command) = \"" + name + "\"'";
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& word : option->get_lnames()) {
      script.append(when).append(" -l ").append(word);
      if (word == "set") {
        script += " -x -a '" + keysWithEquals() + "'";
      } else if (const std::string values = valuesOf(*option); !values.empty()) {
        script += " -x -a '" + values + "'";
      } else if (option->get_items_expected_max() > 0) {
        script += " -r";
      }
      script += " -d " + inSingleQuotes(option->get_description()) + "\n";
    }
  }
  for (const CLI::App* command : commandsByName(app)) {
    script += when + " -f -a " + command->get_name() + " -d " +
              inSingleQuotes(firstSentence(command->get_description())) + "\n";
    addFish(name + " " + command->get_name(), *command, script);
  }
}

}  // namespace

std::string bashCompletion(const CLI::App& app) {
  const std::string keys = keysWithEquals();
  std::string cases, names;
  addCases("foci", app, "\"\"", cases);
  addNames("foci", app, names);
  return "# Completion of foci for bash, written by `foci manual`.\n"
         "_foci() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
         "  local name=foci offers= values= group= word i\n"
         "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
         "    word=${COMP_WORDS[i]}\n"
         "    case \"" +
         names.substr(1) +
         "|\" in *\"$name $word|\"*) name=\"$name $word\" ;; esac\n"
         "  done\n"
         "  COMPREPLY=()\n"
         "  if [[ $before == --set ]]; then\n"
         "    compopt -o nospace 2>/dev/null\n"
         "    COMPREPLY=($(compgen -W \"" +
         keys +
         "\" -- \"$current\"))\n"
         "    return\n"
         "  fi\n"
         "  case \"$name $before\" in\n" +
         valueCases(app, "\"\"") +
         "  esac\n"
         "  if [[ -n $values ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$values\" -- \"$current\"))\n"
         "    return\n"
         "  fi\n"
         "  case \"$name\" in\n" +
         cases +
         "  esac\n"
         "  if [[ $current == -* || -n $group ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$offers\" -- \"$current\"))\n"
         "  else\n"
         "    local IFS=$'\\n'\n"
         "    compopt -o filenames 2>/dev/null\n"
         "    COMPREPLY=($(compgen -f -- \"$current\"))\n"
         "  fi\n"
         "}\n"
         "complete -F _foci foci\n";
}

std::string zshCompletion(const CLI::App& app) {
  std::string cases, names;
  addCases("foci", app, "()", cases);
  addNames("foci", app, names);
  return "#compdef foci\n"
         "# Completion of foci for zsh, written by `foci manual`.\n"
         "_foci() {\n"
         "  local name=foci group= word i\n"
         "  local -a offers=() values=()\n"
         "  for ((i = 2; i < CURRENT; ++i)); do\n"
         "    word=$words[i]\n"
         "    case \"" +
         names.substr(1) +
         "|\" in *\"$name $word|\"*) name=\"$name $word\" ;; esac\n"
         "  done\n"
         "  if [[ $words[CURRENT-1] == --set ]]; then\n"
         "    compadd -S '' -- " +
         keysWithEquals() +
         "\n"
         "    return\n"
         "  fi\n"
         "  case \"$name $words[CURRENT-1]\" in\n" +
         valueCases(app, "()") +
         "  esac\n"
         "  if (( $#values )); then\n"
         "    compadd -- $values\n"
         "    return\n"
         "  fi\n"
         "  case \"$name\" in\n" +
         cases +
         "  esac\n"
         "  if [[ $PREFIX == -* || -n $group ]]; then\n"
         "    compadd -- $offers\n"
         "  else\n"
         "    _files\n"
         "  fi\n"
         "}\n"
         "_foci \"$@\"\n";
}

std::string fishCompletion(const CLI::App& app) {
  std::string names, script;
  addNames("foci", app, names);
  std::string quoted;
  for (std::size_t at = 1; at < names.size();) {
    const std::size_t end = std::min(names.find('|', at), names.size());
    quoted += " '" + names.substr(at, end - at) + "'";
    at = end + 1;
  }
  addFish("foci", app, script);
  return "# Completion of foci for fish, written by `foci manual`.\n"
         "function __foci_command\n"
         "  set -l name foci\n"
         "  for word in (commandline -opc)[2..]\n"
         "    if contains -- \"$name $word\"" +
         quoted +
         "\n"
         "      set name \"$name $word\"\n"
         "    end\n"
         "  end\n"
         "  echo $name\n"
         "end\n" +
         script;
}

}  // namespace foci
