#include "alidade/io/ros/live/live_source.h"

#include <atomic>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/timing.h"
#include "alidade/io/files/depth_size.h"
#include "alidade/io/gray_levels.h"
#include "alidade/io/ros/live/domain.h"
#include "alidade/io/ros/live/first_messages.h"
#include "alidade/io/ros/live/frame_gatherer.h"
#include "alidade/io/ros/live/imu_joiner.h"
#include "alidade/io/ros/messages/messages.h"
#include "alidade/io/ros/messages/picture_of_message.h"
#include "alidade/io/ros/source/describe_topics.h"
#include "alidade/io/ros/source/topic_stamps.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

constexpr double kSettling = 2;  // seconds without a new topic until topics are chosen
constexpr double kFirstNotice = 3, kNextNotice = 30;  // seconds of waiting until users are told
constexpr double kStep = 0.1;                         // seconds of waiting at once
// Images kept by DDS while one is decoded; the newest complete one becomes the next frame.
constexpr int kImageDepth = 4, kImuDepth = 1000;

double Now() {
  static const Stopwatch clock;
  return 1e-3 * clock.Milliseconds();
}

std::string InDomain(const DdsDomain& domain) {
  return "ROS domain " + std::to_string(domain.id) + (domain.local_only ? " (this machine)" : "");
}

// Until topics of images have messages and no further topic appears.
void WaitForTopics(FirstMessages& first, DdsNode& node, const DdsDomain& domain,
                   const SourceOptions& options) {
  const double begin = Now();
  double told = begin - kNextNotice + kFirstNotice, changed = begin;
  while (!first.HasImages() || Now() - changed < kSettling) {
    if (options.interrupted != nullptr && options.interrupted())
      ThrowInput("interrupted while waiting for images on " + InDomain(domain));
    if (first.Gather(kStep)) changed = Now();
    for (const std::string& sentence : node.News()) LogWarning(sentence);
    if (first.HasImages() || Now() - told < kNextNotice) continue;
    told = Now();
    const std::string seen = first.Seen();
    LogWarning(
        "waiting for images on " + InDomain(domain) + ": " +
        (seen.empty() ? "no topic with images is published there" : "nothing comes on " + seen));
  }
}

// A topic that frames are made of.
// `alidade ros2` publishes by another participant, the node /alidade.
constexpr char kNodeName[] = "alidade_source";

struct Subscribed {
  PictureTopic topic;
  int number = -1;  // of the subscription
};

class Ros2Source : public TopicSource {
 public:
  Ros2Source(std::unique_ptr<DdsNode> node, const ChosenTopics& chosen, DescribedTopics described,
             const std::vector<BagTopic>& topics, const BagQuery& query, bool color)
      : node_(std::move(node)),
        info_(std::move(described.info)),
        preparation_(std::move(described.preparation)),
        units_(described.imu.units),
        color_(color) {
    image_ = Subscribe(chosen.image, topics);
    if (info_.sensor == Sensor::kRgbd) {
      partner_ = Subscribe(*chosen.depth, topics);
      max_dt_ = query.max_dt.value_or(kDepthWithin);
    } else if (info_.sensor == Sensor::kStereo) {
      partner_ = Subscribe(*chosen.right, topics);
      max_dt_ = query.max_dt.value_or(kPairWithin);
    }
    gatherer_.emplace(max_dt_, false);
    if (!described.imu.recording) return;
    rate_topic_ = topics[static_cast<size_t>(described.imu.rate_topic)].name;
    force_topic_ = topics[static_cast<size_t>(described.imu.force_topic)].name;
    imu_told_ = described.imu.recording->model;
  }

  const SourceInfo& Info() const override { return info_; }
  const std::optional<ImuModel>& ImuTold() const override { return imu_told_; }

  void UseImu(const ImuModel& model) override {
    info_.imu = model;
    gatherer_.emplace(max_dt_, true);
    rates_ = SubscribeTo(rate_topic_, kImuType, kImuDepth);
    forces_ = force_topic_ == rate_topic_ ? rates_ : SubscribeTo(force_topic_, kImuType, kImuDepth);
  }

  void Stop() override {
    stopped_ = true;
    node_->Wake();
  }

  std::optional<SourceFrame> Next() override {
    while (!stopped_) {
      for (DdsMessage& message : node_->Take(gathering_ ? kShortStep : kStep)) Add(message);
      for (const std::string& sentence : node_->News()) LogWarning(sentence);
      std::optional<GatheredFrame> gathered = gatherer_->Take(Now());
      gathering_ = !gathered && partner_;
      if (gathered) return Decoded(*gathered);
    }
    return std::nullopt;
  }

 private:
  static constexpr double kShortStep = 0.02;  // seconds, while an image waits for its partner

  int SubscribeTo(const std::string& name, const std::string& type, int depth) {
    std::string problem;
    const int number = node_->Subscribe(name, type, DdsQuality::kSensor, depth, &problem);
    if (number < 0) ThrowInput(name + ": " + problem);
    return number;
  }

  Subscribed Subscribe(const PictureTopic& topic, const std::vector<BagTopic>& topics) {
    return {topic, SubscribeTo(topic.name, topics[topic.topic].type, kImageDepth)};
  }

  void Add(DdsMessage& message) {
    try {
      if (message.subscription == rates_ || message.subscription == forces_)
        return AddImu(message.subscription, ParseRosImu(message.bytes, Serialization::kCdr));
      const MessageHeader header = ParseRosHeader(message.bytes, Serialization::kCdr);
      StampedBytes stamped{header.stamp != 0 ? header.stamp : message.sent,
                           std::move(message.bytes)};
      if (message.subscription == image_.number) {
        gatherer_->AddImage(std::move(stamped), Now());
      } else if (partner_ && message.subscription == partner_->number) {
        gatherer_->AddPartner(std::move(stamped));
      }
    } catch (const Error&) {  // DDS has checked the fields: cannot happen
    }
  }

  void AddImu(int subscription, const RosImu& imu) {
    if (!imu.angular_velocity.allFinite() || !imu.linear_acceleration.allFinite()) return;
    const double time = 1e-9 * static_cast<double>(imu.header.stamp);
    const Eigen::Vector3d rate = units_.rate * imu.angular_velocity;
    const Eigen::Vector3d force = units_.force * imu.linear_acceleration;
    if (rates_ == forces_) return gatherer_->AddImu({time, rate, force});
    if (subscription == rates_) {
      joiner_.AddRate(time, rate);
    } else {
      joiner_.AddForce(time, force);
    }
    for (const ImuSample& sample : joiner_.Take()) gatherer_->AddImu(sample);
  }

  cv::Mat Read(const Subscribed& from, const StampedBytes& message, ImageUse use, cv::Mat* color) {
    DecodedImage decoded =
        PictureOf(ParseRosPicture(message.bytes, Serialization::kCdr, from.topic.compressed), use);
    if (use == ImageUse::kDepth) decoded.image = ScaledUpDepth(decoded.image, image_.topic.size);
    if (decoded.image.size() != image_.topic.size)
      ThrowInput("is " + SizeText(decoded.image.size()) + ", but " + image_.topic.name +
                 "'s first was " + SizeText(image_.topic.size));
    if (color != nullptr) *color = decoded.color;
    return decoded.image;
  }

  SourceFrame Decoded(GatheredFrame& gathered) {
    SourceFrame frame;
    frame.number = number_++;
    frame.stamp = StampText(gathered.image.stamp);
    frame.time = ParseNumber(frame.stamp).value_or(0);
    frame.imu = std::move(gathered.imu);
    try {
      cv::Mat color;
      const ImageUse use = color_ ? ImageUse::kGrayAndColor : ImageUse::kGray;
      const cv::Mat image = Read(image_, gathered.image, use, &color);
      frame.image = preparation_.Left(levels_.To8Bit(image, frame.time));
      if (!color.empty()) frame.color = preparation_.Left(levels_.ColorTo8Bit(color));
    } catch (const Error& error) {
      frame.problem =
          "the message of " + image_.topic.name + " at " + frame.stamp + " " + error.what();
      return frame;
    }
    if (!partner_ || !gathered.partner) return frame;
    const bool depth = info_.sensor == Sensor::kRgbd;
    try {
      const cv::Mat read =
          Read(*partner_, *gathered.partner, depth ? ImageUse::kDepth : ImageUse::kGray, nullptr);
      if (depth) {
        frame.depth = preparation_.Depth(read);
      } else {
        frame.right = preparation_.Right(levels_.To8Bit(read, frame.time));
      }
    } catch (const Error& error) {
      frame.incomplete =
          "the message of " + partner_->topic.name + " at " + frame.stamp + " " + error.what();
    }
    return frame;
  }

  std::unique_ptr<DdsNode> node_;
  SourceInfo info_;
  ImagePreparation preparation_;
  ImuUnits units_;
  const bool color_;  // read the frames' colors as well
  Subscribed image_;
  std::optional<Subscribed> partner_;
  std::string rate_topic_, force_topic_;  // the same where a topic has both
  std::optional<ImuModel> imu_told_;
  int rates_ = -1, forces_ = -1;  // subscriptions
  ImuJoiner joiner_;
  std::optional<double> max_dt_;  // see FrameGatherer
  std::optional<FrameGatherer> gatherer_;
  GrayLevels levels_;
  bool gathering_ = false;  // an image may wait for its partner
  int number_ = 0;          // of the next frame
  std::atomic<bool> stopped_{false};
};

}  // namespace

bool IsRos2Source(const std::string& source) { return source.rfind(kRos2Source, 0) == 0; }

std::unique_ptr<TopicSource> OpenRos2Source(const std::string& source,
                                            const SourceOptions& options) {
  const BagQuery query = ParseBagQuery(source);
  if (query.path != kRos2Source)
    ThrowUsage("topics of ROS 2 are ros2: or ros2:?image=TOPIC&depth=TOPIC…, not " + source);
  const DdsDomain domain = DomainFromEnvironment();
  std::unique_ptr<DdsNode> node = JoinDomain(domain, kNodeName);
  ChosenTopics chosen;
  std::optional<DescribedTopics> described;
  std::vector<BagTopic> topics;
  {
    FirstMessages first(*node, query);
    WaitForTopics(first, *node, domain, options);
    for (const std::string& warning : first.Warnings()) LogWarning(warning);
    chosen = ChooseTopics(first, query, options);
    described.emplace(DescribeTopics(first, query, chosen, std::nullopt, options));
    topics = first.Topics();
  }
  described->info.name = "ros2";
  described->info.kind = "ros2";
  described->info.live = true;
  return std::make_unique<Ros2Source>(std::move(node), chosen, std::move(*described), topics, query,
                                      options.color);
}

}  // namespace alidade
