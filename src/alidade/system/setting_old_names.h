// Names that settings had in version 0.1, accepted in 0.2 with a warning.
#pragma once

#include <string>

namespace alidade {

struct OldName {
  std::string now;       // the row's name; "" when the name was not changed
  bool dropped = false;  // there is no such setting any more
};

OldName FindOldName(const std::string& name);

}  // namespace alidade
