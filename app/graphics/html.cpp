#include "app/graphics/html.h"

#include <cctype>
#include <sstream>
#include <utility>

#include "base/base64.h"
#include "base/text.h"

namespace foci {

const char* const kPageStyle = R"(
:root { color-scheme: light dark; --ground: #fbfbfa; --card: #ffffff; --ink: #1d2127; --quiet: #626a75; --line: #e3e4e6; }
@media (prefers-color-scheme: dark) {
  :root { --ground: #14161a; --card: #1b1e23; --ink: #e4e6ea; --quiet: #9aa2ad; --line: #2d3138; } }
body { margin: 0; background: var(--ground); color: var(--ink); font: 15px/1.5 system-ui, sans-serif; }
main { max-width: 1080px; margin: 0 auto; padding: 2rem 1.25rem 4rem; }
h1 { font-size: 1.5rem; margin: 0 0 .25rem; } h2 { font-size: 1.1rem; margin: 2.5rem 0 .75rem; }
p { margin: .5rem 0; max-width: 72ch; } .quiet { color: var(--quiet); }
.notice { border-left: 3px solid #d9822b; padding: .1rem .8rem; margin: .8rem 0; }
.numbers { display: flex; flex-wrap: wrap; gap: 1px;
  background: var(--line); border: 1px solid var(--line); border-radius: 6px; overflow: hidden; margin: 1.25rem 0; }
.numbers div { background: var(--card); padding: .7rem .9rem; flex: 1 1 120px; }
.numbers b { display: block; font-size: 1.25rem; font-weight: 600; font-variant-numeric: tabular-nums; }
.numbers span { color: var(--quiet); font-size: .85rem; }
video { width: 100%; border-radius: 6px; background: #000; display: block; }
.pair { display: grid; grid-template-columns: repeat(auto-fill, minmax(420px, 1fr)); gap: .9rem; }
.sheet { display: grid; grid-template-columns: repeat(auto-fill, minmax(300px, 1fr)); gap: .9rem; }
figure { margin: 0; } figure img { width: 100%; border-radius: 4px; display: block; }
figcaption { font-size: .85rem; color: var(--quiet); font-variant-numeric: tabular-nums; margin-top: .25rem; }
.state { display: inline-block; width: .7em; height: .7em; border-radius: 2px; margin-right: .35em; }
.legend span { margin-right: 1.2em; font-size: .85rem; color: var(--quiet); }
svg { width: 100%; height: auto; color: var(--ink); }
caption { text-align: left; color: var(--quiet); padding: .25rem 0; } th { text-align: left; font-weight: 600; }
table { border-collapse: collapse; width: 100%; font-size: .88rem; }
td { border-top: 1px solid var(--line); padding: .25rem .75rem .25rem 0; vertical-align: top; }
td:first-child { white-space: nowrap; } td.value { font-variant-numeric: tabular-nums; overflow-wrap: anywhere; }
pre { white-space: pre-wrap; font-size: .85rem; }
summary { cursor: pointer; font-weight: 600; margin-top: 2rem; }
)";

const char* const kPageEnd = "</main></body></html>\n";

std::string pageStart(const std::string& title, const std::string& style, const std::string& head) {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width\">\n<title>" +
         escaped(title) + "</title>\n<style>" + kPageStyle + style + "</style>" + head +
         "</head><body><main>\n";
}

std::string escaped(const std::string& text) {
  std::string html = replaced(visible(text), "&", "&amp;");  // first: the others have it, too
  for (const auto& [character, entity] :
       {std::pair("<", "&lt;"), {">", "&gt;"}, {"\"", "&quot;"}, {"'", "&#39;"}}) {
    html = replaced(html, character, entity);
  }
  return html;
}

std::string hrefOf(const std::string& file) {
  std::string link;
  for (const char c : file) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain =
        (byte < 0x80 && std::isalnum(byte) != 0) || c == '-' || c == '_' || c == '.' || c == '/';
    link += plain ? std::string(1, c) : printed("%%%02X", byte);
  }
  return link;
}

std::string imageUri(const std::string& bytes, const std::string& type) {
  std::ostringstream out;
  out << "data:image/" << type << ";base64,";
  Base64 base64(out);
  base64.add(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  base64.finish();
  return out.str();
}

std::string noticesOf(const std::vector<std::string>& texts) {
  std::string html;
  for (const std::string& text : texts) html += "<p class=\"notice\">" + escaped(text) + "</p>\n";
  return html;
}

std::string cell(const std::string& text, const char* kind) {
  return std::string("<td") + (*kind ? std::string(" class=\"") + kind + "\"" : "") + ">" + text +
         "</td>";
}

std::string numberCell(const std::string& value, const std::string& what) {
  return "<div><b>" + value + "</b><span>" + what + "</span></div>\n";
}

std::string numberCell(std::size_t count, const std::string& one) {
  return numberCell(std::to_string(count), one + (count == 1 ? "" : "s"));
}

}  // namespace foci
