#include <algorithm>

#include "app/cli/commands.h"
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

const std::string kFiles = ":files\n";

/// The lines of words that begin as `typed` does.
class Offers {
 public:
  explicit Offers(const std::string& typed) : typed_(typed) {}
  void add(const std::string& word, const std::string& help = "") {
    if (word.starts_with(typed_)) lines_ += help.empty() ? word + "\n" : word + "\t" + help + "\n";
  }
  const std::string& lines() const { return lines_; }

 private:
  std::string typed_, lines_;
};

/// The option of a command that `word` names and that takes a value.
const CLI::Option* optionBefore(const CLI::App& app, const std::string& word) {
  if (!word.starts_with("--")) return nullptr;
  for (const CLI::Option* option : app.get_options()) {
    if (option->check_lname(word.substr(2)) && option->get_items_expected_max() > 0) return option;
  }
  return nullptr;
}

/// The values of an option; the type of one that takes few is "A|B|C".
std::string valuesOf(const CLI::Option& option, Offers offers) {
  std::string type = option.get_type_name();
  if (option.check_lname("set")) {
    for (const ResolvedKey& key : resolvedKeys(Study{})) offers.add(std::string(key.name) + "=");
  } else if (option.check_lname("method")) {
    for (const MethodInfo& method : methods()) offers.add(std::string(method.name));
  } else if (type.find('|') != type.npos) {
    for (const std::string& value : CLI::detail::split(type, '|')) offers.add(value);
  } else {
    return kFiles;
  }
  return offers.lines();
}

}  // namespace

std::string completionsOf(const CLI::App& app, const std::vector<std::string>& words) {
  if (words.empty()) return "";
  const CLI::App* command = &app;
  for (auto word = words.begin(); word != words.end() - 1; ++word) {
    const auto commands = commandsByName(*command);
    const auto named = std::ranges::find(commands, *word, &CLI::App::get_name);
    if (named != commands.end()) command = *named;
  }
  Offers offers(words.back());
  if (words.size() > 1) {
    const CLI::Option* before = optionBefore(*command, words[words.size() - 2]);
    if (before != nullptr) return valuesOf(*before, offers);
  }
  const auto commands = commandsByName(*command);
  if (!words.back().starts_with("-") && commands.empty()) return kFiles;
  for (const CLI::App* one : commands) {
    offers.add(one->get_name(), firstSentence(one->get_description()));
  }
  for (const CLI::Option* option : command->get_options()) {
    for (const std::string& name : option->get_lnames()) {
      offers.add("--" + name, option->get_description());
    }
  }
  return offers.lines();
}

std::array<std::pair<std::string, std::string>, 3> completionScripts() {
  return {{{"foci", R"(# Completion of foci for bash, written by `foci manual`.
_foci() {
  local IFS=$'\n' offers
  offers=$("${COMP_WORDS[0]}" __complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null | cut -f1)
  if [[ $offers == :files ]]; then
    compopt -o filenames 2>/dev/null
    COMPREPLY=($(compgen -f -- "${COMP_WORDS[COMP_CWORD]}"))
  else
    [[ $offers == *= ]] && compopt -o nospace 2>/dev/null
    COMPREPLY=($offers)
  fi
}
complete -F _foci foci
)"},
           {"_foci", R"(#compdef foci
# Completion of foci for zsh, written by `foci manual`.
_foci() {
  local -a offers=("${(@f)$($words[1] __complete "${(@)words[2,CURRENT]}" 2>/dev/null | cut -f1)}")
  if [[ $offers == :files ]]; then
    _files
  elif [[ $offers[1] == *= ]]; then
    compadd -S '' -- $offers
  else
    compadd -- $offers
  fi
}
_foci "$@"
)"},
           {"foci.fish", R"(# Completion of foci for fish, written by `foci manual`.
function __foci_offers
  set -l words (commandline -opc) (commandline -ct)
  set -l offers ($words[1] __complete $words[2..] 2>/dev/null)
  if test "$offers" = :files
    __fish_complete_path (commandline -ct)
  else
    printf '%s\n' $offers
  end
end
complete -c foci -f -a '(__foci_offers)'
)"}}};
}

}  // namespace foci
