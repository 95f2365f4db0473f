// Plays the chosen topics of a ROS recording: one frame per message of the image topic, in order of
// time.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "alidade/io/calibration.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/io/frame_source.h"
#include "alidade/io/gray_levels.h"
#include "alidade/io/ros/source/choose_topics.h"
#include "alidade/io/ros/source/play_order.h"
#include "alidade/io/ros/source/topic_stamps.h"
#include "alidade/io/ros/source/topic_video.h"

namespace alidade {

class BagPlayer : public FrameSource {
 public:
  // `max_dt`: largest time difference of a frame's images, seconds; nullopt: 0.02 for depth, 0.003
  // for stereo.
  BagPlayer(std::unique_ptr<BagFile> bag, std::string path, const ChosenTopics& chosen,
            std::optional<double> max_dt);
  // Must be called once, before the first frame. Sets `info.frames`.
  void Begin(SourceInfo info, ImagePreparation preparation, bool color);

  const SourceInfo& Info() const override { return info_; }
  std::optional<SourceFrame> Next() override;
  bool Seek(int frames) override;

 private:
  // The image of message `i` of a topic.
  DecodedImage Read(const PictureTopic& topic, size_t i, ImageUse use);
  DecodedImage ReadPicture(const PictureTopic& topic, size_t i, ImageUse use);
  // The right or depth image of `frame`, which is message `i` of its topic; empty when there is
  // none. One that cannot be read sets SourceFrame::incomplete.
  cv::Mat Partner(std::optional<PartnerFinder>& finder, const PictureTopic& topic, size_t i,
                  ImageUse use, SourceFrame& frame);

  std::unique_ptr<BagFile> bag_;
  std::string path_;
  PictureTopic image_;
  std::optional<PictureTopic> right_, depth_;
  std::map<size_t, TopicVideo> videos_;  // by topic
  TopicStamps frames_;
  PlayOrder order_{frames_};
  std::optional<TopicStamps> right_stamps_, depth_stamps_;
  std::optional<PartnerFinder> right_finder_, depth_finder_;
  std::optional<ImagePreparation> preparation_;
  SourceInfo info_;
  GrayLevels levels_;
  bool color_ = false;
  bool told_order_ = false;  // a warning said that the messages are not in order
  int next_ = 0;
};

}  // namespace alidade
