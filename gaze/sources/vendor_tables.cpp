// From exports and documentation of Tobii Pro Lab, Tobii Studio, Tobii Pro SDK, Gazepoint, Pupil
// Core, Neon, SMI BeGaze and GazeBase.
#include "gaze/sources/vendor_tables.h"

#include <initializer_list>
#include <optional>
#include <string_view>

namespace foci {
namespace {

class VendorFormat {
 public:
  VendorFormat(const ColumnNames& names, const TraceColumns& columns, const TablePreamble& before,
               TableLayout& layout)
      : names_(names), given_(columns), before_(before), layout_(layout) {}

  void take() {
    const auto set = [&](const char* format) { layout_.format = format; };
    if (given_.x.empty() && find({"bpogx", "fpogx", "lpogx", "rpogx"})) {
      recogniseGazepoint();
    } else if (layout_.eyes[0].point || layout_.eyes[1].point ||
               find({"leftgazepointondisplayareax", "rightgazepointondisplayareax"})) {
      set("Tobii Pro SDK");
      layout_.units = GazeUnits::normalised;
      layout_.validity_code = ValidityCode::one;
      if (layout_.time_scale_s == 0.0) layout_.time_scale_s = 1e-6;
    } else if (isTobiiStudio(names_, before_)) {
      set("Tobii Studio");
      recogniseTobiiStudio();
    } else if (find({"recordingtimestamp"}) && find({"gazepointx", "gazepointleftx"})) {
      set("Tobii Pro Lab");
      layout_.width_px = find({"recordingresolutionwidth"});
      layout_.height_px = find({"recordingresolutionheight"});
      if (!layout_.units) layout_.units = GazeUnits::px;
      // Rows of the mouse and of events lie between those of the eye tracker.
      layout_.rows = find({"sensor"})
                         ? SampleRows{.column = find({"sensor"}), .only = "Eye Tracker"}
                         : SampleRows{.column = find({"eyetrackertimestamp"})};
    } else if (find({"gazetimestamp"}) && (layout_.x || find({"posx"})) && find({"basedata"})) {
      set("Pupil Core export");
      layout_.units = GazeUnits::normalised;
      layout_.y_up = layout_.of_scene_camera = true;
      layout_.time_scale_s = 1.0;
    } else if (find({"onsurf", "onsrf"}) && layout_.x && names_.key(*layout_.x) == "x" &&
               names_.unit(*layout_.x) == "norm") {
      set("Pupil Core surface");
      layout_.units = GazeUnits::normalised;
      layout_.y_up = true;
      layout_.time_scale_s = 1.0;
    } else if (find({"sectionid"}) && find({"gazex"}) && find({"recordingid"})) {
      set("Neon export");
      layout_.of_scene_camera = true;
      layout_.validity = find({"worn"});
      layout_.validity_code = ValidityCode::not_zero;
    } else if (before_.smi ||
               (find({"recordingtime"}) && find({"pointofregardleftx", "pointofregardrightx"}))) {
      set("SMI BeGaze");
      layout_.units = GazeUnits::px;
      layout_.zero_is_absent = true;
      if (layout_.time_scale_s == 0.0) layout_.time_scale_s = 1e-6;
      recogniseSmiRows();
    } else if (find({"n"}) && find({"val"}) && find({"dp"})) {
      set("GazeBase");
      layout_.units = GazeUnits::deg;
      layout_.time_scale_s = 1e-3;
      layout_.validity = find({"val"});
      layout_.validity_code = ValidityCode::zero;
    } else if (layout_.x && names_.unit(*layout_.x) == "norm" &&
               names_.key(*layout_.x).ends_with("posx")) {
      layout_.y_up = true;  // Pupil Labs' norm_pos counts from the bottom
    }
  }

 private:
  std::optional<std::size_t> find(std::initializer_list<std::string_view> keys) const {
    return names_.find(keys);
  }

  /// Gazepoint Analysis: seconds, fractions of the screen, 1 for valid; a blink's number or 0.
  void recogniseGazepoint() {
    layout_.format = "Gazepoint";
    layout_.units = GazeUnits::normalised;
    layout_.validity_code = ValidityCode::one;
    if (layout_.x) {
      layout_.validity = names_.key(*layout_.x) == "bpogx" ? find({"bpogv"}) : find({"fpogv"});
    }
    if (given_.time_scale_s) return;
    if (layout_.time && names_.key(*layout_.time) == "time") layout_.time_scale_s = 1.0;
  }

  /// Version 1 and 2: times in ms, (0, 0) and (-width, -height) in data loss. Version 3: times in
  /// ms, empty fields in data loss.
  void recogniseTobiiStudio() {
    layout_.units = GazeUnits::px;
    layout_.zero_is_absent = layout_.size_off_is_absent = true;
    if (layout_.time_scale_s == 0.0) layout_.time_scale_s = 1e-3;
    layout_.resolution = find({"recordingresolution"});
    // Rows of the mouse, keys and events have no number of a gaze sample.
    for (const std::string_view key :
         {"gazepointindex", "number", "eyetrackertimestamp", "validityleft", "validityright",
          "gazepointxleft", "gazepointxright"}) {
      if (!layout_.rows.column) layout_.rows.column = find({key});
    }
  }

  /// Messages and the separators of trials lie between the samples.
  void recogniseSmiRows() {
    if (const auto type = find({"type"})) {
      layout_.rows = {.column = type, .only = "SMP"};
    } else {
      layout_.rows = {.column = find({"categoryright", "categoryleft"}), .except = "Separator"};
    }
  }

  const ColumnNames& names_;
  const TraceColumns& given_;
  const TablePreamble& before_;
  TableLayout& layout_;
};

}  // namespace

bool isTobiiStudio(const ColumnNames& names, const TablePreamble& before) {
  const auto time = names.find({"recordingtimestamp"});
  const bool version3 = time && names.text(*time).find(' ') == std::string_view::npos &&
                        names.find({"gazepointx", "gazepointleftx"});
  return before.tobii_studio || version3 ||
         (names.find({"gazepointxleft"}) &&
          names.find({"camxleft", "distanceleft", "validityleft"}));
}

void takeVendorFormat(const ColumnNames& names, const TraceColumns& columns,
                      const TablePreamble& before, TableLayout& layout) {
  VendorFormat(names, columns, before, layout).take();
}

}  // namespace foci
