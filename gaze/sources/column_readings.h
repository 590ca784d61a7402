// How each column of a table was understood, for people.
#pragma once

#include <vector>

#include "gaze/sources/column_names.h"
#include "gaze/sources/table_layout.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// A column that the study names is as the study says. Of the others, a format's own columns are
/// sure, a name with its unit is likely, and a name without one is a guess.
std::vector<ColumnReading> readingsOf(const ColumnNames& names, const TableLayout& layout,
                                      const TraceColumns& given);

}  // namespace foci
