// What our HTML pages have in common: one file each, no script, nothing loaded from elsewhere.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace alidade {

// Light or dark as the reader's system is; fit for a phone. `body` is markup.
std::string HtmlPage(const std::string& title, const std::string& body);

// `text` and `items` are words of others: what would be markup is escaped.
std::string Cell(const std::string& tag, const std::string& text);
std::string PairTable(const std::vector<std::pair<std::string, std::string>>& rows);
std::string HtmlList(const std::string& heading, const std::vector<std::string>& items);

}  // namespace alidade
