// Columns of gaze samples from NumPy, and a recording as Python holds it.
#pragma once

#include <memory>
#include <optional>

#include "gaze/geometry/gaze_sample.h"
#include "python/bindings.h"

namespace foci {

/// Columns of the same length. NaN in x, y or pupil stands for an absent value.
struct SampleColumns {
  pybind11::ssize_t rows = 0;
  const double *t = nullptr, *x = nullptr, *y = nullptr, *pupil = nullptr;

  GazeSample at(pybind11::ssize_t row) const;
};

/// Points into the arrays. Times are finite and increase.
/// @throws InputError
SampleColumns columnsOf(const Numbers& t, const Numbers& x, const Numbers& y,
                        const std::optional<Numbers>& pupil);

/// @throws InputError unless `time_s` is finite and later than `before_s`
void requireLater(double time_s, double before_s);

/// What Python calls a recording: a trace that does not change.
using Recording = std::shared_ptr<GazeTrace>;

}  // namespace foci
