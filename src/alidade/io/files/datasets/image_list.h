// The images of a folder.
#pragma once

#include <string>
#include <vector>

namespace alidade {

// Names of the images in a folder, detected by their endings, in natural order: img2 before img10.
std::vector<std::string> ImagesIn(const std::string& folder);

bool NaturallyBefore(const std::string& a, const std::string& b);

}  // namespace alidade
