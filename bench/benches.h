// The benchmarks, each a subcommand with options of its own.
#pragma once

#include "program/program.h"

namespace alidade::bench {

void AddPartBenches(CLI::App& app, Action& action);  // frame, features, ransac, ba, place
void AddWildBench(CLI::App& app, Action& action);
void AddDynamicBench(CLI::App& app, Action& action);
void AddSemiDenseBench(CLI::App& app, Action& action);
void AddSurfaceBench(CLI::App& app, Action& action);
void AddPhoneBench(CLI::App& app, Action& action);
void AddReliabilityBench(CLI::App& app, Action& action);
void AddScaleBenches(CLI::App& app, Action& action);  // lasting, large-map

}  // namespace alidade::bench
