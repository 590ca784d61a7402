// The Python module `foci._foci`. python/foci/__init__.py gives its names to users.
#include <tbb/global_control.h>

#include "base/input_error.h"
#include "python/bindings.h"
#include "render/literature/literature.h"
#include "render/methods/method.h"

namespace py = pybind11;

namespace foci {
namespace {

std::string described(const py::object& value) { return py::str(value); }
std::string described(double value) { return described(py::float_(value)); }
std::string shapeOf(const Numbers& array) { return described(array.attr("shape")); }

/// A limit for all threads of the libraries, until the next call.
void setThreads(int threads) {
  static std::unique_ptr<tbb::global_control> limit;
  inRange("threads", threads, 1, 1024);
  limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                static_cast<std::size_t>(threads));
}

py::list methodNames() {
  py::list names;
  for (const MethodInfo& info : methods()) names.append(std::string(info.name));
  return names;
}

}  // namespace

double inRange(const char* argument, double value, double low, double high) {
  if (value >= low && value <= high) return value;
  throw InputError(std::string(argument) + " = " + described(value),
                   "expected " + described(low) + " to " + described(high));
}

const double* columnOf(const char* argument, const Numbers& array, py::ssize_t rows) {
  if (array.ndim() == 1 && array.shape(0) == rows) return array.data();
  throw InputError(argument, "has shape " + shapeOf(array) + ", expected (" + std::to_string(rows) +
                                 ",), as the other columns");
}

const double* tableOf(const char* argument, const Numbers& array, py::ssize_t rows,
                      py::ssize_t columns) {
  if (array.ndim() == 2 && array.shape(1) == columns && (rows < 0 || array.shape(0) == rows)) {
    return array.data();
  }
  const std::string wanted = rows < 0 ? "N" : std::to_string(rows);
  throw InputError(argument, "has shape " + shapeOf(array) + ", expected (" + wanted + ", " +
                                 std::to_string(columns) + ")");
}

Word wordOf(std::string_view word) {
  Word out{};
  for (std::size_t i = 0; i < word.size() && i < out.size(); ++i) {
    out[i] = static_cast<char32_t>(static_cast<unsigned char>(word[i]));
  }
  return out;
}

}  // namespace foci

PYBIND11_MODULE(_foci, module) {
  foci::registerLiterature();
  module.doc() = "The compiled part of foci. Import `foci` instead.";
  py::register_exception<foci::InputError>(module, "InputError", PyExc_ValueError).doc() =
      "Bad input: one line with the argument, its value and what is expected.";
  foci::bindScreenAndEye(module);
  foci::bindImage(module);
  foci::bindScene(module);
  foci::bindRecordings(module);
  foci::bindCalibration(module);
  foci::bindSession(module);
  foci::bindStudy(module);
  module.def("set_threads", &foci::setThreads, py::arg("threads"),
             "Let foci use at most this many threads. The images do not depend on the number.");
  module.def("methods", &foci::methodNames, "The names of all depth-of-field methods.");
  module.attr("__version__") = FOCI_VERSION;
}
