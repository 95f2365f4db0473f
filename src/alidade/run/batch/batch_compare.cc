#include "alidade/run/batch/batch_compare.h"

#include <algorithm>
#include <filesystem>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/run/folder/result_folder.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

// "monday" of "runs/monday/".
std::string LastPart(const std::string& folder) {
  return (fs::absolute(folder) / "").lexically_normal().parent_path().filename().string();
}

bool IsOneFolder(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return fs::equivalent(a, b, ignored);
}

}  // namespace

EarlierBatch ReadEarlierBatch(const std::string& path) {
  EarlierBatch earlier;
  const std::string file = IsFolder(path) ? path + "/batch.json" : path;
  earlier.folder = IsFolder(path) ? path : fs::absolute(path).parent_path().string();
  earlier.rows = ParseBatchJson(ReadFile(file), file);
  return earlier;
}

BatchComparison RunsToCompare(const std::string& folder, const std::vector<BatchRow>& rows,
                              const EarlierBatch* earlier) {
  BatchComparison page;
  // contains only the new batch
  if (earlier && IsOneFolder(folder, earlier->folder)) earlier = nullptr;
  std::string now, before;
  if (earlier) {
    now = LastPart(folder);
    before = LastPart(earlier->folder);
    if (now == before) {
      now = folder;
      before = earlier->folder;
    }
  }
  for (const BatchRow& row : rows) {
    if (!row.ok()) continue;
    const ComparedFolder own{folder + "/" + row.name, earlier ? now + "/" + row.name : row.name};
    if (earlier) {
      const auto same =
          std::find_if(earlier->rows.begin(), earlier->rows.end(),
                       [&](const BatchRow& old) { return old.name == row.name && old.ok(); });
      if (same != earlier->rows.end()) {
        const std::string path = earlier->folder + "/" + row.name;
        try {
          ReadResultFolder(path);
          page.runs.push_back({path, before + "/" + row.name});
        } catch (const Error& error) {
          page.missing.push_back(row.name + ": " + error.what());
        }
      }
    }
    page.runs.push_back(own);
  }
  return page;
}

}  // namespace alidade
