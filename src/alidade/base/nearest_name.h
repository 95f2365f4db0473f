// Suggests the intended name for a misspelled one: "Unknown setting 'treads': did you mean
// 'threads'?"
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace alidade {

// Case-insensitive edit distance (insertion, deletion, substitution, transposition of adjacent
// letters). Optimal string alignment (Damerau 1964).
int EditDistance(std::string_view a, std::string_view b);

// The known name with the smallest edit distance to `written` (the first one on a tie). Empty if
// the distance exceeds half the length of the longer of the two names.
std::string NearestName(std::string_view written, std::span<const std::string> known);

// "; did you mean 'threads'?" to append to an error message; empty if there is no near name.
std::string DidYouMean(std::string_view written, std::span<const std::string> known);

}  // namespace alidade
