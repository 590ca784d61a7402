#include "app/replay/report_explorer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

#include "app/graphics/html.h"
#include "base/text.h"
#include "gaze/geometry/line_of_sight.h"

namespace foci {
namespace {

/// Each chart is an SVG across its panels from `left` to `right`, shares of its width. `spans` are
/// those of the chosen trial, on the recording's clock; each of `watchers` gets the video's time.
constexpr const char* kScript = R"(
const video = document.querySelector('video'), chart = document.querySelector('#charts svg');
const picked = document.getElementById('trial'), tip = document.getElementById('tip');
const last = run.rows.length - 1, from = run.rows[0][0], to = Math.max(run.rows[last][0], from + 1e-3);
const ns = 'http://www.w3.org/2000/svg', shapes = [], watchers = [];
let spans = [];
function seek(time, still) {
  video.currentTime = Math.max(0, time - run.first);
  if (!still) video.scrollIntoView({ block: 'nearest' });
}
function tell(event, text) {
  tip.textContent = text;
  tip.hidden = false;
  tip.style.left = Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 8) + 'px';
  tip.style.top = event.clientY + 14 + 'px';
}
const timed = document.getElementById('timed');
const timeShown = time => timed.value === 'zero' ? time - run.first : time;
const ticks = chart ? [...chart.querySelectorAll('text')].filter(one => one.textContent.trim() !== '' &&
    !isNaN(one.textContent)).map(one => ({ word: one.querySelector('tspan') ?? one, value: +one.textContent,
    low: one.getBoundingClientRect().bottom })) : [];
const lowestTick = Math.max(...ticks.map(one => one.low));
timed.onchange = () => {
  for (const one of ticks) if (one.low > lowestTick - 3) one.word.textContent = +timeShown(one.value).toFixed(3);
  for (const one of document.querySelectorAll('[data-time]')) {
    one.textContent = timeShown(+one.dataset.time).toFixed((one.dataset.time.split('.')[1] || '').length);
  }
};
function xOf(time) {
  const share = Math.min(1, Math.max(0, (time - from) / (to - from)));
  return chart.viewBox.baseVal.width * (run.left + (run.right - run.left) * share);
}
function shape(x, width, paint) {
  const rect = document.createElementNS(ns, 'rect'), box = chart.viewBox.baseVal;
  for (const [name, value] of Object.entries({ x, width: Math.max(0, width), y: 0, height: box.height,
       'pointer-events': 'none', ...paint })) rect.setAttribute(name, value);
  return chart.appendChild(rect);
}
const cursor = chart && shape(xOf(from), 1.5, { fill: '#c94a4a' });
if (picked) picked.onchange = () => {
  const chosen = picked.selectedOptions[0];
  spans = JSON.parse(chosen.dataset.spans || '[]');
  for (const one of document.querySelectorAll('[data-trial]')) {
    one.hidden = spans.length > 0 && one.dataset.trial !== chosen.value;
  }
  shapes.splice(0).forEach(one => one.remove());
  if (!spans.length) return;
  seek(spans[0][0]);
  let end = from;
  for (const [first, last] of chart ? [...spans, [to, to]] : []) {
    shapes.push(shape(xOf(end), xOf(first) - xOf(end), { fill: 'var(--ground)', opacity: .75 }));
    end = last ?? to;
  }
};
for (const row of document.querySelectorAll('[data-at]')) row.onclick = () => seek(+row.dataset.at);
if (cursor) watchers.push(time => cursor.setAttribute('x', xOf(run.first + time)));
setInterval(() => watchers.forEach(one => one(video.currentTime)), 50);
function timeAt(event) {
  const box = chart.getBoundingClientRect(), share = (event.clientX - box.left) / box.width;
  return from + (to - from) * Math.min(1, Math.max(0, (share - run.left) / (run.right - run.left)));
}
if (chart) {
  chart.style.cursor = 'crosshair';
  chart.onclick = event => seek(timeAt(event));
  chart.onmouseleave = () => { tip.hidden = true; };
  chart.onmousemove = event => {
    const time = timeAt(event), after = run.rows.findIndex(one => one[0] >= time);
    const row = run.rows[after < 0 ? last : after];
    const values = [+timeShown(row[0]).toFixed(3), ...row.slice(1)];
    tell(event, run.names.map((name, i) => name + ' ' + (values[i] ?? 'n/a')).join(', '));
  };
}
)";

std::string json(double value, int digits) {
  return std::isfinite(value) ? decimal(value, digits) : "null";
}

}  // namespace

const char* const kExplorerStyle = R"(
.seek { cursor: pointer; } .seek:hover { background: var(--card); } .scroll { max-height: 26rem; overflow: auto; }
#tip { position: fixed; background: var(--card); border: 1px solid var(--line); border-radius: 4px; margin: 0;
  padding: .2rem .5rem; font-size: .8rem; pointer-events: none; font-variant-numeric: tabular-nums; }
a { color: inherit; } [hidden] { display: none !important; }
)";

std::string trialChoice(const std::vector<TraceTrial>& trials) {
  std::map<std::string, std::string> spans;
  for (const TraceTrial& trial : trials) {
    std::string& all = spans[trial.name];
    all += (all.empty() ? "[" : ",[") + json(trial.first_s, 6) + "," + json(trial.last_s, 6) + "]";
  }
  std::string options;
  for (const TraceTrial& trial : trials) {
    if (const auto own = spans.extract(trial.name)) {
      const std::string name = escaped(trial.name);
      options += "<option value=\"";
      options += name;
      options += "\" data-spans=\"[";
      options += own.mapped();
      options += "]\">";
      options += name;
      options += "</option>";
    }
  }
  if (options.empty()) return "";
  return "<p><label>Trial <select id=\"trial\"><option>all</option>" + options +
         "</select></label></p>\n";
}

std::string fixationRows(const std::string& table) {
  constexpr std::size_t kMost = 2000;
  constexpr std::array<std::pair<const char*, const char*>, 11> kShown{
      {{"fixation", "no."},
       {"trial", "trial"},
       {"onset_s", "onset, s"},
       {"duration_s", "duration, s"},
       {"x_deg", "x, deg"},
       {"y_deg", "y, deg"},
       {"object", "object"},
       {"distance_m", "distance, m"},
       {"surface_D", "surface, D"},
       {"focus_D", "focus, D"},
       {"blur_radius_arcmin", "blur radius, arcmin"}}};
  std::istringstream lines(table);
  std::string line, html;
  std::getline(lines, line);
  const std::vector<std::string> names = fieldsOf(line);
  const auto at = [&](const char* name) {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  html = "<div class=\"scroll\"><table><tr>";
  for (const auto& [name, title] : kShown) html += std::string("<th>") + title + "</th>";
  html += "</tr>\n";
  for (std::size_t i = 0; i < kMost && std::getline(lines, line); ++i) {
    const std::vector<std::string> fields = fieldsOf(line);
    html += "<tr class=\"seek\" data-trial=\"" + escaped(fields.at(at("trial"))) + "\" data-at=\"" +
            escaped(fields.at(at("onset_s"))) + "\">";
    for (const auto& [name, title] : kShown) {
      const std::string value = escaped(fields.at(at(name)));
      html += "<td class=\"value\"";
      if (name == kShown[2].first) html += " data-time=\"" + value + "\"";
      html += ">" + value + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

std::string clockChoice() {
  return "<p><label>Time <select id=\"timed\"><option value=\"own\">on the recording's "
         "clock</option><option value=\"zero\">from zero</option></select></label></p>\n";
}

std::string explorerScript(const std::vector<ChartRow>& rows, const Screen& screen) {
  const glm::dvec2 center_deg = eccentricity_deg(screen, 0.5 * glm::dvec2(screen.size_px));
  const glm::dvec2 sides = panelSides(reportStyle());
  std::string text = "<p id=\"tip\" hidden></p>\n<script>\nconst run = {first: " +
                     decimal(rows.front().time_s, 6) + ", left: " + decimal(sides.x, 5) +
                     ", right: " + decimal(sides.y, 5) +
                     ",\nnames: ['time, s', 'x, px', 'y, px', 'x, deg', 'y, deg', 'surface, D', "
                     "'focus, D', 'pupil, mm'],\nrows: [";
  for (const ChartRow& row : rows) {
    const glm::dvec2 deg = eccentricity_deg(screen, {row.gaze_x_px, row.gaze_y_px}) - center_deg;
    text += "[" + json(row.time_s, 3) + "," + json(row.gaze_x_px, 0) + "," +
            json(row.gaze_y_px, 0) + "," + json(deg.x, 2) + "," + json(deg.y, 2) + "," +
            json(row.surface_D, 2) + "," + json(row.focus_D, 2) + "," + json(row.pupil_mm, 2) +
            "],";
  }
  return text + "]};\n" + kScript + "</script>\n";
}

}  // namespace foci
