#include <algorithm>

#include "app/graphics/html.h"
#include "app/replay/report_charts.h"
#include "base/text.h"

namespace foci {
namespace {

std::string valueOf(const Study& study, const std::string& key) {
  for (const ResolvedKey& one : resolvedKeys(study)) {
    if (one.name == key) return one.json;
  }
  return "null";
}

std::string shownValue(const std::string& json) { return json == "null" ? "absent" : json; }

}  // namespace

RunChanges changesOfRun(const Study& study, const std::vector<Change>& changes,
                        const std::vector<TraceMarker>& markers, double first_s, double last_s) {
  RunChanges run{.start = study, .changes = {}, .markers = {}};
  Study now = study;
  for (const Change& change : changes) {
    if (change.time_s > last_s) break;
    const std::string from = valueOf(now, change.key);
    setKey(now, change.key, change.toml, "change");
    if (change.time_s <= first_s) {
      run.start = now;
    } else if (const std::string to = valueOf(now, change.key); to != from) {
      run.changes.push_back({change.time_s, change.key, from, to});
    }
  }
  std::ranges::copy_if(markers, std::back_inserter(run.markers), [&](const TraceMarker& one) {
    return one.time_s >= first_s && one.time_s <= last_s;
  });
  return run;
}

std::vector<std::string> valuesOf(const std::vector<SettingChange>& changes,
                                  const std::string& key) {
  std::vector<std::string> values;
  for (const SettingChange& change : changes) {
    if (change.key != key) continue;
    if (values.empty()) values.push_back(shownValue(change.from));
    values.push_back(shownValue(change.to));
  }
  return values;
}

std::string changesText(const std::vector<SettingChange>& changes) {
  constexpr std::size_t kMaxValues = 6;
  std::vector<std::string> keys;
  for (const SettingChange& change : changes) {
    if (std::ranges::find(keys, change.key) == keys.end()) keys.push_back(change.key);
  }
  std::string text;
  for (const std::string& key : keys) {
    const auto values = valuesOf(changes, key);
    text += (text.empty() ? "" : "; ") + key;
    if (values.size() > kMaxValues) {
      text += " " + std::to_string(values.size() - 1) + " times";
      continue;
    }
    for (std::size_t i = 0; i < values.size(); ++i) text += (i ? ", then " : " ") + values[i];
  }
  return text;
}

std::vector<RunMark> marksOf(const RunChanges& run) {
  std::vector<RunMark> marks;
  for (const TraceMarker& marker : run.markers) {
    marks.push_back({.time_s = marker.time_s, .text = marker.text});
  }
  for (const SettingChange& change : run.changes) {
    marks.push_back(
        {.time_s = change.time_s,
         .is_change = true,
         .text = change.key + ": " + shownValue(change.from) + " to " + shownValue(change.to)});
  }
  std::ranges::stable_sort(marks, {}, &RunMark::time_s);
  return marks;
}

std::string marksTable(const std::vector<RunMark>& marks) {
  constexpr std::size_t kMaxRows = 200;
  if (marks.empty()) return {};
  std::string html =
      "<table><caption>Event markers and changes; the numbers stand in the charts</caption>\n"
      "<tr><th scope=\"col\">no.</th><th scope=\"col\">time</th><th scope=\"col\">kind</th>"
      "<th scope=\"col\">what</th></tr>\n";
  for (std::size_t i = 0; i < std::min(marks.size(), kMaxRows); ++i) {
    html += "<tr>" + cell(std::to_string(i + 1)) +
            cell(decimal(marks[i].time_s, 3) + " s", "value") +
            cell(marks[i].is_change ? "change" : "event marker") +
            cell(escaped(marks[i].text), "value") + "</tr>\n";
  }
  html += "</table>\n";
  if (marks.size() > kMaxRows) {
    html += "<p class=\"quiet\">" + std::to_string(marks.size() - kMaxRows) +
            " more stand in changes.tsv and event_markers.tsv.</p>\n";
  }
  return html;
}

}  // namespace foci
