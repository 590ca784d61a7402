#include "app/evaluation/evaluation_page.h"

#include <cmath>

#include "app/evaluation/evaluated_methods.h"
#include "app/graphics/html.h"
#include "app/graphics/image.h"
#include "base/text.h"

namespace foci {

const char* const kEvaluationStyle = R"(
main { max-width: 1240px; }
th { text-align: left; font-weight: 600; padding: .25rem .75rem .25rem 0; vertical-align: bottom; }
.scroll { overflow-x: auto; } td.wraps { white-space: normal; }
)";

const char* const kChartStyle = R"(
.figures td { white-space: nowrap; font-variant-numeric: tabular-nums; }
.panels { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 520px), 1fr)); gap: 1rem; }
.panel { background: var(--card); border: 1px solid var(--line); border-radius: 6px; padding: .5rem; }
svg a:hover circle, svg a:focus circle { stroke-width: 4; }
fieldset { border: 0; padding: 0; margin: .4rem 1.6rem .4rem 0; display: inline-block; }
legend { float: left; margin-right: .6rem; color: var(--quiet); } label { margin-right: .7rem; }
.dials { position: sticky; top: 0; background: var(--ground); padding: .3rem 0; z-index: 1; }
dialog { width: min(1500px, 96vw); border: 1px solid var(--line); border-radius: 6px;
  background: var(--ground); color: var(--ink); }
dialog::backdrop { background: #000a; }
dialog p { max-width: none; } td code { white-space: nowrap; }
.three { display: grid; grid-template-columns: repeat(3, 1fr); gap: .7rem; }
.yes { font-weight: 600; }
.three img { image-rendering: pixelated; }
)";

const char* const kPanelScript = R"(
const dials = document.querySelectorAll('.dials input');
function show() {
  for (const panel of document.querySelectorAll('.panel'))
    panel.hidden = [...dials].some(dial => dial.checked && dial.name in panel.dataset &&
      panel.dataset[dial.name] !== dial.value);
}
for (const dial of dials) dial.addEventListener('change', show);
show();
)";

namespace {

constexpr const char* kDialogScript = R"(
const box = document.querySelector('dialog');
document.addEventListener('click', event => {
  const link = event.target.closest('svg a');
  if (!link || !box.showModal) return;
  event.preventDefault();
  const image = link.getAttribute('href');
  box.querySelector('p').textContent = link.querySelector('title').textContent;
  const [a, b, c] = box.querySelectorAll('img');
  a.src = image; b.src = link.dataset.at; c.src = image.replace(/\.png$/, '_difference.png');
  for (const image of [a, b, c]) image.parentElement.href = image.src;
  box.showModal();
});
box.addEventListener('click', event => { if (event.target === box) box.close(); });
)";

}  // namespace

std::string numberHtml(double value, int digits) {
  return std::isfinite(value) ? decimal(value, digits) : "&infin;";
}

std::string decibels(double value) {
  return std::isfinite(value) ? decimal(value, 1) + " dB" : "exact";
}

std::string threadsText(unsigned threads) {
  return std::to_string(threads) + (threads == 1 ? " thread" : " threads");
}

std::string differenceFileOf(std::string image) {
  return image.insert(image.rfind('.'), "_difference");
}

std::string dialHtml(const char* name, const char* title,
                     const std::vector<std::pair<std::string, std::string>>& choices,
                     const std::string& chosen) {
  std::string html = std::string("<fieldset><legend>") + title + "</legend>";
  for (const auto& [value, text] : choices) {
    html.append("<label><input type=\"radio\" name=\"").append(name);
    html.append("\" value=\"").append(value).append(value == chosen ? "\" checked> " : "\"> ");
    html.append(text).append("</label>");
  }
  return html + "</fieldset>\n";
}

void writeFamilies(std::ostream& out, bool imported) {
  const auto entry = [&](const std::string& name, const std::string& color) {
    out << "<span style=\"white-space:nowrap\"><span class=\"state\" "
           "style=\"margin-right:.35em;background:"
        << color << "\"></span>" << escaped(name) << "</span> ";
  };
  for (const FamilyStyle& family : methodFamilies()) entry(family.name, family.color);
  if (imported) entry(kImportedName, kImportedColor);
}

void writeImageDialog(std::ostream& out) {
  out << "<dialog><form method=\"dialog\" style=\"float:right\"><button>close</button></form>\n"
         "<p></p>\n<div class=\"three\">";
  for (const char* what : {"rendered", "reference", "difference"}) {
    out << "<figure><a target=\"_blank\"><img alt=\"" << what << "\"></a><figcaption>" << what
        << (std::string(what) == "difference" ? " times " + decimal(kDifferenceGain, 0) : "")
        << "</figcaption></figure>";
  }
  out << "</div></dialog>\n<script>" << kDialogScript << "</script>\n";
}

}  // namespace foci
