// The images of a folder.
#pragma once

#include <string>
#include <vector>

namespace alidade {

// Names (without the folder) of the images, by their endings, sorted as people count: img2 before
// img10.
std::vector<std::string> ImagesIn(const std::string& folder);

bool NaturallyBefore(const std::string& a, const std::string& b);

}  // namespace alidade
