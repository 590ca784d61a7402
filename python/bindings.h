// The parts of the Python module, and what they share: arguments, rows of tables, and locks that
// never wait with the interpreter's lock in hand.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

/// A vector is a tuple in Python, which may pass any sequence of as many numbers.
template <glm::length_t kSize, typename Number>
struct pybind11::detail::type_caster<glm::vec<kSize, Number>> {
  using Vector = glm::vec<kSize, Number>;
  using Numbers = std::array<Number, kSize>;
  PYBIND11_TYPE_CASTER(Vector, make_caster<Numbers>::name);

  bool load(handle source, bool convert) {
    make_caster<Numbers> numbers;
    if (!numbers.load(source, convert)) return false;
    std::ranges::copy(cast_op<Numbers&>(numbers), &value[0]);
    return true;
  }
  static handle cast(const Vector& vector, return_value_policy, handle) {
    tuple numbers(kSize);
    for (int k = 0; k < kSize; ++k) numbers[k] = vector[k];
    return numbers.release();
  }
};

namespace foci {

void bindScreenAndEye(pybind11::module_& module);
void bindScene(pybind11::module_& module);
void bindImage(pybind11::module_& module);
void bindRecordings(pybind11::module_& module);
void bindCalibration(pybind11::module_& module);
void bindSession(pybind11::module_& module);
void bindStudy(pybind11::module_& module);

/// Raises a UserWarning.
void warn(const std::string& text);

/// Any array of numbers, as doubles in C order. No copy where it is one already.
using Numbers = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// The number, if it lies in [low, high].
/// @throws InputError naming the argument; also for NaN
double inRange(const char* argument, double value, double low, double high);

/// The numbers of an array of one dimension.
/// @throws InputError
const double* columnOf(const char* argument, const Numbers& array, pybind11::ssize_t rows);
/// The numbers of an array of shape (rows, columns), row by row.
/// @throws InputError; `rows` below 0 stands for any number
const double* tableOf(const char* argument, const Numbers& array, pybind11::ssize_t rows,
                      pybind11::ssize_t columns);

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
template <typename Value>
Value orNaN(const std::optional<Value>& value) {
  return value.value_or(Value(kNaN));
}

/// The point, absent where a coordinate is NaN or infinite.
inline std::optional<glm::dvec2> pointOrAbsent(double x, double y) {
  if (!std::isfinite(x) || !std::isfinite(y)) return std::nullopt;
  return glm::dvec2(x, y);
}
inline std::optional<double> numberOrAbsent(double value) {
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

/// A word of a table: NumPy's "U8".
using Word = std::array<char32_t, 8>;
Word wordOf(std::string_view word);

/// A structured array of rows whose members are words and doubles, in the order of `names`. A name
/// with a leading `*` is a word.
template <typename Row>
pybind11::array tableOfRows(const std::vector<Row>& rows,
                            std::initializer_list<const char*> names) {
  pybind11::list fields;
  for (const char* name : names) {
    const bool is_word = *name == '*';
    fields.append(pybind11::make_tuple(is_word ? name + 1 : name, is_word ? "U8" : "f8"));
  }
  const pybind11::dtype type = pybind11::dtype::from_args(fields);
  if (static_cast<std::size_t>(type.itemsize()) != sizeof(Row)) {
    throw std::logic_error("the row of a table has other members than its names say");
  }
  return pybind11::array(type, static_cast<pybind11::ssize_t>(rows.size()), rows.data());
}

/// Columns of gaze samples of the same length. NaN in x, y or pupil stands for an absent value.
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

/// What the function returns. It runs without the interpreter's lock.
template <typename Function>
auto outsideInterpreter(const Function& function) {
  const pybind11::gil_scoped_release released;
  return function();
}

/// Locks the mutex. If another thread holds it, waits without the interpreter's lock.
inline std::unique_lock<std::mutex> lockOutsideInterpreter(std::mutex& mutex) {
  std::unique_lock lock(mutex, std::try_to_lock);
  if (!lock.owns_lock()) outsideInterpreter([&] { lock.lock(); });
  return lock;
}

}  // namespace foci
