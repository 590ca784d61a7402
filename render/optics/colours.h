// The colours of light that the eye focuses differently.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace foci {

/// Light of one wavelength, or of one primary.
struct Colour {
  float nearer_D = 0.0f;  ///< how much nearer than the focus this light is in focus
  glm::vec3 share{0.0f};  ///< of all light of the display's red, green and blue
  bool operator==(const Colour&) const = default;
};

/// The primaries, each as light of its dominant wavelength (`chromaticDifferenceOfPrimaries_D`).
std::vector<Colour> coloursOfPrimaries();

/// Luminous efficiency V(lambda) of CIE 1924, linear between its values each 10 nm; 0 outside of
/// 380 to 720 nm.
double luminousEfficiency(double wavelength_nm);

/// The light of a display's primaries at one wavelength, in any unit of power.
struct SpectrumSample {
  double wavelength_nm = 0.0;
  glm::dvec3 red_green_blue{0.0};
};

/// The spectra in `n` bands of equal width, each as light of the wavelength in its middle, weighted
/// by `luminousEfficiency`. The shares of each primary sum to 1. Bands without light are left out.
/// @param spectra  by wavelength, at least two; each primary has light that is seen (asserted)
std::vector<Colour> coloursOfSpectra(const std::vector<SpectrumSample>& spectra, int n);

}  // namespace foci
