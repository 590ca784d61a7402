// Cases: the scenes, cameras, lenses and references of a chart as files that other renderers read.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/evaluation/chart/chart.h"
#include "app/graphics/image.h"
#include "app/platform/output_files.h"
#include "render/image/frame.h"
#include "render/optics/view.h"
#include "render/scene/mesh/triangle_mesh.h"
#include "render/scene/scene.h"

namespace foci {

/// The width of the sensor that f-numbers refer to: a photographer's full frame.
inline constexpr double kSensorWidth_m = 0.036;

/// A folder of one scene at one blur, relative to the folder of all: "plane/4px".
std::string caseName(const ChartScene& scene, double blur_px);

/// The files that `exportCases` writes.
std::vector<std::filesystem::path> exportedFiles(const ChartPlan& plan,
                                                 const std::filesystem::path& folder);

/// Stages the files; a README.md explains them.
/// @param options  of the plan as the user gave them: the README repeats them for the import
/// @param on_step  called after each reference, of which there is one for each scene and blur
void exportCases(const ChartPlan& plan, const std::string& options, OutputFolder& output,
                 const std::function<void()>& on_step);

/// A point of the chart, with its images.
struct ImportedPoint {
  ChartPoint point;
  Image image{}, difference{};
  std::vector<std::filesystem::path> read{};  ///< the files
};

/// Reads `times.json` in a folder of exported cases, and the images that it lists, and scores them.
/// @throws InputError for the first thing that is wrong: an entry, an image, a sharp image that
/// shows another view, a case of another plan
std::vector<ImportedPoint> importPoints(const ChartPlan& plan, const std::filesystem::path& folder);

/// The files that `writeImages` writes.
std::vector<std::filesystem::path> importedFiles(const std::vector<ImportedPoint>& points,
                                                 const std::filesystem::path& folder);

/// Stages the image of each point, and its difference from the reference.
void writeImages(const std::vector<ImportedPoint>& points, OutputFolder& output);

/// What is wrong with a sharp image: shifted, mirrored, in another gamma, or of another view. Empty
/// if it agrees as well as the images of two renderers do. The frames have one size (asserted).
std::string cameraFault(const Frame& sharp, const Frame& expected);

/// Surfels as points with normal, colour, opacity and the radius that gives their size back
/// (`writePly`).
void writePoints(const std::filesystem::path& file, const SurfelCloud& surfels);

/// The PLY of Kerbl et al. 2023. A surfel becomes a flat Gaussian. Gaussians are composited where
/// kernels of surfels sum to one, so a viewer shows about the surfels' image.
void writeGaussians(const std::filesystem::path& file, const Scene& scene);

/// Binary glTF 2.0, unlit: the light of a place is its colour.
/// @param mesh  one material with a texture (asserted), which alone gives the colour
void writeGlb(const std::filesystem::path& file, const TriangleMesh& mesh);

/// The `transforms.json` of NeRF and Gaussian tools. `transform_matrix` is world from camera, with
/// the axes of OpenGL: x right, y up, the camera looks along -z.
/// @param image, points  file names beside it; `points` may be empty
std::string nerfTransforms(const View& view, const std::string& image, const std::string& points);

/// A COLMAP model as text. Its camera has x right, y down and looks along +z.
struct ColmapModel {
  std::string cameras, images, points3D;
};

/// @param scene  a thousand of its points go to points3D.txt
ColmapModel colmapModel(const View& view, const std::string& image, const Scene& scene);

}  // namespace foci
