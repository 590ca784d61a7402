#include <algorithm>
#include <array>
#include <string_view>

#include "app/platform/version.h"
#include "app/replay/report.h"
#include "base/text.h"
#include "gaze/focus/pupil.h"

namespace foci {
namespace {

struct Reference {
  std::string_view key, bibtex;
};

constexpr std::array<Reference, 12> kSources{{
    {"foci", R"(@software{foci, title = {foci: gaze-contingent simulation of the focusing eye},
  author = {{The foci developers}}, version = {)" FOCI_VERSION R"(}})"},
    {"krivanek2003", R"(@inproceedings{krivanek2003,
  title = {Fast Depth of Field Rendering with Surface Splatting},
  author = {K{\v{r}}iv{\'a}nek, Jaroslav and {\v{Z}}{\'a}ra, Ji{\v{r}}{\'i} and Bouatouch, Kadi},
  booktitle = {Proceedings of Computer Graphics International 2003}, year = {2003},
  doi = {10.1109/CGI.2003.1214466}})"},
    {"salvucci2000", R"(@inproceedings{salvucci2000,
  title = {Identifying Fixations and Saccades in Eye-Tracking Protocols},
  author = {Salvucci, Dario D. and Goldberg, Joseph H.}, year = {2000}, pages = {71--78},
  booktitle = {Proceedings of the Symposium on Eye Tracking Research and Applications},
  doi = {10.1145/355017.355028}})"},
    {"olsen2012", R"(@techreport{olsen2012, title = {The {Tobii} {I-VT} Fixation Filter},
  author = {Olsen, Anneli}, institution = {Tobii Technology}, year = {2012}})"},
    {"watson2012", R"(@article{watson2012,
  title = {A Unified Formula for Light-Adapted Pupil Size},
  author = {Watson, Andrew B. and Yellott, John I.},
  journal = {Journal of Vision}, volume = {12}, number = {10}, year = {2012},
  doi = {10.1167/12.10.12}})"},
    {"hofstetter1950", R"(@article{hofstetter1950, title = {Useful Age-Amplitude Formula},
  author = {Hofstetter, Henry W.}, journal = {Optometric World}, volume = {38}, year = {1950}})"},
    {"seidemann2003", R"(@article{seidemann2003,
  title = {An Evaluation of the Lag of Accommodation Using Photorefraction},
  author = {Seidemann, Anne and Schaeffel, Frank},
  journal = {Vision Research}, volume = {43}, number = {4}, pages = {419--430}, year = {2003}})"},
    {"thibos1997", R"(@article{thibos1997,
  title = {Power Vectors: An Application of {Fourier} Analysis to the Description and Statistical
           Analysis of Refractive Error},
  author = {Thibos, Larry N. and Wheeler, William and Horner, Douglas},
  journal = {Optometry and Vision Science}, volume = {74}, number = {6}, year = {1997},
  doi = {10.1097/00006324-199706000-00019}})"},
    {"thibos1992", R"(@article{thibos1992,
  title = {The Chromatic Eye: A New Reduced-Eye Model of Ocular Chromatic Aberration in Humans},
  author = {Thibos, Larry N. and Ye, Ming and Zhang, Xiaoxiao and Bradley, Arthur},
  journal = {Applied Optics}, volume = {31}, number = {19}, year = {1992},
  doi = {10.1364/AO.31.003594}})"},
    {"salmon2006", R"(@article{salmon2006,
  title = {Normal-Eye {Zernike} Coefficients and Root-Mean-Square Wavefront Errors},
  author = {Salmon, Thomas O. and van de Pol, Corina},
  journal = {Journal of Cataract and Refractive Surgery}, volume = {32}, year = {2006},
  doi = {10.1016/j.jcrs.2006.07.022}})"},
    {"berrio2010", R"(@article{berrio2010,
  title = {Optical Aberrations and Alignment of the Eye with Age},
  author = {Berrio, Esther and Tabernero, Juan and Artal, Pablo},
  journal = {Journal of Vision}, volume = {10}, number = {14}, year = {2010},
  doi = {10.1167/10.14.34}})"},
    {"berendschot2001", R"(@article{berendschot2001,
  title = {Wavelength Dependence of the {Stiles-Crawford} Effect Explained by Perception of
           Backscattered Light from the Choroid},
  author = {Berendschot, Tos T. J. M. and van de Kraats, Jan and van Norren, Dirk},
  journal = {Journal of the Optical Society of America A}, volume = {18}, year = {2001},
  doi = {10.1364/JOSAA.18.001445}})"},
}};

std::string milli(double seconds) { return significant(1e3 * seconds, 3) + " ms"; }

/// What the run is of, as file names without folders.
std::string sceneSentence(const Study& study) {
  const std::string scene = study.scene.file
                                ? "the scene `" + visible(study.scene.file->filename().string()) +
                                      "` (" + significant(study.scene.scale_m) + " m a unit)"
                                : "the built-in scene " + study.scene.builtin;
  const Screen screen = study.screenInForce();
  const std::string size_px =
      std::to_string(screen.size_px.x) + " × " + std::to_string(screen.size_px.y) + " px";
  if (study.display.kind == DisplayKind::headset) {
    return "We showed " + scene + " as on a headset with " +
           significant(study.display.pixels_per_degree) + " px a degree straight ahead, " +
           size_px + " for what both eyes see. ";
  }
  return "We showed " + scene + " as on a screen of " + size_px + " and " +
         decimal(screen.size_m.x, 3) + " × " + decimal(screen.size_m.y, 3) + " m, seen from " +
         decimal(screen.distance_m, 2) + " m" +
         (study.screen.is_default ? " (assumed: no screen was stated)" : "") + ". ";
}

std::string gazeSentence(const Study& study, const GazeTrace& trace, const ReportFacts& facts) {
  if (trace.simulated) return "An oculomotor model simulated the gaze; no person looked. ";
  std::string text = "Gaze came from `" +
                     visible(std::filesystem::path(study.gaze.source).filename().string()) + "` (" +
                     visible(trace.format) + ", " + decimal(trace.rate_Hz, 0) + " Hz); " +
                     decimal(100.0 * (1.0 - facts.summary.gaze_valid), 1) + " % of its " +
                     std::to_string(facts.samples) + " samples in the " +
                     decimal(facts.summary.duration_s, 2) + " s analysed have no gaze. ";
  for (const std::string& assumed : trace.assumed) {
    text += "The recording does not state this, so we assumed: " + visible(assumed) + ". ";
  }
  return text;
}

std::string eventSentence(const Study& study, const ReportFacts& facts) {
  const EventSettings& events = study.gaze.events;
  const std::string cited = events.detector == Detector::ivt   ? " [@salvucci2000; @olsen2012]"
                            : events.detector == Detector::idt ? " [@salvucci2000]"
                                                               : "";
  const bool threshold = events.detector == Detector::rules || events.detector == Detector::ivt;
  return "Its detector " + labelOf(events.detector) + cited + " found " +
         counted(facts.summary.fixations, "fixation") + " and " +
         counted(facts.summary.saccades, "saccade") +
         (threshold ? " (peak velocity at least " + significant(events.saccade_deg_s) + " deg/s)"
                    : "") +
         ". Data loss up to " + milli(events.max_gap_s) + " was bridged; fixations less than " +
         milli(events.merge_gap_s) + " and " + significant(events.merge_deg) +
         " deg apart [@olsen2012] were merged, and those shorter than " +
         milli(events.min_fixation_s) + " left out.";
}

std::string citedEye(const Study& study) {
  const Study::Observer& observer = study.observer;
  std::string cited;
  const auto add = [&](bool used, const char* what) {
    if (used) cited += (cited.empty() ? "" : "; ") + std::string(what);
  };
  add(observer.pupil == PupilModel::luminance, "pupil [@watson2012]");
  add(study.focus.accommodation.age_years.has_value(), "amplitude by age [@hofstetter1950]");
  add(study.focus.accommodation.lag, "lag of accommodation [@seidemann2003]");
  add(observer.sphere_D != 0.0 || observer.cylinder_D != 0.0, "power vectors [@thibos1997]");
  add(observer.chromatic, "chromatic aberration [@thibos1992]");
  add(observer.age_years.has_value(), "typical aberrations [@salmon2006; @berrio2010]");
  add(observer.stiles_crawford, "Stiles-Crawford effect [@berendschot2001]");
  return cited.empty() ? "" : " Models of the eye: " + cited + ".";
}

/// Settings that differ from the defaults, without places of files.
std::string changedSettings(const Study& study) {
  constexpr std::size_t kLongest = 60;
  constexpr std::array<std::string_view, 5> kPlaces{"scene.file", "gaze.source", "eye.", "record.",
                                                    "remote."};
  std::string text;
  for (const ResolvedKey& key : resolvedKeys(study)) {
    if (key.is_default) continue;
    if (std::ranges::any_of(kPlaces, [&](auto place) { return key.name.starts_with(place); })) {
      continue;
    }
    text += (text.empty() ? "" : ", ") + ("`" + std::string(key.name) + "`") +
            (key.json.size() > kLongest ? " (see manifest.json)" : " = " + visible(key.json));
  }
  return text.empty() ? "All settings are foci's defaults."
                      : "Settings that differ from foci's defaults: " + text + ".";
}

}  // namespace

std::string distanceText(double focus_D) {
  if (focus_D < -0.01) return "behind the eye";
  return focus_D < 0.01 ? "infinity" : decimal(1.0 / focus_D, 2) + " m";
}

std::string eyeSentences(const Study& study) {
  const AccommodationSettings& accommodation = study.focus.accommodation;
  const Study::Observer& observer = study.observer;
  std::string text;
  if (study.focus.fixed_D) {
    text = " Its focus is fixed at " + decimal(*study.focus.fixed_D, 2) + " D (" +
           distanceText(*study.focus.fixed_D) + "), whatever it looks at.";
  } else {
    text = " The eye focuses on the nearest surface that fills " +
           decimal(100.0 * study.focus.coverage, 0) + " % of a cone of " +
           decimal(study.focus.cone_deg, 2) + " deg around the line of sight; " +
           (accommodation.on ? "its focus follows after " + decimal(accommodation.latency_s, 2) +
                                   " s, with a time constant of " +
                                   decimal(accommodation.time_constant_s, 2) + " s."
                             : std::string("its focus jumps at once."));
  }
  if (observer.pupil == PupilModel::recording) {
    text += " The pupil is the recorded one. It stays through blinks and data loss.";
  } else if (observer.pupil == PupilModel::luminance) {
    text += " The pupil follows the luminance of the images on a screen whose white has " +
            decimal(study.screen.luminance_cd_m2, 0) + " cd/m² and that fills " +
            decimal(fieldArea_deg2(study.screenInForce()), 0) +
            " square degrees, in a dark room (Watson and Yellott 2012).";
  }
  if (observer.sphere_D != 0.0 || observer.cylinder_D != 0.0) {
    text += " The observer's prescription is " + decimal(observer.sphere_D, 2) + " D";
    if (observer.cylinder_D != 0.0) {
      text += ", cylinder " + decimal(observer.cylinder_D, 2) + " D, axis " +
              decimal(observer.axis_deg, 0) + " deg";
    }
    text += observer.corrected
                ? "; the observer wears it."
                : "; the observer does not wear it, and the focus is the mean over all meridians.";
  }
  if (observer.chromatic) text += " Red, green and blue each have their own focus.";
  return text;
}

MethodsText methodsOf(const GazeTrace& trace, const ReportFacts& facts) {
  const Study& study = facts.run.start;
  MethodsText text;
  text.markdown =
      "<!-- Methods of this run, ready to paste. The keys in [@...] stand in references.bib. -->\n"
      "\n" +
      sceneSentence(study) + gazeSentence(study, trace, facts) +
      "The gaze was analysed with foci " + versionText() + " [@foci]. " +
      eventSentence(study, facts) + "\n\nfoci then rendered what the observer's eye saw at " +
      significant(study.output.fps) + " frames a second, with its method `" + study.render.method +
      "` for depth of field; its surface splatting follows [@krivanek2003]." + eyeSentences(study) +
      " The pupil's diameter was " + decimal(facts.summary.pupil_mm, 1) + " mm" +
      (study.observer.pupil == PupilModel::fixed ? "" : " (median)") +
      ". Defocus is the focus of the eye less the vergence of the surface, in dioptres; the blur "
      "radius is half the pupil times the defocus, as an angle." +
      citedEye(study) + "\n\n" + changedSettings(study) + "\n";
  if (!facts.run.changes.empty()) {
    text.markdown += "Settings changed during the run: " + changesText(facts.run.changes) + ".\n";
  }
  for (const std::string& warning : facts.warnings) {
    text.markdown += "\nNote: " + visible(warning) + "\n";
  }
  for (const Reference& reference : kSources) {
    if (text.markdown.find("@" + std::string(reference.key)) == std::string::npos) continue;
    text.bibtex += std::string(reference.bibtex) + "\n\n";
  }
  return text;
}

}  // namespace foci
