// alidade-bench: how fast the parts are, how good the results. For developers; not installed.
#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

#include "alidade/base/parallel.h"
#include "bench/benches.h"

namespace {

void Describe(CLI::App& app, alidade::Action& action) {
  using namespace alidade::bench;
  cv::setNumThreads(1);
  alidade::SetThreadCount(0);
  app.name("alidade-bench");
  app.description("Measures Alidade: times beside OpenCV's ORB, errors beside the truth.");
  app.set_help_flag("-h,--help", "Show this help; each benchmark has its own");
  app.require_subcommand(1);
  AddPartBenches(app, action);
  AddWildBench(app, action);
  AddDynamicBench(app, action);
  AddSemiDenseBench(app, action);
  AddSurfaceBench(app, action);
  AddPhoneBench(app, action);
  AddReliabilityBench(app, action);
  AddScaleBenches(app, action);
  app.footer(  // after its benchmarks, which would show it as well
      "\nExamples:\n"
      "  alidade-bench frame\n"
      "  alidade-bench wild --cases hall,turn --seeds 1 --check\n"
      "  alidade-bench dynamic TUM --detector yolov5s.onnx --out bench/results/dynamic.json\n"
      "\nU is the median time of cv::ORB (1000 features, 640 pixels wide, one thread) on the same "
      "frames. bench/README.md describes the JSON files.");
}

}  // namespace

int main(int argc, char** argv) { return alidade::RunProgram(argc, argv, Describe); }
