#include "alidade/run/batch/batch_list.h"

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <set>
#include <sstream>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/io/text.h"
#include "alidade/run/sources/any_source.h"

namespace alidade {
namespace {

bool IsNameSign(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

std::string FromEnvironment(const std::string& name) {
  const char* value = std::getenv(name.c_str());
  if (!value) ThrowUsage("$" + name + " is not set in the environment");
  return value;
}

// `at`: position of the $ in `line`; moved to the last character of the name.
std::string Expanded(const std::string& line, size_t& at) {
  const bool braced = at + 1 < line.size() && line[at + 1] == '{';
  size_t end = at + (braced ? 2 : 1);
  const size_t begin = end;
  while (end < line.size() && IsNameSign(line[end])) ++end;
  if (end == begin) return "$";  // a plain dollar sign
  if (braced && (end >= line.size() || line[end] != '}')) ThrowUsage("${ without }");
  at = braced ? end : end - 1;
  return FromEnvironment(line.substr(begin, end - begin));
}

// Default name of the result folder of a source.
std::string FolderNameOf(const std::string& source) {
  std::string name = source;
  if (const std::string path = PathOfSource(source); !path.empty()) {
    name = NameAsTyped(path);
    if (name.find('.') != std::string::npos && name.front() != '.')
      name = std::filesystem::path(name).stem().string();
  } else if (name.rfind("synth:", 0) == 0) {
    name = name.substr(6);
  }
  for (char& c : name) {
    if (!IsNameSign(c) && c != '-' && c != '.') c = '_';
  }
  return name.empty() || name.front() == '.' ? "recording" : name;
}

// Files of the batch itself in its folder.
bool IsBatchsOwn(const std::string& name) {
  static const std::set<std::string> kOwn = {"log",        "done",   "batch.json",
                                             "batch.md",   "merged", "batch.log",
                                             "batch.lock", "slurm",  "compare.html"};
  return kOwn.count(name) > 0 || name.rfind("merged-", 0) == 0;
}

void CheckFolderName(const std::string& name) {
  if (name.empty() || name.front() == '.' || name.find('/') != std::string::npos)
    ThrowUsage("--out " + name + " must be the name of a folder within the batch's --out");
  if (IsBatchsOwn(name))
    ThrowUsage("--out " + name + ": the batch itself writes a file of that name");
}

// Removes --out NAME or --out=NAME from the words.
std::optional<std::string> TakeOut(std::vector<std::string>& words) {
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--out" && i + 1 < words.size()) {
      const std::string name = words[i + 1];
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i),
                  words.begin() + static_cast<std::ptrdiff_t>(i) + 2);
      return name;
    }
    if (words[i].rfind("--out=", 0) == 0) {
      const std::string name = words[i].substr(6);
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i));
      return name;
    }
  }
  return std::nullopt;
}

std::string Quoted(const std::string& word) {
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

std::vector<std::string> WordsOfLine(const std::string& line) {
  std::vector<std::string> words;
  std::string word;
  bool within = false;  // within a word, which may be empty: ''
  char quote = 0;
  const auto end_word = [&] {
    if (within) words.push_back(word);
    word.clear();
    within = false;
  };
  for (size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == quote && quote) {
      quote = 0;
    } else if (c == '\\' && quote != '\'' && i + 1 < line.size()) {
      word += line[++i];
      within = true;
    } else if (c == '$' && quote != '\'') {
      word += Expanded(line, i);
      within = true;
    } else if (quote) {
      word += c;
    } else if (c == '\'' || c == '"') {
      quote = c;
      within = true;
    } else if (c == ' ' || c == '\t' || c == '\r') {
      end_word();
    } else if (c == '#' && !within) {
      break;
    } else if (c == '~' && !within && (i + 1 == line.size() || line[i + 1] == '/')) {
      word = FromEnvironment("HOME");
      within = true;
    } else {
      word += c;
      within = true;
    }
  }
  if (quote) ThrowUsage(std::string("a ") + quote + " is not closed");
  end_word();
  return words;
}

std::vector<BatchItem> ParseBatchList(const std::string& text, const std::string& name,
                                      const std::vector<std::string>& more,
                                      const IsOthersFolder& is_others) {
  CheckIsText(text, name);
  std::vector<BatchItem> items;
  std::set<std::string> taken;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    try {
      BatchItem item;
      item.words = WordsOfLine(line);
      if (item.words.empty()) continue;
      item.line = number;
      if (item.words.front().rfind("--", 0) == 0)
        ThrowUsage("a line must begin with its source; options follow");
      if (const auto out = TakeOut(item.words)) {
        CheckFolderName(*out);
        if (!taken.insert(*out).second)
          ThrowUsage("--out " + *out + ": another line has the same name");
        item.name = *out;
      }
      item.words.insert(item.words.end(), more.begin(), more.end());
      items.push_back(std::move(item));
    } catch (const Error& error) {
      ThrowUsage(name + ":" + std::to_string(number) + ": " + error.what());
    }
  }
  if (items.empty()) ThrowUsage(name + ": the list contains no recording");
  for (BatchItem& item : items) {  // given names have priority
    if (!item.name.empty()) continue;
    const std::string own = FolderNameOf(SourceOf(item));
    item.name = own;
    const auto is_taken = [&] {
      return taken.count(item.name) > 0 || IsBatchsOwn(item.name) ||
             (is_others && is_others(item.name, SourceOf(item)));
    };
    for (int i = 2; is_taken(); ++i) item.name = own + "-" + std::to_string(i);
    taken.insert(item.name);
  }
  return items;
}

std::string LineOf(const BatchItem& item) {
  std::string line;
  for (const std::string& word : item.words) line += Quoted(word) + " ";
  return line + "--out " + Quoted(item.name);
}

}  // namespace alidade
