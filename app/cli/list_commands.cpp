#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "app/cli/commands.h"
#include "app/study/study_text.h"
#include "render/methods/method.h"

namespace foci {
namespace {

/// The name as users type it, with `:N` if the method takes a number, or its variants.
std::string typed(const MethodInfo& method) {
  std::string text(method.name);
  if (method.max_n > 0) text += ":N";
  for (const std::string_view variant : method.variants) {
    text.append(text.size() == method.name.size() ? "[:" : "|").append(variant);
  }
  if (!method.variants.empty()) text += "]";
  return text;
}

/// Four columns: name, whether a GPU renders surfaces by it, summary, source.
void printMethodTable() {
  std::size_t name_width = 0, summary_width = 0;
  for (const MethodInfo& method : methods()) {
    name_width = std::max(name_width, typed(method).size());
    summary_width = std::max(summary_width, method.summary.size());
  }
  for (const MethodInfo& method : methods()) {
    std::printf("%-*s  %s  %-*s  %s\n", static_cast<int>(name_width), typed(method).c_str(),
                method.gpu ? "GPU" : "   ", static_cast<int>(summary_width),
                std::string(method.summary).c_str(), std::string(method.source).c_str());
  }
}

void printMethodJson() {
  auto list = nlohmann::ordered_json::array();
  for (const MethodInfo& method : methods()) {
    nlohmann::ordered_json entry = {{"name", method.name},
                                    {"summary", method.summary},
                                    {"source", method.source},
                                    {"gpu", method.gpu}};
    if (method.max_n > 0) {
      entry["default_n"] = method.default_n;
      entry["max_n"] = method.max_n;
    }
    if (!method.variants.empty()) entry["variants"] = method.variants;
    list.push_back(entry);
  }
  std::puts(list.dump().c_str());
}

}  // namespace

void addMethodsCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("methods",
                                         "List the depth-of-field methods, each with its source.\n"
                                         "GPU marks those that also render surfaces on a GPU.");
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "print the list as JSON");
  command->callback([json] { *json ? printMethodJson() : printMethodTable(); });
}

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
