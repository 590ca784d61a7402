#include <cstdio>
#include <memory>

#include "app/cli/commands.h"
#include "app/study/study_text.h"

namespace foci {

void addKeysCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("keys", "List the keys of a study file.");
  const auto markdown = std::make_shared<bool>(false);
  command->add_flag("--markdown", *markdown, "print docs/studies.md");
  command->callback([markdown] {
    if (*markdown) {
      std::fputs(studyKeysMarkdown().c_str(), stdout);
      return;
    }
    for (const ResolvedKey& key : resolvedKeys(Study{})) {
      std::printf("%-28s %s%s%s\n", std::string(key.name).c_str(), std::string(key.meaning).c_str(),
                  key.allowed.empty() ? "" : ": ", key.allowed.c_str());
    }
  });
}

}  // namespace foci
