// What a benchmark measured: times and other figures, each with what it is of.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace alidade::bench {

// What a figure is of. Empty and 0: does not apply.
struct Case {
  std::string name;  // unique in a result together with sensor, profile and seed
  std::string sensor = {}, profile = {};
  std::string source = {};   // the recording, as it was named
  std::string variant = {};  // what was varied: part of the name
  int frames = 0;            // of the recording
  int seed = 0;              // 0: the median of all seeds
};

struct Timing {
  Case of;
  std::vector<double> milliseconds;  // in the order they were taken
  std::string note = {};             // how large the work was
};

struct Column {
  std::string metric;     // a name for programs, "ate_rmse"
  std::string unit = {};  // "": a number
};

struct Line {
  Case of;
  std::vector<double> values;  // one for each column; NaN: none
  std::string note = {};
};

struct Table {
  std::string name;
  std::vector<Column> columns;
  std::vector<Line> lines = {};
  std::string note = {};
};

struct Section {
  std::string name;
  std::vector<double> u_milliseconds = {};  // of the reference, taken in turns with the work
  std::vector<Timing> timings = {};
  std::vector<Table> tables = {};
};

}  // namespace alidade::bench
