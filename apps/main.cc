// The alidade program and its subcommands.
#include <CLI/CLI.hpp>

#include "alidade/version.h"
#include "commands.h"
#include "old_forms.h"

namespace {

void AddCommands(CLI::App& app, alidade::Action& action) {
  alidade::AddRunCommand(app, action);
  alidade::AddLocalizeCommand(app, action);
  alidade::AddRos2Command(app, action);
  alidade::AddCamerasCommand(app, action);
  alidade::AddEvaluateCommand(app, action);
  alidade::AddSynthCommand(app, action);
  alidade::AddExportCommand(app, action);
  alidade::AddMeshCommand(app, action);
  alidade::AddGridCommand(app, action);
  alidade::AddViewCommand(app, action);
  alidade::AddServeCommand(app, action);
  alidade::AddPhoneCommand(app, action);
  alidade::AddCompareCommand(app, action);
  alidade::AddMergeCommand(app, action);
  alidade::AddGeoreferenceCommand(app, action);
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
      "Alidade: visual SLAM. Estimates the trajectory of a moving camera and a map of the place.");
  app.set_version_flag("--version", "alidade " ALIDADE_VERSION);
  app.set_help_flag("-h,--help", "Show this help; each command has its own");
  app.require_subcommand(1);
  AddCommands(app, action);
  // After the commands, which would inherit it.
  app.footer(
      "\nExamples:\n  alidade run my_recording                    a TUM, EuRoC or KITTI folder, "
      "images or a video\n  alidade run \"synth:room?frames=300\"         a rendered room, no "
      "recording needed\n  alidade evaluate ate truth.txt "
      "alidade-out/my_recording/trajectory.txt\n  alidade run my_recording --viewer           "
      "watch the run in a browser\n  alidade phone --host 0.0.0.0 --tls          the page for "
      "phones in this network\n  alidade compare result_a result_b           a page that compares "
      "two runs\n  alidade info alidade-out/my_recording       what a map contains\n  alidade run "
      "--help                          all options of a command\n\nExit status: 0 done, 2 wrong "
      "usage, 3 invalid input, 4 nothing could be mapped, 70 internal error (a bug), 130 "
      "interrupted.");
}

}  // namespace

int main(int argc, char** argv) {
  return alidade::RunProgram(argc, argv, Describe, alidade::WithoutOldForms);
}
