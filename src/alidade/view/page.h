// Common parts of Alidade's HTML pages: single files without scripts or external resources.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace alidade {

// Light or dark as the system is set; responsive for phones. `body` is markup.
std::string HtmlPage(const std::string& title, const std::string& body);

// `text` and `items` are untrusted and are escaped.
std::string Cell(const std::string& tag, const std::string& text);
std::string PairTable(const std::vector<std::pair<std::string, std::string>>& rows);
std::string HtmlList(const std::string& heading, const std::vector<std::string>& items);

}  // namespace alidade
