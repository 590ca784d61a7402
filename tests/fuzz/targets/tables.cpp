// Tables of labels, of targets and of Zernike coefficients.
#include "app/study/eye_tables.h"
#include "calibration/binocular/fit_binocular.h"
#include "calibration/gaze_map/map_units.h"
#include "calibration/webcam/webcam_calibration.h"
#include "gaze/sources/trace_reader.h"
#include "tests/fuzz/harness.h"

FOCI_FUZZ(tables) {
  const auto file = foci::fuzz::asFile("input.tsv", bytes, size);
  foci::fuzz::readWithinLimits(size, [&] { foci::readLabelledTrace(file, foci::defaultScreen()); });
  for (const auto units : {foci::MapUnits::deg, foci::MapUnits::norm, foci::MapUnits::direction}) {
    foci::fuzz::readWithinLimits(size, [&] { foci::readGazePairs(file, units); });
  }
  foci::fuzz::readWithinLimits(size, [&] { foci::readShownTargets(file); });
  foci::fuzz::readWithinLimits(size, [&] { foci::readBinocularPairs(file); });
  foci::fuzz::readWithinLimits(size, [&] { foci::readWavefronts(file, 6.0); });
  foci::fuzz::readWithinLimits(size, [&] { foci::readSpectra(file); });
  return 0;
}
