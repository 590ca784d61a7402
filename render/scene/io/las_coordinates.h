// What the coordinates of a LAS scan mean: the units and the kind of its coordinate system, from
// GeoKeys (OGC GeoTIFF 1.1) or from text (OGC WKT, versions 1 and 2). Private to the reader of LAS.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace foci {

struct LasCoordinates {
  std::optional<double> unit_m{};         ///< of x and y, metres; absent: not stated
  std::optional<double> height_unit_m{};  ///< of z; absent: as x and y, or metres beside degrees
  /// x and y are longitude and latitude, in units of this many degrees. Absent: they are lengths.
  std::optional<double> unit_deg{};
  bool geocentric = false;  ///< x, y and z from the middle of the Earth
  std::vector<std::string> remarks{};
};

/// @param directory, doubles, ascii  the records 34735, 34736 and 34737; each may be empty or
///                                   damaged
LasCoordinates coordinatesOfGeoKeys(std::span<const unsigned char> directory,
                                    std::span<const unsigned char> doubles, std::string_view ascii);

/// Nothing is known of a text that is damaged.
LasCoordinates coordinatesOfWkt(std::string_view wkt);

}  // namespace foci
