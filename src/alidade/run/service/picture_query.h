// The camera of a picture that was sent, from the query of its request.
#pragma once

#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>

#include "alidade/io/calibration.h"

namespace alidade {

// "a=1&b=x%20y" as names and values, decoded. Throws Error (input) for a name given twice, an
// invalid escape, or more than 64 names.
std::map<std::string, std::string> QueryOf(std::string_view query);

// Removes "probability" from the query and returns it: the least of a pose that is believed; 0: not
// given. Throws Error (input) if it is not above 0 and below 1.
double TakeProbability(std::map<std::string, std::string>& query);

// The calibration that `query` tells of a picture of `size`:
//   f=PIXELS or fx= fy=, with cx= cy= (default: the center), k1= k2= p1= p2= k3=, or with
//   model=fisheye k1= to k4=; width= height= if these are of another size of the same picture;
//   fov=DEGREES, horizontal;
//   camera=map, the camera of the map, `map`;
//   none of these: the focal length of the JPEG `bytes` (EXIF).
// "token" is ignored. Throws Error (input) that says what is missing or wrong.
Calibration CalibrationOfQuery(const std::map<std::string, std::string>& query, cv::Size size,
                               std::string_view bytes, const Camera& map);

}  // namespace alidade
