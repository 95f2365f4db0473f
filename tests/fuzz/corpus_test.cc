// Runs the fuzz targets on the seed corpus and on all inputs that ever failed (scripts/check/fuzz): every
// file must be read or rejected as its name states, in every build and without libFuzzer.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "alidade/io/files/file.h"
#include "fuzz/targets.h"

namespace alidade::fuzz {

void PrintTo(const Target& target, std::ostream* out) { *out << target.name; }

}  // namespace alidade::fuzz

namespace alidade::corpus_test {
namespace {

std::vector<std::string> CorpusOf(const fuzz::Target& target) {
  const std::string folder = std::string(ALIDADE_FUZZ_CORPUS) + "/" + target.name;
  std::vector<std::string> paths;
  for (const std::string& name : NamesIn(folder)) paths.push_back(folder + "/" + name);
  std::sort(paths.begin(), paths.end());
  return paths;
}

class FuzzCorpus : public testing::TestWithParam<fuzz::Target> {};

TEST_P(FuzzCorpus, IsReadOrRefused) {
  int accepted = 0;
  for (const std::string& path : CorpusOf(GetParam())) {
    SCOPED_TRACE(path);
    bool accepts = false;
    EXPECT_NO_THROW(accepts = fuzz::Accepts(GetParam(), ReadFile(path)));
    accepted += accepts ? 1 : 0;
    if (path.find("/good-") != std::string::npos) {
      EXPECT_TRUE(accepts);
    } else if (path.find("/bad-") != std::string::npos) {
      EXPECT_FALSE(accepts);
    }
  }
  EXPECT_GT(accepted, 0) << "nothing to begin with";
}

INSTANTIATE_TEST_SUITE_P(All, FuzzCorpus, testing::ValuesIn(fuzz::Targets()),
                         [](const auto& test) { return test.param.name; });

TEST(FuzzCorpusFolder, IsSmall) {
  uintmax_t bytes = 0;
  for (const fuzz::Target& target : fuzz::Targets()) {
    for (const std::string& path : CorpusOf(target)) bytes += std::filesystem::file_size(path);
  }
  EXPECT_LT(bytes, 300'000u);
}

}  // namespace
}  // namespace alidade::corpus_test
