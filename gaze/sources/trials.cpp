#include "gaze/sources/trials.h"

#include <algorithm>

#include "base/text.h"

namespace foci {

std::vector<TraceTrial> trialsIn(const std::vector<TraceMarker>& messages, std::string_view start,
                                 double end_s) {
  constexpr std::string_view kResult = "TRIAL_RESULT", kVariable = "!V TRIAL_VAR ";
  std::vector<TraceTrial> trials;
  bool open = false;
  for (const TraceMarker& message : messages) {
    const std::string_view text = message.text;
    if (text.starts_with(kResult)) {
      if (!open) continue;
      trials.back().last_s = message.time_s;
      trials.back().result = trimmed(text.substr(kResult.size()));
      open = false;
    } else if (text.starts_with(start)) {
      if (open) trials.back().last_s = message.time_s;
      const std::string_view rest = trimmed(text.substr(start.size()));
      trials.push_back({.name = std::string(rest.empty() ? trimmed(text) : rest),
                        .first_s = message.time_s,
                        .last_s = std::max(end_s, message.time_s)});
      open = true;
    } else if (open && text.starts_with(kVariable)) {
      const std::string_view rest = trimmed(text.substr(kVariable.size()));
      const std::size_t end = std::min(rest.find(' '), rest.size());
      trials.back().variables.emplace_back(rest.substr(0, end), trimmed(rest.substr(end)));
    }
  }
  return trials;
}

const TraceTrial* trialDuring(const std::vector<TraceTrial>& trials, double time_s) {
  auto trial = std::ranges::upper_bound(trials, time_s, {}, &TraceTrial::first_s);
  while (trial != trials.begin()) {
    if (time_s < (--trial)->last_s) return &*trial;
  }
  return nullptr;
}

std::string trialAt(const std::vector<TraceTrial>& trials, double time_s) {
  const TraceTrial* const trial = trialDuring(trials, time_s);
  return trial == nullptr ? "n/a" : visible(trial->name);
}

}  // namespace foci
