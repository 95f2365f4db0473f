#include "alidade/io/ros/containers/open_bag.h"

#include <algorithm>

#include "alidade/base/error.h"
#include "alidade/io/ros/containers/byte_source.h"
#include "alidade/io/ros/containers/indexed_bag.h"
#include "alidade/io/ros/containers/mcap_bag.h"
#include "alidade/io/ros/containers/ros1_bag.h"
#include "alidade/io/ros/containers/rosbag2_database.h"
#include "alidade/io/ros/containers/unpack.h"
#include "alidade/io/ros/containers/unpacked_file.h"

namespace alidade {
namespace {

std::unique_ptr<BagFile> OpenByContent(const std::string& path) {
  std::unique_ptr<ByteSource> source = OpenFileSource(path);
  const std::string start = source->Read(0, std::min<uint64_t>(source->Size(), 16));
  if (start.empty()) ThrowInput("is empty");
  if (LooksLikeRos1Bag(start)) return OpenRos1Bag(std::move(source));
  if (LooksLikeMcap(start)) return OpenMcapFile(std::move(source));
  if (LooksLikeDatabase(start)) return OpenRosbag2Database(path);
  ThrowInput("is neither a ROS bag, an MCAP file nor a database of rosbag2");
}

// true when the whole file is compressed (rosbag2's compression mode `file`).
bool IsPacked(const std::string& path) {
  const auto source = OpenFileSource(path);
  return LooksLikeZstd(source->Read(0, std::min<uint64_t>(source->Size(), 4)));
}

class SplitBag : public IndexedBag {
 public:
  explicit SplitBag(const std::vector<std::string>& paths) : paths_(paths) {
    std::string first_problem;
    for (const std::string& path : paths) {
      unpacked_.emplace_back();
      try {
        if (IsPacked(path)) unpacked_.back() = std::make_unique<UnpackedFile>(path);
        files_.push_back(OpenByContent(unpacked_.back() ? unpacked_.back()->path() : path));
        TakeOver(*files_.back());
      } catch (const Error& error) {
        files_.resize(unpacked_.size());
        const std::string problem = path + " " + error.what();
        if (first_problem.empty()) first_problem = problem;
        if (paths.size() > 1) Warn(problem + "; it is ignored");
      }
    }
    if (Topics().empty())
      ThrowInput(first_problem.empty() ? paths.front() + " contains no messages" : first_problem);
    SortByTime();
  }

  std::string Read(const BagMessage& message, std::string& bytes, uint64_t most) override {
    const std::string problem = files_[message.file]->Read(message, bytes, most);
    return problem.empty() ? problem : paths_[message.file] + " " + problem;
  }

 private:
  void TakeOver(const BagFile& file) {
    const auto number = static_cast<uint32_t>(files_.size() - 1);
    for (size_t i = 0; i < file.Topics().size(); ++i) {
      const BagTopic& from = file.Topics()[i];
      const size_t to = TopicOf(from.name, from.type, from.serialization);
      for (BagMessage message : file.Messages(i)) {
        message.file = number;
        Add(to, message);
      }
      Count(to, from.messages - static_cast<int64_t>(file.Messages(i).size()));
    }
    for (const std::string& warning : file.Warnings()) Warn(paths_[number] + " " + warning);
  }

  std::vector<std::string> paths_;
  // Declared before files_, which read from them.
  std::vector<std::unique_ptr<UnpackedFile>> unpacked_;
  std::vector<std::unique_ptr<BagFile>> files_;
};

}  // namespace

std::unique_ptr<BagFile> OpenBag(const std::vector<std::string>& paths) {
  if (paths.empty()) ThrowInput("there is no file to read");
  return std::make_unique<SplitBag>(paths);
}

}  // namespace alidade
