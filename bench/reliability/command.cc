#include <memory>

#include "bench/benches.h"
#include "bench/measure/print.h"
#include "bench/measure/result_file.h"
#include "bench/options.h"
#include "bench/reliability/reliability.h"

namespace alidade::bench {
namespace {

struct Arguments {
  std::string out;
  int seeds = 1, first_seed = 1;
};

}  // namespace

void AddReliabilityBench(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "reliability", "Whether poses are as probably right as quality.probability says");
  const auto arguments = std::make_shared<Arguments>();
  AddSeeds(*command, arguments->seeds, "Seeds of all recordings");
  command->add_option("--first-seed", arguments->first_seed, "The first of them")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  AddOut(*command, arguments->out);
  command->callback([arguments, &action] {
    action = [arguments] {
      const Section section = BenchReliability(arguments->seeds, arguments->first_seed);
      PrintSection(section);
      WriteResult(arguments->out, "reliability", {section});
      return 0;
    };
  });
}

}  // namespace alidade::bench
