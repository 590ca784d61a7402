#include <algorithm>
#include <cmath>
#include <sstream>

#include "app/eye/validation.h"
#include "app/eye/visual_quality.h"
#include "app/graphics/html.h"
#include "app/platform/output_folder.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr const char* kValidationTable = "validation.tsv";
constexpr const char* kValidationPage = "validation.html";

constexpr const char* kValidationStyle = R"(
td.value, th.value { text-align: right; } td svg { width: 132px; height: 16px; vertical-align: middle; }
.out { color: #c0392b; font-weight: 600; }
)";

/// Where the value lies between its bounds: a dot on a line whose ends are the bounds.
std::string dotOf(const ValidationFigure& figure) {
  const double off = (figure.value - figure.expected) / figure.tolerance;
  const double at = 66.0 + 50.0 * std::clamp(std::isfinite(off) ? off : 2.0, -1.2, 1.2);
  return "<svg viewBox=\"0 0 132 16\" role=\"img\" aria-label=\"" + decimal(off, 2) +
         " of the tolerance\"><path d=\"M16 8H116M16 4V12M116 4V12M66 5V11\" "
         "stroke=\"currentColor\" "
         "opacity=\".45\" fill=\"none\"/><circle cx=\"" +
         decimal(at, 1) + "\" cy=\"8\" r=\"4\" fill=\"" +
         (figure.inBounds() ? "#2f8f5b" : "#c0392b") + "\"/></svg>";
}

}  // namespace

std::string validationTable(const std::vector<ValidationFigure>& figures) {
  std::string text = "figure\tcondition\tunit\texpected\ttolerance\tvalue\tin_bounds\tsource\n";
  for (const ValidationFigure& one : figures) {
    text += one.group + "\t" + one.what + "\t" + one.unit + "\t" + decimal(one.expected, 4) + "\t" +
            decimal(one.tolerance, 4) + "\t" + decimal(one.value, 4) + "\t" +
            (one.inBounds() ? "1" : "0") + "\t" + one.source + "\n";
  }
  return text;
}

std::string validationPage(const std::vector<ValidationFigure>& figures) {
  const auto out_of_bounds = std::count_if(figures.begin(), figures.end(),
                                           [](const auto& one) { return !one.inBounds(); });
  std::ostringstream page;
  page << pageStart("foci validate", kValidationStyle)
       << "<h1>foci against published measurements</h1>\n<p>" << figures.size() << " figures, "
       << (out_of_bounds == 0
               ? std::string("all within their bounds.")
               : "<span class=\"out\">" + std::to_string(out_of_bounds) + " out of bounds.</span>")
       << " The ends of each line are the bounds, the tick in its middle is the published value, "
          "and "
          "the dot is the value here.</p>\n";
  std::string group;
  for (const ValidationFigure& one : figures) {
    if (one.group != group) {
      if (!group.empty()) page << "</table>\n";
      group = one.group;
      page << "<h2>" << escaped(group)
           << "</h2>\n<table><tr><th>condition</th><th class=\"value\">published</th><th "
              "class=\"value\">tolerance</th><th "
              "class=\"value\">here</th><th></th><th>source</th></tr>\n";
    }
    const std::string unit = one.unit.empty() ? "" : " " + escaped(one.unit);
    page << "<tr><td>" << escaped(one.what) << "</td><td class=\"value\">"
         << decimal(one.expected, one.digits) << unit << "</td><td class=\"value\">&plusmn;"
         << significant(one.tolerance, 2) << "</td><td class=\"value"
         << (one.inBounds() ? "" : " out") << "\">" << decimal(one.value, one.digits) << unit
         << "</td><td>" << dotOf(one) << "</td><td>" << escaped(one.source) << "</td></tr>\n";
  }
  page << "</table>\n<p class=\"quiet\">The typical eye has coma, trefoil and spherical "
          "aberration in the proportions, and with the root mean square, of 2560 normal eyes "
          "(Salmon and van de Pol 2006). Glasses leave errors with a standard deviation of "
       << decimal(kRefractionLeft_D, 2)
       << " D of sphere and of cylinder (Thibos and others 2004). "
          "Depth of focus takes one criterion for all pupils, chosen beforehand.</p>\n"
       << kPageEnd;
  return page.str();
}

std::vector<std::filesystem::path> validationFiles(const std::filesystem::path& out) {
  return {out / kValidationTable, out / kValidationPage};
}

std::vector<ValidationFigure> validate(const std::filesystem::path& out, const OutputGuard& guard) {
  OutputFolder files(out, guard);  // before the long computation
  std::vector<ValidationFigure> figures = validationFigures();
  files.write(kValidationTable, validationTable(figures));
  files.write(kValidationPage, validationPage(figures));
  files.commit();
  return figures;
}

}  // namespace foci
