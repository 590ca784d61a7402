#include "app/study/eye_tables.h"

#include <optional>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "gaze/sources/rows.h"

namespace foci {

FieldAberrations readFieldAberrations(const std::filesystem::path& file) {
  constexpr double kMostField_angle_deg = 90.0, kMostField_um = 50.0;
  constexpr std::size_t kMostRows = 200000;
  NamedTable table(file, "horizontal_deg, vertical_deg and z3_um to z8_um");
  std::vector<std::size_t> columns;
  for (const char* name :
       {"horizontal_deg", "vertical_deg", "z3_um", "z4_um", "z5_um", "z6_um", "z7_um", "z8_um"}) {
    columns.push_back(table.column(name));
  }
  const std::optional<std::size_t> subject = table.find("subject");
  std::vector<FieldSample> samples;
  while (table.next()) {
    const auto angle_deg = [&](std::size_t i) {
      return table.needed(columns[i], -kMostField_angle_deg, kMostField_angle_deg);
    };
    FieldSample sample{.field_deg = {angle_deg(0), angle_deg(1)}};
    for (std::size_t j = 0; j < sample.z_um.size(); ++j) {
      sample.z_um[j] = table.needed(columns[2 + j], -kMostField_um, kMostField_um);
    }
    if (subject) sample.eye = static_cast<int>(table.needed(*subject, -1e6, 1e6));
    if (samples.size() == kMostRows) throw table.error("expected at most 200000 rows");
    samples.push_back(sample);
  }
  FieldAberrations field;
  if (!fitField(samples, field)) {
    throw InputError(file.string(),
                     std::to_string(samples.size()) +
                         " directions do not tell the field: expected rows for the fovea (within 5 "
                         "degrees) and at least 5 angles along and 5 across the horizontal");
  }
  return field;
}

}  // namespace foci
