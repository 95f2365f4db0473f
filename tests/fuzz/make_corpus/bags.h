// ROS recordings of the seed corpus.
#pragma once

#include <functional>
#include <string>

namespace alidade {

using WriteCorpusFile = std::function<void(const std::string& target, const std::string& name,
                                           const std::string& bytes)>;

// Two frames of 8 x 6 pixels with depth and calibration, in every container and form.
void WriteBags(const WriteCorpusFile& write);

}  // namespace alidade
