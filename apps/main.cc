// The alidade program and its subcommands.
#include <CLI/CLI.hpp>

#include "alidade/version.h"
#include "commands.h"
#include "old_forms.h"

namespace {

void AddCommands(CLI::App& app, alidade::Action& action) {
  alidade::AddRunCommand(app, action);
  alidade::AddLocalizeCommand(app, action);
  alidade::AddEvaluateCommand(app, action);
  alidade::AddSynthCommand(app, action);
  alidade::AddExportCommand(app, action);
  alidade::AddViewCommand(app, action);
  alidade::AddPhoneCommand(app, action);
  alidade::AddCompareCommand(app, action);
  alidade::AddMergeCommand(app, action);
  alidade::AddBatchCommand(app, action);
  alidade::AddInfoCommand(app, action);
  alidade::AddCalibrateCommand(app, action);
  alidade::AddSettingsCommand(app, action);
  alidade::AddBenchCommand(app, action);
  alidade::AddDescribeCommands(app, action);
}

void Describe(CLI::App& app, alidade::Action& action) {
  app.name("alidade");
  app.description(
      "Alidade: from what a moving camera sees to where it is and what the place looks like.");
  app.set_version_flag("--version", "alidade " ALIDADE_VERSION);
  app.set_help_flag("-h,--help", "Show this help; each command has its own");
  app.require_subcommand(1);
  app.footer(
      "\nExamples:\n"
      "  alidade run my_recording                    a TUM, EuRoC or KITTI folder, images or a "
      "video\n"
      "  alidade run \"synth:room?frames=300\"         a rendered room, no recording needed\n"
      "  alidade evaluate ate truth.txt alidade-out/my_recording/trajectory.txt\n"
      "  alidade run my_recording --viewer           watch it in a browser\n"
      "  alidade phone --host 0.0.0.0 --tls          the page for phones, for one in this network\n"
      "  alidade compare result_a result_b           two runs beside each other\n"
      "  alidade info alidade-out/my_recording       what is in a map\n"
      "  alidade run --help                          all of a command's options\n"
      "\nExit status: 0 done, 2 usage, 3 input, 4 nothing could be mapped, 70 a bug of ours, 130 "
      "interrupted.");
  AddCommands(app, action);
}

}  // namespace

int main(int argc, char** argv) {
  return alidade::RunProgram(argc, argv, Describe, alidade::WithoutOldForms);
}
