// "Unknown setting 'treads': did you mean 'threads'?"
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace alidade {

// Edits (insert, delete, replace, swap of neighbours) between two names; case counts for nothing.
// Optimal string alignment: Damerau 1964.
int EditDistance(std::string_view a, std::string_view b);

// The known name closest to what was written, the first of equals; empty when none is near enough
// to be meant.
std::string NearestName(std::string_view written, std::span<const std::string> known);

// "; did you mean 'threads'?" to hang on an error, or nothing when no name is near.
std::string DidYouMean(std::string_view written, std::span<const std::string> known);

}  // namespace alidade
