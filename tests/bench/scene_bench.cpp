// The times of loading a scene, of estimation and of distance queries. Fixed scenes and seeds.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <glm/gtc/constants.hpp>
#include <random>

#include "render/lod/surface_query.h"
#include "render/scene/builtin/procedural.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/io/ply.h"
#include "render/scene/mesh/sample_mesh.h"

namespace foci {
namespace {

std::filesystem::path lionFile() {
  const char* folder = std::getenv("FOCI_DATA");
  return std::filesystem::path(folder != nullptr ? folder : FOCI_SOURCE_DIR "/../shared/data") /
         "scans/lion.ply";
}

/// Peak memory of the process so far.
double peakMemory_MiB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// Points on a unit sphere in random order, as in a file.
PointCloud randomSphere(std::size_t count) {
  std::mt19937 random(1);
  const auto uniform = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
  PointCloud points;
  points.position_m.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float y = 2.0f * uniform() - 1.0f, a = glm::two_pi<float>() * uniform();
    const float r = std::sqrt(1.0f - y * y);
    points.position_m.emplace_back(r * std::cos(a), y, r * std::sin(a));
  }
  points.color.assign(count, glm::vec3(0.5f));
  return points;
}

void BM_LoadLion(benchmark::State& state) {
  const std::filesystem::path file = lionFile();
  if (!std::filesystem::exists(file)) {
    state.SkipWithError("no scans/lion.ply (FOCI_DATA)");
    return;
  }
  for (auto _ : state) {
    const SurfelCloud lion = surfelsFromPoints(readPly(file));
    const SurfaceQuery query(lion);
    benchmark::DoNotOptimize(&query);
  }
}
BENCHMARK(BM_LoadLion)->Unit(benchmark::kMillisecond)->UseRealTime();

/// Argument: number of points.
void BM_SurfelsOfRandomSphere(benchmark::State& state) {
  for (auto _ : state) {
    state.PauseTiming();
    PointCloud points = randomSphere(static_cast<std::size_t>(state.range(0)));
    state.ResumeTiming();
    const SurfelCloud cloud = surfelsFromPoints(std::move(points));
    benchmark::DoNotOptimize(cloud.area_m2.data());
  }
  state.counters["peak_MiB"] = peakMemory_MiB();
}
BENCHMARK(BM_SurfelsOfRandomSphere)
    ->Arg(1'000'000)
    ->Arg(10'000'000)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// A closed sphere of as many columns as rows, two triangles in each field.
TriangleMesh meshedSphere(std::size_t rows) {
  const auto at = [&](std::size_t row, std::size_t column) {
    const float polar = glm::pi<float>() * static_cast<float>(row) / static_cast<float>(rows);
    const float around =
        glm::two_pi<float>() * static_cast<float>(column % rows) / static_cast<float>(rows);
    return glm::vec3(std::sin(polar) * std::cos(around), std::cos(polar),
                     std::sin(polar) * std::sin(around));
  };
  TriangleMesh mesh;
  mesh.corners_m.reserve(6 * rows * rows);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < rows; ++column) {
      const glm::vec3 a = at(row, column), b = at(row, column + 1), c = at(row + 1, column),
                      d = at(row + 1, column + 1);
      mesh.corners_m.insert(mesh.corners_m.end(), {a, b, c, b, d, c});
    }
  }
  mesh.uv.resize(mesh.corners_m.size());
  mesh.material.resize(mesh.size());
  return mesh;
}

/// Argument: rows of the sphere, which has twice as many triangles as their square.
void BM_SampleMesh(benchmark::State& state) {
  const TriangleMesh mesh = meshedSphere(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    const PointCloud points = sampleMesh(mesh, "sphere");
    benchmark::DoNotOptimize(points.position_m.data());
  }
  state.counters["triangles"] = static_cast<double>(mesh.size());
}
BENCHMARK(BM_SampleMesh)
    ->Arg(3)
    ->Arg(200)
    ->Arg(1000)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void BM_DistanceInGallery(benchmark::State& state) {
  const SurfelCloud gallery = makeGallery();
  const SurfaceQuery query(gallery);
  const glm::dvec3 eye(galleryEyePose().position_m);
  const auto places = galleryPointsOfInterest();
  std::size_t at = 0;
  for (auto _ : state) {
    const glm::dvec3 sight = glm::dvec3(places[at++ % places.size()].p_world) - eye;
    benchmark::DoNotOptimize(query.distance(eye, glm::normalize(sight), glm::radians(0.5), 0.5));
  }
}
BENCHMARK(BM_DistanceInGallery)->Unit(benchmark::kMicrosecond)->UseRealTime();

}  // namespace
}  // namespace foci
