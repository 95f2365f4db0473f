// The subcommands. Each adds itself to the command line. Parsing sets `action` to the chosen one;
// main runs it and returns its result as exit status.
#pragma once

#include "program/program.h"

namespace alidade {

void AddRunCommand(CLI::App& app, Action& action);
void AddLocalizeCommand(CLI::App& app, Action& action);
void AddRos2Command(CLI::App& app, Action& action);
void AddCamerasCommand(CLI::App& app, Action& action);
void AddEvaluateCommand(CLI::App& app, Action& action);
void AddSynthCommand(CLI::App& app, Action& action);
void AddExportCommand(CLI::App& app, Action& action);
void AddMeshCommand(CLI::App& app, Action& action);
void AddGridCommand(CLI::App& app, Action& action);
void AddViewCommand(CLI::App& app, Action& action);
void AddServeCommand(CLI::App& app, Action& action);
void AddPhoneCommand(CLI::App& app, Action& action);
void AddCompareCommand(CLI::App& app, Action& action);
void AddMergeCommand(CLI::App& app, Action& action);
void AddGeoreferenceCommand(CLI::App& app, Action& action);
void AddBatchCommand(CLI::App& app, Action& action);
void AddInfoCommand(CLI::App& app, Action& action);
void AddCalibrateCommand(CLI::App& app, Action& action);
void AddSettingsCommand(CLI::App& app, Action& action);
void AddBenchCommand(CLI::App& app, Action& action);      // names its successor
void AddDescribeCommands(CLI::App& app, Action& action);  // completion, man-pages, cli-page

}  // namespace alidade
