#include "app/prepare/prepare.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "app/graphics/html.h"
#include "app/platform/output_files.h"
#include "app/platform/progress.h"
#include "app/platform/warnings.h"
#include "base/input_error.h"
#include "base/quantile.h"
#include "base/text.h"
#include "render/lod/cut.h"
#include "render/lod/moment_tree.h"
#include "render/normalisation/kernel_sums.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/gaussian_tree.h"
#include "render/scene/io/foci_file.h"
#include "render/scene/io/mesh_files.h"
#include "render/scene/io/open_scene.h"

namespace foci {
namespace {

constexpr const char* kReportStyle = R"(
:root { --bar: #3d7ea6; --rest: #c3d3de; }
@media (prefers-color-scheme: dark) { :root { --bar: #6db3dc; --rest: #37505f; } }
main { max-width: 860px; }
table { margin-top: .75rem; width: auto; font-size: .92rem; font-variant-numeric: tabular-nums; }
td, th { border-top: 1px solid var(--line); padding: .3rem 1.5rem .3rem 0; text-align: left; font-weight: normal; }
svg text { fill: var(--quiet); font: 12px system-ui, sans-serif; }
)";

constexpr double kChartWidth = 800.0, kChartHeight = 140.0, kAxisHeight = 22.0;

/// Histogram of the whole surface, and in front of it the histogram of the smooth parts.
std::string histogramSvg(const Normalisation& n) {
  const double highest =
      static_cast<double>(std::max<std::size_t>(std::ranges::max(n.whole.histogram), 1));
  const double step = kChartWidth / static_cast<double>(kHistogramBins);
  std::string svg = printed(
      "<svg viewBox=\"0 0 %g %g\" role=\"img\" aria-label=\"Histogram of the kernel sums\">",
      kChartWidth, kChartHeight + kAxisHeight);
  svg += "<title>Histogram of the kernel sums</title>\n<desc>" +
         printed(
             "Whole surface: mean %.4f, %.1f %% within 0.05 of one. Smooth parts: mean %.4f, "
             "%.1f %% within 0.05 of one.",
             n.whole.mean, 100.0 * n.whole.within_5, n.smooth.mean, 100.0 * n.smooth.within_5) +
         "</desc>\n";
  const auto bars = [&](const std::vector<std::size_t>& bins, const char* color) {
    for (std::size_t i = 0; i < bins.size(); ++i) {
      if (bins[i] == 0) continue;
      const double height = kChartHeight * static_cast<double>(bins[i]) / highest;
      svg +=
          printed("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\"/>",
                  static_cast<double>(i) * step, kChartHeight - height, 0.85 * step, height, color);
    }
  };
  bars(n.whole.histogram, "var(--rest)");
  bars(n.smooth.histogram, "var(--bar)");
  for (int tick = 0; tick <= 10; ++tick) {
    const char* anchor = tick == 0 ? "start" : tick == 10 ? "end" : "middle";
    svg += printed("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%.1f</text>",
                   0.1 * tick * kChartWidth, kChartHeight + 16.0, anchor, 0.5 + 0.1 * tick);
  }
  return svg + "</svg>\n";
}

constexpr const char* kTableHead =
    "<table><tr><th></th><th>mean</th><th>1 &plusmn; 0.02</th><th>1 &plusmn; 0.05</th>"
    "<th>1 &plusmn; 0.1</th></tr>\n";

std::string tableRow(const std::string& what, const KernelSumFigures& of) {
  return "<tr><td>" + what + "</td>" +
         printed("<td>%.4f</td><td>%.1f %%</td><td>%.1f %%</td><td>%.1f %%</td></tr>\n", of.mean,
                 100.0 * of.within_2, 100.0 * of.within_5, 100.0 * of.within_10);
}

std::string tableRows(const std::string& when, const Normalisation& n) {
  std::string rows = tableRow("whole surface" + when, n.whole);
  if (n.smooth_share > 0.0) {
    rows += tableRow("smooth parts" + when + printed(" (%.1f %% of it)", 100.0 * n.smooth_share),
                     n.smooth);
  }
  return rows;
}

std::string levelSection(const PrepareSummary& summary, const LevelNormalisation& level) {
  std::string section =
      printed("<h2>Level of %zu nodes, %.1f surfels in each</h2>\n", level.nodes,
              static_cast<double>(summary.surfels) / static_cast<double>(level.nodes));
  section +=
      printed("<p class=\"quiet\">in focus; a pixel is %.2f of the nodes' spacing wide</p>\n",
              level.sharp.pixel_spacings);
  section += histogramSvg(level.sharp);
  section +=
      printed("<p class=\"quiet\">blurred; the blur radius is %.2f of the nodes' spacing</p>\n",
              level.blurred.blur_spacings);
  section += histogramSvg(level.blurred);
  return section + kTableHead + tableRows(", in focus", level.sharp) +
         tableRows(", blurred", level.blurred) + "</table>\n";
}

std::string gaussianSection(const PrepareSummary& summary) {
  std::string section =
      printed("<p>%zu Gaussians, with harmonics of degree %d, and a tree of %zu nodes.</p>\n",
              summary.gaussians, summary.facts.harmonics_degree, summary.nodes);
  return section +
         "<p>Each node merges the Gaussians below it into one, which covers the same area. foci "
         "renders nodes in place of their Gaussians where blur allows.</p>\n";
}

/// A complete HTML page.
std::string prepareReport(const PrepareRequest& request, const PrepareSummary& summary) {
  const std::string name = summary.out.filename().string();
  std::string page =
      pageStart(name + " - foci prepare", std::string(kReportStyle) + kFidelityStyle) + "<h1>" +
      escaped(name) + "</h1>\n<p class=\"quiet\">from " + escaped(request.input.string()) +
      "</p>\n" + noticesOf(summary.warnings);
  if (summary.gaussians > 0) return page + gaussianSection(summary) + kPageEnd;
  page += printed("<p>%zu surfels on %.4g m<sup>2</sup>, one every %.3g mm. ", summary.surfels,
                  summary.area_m2, 1000.0 * summary.spacing_m);
  page += summary.oriented ? "Their normals tell the outside from the inside.</p>\n"
                           : "Their normals do not tell the outside from the inside.</p>\n";
  page += fidelitySection(summary);
  page +=
      "<h2>Sums of the kernels</h2>\n<p>The kernels of a surface without holes sum to one at every "
      "pixel. The histograms show the sums of the kernels as foci renders them, at points spread "
      "evenly over this surface. Smooth parts, in the stronger colour, have agreeing normals, lie "
      "in one plane and have no border within the reach of a kernel.</p>\n";
  for (std::size_t i = 0; i < summary.normalisation.size(); ++i) {
    const Normalisation &before = summary.before[i], &after = summary.normalisation[i];
    page +=
        after.pixel_spacings > 0.0f
            ? printed("<h2>A pixel of %g times the surfels' spacing</h2>\n", after.pixel_spacings)
            : "<h2>Magnified: pixels much smaller than the surfels' spacing</h2>\n";
    page += "<p class=\"quiet\">before foci solved weights and sizes</p>\n" + histogramSvg(before) +
            "<p class=\"quiet\">after</p>\n" + histogramSvg(after) + kTableHead +
            tableRows(", before", before) + tableRows(", after", after) + "</table>\n";
  }
  if (!summary.levels.empty()) {
    page +=
        "<h2>Levels of detail</h2>\n<p>foci renders blurred and distant parts from nodes. Each "
        "node stands for several surfels and has the sum of their areas as its weight. Each level "
        "is shown where foci renders it at its coarsest. On coarser levels fewer places are smooth "
        "within the reach of a node's kernel.</p>\n";
  }
  for (const LevelNormalisation& level : summary.levels) page += levelSection(summary, level);
  return page + kPageEnd;
}

// Chosen by eye.
constexpr std::size_t kMaxProbes = 10'000, kProbesASurfel = 10;  // a share's standard error: .5 %
constexpr int kMinNodes = 1000;                                  // of a level that the report lists
/// Widths of a pixel, in spacings of the surfels. 0: a view that magnifies them.
constexpr SeenAs kPixels[] = {{1.0f}, {0.5f}, {0.0f}};

/// @param smooth_only  leaves the other sums out
KernelSumFigures figuresOf(const std::vector<KernelSum>& sums, bool smooth_only) {
  KernelSumFigures figures{.within_2 = shareWithin(sums, 0.02f, smooth_only),
                           .within_5 = shareWithin(sums, 0.05f, smooth_only),
                           .within_10 = shareWithin(sums, 0.1f, smooth_only),
                           .histogram = std::vector<std::size_t>(kHistogramBins, 0)};
  double counted = 0.0;
  for (const KernelSum& sum : sums) {
    if (smooth_only && !sum.smooth) continue;
    ++counted;
    figures.mean += sum.sum;
    const float bin = std::floor((sum.sum - 0.5f) * static_cast<float>(kHistogramBins));
    ++figures.histogram[static_cast<std::size_t>(
        std::clamp(bin, 0.0f, static_cast<float>(kHistogramBins - 1)))];
  }
  figures.mean /= std::max(counted, 1.0);
  return figures;
}

Normalisation normalisationOf(const std::vector<KernelSum>& sums, const SeenAs& seen) {
  const auto smooth = std::ranges::count_if(sums, &KernelSum::smooth);
  return {.pixel_spacings = seen.pixel_spacings,
          .blur_spacings = seen.blur_spacings,
          .smooth_share = static_cast<double>(smooth) /
                          static_cast<double>(std::max<std::size_t>(sums.size(), 1)),
          .whole = figuresOf(sums, false),
          .smooth = figuresOf(sums, true)};
}

std::size_t probesOf(const SurfelCloud& cloud) {
  return std::min(kMaxProbes, kProbesASurfel * cloud.size());
}

/// As each of `seen`.
std::vector<Normalisation> normalisationOf(const SurfelCloud& cloud, std::span<const SeenAs> seen,
                                           std::span<const float> added_m2 = {}) {
  std::vector<Normalisation> all;
  for (const auto& sums : kernelSums(cloud, probesOf(cloud), seen, added_m2)) {
    all.push_back(normalisationOf(sums, seen[all.size()]));
  }
  return all;
}

/// Levels of at least `kMinNodes` nodes. Coarser levels consist of border only.
std::vector<LevelNormalisation> normalisationOfLevels(const MomentTree& tree) {
  constexpr SeenAs kCoarsest[] = {kCoarsestSharp, kCoarsestBlurred};
  std::vector<LevelNormalisation> levels;
  for (int level = tree.levels() - 1; level >= 0 && 1 << level >= kMinNodes; --level) {
    const LevelKernels kernels = levelKernels(tree, level);
    const std::vector<Normalisation> coarsest =
        normalisationOf(kernels.surfels, kCoarsest, kernels.added_m2);
    levels.push_back(
        {.nodes = kernels.surfels.size(), .sharp = coarsest[0], .blurred = coarsest[1]});
  }
  return levels;
}

double medianSpacing_m(const SurfelCloud& cloud) {
  std::vector<float> area_m2(cloud.area_m2.begin(), cloud.area_m2.end());
  return std::sqrt(double{quantile(area_m2, 0.5)});
}

std::filesystem::path reportOf(std::filesystem::path scene) {
  return scene.replace_extension(".html");
}

/// @throws InputError
OutputGuard guardOf(const PrepareRequest& request) {
  if (request.out.extension() != ".foci") {
    throw InputError("--out " + request.out.string(), "expected a file name that ends in .foci");
  }
  std::vector<std::filesystem::path> inputs = meshCompanions(request.input);
  inputs.push_back(request.input);
  OutputGuard guard({request.out, reportOf(request.out)}, inputs, request.overwrite);
  if (isSceneFile(request.input)) {
    throw InputError(request.input.string(), "is a prepared scene already");
  }
  return guard;
}

/// The surfels with sizes and weights solved. Progress goes to standard error.
/// @param before  of the surfels as they were
SurfelCloud solved(PointCloud&& points, std::vector<Normalisation>& before) {
  std::optional<Progress> progress;
  return surfelsFromPoints(
      std::move(points),
      {.solve = KernelSolve::thorough,
       .progress =
           [&](std::size_t done, std::size_t total) {
             if (!progress) progress.emplace("solving weights and sizes", "passes", total);
             progress->advance(done);
           },
       .unsolved = [&](const SurfelCloud& cloud) { before = normalisationOf(cloud, kPixels); }});
}

/// Surfels of points or of a mesh with their tree, and how closely they keep its surface.
PreparedScene preparedSurfels(const PrepareRequest& request, SceneFile&& file,
                              PrepareSummary& summary) {
  OpenedPoints opened =
      openPoints(std::move(file), request.scale_m, MeshSampling{.points = request.points});
  PointCloud& points = opened.points;
  summary.dropped = points.dropped;

  SurfelCloud cloud = solved(std::move(points), summary.before);
  summary.surfels = cloud.size();
  summary.oriented = cloud.oriented;
  summary.spacing_m = medianSpacing_m(cloud);
  for (const float area_m2 : cloud.area_m2) summary.area_m2 += area_m2;
  summary.normalisation = normalisationOf(cloud, kPixels);

  summary.of_mesh = opened.mesh != nullptr;
  if (opened.mesh) {
    summary.fidelity = measureFidelity(cloud, *opened.mesh, summary.spacing_m);
    if (summary.fidelity)
      summary.warnings = fidelityWarnings(*summary.fidelity, cloud.size(), *opened.mesh);
  }
  cloud = withTree(cloud);
  summary.levels = normalisationOfLevels(*treeOf(cloud));
  return {{std::move(cloud)},
          {.mesh = summary.of_mesh,
           .plain_colors = !summary.facts.has_colors,
           .up_axis = request.up_axis ? request.up_axis(summary.facts) : std::nullopt,
           .y_is_down = summary.facts.y_is_down}};
}

/// Gaussians with their tree.
PreparedScene preparedGaussians(const PrepareRequest& request, SceneFile&& file,
                                PrepareSummary& summary) {
  if (request.points) {
    throw InputError("--points", "sets the samples of a mesh, and " + request.input.string() +
                                     " holds Gaussians: leave it out");
  }
  auto& read = std::get<GaussianFile>(file.content);
  summary.dropped = read.dropped;
  const bool y_is_down = !read.y_is_up;
  Scene scene = openScene(std::move(file), request.scale_m, std::nullopt).scene;
  GaussianCloud cloud = withTree(std::get<GaussianCloud>(std::move(scene.splats)));
  summary.gaussians = cloud.size();
  summary.nodes = cloud.tree->nodes.size() - 1;
  return {{std::move(cloud)}, {.y_is_down = y_is_down}};
}

}  // namespace

PrepareSummary prepareScene(const PrepareRequest& request) {
  OutputFiles output(guardOf(request));
  const auto start = std::chrono::steady_clock::now();
  output.makeFolder(request.out.parent_path());  // before the work: a bad folder shows at once
  SceneFile file = readScene(request.input);
  PrepareSummary summary{
      .out = request.out, .report = reportOf(request.out), .facts = factsOf(file)};
  if (const auto* const streamed = std::get_if<StreamedGaussians>(&file.content)) {
    file.content = streamed->read({});
  }
  const PreparedScene scene = std::holds_alternative<GaussianFile>(file.content)
                                  ? preparedGaussians(request, std::move(file), summary)
                                  : preparedSurfels(request, std::move(file), summary);
  output.write(request.out, [&](const std::filesystem::path& to) { writeSceneFile(to, scene); });
  Warnings warnings;
  const std::string input = request.input.string();
  warnings.addAll(input,
                  droppedRemarks(summary.dropped, summary.gaussians > 0 ? "Gaussian" : "point"));
  const std::string before = input + ": ";
  for (const std::string& remark : summary.facts.remarks) warnings.include({before + remark});
  warnings.addAll(input, summary.warnings);
  summary.warnings = warnings.all();
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  output.write(summary.report, prepareReport(request, summary));
  output.commit();
  return summary;
}

}  // namespace foci
