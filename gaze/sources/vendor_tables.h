// The formats of vendors' tables, recognised from the names of their columns.
#pragma once

#include "gaze/sources/column_names.h"
#include "gaze/sources/table_layout.h"
#include "gaze/sources/table_preamble.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// Sets what a vendor's format says beyond its columns' names: its own name, units, the code for
/// data loss, and which rows are samples. Changes nothing for a table of no known vendor.
/// @param layout  with the columns of time, point and eyes
void takeVendorFormat(const ColumnNames& names, const TraceColumns& columns,
                      const TablePreamble& before, TableLayout& layout);

/// Whether the table is of Tobii Studio, which writes names without blanks. Pro Lab writes blanks.
bool isTobiiStudio(const ColumnNames& names, const TablePreamble& before);

}  // namespace foci
