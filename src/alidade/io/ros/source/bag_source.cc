#include "alidade/io/ros/source/bag_source.h"

#include <filesystem>
#include <utility>

#include "alidade/base/log.h"
#include "alidade/io/files/file.h"
#include "alidade/io/ros/source/bag_file.h"
#include "alidade/io/ros/source/bag_player.h"
#include "alidade/io/ros/source/choose_topics.h"
#include "alidade/io/ros/source/describe_topics.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

std::string NameOfRecording(const std::string& path) {
  fs::path name = NameAsTyped(path);
  if (IsFolder(path)) return name.string();
  while (name.has_extension() && (name.extension() == ".zstd" || name.extension() == ".active"))
    name = name.stem();
  return name.stem().string();
}

}  // namespace

OpenedBag OpenBagSource(const std::string& source, const SourceOptions& options) {
  const BagQuery query = ParseBagQuery(source);
  std::unique_ptr<BagFile> bag = OpenBagFile(query.path);
  for (const std::string& warning : bag->Warnings()) LogWarning(warning);
  const ChosenTopics chosen = ChooseTopics(*bag, query, options);
  const std::string folder =
      IsFolder(query.path) ? query.path : fs::path(query.path).parent_path().string();
  DescribedTopics described = DescribeTopics(*bag, query, chosen, folder, options);
  described.info.name = NameOfRecording(query.path);
  described.info.kind = "ros";
  auto player = std::make_unique<BagPlayer>(std::move(bag), query.path, chosen, query.max_dt);
  player->Begin(std::move(described.info), std::move(described.preparation), options.color);
  return {std::move(player), std::move(described.imu.recording)};
}

}  // namespace alidade
