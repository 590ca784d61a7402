// Sorts on many threads. Apart from parallel.h, since TBB's headers are heavy to compile.
#pragma once

#include <functional>

#ifdef FOCI_TSAN
#include <algorithm>
#else
#include <tbb/parallel_sort.h>
#endif

namespace foci {

/// Sorts. Elements that compare equal must be identical, or their order depends on the threads.
template <typename Iterator, typename Less = std::less<>>
void parallelSort(Iterator begin, Iterator end, const Less& less = {}) {
#ifdef FOCI_TSAN
  std::sort(begin, end, less);
#else
  tbb::parallel_sort(begin, end, less);
#endif
}

}  // namespace foci
