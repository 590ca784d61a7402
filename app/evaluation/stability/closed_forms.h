// Images of blurred shapes in closed form, which methods are scored against.
#pragma once

namespace foci::stability {

/// Share of a uniform disc beyond a straight edge, seen through a Gaussian pixel:
///   share(x) = (acos(-t) + t sqrt(1 - t^2)) / pi,   t = clamp(x / radius_px, -1, 1),
/// convolved with the Gaussian. With radius 0 the share is the integral of the Gaussian alone.
/// @param distance_px  from the edge to the disc's centre; > 0: the centre lies on the near side
/// @param radius_px    of the disc, >= 0
/// @param sigma_px     of the Gaussian
/// @return 0 to 1
double edgeShare(double distance_px, double radius_px, double sigma_px);

/// Light per square pixel of a uniform disc of unit light, seen through a Gaussian pixel, at the
/// distance d from its centre:
///   1 / (pi C^2 s^2) int_0^C r exp(-(r^2 + d^2) / (2 s^2)) I0(r d / s^2) dr.
/// @param radius_px  C, > 0
/// @param sigma_px   s, of the Gaussian
double discThroughGaussian(double distance_px, double radius_px, double sigma_px);

}  // namespace foci::stability
