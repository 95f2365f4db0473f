// What the benchmarks share: frames held in memory, and times beside U (docs/benchmarks/index.md).
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <string>
#include <vector>

#include "alidade/io/frame_source.h"

namespace alidade::bench {

struct Recording {
  std::string source;
  SourceInfo info;
  std::vector<SourceFrame> frames;  // that could be read
};

// `count` frames at most, from the first on. Throws Error (input) when there are fewer than 2.
Recording LoadRecording(const std::string& source, int count);

// Times of one thing, in the order they were taken.
struct Row {
  std::string name;
  std::vector<double> milliseconds;
  std::string note;  // of what size the work was
};

// What is no time: figures with a heading each.
struct Table {
  std::string name;
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows = {};  // one number for each column; NaN: nothing to tell
  std::string note = {};
  std::vector<std::string> labels = {};  // one for each row, or none at all
};

struct Section {
  std::string name;
  std::vector<double> u_milliseconds;  // of the reference, taken in turns with the rows
  std::vector<Row> rows;
  std::vector<Table> tables = {};
};

// The reference: cv::ORB, 1000 features, on one thread, on the frame scaled to 640 pixels in width.
// Milliseconds.
class Reference {
 public:
  Reference();
  double Run(const cv::Mat& image);

 private:
  cv::Ptr<cv::Feature2D> orb_;
};

// Something to time.
struct Subject {
  std::string name;
  std::function<void(int turn)> run;
  int threads = 1;  // of ParallelFor; 0 = all
  std::string note = {};
};

// Times the reference and every subject in turns, `turns` times each.
Section TakeTurns(const std::string& name, const Recording& recording,
                  std::vector<Subject> subjects, int turns);

Section BenchFeatures(const Recording& recording);
Section BenchRansac(const Recording& recording);
Section BenchBundle(const Recording& recording);
Section BenchFrame(const Recording& recording);
Section BenchPlace(const Recording& recording);

}  // namespace alidade::bench
