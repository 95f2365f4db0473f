// Words of the command line that version 0.1 took and that are written in another way now.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace alidade {

// `words` of `command` (of the whole program, or of `run` alone) with the old forms replaced by the
// new ones. Each is a warning. Accepted in this version only:
//   --viewer PORT  is  --viewer --port PORT
//   --record FILE  is  --record-to FILE
// A command has one SOURCE. So a word behind one of these flags is its old value only if there is
// another word that can be the source, and behind --viewer only if it is a number.
std::vector<std::string> WithoutOldForms(const CLI::App& command, std::vector<std::string> words);

}  // namespace alidade
