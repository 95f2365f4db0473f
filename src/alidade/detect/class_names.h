// What the classes of a network are called.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace alidade {

// The 80 of the COCO data set (Lin et al. 2014) in the order all its detectors give them.
const std::vector<std::string>& CocoNames();

// From the text exporters leave in a file, a list or a table as Python writes it:
// ['person', "dog's bed"] or {0: 'person', 1: 'bicycle'}. Empty when it is neither.
std::vector<std::string> ParseClassNames(std::string_view text);

// One for each class: those of the file; for what it doesn't name COCO's when there are 80, else
// "class 7". `classes` 0: as many as the file names, or COCO's.
std::vector<std::string> NamesFor(int classes, std::vector<std::string> from_file);

// Whether `list`, names with commas between, has this one.
bool IsListed(const std::string& list, const std::string& name);

}  // namespace alidade
