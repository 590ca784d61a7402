#include "app/platform/warnings.h"

#include <algorithm>
#include <cstdio>

#include "base/text.h"

namespace foci {

void say(const std::string& text) { std::fprintf(stderr, "foci: %s\n", visible(text).c_str()); }

bool Warnings::keep(const std::string& text) {
  if (std::find(all_.begin(), all_.end(), text) != all_.end()) return false;
  all_.push_back(text);
  return true;
}

void Warnings::add(const std::string& text) {
  if (keep(text)) say(text);
}

void Warnings::include(const std::vector<std::string>& printed) {
  for (const std::string& text : printed) keep(text);
}

}  // namespace foci
