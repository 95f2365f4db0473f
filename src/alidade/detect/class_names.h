// Class names of a detector network.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace alidade {

// The 80 classes of COCO (Lin et al. 2014), in the order that its detectors use.
const std::vector<std::string>& CocoNames();

// Parses the text that exporters store in a model file, a Python list or dict: ['person', "dog's
// bed"] or {0: 'person', 1: 'bicycle'}. Returns an empty list for other text.
std::vector<std::string> ParseClassNames(std::string_view text);

// One name per class: the file's; for missing ones COCO's if there are 80 classes, else "class 7".
// `classes` 0: the number of names in the file, or COCO's 80.
std::vector<std::string> NamesFor(int classes, std::vector<std::string> from_file);

// true when the comma-separated `list` contains `name`.
bool IsListed(const std::string& list, const std::string& name);

}  // namespace alidade
